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
from wingcrack.figures.scales import ROUND_OFF
from wingcrack.figures.states import select_states
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import Unit

_FEW = 8  # fractures up to which lines are not thinner
_LINEAR = 0.1  # share of the spread that a plane leaves of a field that is nearly linear
SMALL = 0.4  # fractures below this share of the body get a closer map
CHANGED = 0.05  # share of the largest change from which on a cell counts as changed
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


def zoom_window(
    body: Window, fractures: Sequence[FractureField | None], small: float = SMALL
) -> Window | None:
    """Square around all fractures at all times; None if they are large in the body or absent."""
    ends = [f.segments.reshape(-1, 2) for f in fractures if f is not None and len(f.segments)]
    return _square(body, np.concatenate(ends), small) if ends else None


def changed_window(
    body: Window, frames: Sequence[Frame], changes: Sequence[FloatArray], small: float = SMALL
) -> Window | None:
    """Square around the cells that change by a share of the largest change; None if it is large.

    `changes`: a value per cell of each state.
    """
    largest = max(float(np.abs(change).max()) for change in changes)
    points = [
        frame.matrix.points[frame.matrix.triangles[np.abs(change) >= CHANGED * largest]]
        for frame, change in zip(frames, changes, strict=True)
    ]
    return _square(body, np.concatenate(points).reshape(-1, 2), small) if largest > 0.0 else None


def _square(body: Window, points: FloatArray, small: float = SMALL) -> Window | None:
    """Square with some room around points, inside the body; None if they fill much of it."""
    lower, upper = points.min(axis=0), points.max(axis=0)
    size = float((upper - lower).max())
    width, height = body.x_max - body.x_min, body.y_max - body.y_min
    if size == 0.0 or size > small * min(width, height):
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


def line_width(run: Run, width: float) -> float:
    """Width of fractures in a map: the thinner the more there are."""
    count = len((run.network or {}).get("fractures", ()))
    return width * min(1.0, max(0.3, float(np.sqrt(_FEW / max(count, 1)))))


def changes_since(first: Frame, frame: Frame, field: str) -> FloatArray:
    """Change of a field of the cells since the first state, whose mesh may be another one.

    A first state that is linear in the place, as the hydrostatic one, is taken off exactly.
    """
    start, now = first.matrix.cell[field], frame.matrix.cell[field]
    if np.array_equal(first.matrix.triangles, frame.matrix.triangles):
        return np.asarray(now - start)
    middle = first.matrix.points[first.matrix.triangles].mean(axis=1)
    places = frame.matrix.points[frame.matrix.triangles].mean(axis=1)
    origin, size = middle.mean(axis=0), max(float(np.ptp(middle)), 1e-300)

    def plane(where: FloatArray) -> FloatArray:
        return np.column_stack((np.ones(len(where)), (where - origin) / size))

    fit = np.linalg.lstsq(plane(middle), start, rcond=None)[0]
    rest = start - plane(middle) @ fit
    if np.abs(rest).max() <= ROUND_OFF * max(float(np.abs(start).max()), 1e-300):
        return np.asarray(now - plane(places) @ fit)
    # both sides of a fracture have nodes of their own, which a search for triangles refuses
    nodes, number = np.unique(first.matrix.points, axis=0, return_inverse=True)
    mesh = Triangulation(nodes[:, 0], nodes[:, 1], number.ravel()[first.matrix.triangles])
    cell = np.asarray(mesh.get_trifinder()(*places.T), dtype=np.int64)
    before = start[cell]
    if float(rest.std()) < _LINEAR * float(start.std()):
        before = plane(places) @ fit + rest[cell]
    return np.asarray(np.where(cell < 0, 0.0, now - before))


def usual_range(matrix: MatrixField, values: FloatArray, view: Window) -> tuple[float, float]:
    """Range that most of the area in view keeps to: a few singular cells do not set a scale."""
    middle = np.median(values)
    return (
        float(middle) - usual_limit(matrix, np.minimum(values - middle, 0.0), view),
        float(middle) + usual_limit(matrix, np.maximum(values - middle, 0.0), view),
    )


def usual_limit(matrix: MatrixField, values: FloatArray, view: Window) -> float:
    """Size that most of the area in view keeps to."""
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
    style.place_ticks(axes)


def draw_fractures_by(
    axes: Axes,
    fractures: FractureField,
    values: FloatArray,
    norm: Normalize,
    width: float,
    unit: Unit,
) -> None:
    """Draw fractures coloured by a value of each cell, the largest on top."""
    order = np.argsort(values)
    segments = list(unit.of(fractures.segments[order]))
    casing = LineCollection(segments, colors="#888888", linewidths=width + 0.6)
    axes.add_collection(casing, autolim=False)
    lines = LineCollection(
        segments,
        array=values[order],
        norm=norm,
        cmap=style.JUMP_COLOURS,
        linewidths=width,
        zorder=3,
    )
    axes.add_collection(lines, autolim=False)


def draw_fractures(axes: Axes, fractures: FractureField | None, width: float, unit: Unit) -> None:
    """Draw fractures coloured by their state."""
    if fractures is None or not len(fractures.segments):
        return
    # a white casing keeps all three colours apart from light and dark parts of the map
    casing = LineCollection(
        list(unit.of(fractures.segments)), colors="white", linewidths=1.45 * width, capstyle="round"
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
