"""Fields of chosen states, and how maps draw them: body, fractures, surroundings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import Colormap, Normalize
from matplotlib.tri import Triangulation

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.fields import (
    FractureField,
    MatrixField,
    nearest,
    read_fractures,
    read_matrix,
)
from wingcrack.figures.read import Run
from wingcrack.figures.states import select_states
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import Unit

SMALL = 0.4  # fractures below this share of the body get a closer map
SHARE = 0.95  # of the area in view, within the colour scale; stresses at tips have no bound


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
class Frame:
    """Rock and fractures in one written state."""

    moment: float
    row: int | None  # of history.csv, from 0
    matrix: MatrixField
    fractures: FractureField | None


def read_frames(
    run: Run,
    count: int,
    wanted: Sequence[float],
    check: Callable[[MatrixField], None],
    *,
    since_growth: bool = False,
) -> list[Frame]:
    """Read the states that maps show; `check` raises where a field has not what they need.

    Raises `AbsentError` if the run wrote no VTU files.
    """
    written, rows = written_states(run)
    first = read_matrix(run.matrix[0].path)
    check(first)
    frames = []
    for place in select_states(run, written, count, wanted, rows=rows, since_growth=since_growth):
        frame = read_frame(run, place, first if place == 0 else None)
        check(frame.matrix)
        frames.append(frame)
    return frames


def written_states(run: Run) -> tuple[list[float], list[int | None]]:
    """Moments of the written VTU files and their rows of history.csv, from 0, where known.

    Raises `AbsentError` if the run wrote none.
    """
    if not run.matrix:
        raise AbsentError("the run has no matrix.pvd (VTU output off, or no step written yet)")
    return [snapshot.time_s for snapshot in run.matrix], [snapshot.row for snapshot in run.matrix]


def read_frame(run: Run, place: int, matrix: MatrixField | None = None) -> Frame:
    """Read a written state by its place in the series; its rock may have been read before."""
    snapshot = run.matrix[place]
    rock = read_matrix(snapshot.path) if matrix is None else matrix
    return Frame(snapshot.time_s, snapshot.row, rock, _fractures(run, place))


def _fractures(run: Run, place: int) -> FractureField | None:
    """Fractures of the same state: both series are written together."""
    if not run.fracture_fields:
        return None
    if len(run.fracture_fields) == len(run.matrix):
        return read_fractures(run.fracture_fields[place].path)
    return read_fractures(nearest(run.fracture_fields, run.matrix[place].time_s).path)


def extent(fields: Sequence[MatrixField]) -> Window:
    """Smallest window with the whole body."""
    points = np.concatenate([field.points for field in fields])
    (x_min, y_min), (x_max, y_max) = points.min(axis=0), points.max(axis=0)
    return Window(float(x_min), float(x_max), float(y_min), float(y_max))


def zoom_window(body: Window, fractures: Sequence[FractureField | None]) -> Window | None:
    """Square around all fractures at all times; None if they are large in the body or absent."""
    ends = [f.segments.reshape(-1, 2) for f in fractures if f is not None and len(f.segments)]
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


def value_scale(fields: Sequence[FloatArray]) -> Normalize:
    """One scale for all values; around a uniform field, too."""
    values = np.concatenate(fields)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if high - low <= 1e-6 * max(abs(low), abs(high), 1e-12):
        margin = max(0.01 * abs(low), 1e-6)
        low, high = low - margin, high + margin
    return Normalize(low, high)


def usual_limit(matrix: MatrixField, values: FloatArray, view: Window) -> float:
    """Size that most of the area in view keeps to: a few singular cells do not set a scale."""
    corners = matrix.points[matrix.triangles]
    middle = corners.mean(axis=1)
    inside = (middle[:, 0] >= view.x_min) & (middle[:, 0] <= view.x_max)
    inside &= (middle[:, 1] >= view.y_min) & (middle[:, 1] <= view.y_max)
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    areas, sizes = 0.5 * np.abs(ax * by - ay * bx)[inside], np.abs(values)[inside]
    if sizes.size == 0:
        return 0.0
    order = np.argsort(sizes)
    covered = np.cumsum(areas[order])
    last = min(int(np.searchsorted(covered, SHARE * covered[-1])), sizes.size - 1)
    return float(sizes[order][last])


def draw_field(
    axes: Axes,
    frame: Frame,
    values: FloatArray,
    norm: Normalize,
    colours: Colormap | str,
    unit: Unit,
) -> None:
    """Draw one value per triangle; `unit` is that of the axes."""
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
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.locator_params(nbins=4)
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)


def set_window(axes: Axes, view: Window, unit: Unit) -> None:
    """Show this part of the body."""
    axes.set_xlim(*unit.of([view.x_min, view.x_max]))
    axes.set_ylim(*unit.of([view.y_min, view.y_max]))


def draw_fractures(axes: Axes, fractures: FractureField | None, width: float, unit: Unit) -> None:
    """Draw fractures coloured by their state."""
    if fractures is None or not len(fractures.segments):
        return
    # a white casing keeps all three colours apart from light and dark parts of the map
    casing = LineCollection(
        list(unit.of(fractures.segments)), colors="white", linewidths=width + 1.0, capstyle="round"
    )
    axes.add_collection(casing, autolim=False)
    for number, state in enumerate(style.STATES):
        mine = fractures.segments[fractures.state == number]
        if len(mine):
            lines = LineCollection(
                list(unit.of(mine)),
                colors=style.STATE_COLOURS[state],
                linewidths=width,
                label=state,
                capstyle="butt",
                zorder=3,
            )
            axes.add_collection(lines, autolim=False)
