"""Pore-pressure maps at several times with the fractures on top, coloured by their state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.tri import Triangulation

from wingcrack_post import style
from wingcrack_post.errors import AbsentError, RunError
from wingcrack_post.fields import (
    FractureField,
    MatrixField,
    nearest,
    read_fractures,
    read_matrix,
)
from wingcrack_post.read import Run
from wingcrack_post.table import FloatArray
from wingcrack_post.times import select_times
from wingcrack_post.units import MEGAPASCAL, Unit, time_unit

PANELS_PER_ROW = 3
DEFAULT_COUNT = 6
SMALL = 0.4  # fractures below this share of the body get a second, closer map


@dataclass(frozen=True)
class Window:
    """A part of the body, in metres."""

    x_min: float
    x_max: float
    y_min: float
    y_max: float

    @property
    def ratio(self) -> float:
        """Height over width."""
        return (self.y_max - self.y_min) / (self.x_max - self.x_min)


@dataclass(frozen=True)
class _Frame:
    time_s: float
    matrix: MatrixField
    fractures: FractureField | None


@style.styled
def pressure_maps(run: Run, wanted_s: Sequence[float] = ()) -> Figure:
    """Draw the pore pressure at chosen times on one colour scale.

    Fractures that are small in the body get a second panel each, below the whole body.

    Parameters
    ----------
    run : Run
    wanted_s : sequence of float
        Times [s]; the nearest written ones are drawn. Default: see `select_times`.

    Raises
    ------
    AbsentError
        If the run wrote no VTU files, or none with a pressure (mechanics only).
    """
    frames = _frames(run, wanted_s)
    body = _extent(np.concatenate([frame.matrix.points for frame in frames]))
    zoom = zoom_window(body, [f.fractures for f in frames if f.fractures is not None])
    norm = _pressure_scale(frames)
    clock = time_unit(float(run.history.moments()[-1]))
    columns = min(PANELS_PER_ROW, len(frames))
    bands = -(-len(frames) // columns)
    views = [body] if zoom is None else [body, zoom]
    figure, grid = _panels(columns, bands, views)
    lettered = []
    for index, frame in enumerate(frames):
        band, column = divmod(index, columns)
        for depth, view in enumerate(views):
            axes = grid[band * len(views) + depth][column]
            _draw(axes, frame, view, norm, close=depth == 1 or zoom is None)
            if depth == 0:
                axes.set_title(_time_label(frame.time_s, clock))
                lettered.append(axes)
                if zoom is not None:
                    _mark(axes, zoom)
            if column == 0:
                axes.set_ylabel("$y$ [m]")
            if depth == len(views) - 1:
                axes.set_xlabel("$x$ [m]")
    for axes in [panel for row in grid for panel in row if not panel.collections]:
        axes.remove()
    style.letter(lettered)
    drawn = [panel for row in grid for panel in row if panel.collections]
    bar = figure.colorbar(
        ScalarMappable(norm, style.FIELD_COLOURS),
        ax=drawn,
        shrink=0.6 if bands > 1 else 0.9,
        aspect=30,
        pad=0.015,
    )
    bar.set_label("pore pressure [MPa]")
    if any(frame.fractures is not None for frame in frames):
        style.outside_legend(figure, style.state_handles(), len(style.STATES))
    return figure


def zoom_window(body: Window, fractures: Sequence[FractureField]) -> Window | None:
    """Square around all fractures at all times; None if they are large in the body or absent."""
    ends = [field.segments.reshape(-1, 2) for field in fractures if len(field.segments)]
    if not ends:
        return None
    points = np.concatenate(ends)
    lower, upper = points.min(axis=0), points.max(axis=0)
    size = float((upper - lower).max())
    width, height = body.x_max - body.x_min, body.y_max - body.y_min
    if size == 0.0 or size > SMALL * min(width, height):
        return None
    half = 0.7 * size
    half_x, half_y = min(half, width / 2), min(half, height / 2)
    # shifted, not cut, at the boundary: every zoom panel keeps its shape
    x = float(np.clip((lower[0] + upper[0]) / 2, body.x_min + half_x, body.x_max - half_x))
    y = float(np.clip((lower[1] + upper[1]) / 2, body.y_min + half_y, body.y_max - half_y))
    return Window(x - half_x, x + half_x, y - half_y, y + half_y)


def _frames(run: Run, wanted_s: Sequence[float]) -> list[_Frame]:
    if not run.matrix:
        raise AbsentError("the run has no matrix.pvd (VTU output off, or no step written yet)")
    if "pressure" not in read_matrix(run.matrix[0].path).cell:
        raise AbsentError("the run has no pore pressure (mechanics only)")
    written = [snapshot.time_s for snapshot in run.matrix]
    frames = []
    for time in select_times(run, written, DEFAULT_COUNT, wanted_s):
        snapshot = nearest(run.matrix, time)
        matrix = read_matrix(snapshot.path)
        if "pressure" not in matrix.cell:
            raise RunError(f"{snapshot.path}: the cell data 'pressure' is missing.")
        fractures = None
        if run.fracture_fields:
            fractures = read_fractures(nearest(run.fracture_fields, time).path)
        frames.append(_Frame(time, matrix, fractures))
    return frames


def _extent(points: FloatArray) -> Window:
    (x_min, y_min), (x_max, y_max) = points.min(axis=0), points.max(axis=0)
    return Window(float(x_min), float(x_max), float(y_min), float(y_max))


def _pressure_scale(frames: Sequence[_Frame]) -> Normalize:
    values = np.concatenate([MEGAPASCAL.of(frame.matrix.cell["pressure"]) for frame in frames])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if high - low <= 1e-6 * max(abs(low), abs(high), 1e-12):  # a uniform field: a scale around it
        margin = max(0.01 * abs(low), 1e-6)
        low, high = low - margin, high + margin
    return Normalize(low, high)


def _panels(columns: int, bands: int, views: Sequence[Window]) -> tuple[Figure, list[list[Axes]]]:
    width = {1: style.SINGLE_COLUMN, 2: 5.3}.get(columns, style.DOUBLE_COLUMN)
    panel_width = (width - 1.1) / columns - 0.35  # without colour bar and tick labels
    heights = [view.ratio * panel_width for view in views] * bands
    # tick labels in every row; a title and the label of x once in a band; the legend once
    height = sum(heights) + 0.25 * len(heights) + 0.35 * bands + 0.35
    figure = style.new_figure(width, height)
    axes = figure.subplots(len(heights), columns, squeeze=False, height_ratios=heights)
    return figure, [list(row) for row in axes]


def _draw(axes: Axes, frame: _Frame, view: Window, norm: Normalize, *, close: bool) -> None:
    points = frame.matrix.points
    triangulation = Triangulation(points[:, 0], points[:, 1], frame.matrix.triangles)
    axes.tripcolor(
        triangulation,
        facecolors=MEGAPASCAL.of(frame.matrix.cell["pressure"]),
        norm=norm,
        cmap=style.FIELD_COLOURS,
        rasterized=True,
        edgecolors="none",
        antialiased=False,
    )
    if frame.fractures is not None and len(frame.fractures.segments):
        _draw_fractures(axes, frame.fractures, 2.2 if close else 1.0)
    axes.set_xlim(view.x_min, view.x_max)
    axes.set_ylim(view.y_min, view.y_max)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.locator_params(nbins=4)
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)


def _draw_fractures(axes: Axes, fractures: FractureField, width: float) -> None:
    # a white casing keeps all three colours apart from light and dark parts of the map
    casing = LineCollection(
        list(fractures.segments), colors="white", linewidths=width + 1.2, capstyle="round"
    )
    axes.add_collection(casing, autolim=False)
    for number, state in enumerate(style.STATES):
        mine = fractures.segments[fractures.state == number]
        if len(mine):
            lines = LineCollection(
                list(mine),
                colors=style.STATE_COLOURS[state],
                linewidths=width,
                label=state,
                capstyle="butt",
                zorder=3,
            )
            axes.add_collection(lines, autolim=False)


def _mark(axes: Axes, zoom: Window) -> None:
    frame = Rectangle(
        (zoom.x_min, zoom.y_min),
        zoom.x_max - zoom.x_min,
        zoom.y_max - zoom.y_min,
        fill=False,
        edgecolor="white",
        linewidth=0.7,
        zorder=4,
        path_effects=[withStroke(linewidth=1.5, foreground="black")],
    )
    axes.add_patch(frame)


def _time_label(time_s: float, clock: Unit) -> str:
    return f"$t$ = {float(clock.of(time_s)):.4g} {clock.name}"
