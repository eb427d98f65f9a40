"""The body as the scene has it: its outline, loads as arrows, supports, wells, first fractures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from wingcrack.errors import RunError
from wingcrack.figures import style
from wingcrack.figures.read import Run
from wingcrack.figures.regions import draw_regions
from wingcrack.figures.scene import read_groups
from wingcrack.figures.story_map import draw_wells
from wingcrack.figures.table import FloatArray
from wingcrack.figures.text_files import read_text
from wingcrack.figures.units import Unit, length_unit, stress_unit

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
    """What acts on a body; places and vectors are lists of pairs."""

    # traction_places, tractions: points of the outer boundary [m], and the total traction there
    # [Pa]: that of the side and that of the stress in situ
    traction_places: list[FloatArray] = field(default_factory=list)
    tractions: list[FloatArray] = field(default_factory=list)
    # number of the side that each traction belongs to, from 0
    sides: list[int] = field(default_factory=list)
    # force_places, forces: point loads [m], [N/m]
    force_places: list[FloatArray] = field(default_factory=list)
    forces: list[FloatArray] = field(default_factory=list)
    # held, springs: points of the outer boundary or of the body that are held, or stand on springs
    held: list[Support] = field(default_factory=list)
    springs: list[Support] = field(default_factory=list)
    # whether a traction changes with time; that of the beginning is given then
    changes: bool = False


def read_loading(path: Path, outline: FloatArray | None) -> Loading:
    """Read what acts on the body from ``scene.nml``; nothing where it does not tell the outline.

    Raises `RunError` if a value is no number.
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


_ARROW = 0.13  # of the body's size: the longest arrow
_MOST_ARROWS = 5  # of a side that is straight
_ROOM = 0.21  # of the body's size around it
_COLOUR = "#0072B2"
_SUPPORT: dict[str, Any] = {"mec": "#555555", "mew": 0.7, "mfc": "none", "ls": "none"}


def draw_geometry(axes: Axes, run: Run) -> list[Artist]:
    """Draw the body with what acts on it into axes and give the entries of a legend.

    Nothing is drawn of a body whose outline the scene does not tell.
    """
    scene = run.scene
    body = None if scene is None else scene.outline
    if scene is None or body is None:
        axes.text(0.5, 0.5, "scene.nml has no body", transform=axes.transAxes, ha="center")
        axes.set_axis_off()
        return []
    unit = length_unit(body)
    size = float(np.ptp(body, axis=0).max())
    handles: list[Artist] = [*draw_regions(axes, scene.regions, scene.permeability_m2, body, unit)]
    axes.plot(*unit.of(body).T, color="#555555", linewidth=0.9, zorder=2)
    _draw_fractures(axes, run, unit)
    loading = read_loading(run.directory / "scene.nml", body)
    handles = [
        *_draw_tractions(axes, loading, body, size, unit),
        *_draw_forces(axes, loading, size, unit),
        *_draw_supports(axes, loading, size, unit),
        *draw_wells(axes, run, unit),
        *handles,
    ]
    low, high = unit.of(body.min(axis=0)), unit.of(body.max(axis=0))
    room = _ROOM * float(unit.of(size))
    axes.set_xlim(low[0] - room, high[0] + room)
    axes.set_ylim(low[1] - room, high[1] + room)
    style.map_axes(axes, unit)
    return handles


def _draw_fractures(axes: Axes, run: Run, unit: Unit) -> None:
    """Fractures at the start."""
    network = run.network or {}
    first = network["steps"][0] if network.get("steps") else network
    for item in first.get("fractures", []):
        points = np.column_stack((item["x_m"], item["y_m"])).astype(np.float64)
        axes.plot(*unit.of(points).T, color="#000000", linewidth=1.2, zorder=3)


