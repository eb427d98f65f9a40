"""Names and entries of scene groups from the attributes of a map's features."""

from __future__ import annotations

import math
import re
import unicodedata
from collections import Counter
from collections.abc import Mapping, Sequence

from wingcrack.runs.parameter_table import Parameter
from wingcrack.scenes.errors import SceneError
from wingcrack.scenes.namelist import Value
from wingcrack.scenes.parameters import Group, groups
from wingcrack_maps.features import Area, Line, Map
from wingcrack_maps.geometry import NAMES

_LONGEST = 64  # characters of a name
_GEOMETRIC = ("name", "x", "y", "x_other", "y_other", "x_vertex", "y_vertex", "curvature", "shape")


def give_names(content: Map, taken: set[str]) -> None:
    """Make all names such that a scene may have them, each different; what changes is noted.

    `taken`: names that are there already.
    """
    nameless = 0
    kinds: tuple[tuple[str, Sequence[Line | Area], set[str]], ...] = (
        ("f", content.lines, set(taken)),
        ("r", content.areas, set()),
        ("w", content.wells, set()),
    )
    for stem, items, used in kinds:
        for number, item in enumerate(items, start=1):
            wanted = item.name
            nameless += not wanted
            name = _allowed(wanted) if wanted else f"{stem}{number}"
            item.name = _different(name or f"{stem}{number}", used)
            used.add(item.name)
            if wanted and item.name != wanted:
                content.note("renamed", f"{item.source}: '{wanted}' is called '{item.name}'")
    if nameless:
        content.note("unnamed", f"{nameless} features without a name are called f1, f2, r1 or w1")


def _allowed(name: str) -> str:
    """Letters, digits, `_`, `-` and `.` of a name, letters without their accents.

    The first one is a letter or a digit.
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", plain).lstrip("_.-").rstrip("_")[:_LONGEST]


def _different(name: str, used: set[str]) -> str:
    number, candidate = 1, name
    while candidate in used:
        number += 1
        ending = f"_{number}"
        candidate = name[: _LONGEST - len(ending)] + ending
    return candidate


def entry_values(
    group_name: str, features: list[Line] | list[Area], content: Map, path: str
) -> list[dict[str, Value]]:
    """Entries of a group for each feature, by the names of its attributes.

    Attributes that are no entry of the group are noted, once each. Raises `SceneError` if a value
    is of the wrong kind.
    """
    group = groups()[group_name]
    unknown: Counter[str] = Counter()
    found = []
    for feature in features:
        values: dict[str, Value] = {}
        for word, value in feature.attributes.items():
            name = word.strip().lower()
            if name in NAMES or name == "kind" or value in (None, ""):
                continue
            number = _number(value)
            if group_name == "injection" and number is not None:
                # rates, with the ending of a unit too, which the solver knows
                stem = next((n for n in ("rate", "pressure") if name.startswith(n)), "")
                if (stem and name.startswith(f"{stem}_")) or name == stem:
                    values[name] = number
                    continue
            if name in group.parameters and name not in _GEOMETRIC:
                where = f"{path}: {feature.source}"
                values[name] = entry_value(group.parameters[name], value, where)
            else:
                unknown[word] += 1
        found.append(values)
    for word, times in unknown.items():
        what = f"'{word}' of {times} features is no entry of &{group_name}"
        content.note("attribute left out", what)
    return found


def entry_value(parameter: Parameter, value: object, where: str) -> Value:
    """Give a value as the kind that the parameter has.

    Raises `SceneError` if it cannot be one.
    """
    if parameter.kind == "number":
        number = _number(value)
        if number is not None:
            return number
    elif parameter.kind == "text" and isinstance(value, str):
        return value
    elif parameter.kind == "logical":
        if isinstance(value, bool):
            return value
        if str(value).strip(".").lower() in ("true", "false"):
            return str(value).strip(".").lower() == "true"
    raise SceneError(
        f"{where}: {parameter.name} is {value!r} but must be a {parameter.kind}"
        + (f" in {parameter.unit}" if parameter.unit not in ("", "-") else "")
    )


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def set_regions(texts: Sequence[str], content: Map) -> None:
    """Give regions what the command line says of them, as REGION:NAME=VALUE."""
    for text in texts:
        name, mark, rest = text.partition(":")
        found = [area for area in content.areas if area.name == name and area.role == "region"]
        if not (mark and found):
            known = ", ".join(area.name for area in content.areas if area.role == "region")
            raise SceneError(
                f"--region {text}: it must be REGION:NAME=VALUE with a REGION of the map"
                f" ({known or 'which has none'})"
            )
        word, value = setting(rest, groups()["region"], "--region")
        found[0].attributes[word] = value


def setting(text: str, group: Group, option: str = "--set") -> tuple[str, Value]:
    """Understand NAME=VALUE of the command line for a group."""
    name, mark, value = text.partition("=")
    name = name.strip().lower()
    if not mark or name not in group.parameters or name in _GEOMETRIC:
        known = ", ".join(n for n in group.parameters if n not in _GEOMETRIC)
        raise SceneError(f"{option} {text}: it must be NAME=VALUE with a NAME of {known}")
    return name, entry_value(group.parameters[name], value.strip(), f"{option} {text}")


def complete(
    values: list[dict[str, Value]], defaults: Mapping[str, Value], content: Map, assumed: bool
) -> None:
    """Add what is missing to the entries of each fracture.

    `assumed`: the values are ours and not the user's: that is noted.
    """
    for name, value in defaults.items():
        lacking = [entries for entries in values if name not in entries]
        for entries in lacking:
            entries[name] = value
        if lacking and assumed:
            content.note("assumed", f"{name} = {value} for {len(lacking)} fractures that say none")
