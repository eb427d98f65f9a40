"""Pore-pressure maps of several states with the fractures on top, coloured by their state."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke

from wingcrack.figures import style
from wingcrack.figures.errors import AbsentError
from wingcrack.figures.fields import MatrixField
from wingcrack.figures.frames import (
    Window,
    draw_field,
    draw_fractures,
    extent,
    read_frames,
    set_window,
    value_scale,
    zoom_window,
)
from wingcrack.figures.load import moment_label
from wingcrack.figures.marks import well_mark
from wingcrack.figures.read import Run
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.units import MEGAPASCAL, Unit

PANELS_PER_ROW = 3
DEFAULT_COUNT = 6


@style.styled
def pressure_maps(run: Run, wanted_s: Sequence[float] = ()) -> Figure:
    """Draw the pore pressure in chosen states on one colour scale.

    Fractures that are small in the body get a second panel each, below the whole body.

    Parameters
    ----------
    run : Run
    wanted_s : sequence of float
        Times [s]; the nearest written ones are drawn. Default: see `select_states`.

    Raises
    ------
    AbsentError
        If the run wrote no VTU files, or none with a pressure (mechanics only).
    """
    frames = read_frames(run, DEFAULT_COUNT, wanted_s, _check)
    body = extent([frame.matrix for frame in frames])
    zoom = zoom_window(body, [frame.fractures for frame in frames])
    norm = value_scale([MEGAPASCAL.of(frame.matrix.cell["pressure"]) for frame in frames])
    unit = run_length_unit(run)
    columns = min(PANELS_PER_ROW, len(frames))
    bands = -(-len(frames) // columns)
    views = [body] if zoom is None else [body, zoom]
    figure, grid = _panels(columns, bands, views)
    lettered = []
    for index, frame in enumerate(frames):
        band, column = divmod(index, columns)
        for depth, view in enumerate(views):
            axes = grid[band * len(views) + depth][column]
            values = MEGAPASCAL.of(frame.matrix.cell["pressure"])
            draw_field(axes, frame, values, norm, style.FIELD_COLOURS, unit)
            close = depth == 1 or zoom is None
            draw_fractures(axes, frame.fractures, 2.2 if close else 1.0, unit)
            set_window(axes, view, unit)
            if depth == 0:
                axes.set_title(_title(run, frame.moment))
                lettered.append(axes)
                if zoom is not None:
                    _mark(axes, zoom, unit)
            if column == 0:
                axes.set_ylabel(f"$y$ [{unit.name}]")
            if depth == len(views) - 1:
                axes.set_xlabel(f"$x$ [{unit.name}]")
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


def _check(matrix: MatrixField) -> None:
    if "pressure" not in matrix.cell:
        raise AbsentError("the run has no pore pressure (mechanics only)")


def _title(run: Run, moment: float) -> str:
    """When the state holds, and what the well does then."""
    mark = well_mark(run, moment)
    return f"{moment_label(run, moment)}, {mark}" if mark else moment_label(run, moment)


def _panels(columns: int, bands: int, views: Sequence[Window]) -> tuple[Figure, list[list[Axes]]]:
    width = {1: style.SINGLE_COLUMN, 2: 5.3}.get(columns, style.DOUBLE_COLUMN)
    panel_width = (width - 1.1) / columns - 0.35  # without colour bar and tick labels
    heights = [view.ratio * panel_width for view in views] * bands
    # tick labels in every row; a title and the label of x once in a band; the legend once
    height = sum(heights) + 0.25 * len(heights) + 0.35 * bands + 0.35
    figure = style.new_figure(width, height)
    axes = figure.subplots(len(heights), columns, squeeze=False, height_ratios=heights)
    return figure, [list(row) for row in axes]


def _mark(axes: Axes, zoom: Window, unit: Unit) -> None:
    x_min, x_max, y_min, y_max = unit.of([zoom.x_min, zoom.x_max, zoom.y_min, zoom.y_max])
    frame = Rectangle(
        (float(x_min), float(y_min)),
        float(x_max - x_min),
        float(y_max - y_min),
        fill=False,
        edgecolor="white",
        linewidth=0.7,
        zorder=4,
        path_effects=[withStroke(linewidth=1.5, foreground="black")],
    )
    axes.add_patch(frame)
