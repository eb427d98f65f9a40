"""Maps of the stress in mechanics-only runs: mean stress and largest shear stress in the plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from wingcrack_post import style
from wingcrack_post.errors import AbsentError
from wingcrack_post.fields import FractureField, MatrixField, nearest, read_fractures, read_matrix
from wingcrack_post.load import moment_label
from wingcrack_post.maps import Window, zoom_window
from wingcrack_post.read import Run
from wingcrack_post.table import FloatArray
from wingcrack_post.times import select_times
from wingcrack_post.units import Unit, length_unit, stress_unit

DEFAULT_COUNT = 3
MEAN_COLOURS = "PuOr_r"  # orange in tension, purple in compression: seen by the colour-blind
SHARE = 98.0  # per cent of the area within the colour scale; stresses at tips have no bound
_HEIGHT = 3.0  # [inch] of a panel at most


@dataclass(frozen=True)
class _Frame:
    time_s: float
    matrix: MatrixField
    fractures: FractureField | None
    mean: FloatArray
    shear: FloatArray


@style.styled
def stress_maps(run: Run, wanted_s: Sequence[float] = ()) -> Figure:
    """Draw the stress at chosen times, with the fractures coloured by their state.

    Parameters
    ----------
    run : Run
    wanted_s : sequence of float
        Times [s]; the nearest written ones are drawn. Default: see `select_times`.

    Raises
    ------
    AbsentError
        If the run wrote no VTU files, or has a pore pressure (whose maps say more).
    """
    frames = _frames(run, wanted_s)
    body = _extent(frames)
    view = zoom_window(body, [f.fractures for f in frames if f.fractures is not None]) or body
    unit = length_unit(view.x_max - view.x_min, view.y_max - view.y_min)
    columns = len(frames)
    width = {1: style.SINGLE_COLUMN + 0.7, 2: 5.6}.get(columns, style.DOUBLE_COLUMN)
    height = min(_HEIGHT, (width - 1.6) / columns * view.ratio)
    figure = style.new_figure(width, 2 * height + 1.45)
    rows = figure.subplots(2, columns, squeeze=False, sharex=True, sharey=True)
    quantities = (
        ("mean stress", MEAN_COLOURS, [frame.mean for frame in frames]),
        ("largest shear stress", style.FIELD_COLOURS, [frame.shear for frame in frames]),
    )
    for panels, (name, colours, fields) in zip(rows, quantities, strict=True):
        norm, scale = _scale(frames, fields, view, signed=colours == MEAN_COLOURS)
        for axes, frame, field in zip(panels, frames, fields, strict=True):
            _draw(axes, frame, scale.of(field), norm, colours, unit)
            axes.set_title(moment_label(run, frame.time_s))
        panels[0].set_ylabel(f"$y$ [{unit.name}]")
        bar = figure.colorbar(
            ScalarMappable(norm, colours),
            ax=list(panels),
            extend="both" if colours == MEAN_COLOURS else "max",
            aspect=20,
            pad=0.02,
        )
        bar.set_label(f"{name} [{scale.name}]")
    for axes in rows[-1]:
        axes.set_xlabel(f"$x$ [{unit.name}]")
    rows[0][0].set_xlim(*unit.of([view.x_min, view.x_max]))
    rows[0][0].set_ylim(*unit.of([view.y_min, view.y_max]))
    style.letter(list(rows.flat))
    if any(frame.fractures is not None for frame in frames):
        style.outside_legend(figure, style.state_handles(), len(style.STATES))
    return figure


def _frames(run: Run, wanted_s: Sequence[float]) -> list[_Frame]:
    if not run.matrix:
        raise AbsentError("the run has no matrix.pvd (VTU output off, or no step written yet)")
    first = read_matrix(run.matrix[0].path)
    if "pressure" in first.cell:
        raise AbsentError("the run has a pore pressure: see its maps")
    if "stress" not in first.cell:
        raise AbsentError("the run wrote no stress")
    frames = []
    written = [snapshot.time_s for snapshot in run.matrix]
    for time in select_times(run, written, DEFAULT_COUNT, wanted_s):
        matrix = read_matrix(nearest(run.matrix, time).path)
        xx, yy, _zz, xy = (matrix.cell["stress"][:, k] for k in range(4))
        fractures = None
        if run.fracture_fields:
            fractures = read_fractures(nearest(run.fracture_fields, time).path)
        mean, shear = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
        frames.append(_Frame(time, matrix, fractures, mean, np.asarray(shear)))
    return frames


def _extent(frames: Sequence[_Frame]) -> Window:
    points = np.concatenate([frame.matrix.points for frame in frames])
    (x_min, y_min), (x_max, y_max) = points.min(axis=0), points.max(axis=0)
    return Window(float(x_min), float(x_max), float(y_min), float(y_max))


def _scale(
    frames: Sequence[_Frame], fields: Sequence[FloatArray], view: Window, *, signed: bool
) -> tuple[Normalize, Unit]:
    """One scale for a row of panels: what most of the area in view keeps to."""
    values, areas = [], []
    for frame, field in zip(frames, fields, strict=True):
        corners = frame.matrix.points[frame.matrix.triangles]
        middle = corners.mean(axis=1)
        inside = (middle[:, 0] >= view.x_min) & (middle[:, 0] <= view.x_max)
        inside &= (middle[:, 1] >= view.y_min) & (middle[:, 1] <= view.y_max)
        (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
        areas.append(0.5 * np.abs(ax * by - ay * bx)[inside])
        values.append(np.abs(field)[inside])
    sizes, weights = np.concatenate(values), np.concatenate(areas)
    order = np.argsort(sizes)
    share = np.cumsum(weights[order]) / max(float(weights.sum()), np.finfo(float).tiny)
    last = min(int(np.searchsorted(share, SHARE / 100.0)), sizes.size - 1)
    limit = float(sizes[order][last])
    limit = limit if limit > 0.0 else 1.0
    unit = stress_unit(limit)
    top = float(unit.of(limit))
    return Normalize(-top if signed else 0.0, top), unit


def _draw(
    axes: Axes, frame: _Frame, values: FloatArray, norm: Normalize, colours: str, unit: Unit
) -> None:
    x, y = unit.of(frame.matrix.points).T
    axes.tripcolor(
        Triangulation(x, y, frame.matrix.triangles),
        facecolors=values,
        norm=norm,
        cmap=colours,
        rasterized=True,
        edgecolors="none",
        antialiased=False,
    )
    if frame.fractures is not None and len(frame.fractures.segments):
        for number, state in enumerate(style.STATES):
            mine = unit.of(frame.fractures.segments[frame.fractures.state == number])
            for colour, line_width in (("white", 2.0), (style.STATE_COLOURS[state], 1.1)):
                lines = LineCollection(
                    list(mine), colors=colour, linewidths=line_width, capstyle="round"
                )
                axes.add_collection(lines, autolim=False)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.locator_params(nbins=4)