def _draw_tractions(
    axes: Axes, loading: Loading, body: FloatArray, size: float, unit: Unit
) -> list[Artist]:
    """Arrows outside the body: towards it in compression, away from it in tension."""
    if not loading.tractions:
        return []
    places, tractions = np.array(loading.traction_places), np.array(loading.tractions)
    largest = float(np.linalg.norm(tractions, axis=1).max())
    arrows = _ARROW * size / largest * tractions
    inward = np.sum(tractions * (places - body[:-1].mean(axis=0)), axis=1) < 0.0
    _draw_arrows(axes, places, arrows, inward, unit)
    stress = stress_unit(largest)
    middle = body[:-1].mean(axis=0)
    for side in sorted(set(loading.sides)):
        _name_traction(axes, loading, side, middle, size, (unit, stress))
    label = f"traction, largest {float(stress.of(largest)):.3g} {stress.name}"
    label += ", at the start" if loading.changes else ""
    return [_arrow_handle(label, _COLOUR)]


def _name_traction(
    axes: Axes,
    loading: Loading,
    side: int,
    middle: FloatArray,
    size: float,
    units: tuple[Unit, Unit],
) -> None:
    """Write how large the traction is beyond the arrows of a side on which it is uniform."""
    mine = [k for k, one in enumerate(loading.sides) if one == side]
    tractions = np.array([loading.tractions[k] for k in mine])
    if not np.allclose(tractions, tractions[0]) or len(mine) > _MOST_ARROWS:
        return
    unit, stress = units
    place = np.mean([loading.traction_places[k] for k in mine], axis=0)
    away = place - middle
    away = away / max(float(np.linalg.norm(away)), 1e-300)
    value = float(stress.of(np.linalg.norm(tractions[0])))
    upright = abs(away[0]) > abs(away[1])
    largest = float(np.linalg.norm(np.array(loading.tractions), axis=1).max())
    length = _ARROW * float(np.linalg.norm(tractions[0])) / largest
    x, y = unit.of(place + (length + 0.04) * size * away)
    axes.text(
        float(x),
        float(y),
        f"{value:.3g} {stress.name}",
        fontsize=6.5,
        ha="center",
        va="center",
        rotation=90.0 if upright else 0.0,
        color=_COLOUR,
    )


def _draw_forces(axes: Axes, loading: Loading, size: float, unit: Unit) -> list[Artist]:
    if not loading.forces:
        return []
    places, forces = np.array(loading.force_places), np.array(loading.forces)
    largest = float(np.linalg.norm(forces, axis=1).max())
    if largest == 0.0:
        return []
    arrows = 1.3 * _ARROW * size / largest * forces
    _draw_arrows(axes, places, arrows, np.ones(len(places), dtype=bool), unit, width=1.6)
    return [_arrow_handle(f"point load, largest {largest:.3g} N/m", _COLOUR, 1.6)]


def _draw_arrows(
    axes: Axes,
    places: FloatArray,
    arrows: FloatArray,
    ends_there: Any,
    unit: Unit,
    width: float = 0.9,
) -> None:
    """Arrows that end at their place, or begin there."""
    tails = np.where(np.asarray(ends_there)[:, None], places - arrows, places)
    axes.quiver(
        *unit.of(tails).T,
        *unit.of(arrows).T,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        units="inches",
        width=width / 72.0,
        headwidth=4.0,
        headlength=4.5,
        headaxislength=4.0,
        minlength=0.0,
        color=_COLOUR,
        zorder=4,
    )


def _arrow_handle(label: str, colour: str, width: float = 0.9) -> Line2D:
    return style.handle(color=colour, lw=width, marker=">", ms=3, label=label)


def _draw_supports(axes: Axes, loading: Loading, size: float, unit: Unit) -> list[Artist]:
    """Rollers and fixed points just outside the body."""
    handles: list[Artist] = []
    for marker, label, chosen in (
        ("o", "held in one direction", [s for s in loading.held if s.in_x != s.in_y]),
        ("^", "held in both directions", [s for s in loading.held if s.in_x and s.in_y]),
        ("d", "on springs", loading.springs),
    ):
        if chosen:
            shown = np.array([one.place + 0.025 * size * one.outwards for one in chosen])
            axes.plot(*unit.of(shown).T, marker, ms=3, zorder=4, **_SUPPORT)
            handles.append(style.handle(marker=marker, ms=3, label=label, **_SUPPORT))
    return handles
