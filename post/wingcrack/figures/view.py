"""The deformed body with its fractures, its displacements drawn larger than they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from wingcrack.errors import RunError
from wingcrack.figures import style
from wingcrack.figures.fields import FractureField, MatrixField, nearest
from wingcrack.figures.frames import (
    Frame,
    Window,
    draw_fractures,
    extent,
    read_frame,
    usual_range,
    value_scale,
    written_states,
    zoom_window,
)
from wingcrack.figures.load import moment_label
from wingcrack.figures.maps import mean_stress, signed_colours, stress_norm
from wingcrack.figures.read import Run
from wingcrack.figures.states import last_settled
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import MEGAPASCAL, METRE

WARP_SHARE = 0.03  # the largest displacement is drawn as this share of the body's width
_MARGIN = 0.04  # of the body's size around it


@style.styled
def view(run: Run, wanted: Sequence[float] = ()) -> Figure:
    """Draw the deformed body and, where fractures are small, their surroundings.

    Raises `AbsentError` if the run wrote no VTU files, `RunError` if a VTU file is damaged.

    `wanted`: moments, in the unit of the tables; the written state nearest to the last of them is
    drawn. Default: the last one that is in no short step after growth.
    """
    written, rows = written_states(run)
    if wanted:
        place = run.matrix.index(nearest(run.matrix, wanted[-1]))
    else:
        place = last_settled(run, written, rows)
    frame = read_frame(run, place)
    quantity, values, norm, colours = _quantity(frame.matrix, run.matrix[place].path.name)
    displacement = _nodal_displacement(frame.matrix, run.matrix[place].path.name)
    factor = _factor(frame.matrix, displacement)
    body = replace(frame.matrix, points=frame.matrix.points + factor * displacement)
    fractures = _moved(frame, displacement, factor)
    whole = extent([body])
    zoom = zoom_window(whole, [fractures])
    views = [whole] if zoom is None else [whole, zoom]
    figure, panels = _panels(views)
    for axes, shown in zip(panels, views, strict=True):
        _draw_body(axes, body, values, norm, colours, close=shown is zoom)
        draw_fractures(axes, fractures, 2.4 if shown is not whole else 1.8, METRE)
    _frame(panels[0], whole, _MARGIN)
    if zoom is not None:
        _frame(panels[1], zoom, 0.0)
    moment = moment_label(run, frame.moment, frame.row)
    title = f"{run.name}, {moment}, displacements × {factor:.3g}"  # noqa: RUF001
    figure.suptitle(title, x=0.02, ha="left", fontsize=style.RC["axes.titlesize"])
    bar = figure.colorbar(
        ScalarMappable(norm, colours),
        ax=panels,
        location="bottom",
        shrink=0.6,
        aspect=30,
        pad=0.02,
        extend="neither" if "pressure" in frame.matrix.cell else "both",
    )
    bar.set_label(quantity)
    if fractures is not None:
        style.outside_legend(figure, style.state_handles(), len(style.STATES))
    return figure


def _quantity(matrix: MatrixField, file: str) -> tuple[str, FloatArray, Normalize, Colormap | str]:
    """What colours the body: its name with the unit, values, their scale, colours."""
    if "pressure" in matrix.cell:
        values = MEGAPASCAL.of(matrix.cell["pressure"])
        return "pore pressure [MPa]", values, value_scale([values]), style.FIELD_COLOURS
    if "stress" not in matrix.cell:
        raise RunError(f"{file}: the cell data 'stress' is missing.")
    stress = mean_stress(matrix)
    norm, unit = stress_norm(*usual_range(matrix, stress, extent([matrix])))
    colours = signed_colours(float(norm.vmin or 0.0), float(norm.vmax or 0.0))
    name = f"mean in-plane stress [{unit.name}]"
    return name, unit.of(stress), norm, colours


def _nodal_displacement(matrix: MatrixField, file: str) -> FloatArray:
    """Displacement of each node [m]: as written, or the mean of the cells around it."""
    if "nodal_displacement" in matrix.nodal:
        return matrix.nodal["nodal_displacement"][:, :2]
    if "displacement" not in matrix.cell:
        raise RunError(f"{file}: the cell data 'displacement' is missing.")
    nodes = matrix.triangles.ravel()
    count = np.bincount(nodes, minlength=len(matrix.points))
    of_corners = np.repeat(matrix.cell["displacement"][:, :2], 3, axis=0)
    sums = [np.bincount(nodes, of_corners[:, k], len(matrix.points)) for k in (0, 1)]
    return np.column_stack(sums) / np.maximum(count, 1)[:, None]


def _factor(matrix: MatrixField, displacement: FloatArray) -> float:
    """How much larger than in truth displacements are drawn."""
    largest = float(np.linalg.norm(displacement, axis=1).max())
    width = float(np.ptp(matrix.points[:, 0]))
    return WARP_SHARE * width / largest if largest > 0.0 else 0.0


def _moved(frame: Frame, displacement: FloatArray, factor: float) -> FractureField | None:
    """Fractures moved with the body; None without any."""
    found = frame.fractures
    if found is None or not len(found.segments):
        return None
    corners = np.unique(frame.matrix.triangles)
    ends, back = np.unique(found.segments.reshape(-1, 2), axis=0, return_inverse=True)
    moved = displacement_at(ends, frame.matrix.points[corners], displacement[corners])
    shift = factor * moved[back.ravel()].reshape(found.segments.shape)
    return FractureField(found.segments + shift, found.state)


def displacement_at(places: FloatArray, nodes: FloatArray, displacement: FloatArray) -> FloatArray:
    """Displacement of the body at fracture points: mean of the nodes there, which are split."""
    same = 1.0e-9 * float(np.ptp(nodes, axis=0).max())
    means = []
    for place in places:
        distance = np.hypot(*(nodes - place).T)
        means.append(displacement[distance <= distance.min() + same].mean(axis=0))
    return np.array(means)


def _panels(views: Sequence[Window]) -> tuple[Figure, list[Axes]]:
    width = style.DOUBLE_COLUMN if len(views) > 1 else style.SINGLE_COLUMN + 1.5
    panel = (width - 0.3) / len(views)
    height = min(max(panel * window.ratio for window in views), 5.5)
    figure = style.new_figure(width, height + 1.1)
    return figure, list(figure.subplots(1, len(views), squeeze=False)[0])


def _draw_body(
    axes: Axes,
    body: MatrixField,
    values: FloatArray,
    norm: Normalize,
    colours: Colormap | str,
    *,
    close: bool,
) -> None:
    """One value per triangle; from close by, with the edges of the cells as a hint."""
    x, y = body.points.T
    cells = Triangulation(x, y, body.triangles)
    axes.tripcolor(
        cells,
        facecolors=values,
        norm=norm,
        cmap=colours,
        rasterized=True,
        edgecolors="none",
        antialiased=False,
    )
    if close:
        axes.triplot(cells, color="white", linewidth=0.3, alpha=0.15, rasterized=True)
    axes.set_aspect("equal")
    axes.grid(visible=False)


def _frame(axes: Axes, window: Window, margin: float) -> None:
    """Show a window; the axes stay unmarked, as places are not where they are in truth."""
    wide, high = margin * (window.x_max - window.x_min), margin * (window.y_max - window.y_min)
    axes.set_xlim(window.x_min - wide, window.x_max + wide)
    axes.set_ylim(window.y_min - high, window.y_max + high)
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(margin == 0.0)
