"""The few values of ``scene.nml`` that figures show beside the results: toughness and friction."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from wingcrack_post.errors import RunError

# one group: "&name ... /", where a slash inside a quoted string does not end the group
_QUOTED = r"'[^']*'|\"[^\"]*\""
_GROUP = re.compile(rf"&(\w+)((?:{_QUOTED}|[^'\"/])*)/")
_ASSIGNMENT = re.compile(rf"(\w+)\s*(?:\([^)]*\))?\s*=\s*((?:{_QUOTED}|[^=&'\"])*?)(?=\s*,?\s*\w+\s*(?:\([^)]*\))?\s*=|\s*$)")  # fmt: skip  # noqa: E501
_COMMENT = re.compile(rf"({_QUOTED})|![^\n]*")


@dataclass(frozen=True)
class FractureLaw:
    """What the scene says about one fracture."""

    name: str
    friction: float | None  # mu_s [-]


@dataclass(frozen=True)
class Scene:
    """What figures use of a scene.

    Attributes
    ----------
    name, title : str
    toughness_pa_sqrtm : float or None
        K_IC [Pa m^1/2]; None if the scene has none.
    fractures : tuple of FractureLaw
        In the order of the file, which is the order of the numbers in the results.
    """

    name: str
    title: str
    toughness_pa_sqrtm: float | None
    fractures: tuple[FractureLaw, ...]

    def fracture(self, label: str) -> FractureLaw | None:
        """The law of a fracture known by its name or by its number from 1."""
        for fracture in self.fractures:
            if fracture.name == label:
                return fracture
        if label.isdecimal() and 1 <= int(label) <= len(self.fractures):
            return self.fractures[int(label) - 1]
        return None


def read_groups(text: str) -> list[tuple[str, dict[str, str]]]:
    """Split a Fortran namelist text into its groups, each a name and the raw text of its values.

    >>> read_groups("&material toughness = 7.0e5, young=4e10 / ! rock")
    [('material', {'toughness': '7.0e5', 'young': '4e10'})]
    """
    plain = _COMMENT.sub(lambda match: match.group(1) or "", text)
    groups = []
    for group, body in _GROUP.findall(plain):
        values = {
            key.lower(): value.strip().rstrip(",").strip()
            for key, value in _ASSIGNMENT.findall(body)
        }
        groups.append((group.lower(), values))
    return groups


def read_scene(path: Path) -> Scene | None:
    """Read ``scene.nml``; None where the run has none."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as reason:
        raise RunError(f"{path}: the file cannot be read ({reason}).") from None
    groups = read_groups(text)
    toughness: float | None = None
    name = title = ""
    fractures = []
    for group, values in groups:
        if "toughness" in values:
            toughness = _number(path, group, "toughness", values["toughness"])
        if group == "fracture":
            friction = (
                _number(path, group, "friction", values["friction"])
                if "friction" in values
                else None
            )
            fractures.append(FractureLaw(_string(values.get("name", "")), friction))
        elif group == "scene":
            name, title = _string(values.get("name", "")), _string(values.get("title", ""))
    if toughness is not None and toughness > 1e30:  # huge(): the scene has no toughness
        toughness = None
    return Scene(name, title, toughness, tuple(fractures))


def _string(raw: str) -> str:
    return raw.strip().strip("'\"").strip()


def _number(path: Path, group: str, key: str, raw: str) -> float:
    try:
        return float(raw.lower().replace("d", "e"))
    except ValueError:
        raise RunError(f"{path}: '{raw}' for {key} in &{group} is no number.") from None
