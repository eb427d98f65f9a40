"""The mesh of a state: the whole body, and around the fractures with the windows of the tips."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from wingcrack.figures import style
from wingcrack.figures.fields import MatrixField, read_matrix
from wingcrack.figures.frames import (
    Frame,
    Window,
    extent,
    read_frame,
    set_window,
    written_states,
    zoom_window,
)
from wingcrack.figures.load import moment_label
from wingcrack.figures.read import Run
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.states import last_settled
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import Unit

_TIP = "#D55E00"


@style.styled
def mesh_figure(run: Run, wanted_s: Sequence[float] = ()) -> Figure:
    """Draw the mesh in the last state, and, where windows drive growth, where these are.

    If the run wrote their elements, those of the first tip have a panel.

    Raises `AbsentError` if the run wrote no fields.

    `wanted_s`: the written state nearest to the first of these moments is drawn instead.
    """
    written, rows = written_states(run)
    place = last_settled(run, written, rows)
    if len(wanted_s):
        place = int(np.argmin(np.abs(np.array(written) - wanted_s[0])))
    frame = read_frame(run, place)
    body = extent([frame.matrix])
    zoom = zoom_window(body, [frame.fractures])
    views = [body] if zoom is None else [body, zoom]
    fine = _fine_mesh(run.matrix[place].path)
    unit = run_length_unit(run)
    count = len(views) + (fine is not None)
    figure = style.new_figure(style.SINGLE_COLUMN * count, 3.1 * min(1.6, body.ratio) + 0.8)
    panels = list(np.atleast_1d(figure.subplots(1, count)))
    squares = _windows(run, frame)
    for axes, view in zip(panels, views, strict=False):
        _draw(axes, frame.matrix, frame, view, unit)
        for lower, size in squares:
            x, y = unit.of(lower)
            side = float(unit.of(size))
            look: dict[str, Any] = {"fill": False, "edgecolor": _TIP, "linewidth": 1.0, "zorder": 4}
            axes.add_patch(Rectangle((float(x), float(y)), side, side, **look))
        set_window(axes, view, unit)
        style.map_axes(axes, unit)
    cells = len(frame.matrix.triangles)
    panels[0].set_title(f"{cells} cells, {moment_label(run, frame.moment, frame.row)}")
    if zoom is not None:
        panels[1].set_title("around the fractures")
    if fine is not None:
        view = zoom or extent([fine])  # of both meshes
        _draw(panels[-1], fine, frame, view, unit)
        set_window(panels[-1], view, unit)
        style.map_axes(panels[-1], unit)
        panels[-1].set_title(f"{len(fine.triangles)} elements of the window of a tip")
    style.letter(panels)
    entries = [style.handle(color="black", linewidth=1.6, label="fracture")]
    if squares:
        entries.append(style.handle(color=_TIP, linewidth=1.0, label="window of a tip"))
    style.outside_legend(figure, entries, 2)
    return figure


def _fine_mesh(matrix: Path) -> MatrixField | None:
    """Elements of the window of the first tip in the state of a file; None: not written."""
    path = matrix.with_name(matrix.name.replace("matrix", "windows"))
    if not path.is_file():
        return None
    windows = read_matrix(path)
    tips = windows.cell["tip"]
    used, numbers = np.unique(windows.triangles[tips == tips.min()], return_inverse=True)
    return MatrixField(windows.points[used], numbers.reshape(-1, 3), {})


def _draw(axes: Axes, mesh: MatrixField, frame: Frame, view: Window, unit: Unit) -> None:
    edges = unit.of(_edges(mesh, view))
    lines = LineCollection(
        list(edges), colors="#777777", linewidths=0.25, rasterized=len(edges) > 5000
    )
    axes.add_collection(lines, autolim=False)
    if frame.fractures is not None and len(frame.fractures.segments):
        axes.add_collection(
            LineCollection(
                list(unit.of(frame.fractures.segments)), colors="black", linewidths=1.4, zorder=3
            ),
            autolim=False,
        )


def _edges(matrix: MatrixField, view: Window) -> FloatArray:
    """Both ends of every edge of the triangles in view, each edge once (n, 2, 2) [m]."""
    corners = matrix.triangles
    pairs = np.concatenate((corners[:, (0, 1)], corners[:, (1, 2)], corners[:, (2, 0)]))
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    ends = matrix.points[pairs]
    x, y = ends[:, :, 0], ends[:, :, 1]
    seen = (x.max(axis=1) >= view.x_min) & (x.min(axis=1) <= view.x_max)
    seen &= (y.max(axis=1) >= view.y_min) & (y.min(axis=1) <= view.y_max)
    return np.asarray(ends[seen])


def _windows(run: Run, frame: Frame) -> list[tuple[FloatArray, float]]:
    """Lower left corner and side of the windows around the tips of the state [m].

    Those that the scene asks for; a window may have been enlarged since (events.csv).
    """
    side = run.scene.window_m if run.scene else None
    if side is None or run.tips is None or run.tips.rows == 0:
        return []
    moments = run.tips.moments()
    rows = moments == moments[int(np.argmin(np.abs(moments - frame.moment)))]
    places = np.column_stack((run.tips.number("x_m")[rows], run.tips.number("y_m")[rows]))
    return [(place - 0.5 * side, side) for place in places]
