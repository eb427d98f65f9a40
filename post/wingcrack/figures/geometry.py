"""The body as the scene has it: its outline, loads as arrows, supports, wells, first fractures."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from wingcrack.figures.loading import Loading, read_loading
from wingcrack.figures.read import Run
from wingcrack.figures.regions import draw_regions
from wingcrack.figures.story_map import draw_wells
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import Unit, length_unit, stress_unit

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
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel(f"$x$ [{unit.name}]")
    axes.set_ylabel(f"$y$ [{unit.name}]")
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
    return Line2D([], [], color=colour, lw=width, marker=">", ms=3, label=label)


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
            handles.append(Line2D([], [], marker=marker, ms=3, label=label, **_SUPPORT))
    return handles
