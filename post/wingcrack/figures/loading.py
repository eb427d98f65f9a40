"""How a body is loaded and held, from its scene: tractions along its sides, forces, supports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wingcrack.figures.errors import RunError
from wingcrack.figures.scene import read_groups
from wingcrack.figures.table import FloatArray
from wingcrack.figures.text_files import read_text

_PER_SIDE = 5  # arrows
_PER_RIM = 24
_Values = Mapping[str, Sequence[str]]


@dataclass(frozen=True)
class Support:
    """A point that cannot move freely [m], the direction out of the body there, and in what."""

    place: FloatArray
    outwards: FloatArray
    in_x: bool
    in_y: bool


@dataclass
class Loading:
    """What acts on a body; places and vectors are lists of pairs.

    Attributes
    ----------
    traction_places, tractions : list of array
        Points of the outer boundary [m], and the total traction there [Pa]: that of the side and
        that of the stress in situ.
    force_places, forces : list of array
        Point loads [m], [N/m].
    sides : list of int
        Number of the side that each traction belongs to, from 0.
    held, springs : list of Support
        Points of the outer boundary or of the body that are held, or stand on springs.
    changes : bool
        Whether a traction changes with time; that of the beginning is given then.
    """

    traction_places: list[FloatArray] = field(default_factory=list)
    tractions: list[FloatArray] = field(default_factory=list)
    sides: list[int] = field(default_factory=list)
    force_places: list[FloatArray] = field(default_factory=list)
    forces: list[FloatArray] = field(default_factory=list)
    held: list[Support] = field(default_factory=list)
    springs: list[Support] = field(default_factory=list)
    changes: bool = False


def read_loading(path: Path, outline: FloatArray | None) -> Loading:
    """Read what acts on the body from ``scene.nml``; nothing where it does not tell the outline.

    Raises
    ------
    RunError
        If a value is no number.
    """
    found = Loading()
    if outline is None or not path.exists():
        return found
    try:
        groups = read_groups(read_text(path))
        _fill(found, groups, outline)
    except (OSError, ValueError, IndexError) as reason:
        raise RunError(f"{path}: the sides cannot be read ({reason}).") from None
    return found


def _fill(found: Loading, groups: Sequence[tuple[str, _Values]], outline: FloatArray) -> None:
    shape = next((_word(v, "shape") for name, v in groups if name == "domain"), "") or "rectangle"
    situ = next((v for name, v in groups if name == "in_situ"), {})
    sides = [values for name, values in groups if name == "side"]
    for piece in _pieces(outline, shape):
        places, normals = _samples(piece, outline, shape)
        mine = [side for side in sides if _belongs(side, piece, shape)]
        for place, normal in zip(places, normals, strict=True):
            on_place = [side for side in mine if shape != "disc" or _on_arc(side, normal)]
            _add(found, piece, place, normal, on_place, situ)
    for name, values in groups:
        if name == "point_load":
            found.force_places.append(_pair(values, "x", "y"))
            found.forces.append(_pair(values, "x_force", "y_force"))
        elif name == "restraint":
            place = _pair(values, "x", "y")
            away = place - outline[:-1].mean(axis=0)
            away = away / max(float(np.linalg.norm(away)), 1e-300)
            held = ["x_displacement" in values, "y_displacement" in values]
            found.held.append(Support(place, away, held[0], held[1]))


def _pieces(outline: FloatArray, shape: str) -> list[int]:
    """Numbers of the edges, from 0; a disc has one."""
    return [0] if shape == "disc" else list(range(len(outline) - 1))


def _samples(piece: int, outline: FloatArray, shape: str) -> tuple[FloatArray, FloatArray]:
    """Places along an edge [m] and outward normals there."""
    if shape == "disc":
        angle = 2.0 * np.pi * (np.arange(_PER_RIM) + 0.5) / _PER_RIM
        normals = np.column_stack((np.cos(angle), np.sin(angle)))
        centre = outline[:-1].mean(axis=0)
        radius = float(np.linalg.norm(outline[0] - centre))
        return centre + radius * normals, normals
    start, end = outline[piece], outline[piece + 1]
    share = (np.arange(_PER_SIDE) + 0.5) / _PER_SIDE
    along = (end - start) / np.linalg.norm(end - start)
    x, y = outline.T
    turn = 1.0 if float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) > 0.0 else -1.0
    normal = turn * np.array([along[1], -along[0]])
    return start + share[:, None] * (end - start), np.tile(normal, (_PER_SIDE, 1))


_RECTANGLE = ("bottom", "right", "top", "left")  # in the order of the outline's edges


def _belongs(side: _Values, piece: int, shape: str) -> bool:
    if shape == "rectangle":
        return _word(side, "name") == _RECTANGLE[piece]
    if shape == "polygon":
        return piece + 1 in _numbers(side, "edges")
    return True


def _on_arc(side: _Values, normal: FloatArray) -> bool:
    ends = [*_numbers(side, "arc_from_deg"), *_numbers(side, "arc_to_deg")]
    if len(ends) != 2:
        return True
    angle = float(np.degrees(np.arctan2(normal[1], normal[0])))
    return (angle - ends[0]) % 360.0 <= ends[1] - ends[0]


def _add(
    found: Loading,
    piece: int,
    place: FloatArray,
    normal: FloatArray,
    sides: Sequence[_Values],
    situ: _Values,
) -> None:
    """Traction and support of a point of the outer boundary."""
    traction = _stress(situ, float(place[1])) @ normal
    along = np.array([-normal[1], normal[0]])  # has the body on its left
    held = [False, False]
    for side in sides:
        traction = traction + np.array([_first(side, f"{axis}_traction") for axis in "xy"])
        traction = traction + _first(side, "normal_traction") * normal
        traction = traction + _first(side, "shear_traction") * along
        held = [
            before or f"{axis}_displacement" in side
            for before, axis in zip(held, "xy", strict=True)
        ]
        if "x_spring" in side or "y_spring" in side:
            found.springs.append(Support(place, normal, "x_spring" in side, "y_spring" in side))
        names = ("x_traction", "y_traction", "normal_traction", "shear_traction")
        found.changes |= any(len(set(_numbers(side, name))) > 1 for name in names)
    if np.any(traction != 0.0):
        found.traction_places.append(place)
        found.tractions.append(traction)
        found.sides.append(piece)
    if any(held):
        found.held.append(Support(place, normal, held[0], held[1]))


def _stress(situ: _Values, y: float) -> FloatArray:
    """Stress in situ at a height [Pa]."""
    height = y - _first(situ, "y_datum")
    xx = _first(situ, "sxx") + height * _first(situ, "sxx_per_y")
    yy = _first(situ, "syy") + height * _first(situ, "syy_per_y")
    xy = _first(situ, "sxy")
    return np.array([[xx, xy], [xy, yy]])


def _pair(values: _Values, *names: str) -> FloatArray:
    return np.array([_first(values, name) for name in names])


def _first(values: _Values, name: str) -> float:
    return next(iter(_numbers(values, name)), 0.0)


def _numbers(values: _Values, name: str) -> list[float]:
    return [float(raw.lower().replace("d", "e")) for raw in values.get(name, ())]


def _word(values: _Values, name: str) -> str:
    return "".join(values.get(name, ())[:1]).strip("'\"").strip()
