"""What a scene can hold: the solver's own table of groups and names, in words."""

from __future__ import annotations

import difflib
import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from wingcrack.errors import EnvironmentLacksError, SceneError
from wingcrack.names import table

TOP = Path(__file__).resolve().parents[3]
_SOLVER = TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver"


@dataclass(frozen=True)
class Parameter:
    """A name of a group of the scene file, as docs/input.md has it.

    Attributes
    ----------
    group, name : str
    repeated : bool
        Whether the group may be given once per item.
    kind : str
        text, number, whole number, logical, or a list of these.
    unit : str
        ``-`` where it has none.
    default, allowed, meaning : str
        In words.
    """

    group: str
    name: str
    repeated: bool
    kind: str
    unit: str
    default: str
    allowed: str
    meaning: str


def solver() -> Path:
    """Place of the solver: what ``WINGCRACK_SOLVER`` names, or what ``./wingcrack build`` built.

    Raises
    ------
    EnvironmentLacksError
        If it is not there.
    """
    found = Path(os.environ.get("WINGCRACK_SOLVER") or _SOLVER)
    if not os.access(found, os.X_OK) or found.is_dir():
        raise EnvironmentLacksError(f"there is no solver {found}; ./wingcrack build makes it")
    return found


@cache
def parameters() -> dict[str, Parameter]:
    """Every name that a scene may hold, by ``group.name``.

    >>> wingcrack.parameters()["fracture.friction"].unit  # doctest: +SKIP
    '-'
    """
    return {
        f"{group['name']}.{row['name']}": Parameter(
            group["name"],
            row["name"],
            group.get("repeated", False),
            _kind(row),
            row["unit"],
            _default(row),
            _allowed(row),
            _meaning(row),
        )
        for group in table()["groups"]
        for row in group["parameters"]
    }


def _kind(row: dict[str, Any]) -> str:
    if row["kind"] in ("choice", "name"):
        return "text"
    return "number or text" if row["kind"] == "number" and "choices" in row else str(row["kind"])


def _default(row: dict[str, Any]) -> str:
    if "default" in row:
        return f"`{row['default']}`"
    if "required" not in row:
        return str(row["absent"]) if "derived" in row else f"none: {row['absent']}"
    if row["required"] == "always":
        return "required"
    return f"required {row['required']}".replace("its choice", _choice(row))


def _choice(row: dict[str, Any]) -> str:
    return "".join(f"the {name} '{value}'" for name, value in row.get("of", {}).items())


def _allowed(row: dict[str, Any]) -> str:
    choices = ", ".join(f"`{choice}`" for choice in row.get("choices", ()))
    if row["kind"] == "choice":
        return choices
    if row["kind"] == "logical":
        return "`.true.`, `.false.`"
    if row["kind"] in ("name", "list of names"):
        return "at most 64 letters, digits, `_`, `-`, `.`"
    if row["kind"] == "text":
        return "at most 256 bytes of UTF-8"
    bounds = [
        f"{word} {_bound(row[key], 'whole' in row['kind'])}"
        for key, word in (
            ("minimum", "greater than" if "above_minimum" in row else "at least"),
            ("maximum", "less than" if "below_maximum" in row else "at most"),
        )
        if key in row
    ]
    others = [f"at most {row['at_most']}"] if "at_most" in row else []
    words = ", ".join([*filter(None, [" and ".join(bounds)]), *others]) or "any finite"
    return f"{words}, or {choices}" if choices else words


def _bound(value: float, whole: bool) -> str:
    """A number as the solver writes it: 1.0e-6, but without a fraction if all values are whole."""
    if whole:
        return f"{value:.0f}"
    digits, mark, power = repr(value).partition("e")
    return f"{digits if '.' in digits else digits + '.0'}e{int(power)}" if mark else digits


def _meaning(row: dict[str, Any]) -> str:
    words = row["meaning"]
    if "with" in row:
        words += f"; given together with {row['with']}"
    if "of" in row and row.get("required") != "with its choice":
        words += f"; only with {_choice(row)}"
    return f"{words}; only {row['scenes']}" if "scenes" in row else str(words)


def parameter(group: str, name: str) -> Parameter:
    """One of them.

    Raises
    ------
    SceneError
        If there is no such group, or no such name in it; it tells the nearest one.
    """
    known = parameters()
    if f"{group}.{name}" in known:
        return known[f"{group}.{name}"]
    groups = {entry.group for entry in known.values()}
    if group not in groups:
        raise SceneError(f"there is no group &{group}{_near(group, sorted(groups))}")
    names = [entry.name for entry in known.values() if entry.group == group]
    raise SceneError(f"&{group} has no name '{name}'{_near(name, names)}")


def _near(word: str, known: list[str]) -> str:
    near = difflib.get_close_matches(word, known, n=1)
    return f"; did you mean '{near[0]}'?" if near else f"; there are {', '.join(known)}"
