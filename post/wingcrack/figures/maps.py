"""Maps of the rock in several states, the fractures on top by state: pore pressure, or stress."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import (
    Colormap,
    LinearSegmentedColormap,
    ListedColormap,
    Normalize,
    TwoSlopeNorm,
)
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.fields import MatrixField
from wingcrack.figures.frames import (
    Frame,
    Window,
    changed_window,
    changes_since,
    draw_field,
    draw_fractures,
    extent,
    line_width,
    read_frame,
    read_frames,
    set_window,
    usual_range,
    value_scale,
    zoom_window,
)
from wingcrack.figures.load import moment_label
from wingcrack.figures.marks import well_mark
from wingcrack.figures.read import Run
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import MEGAPASCAL, Unit, stress_unit

PANELS_PER_ROW = 3
DEFAULT_COUNT = 6
PRESSURE_COUNT = 3  # each state perhaps twice, the body and near the fractures
_DEPTH = (
    0.1  # range of most of the first state over the largest change from which on changes are drawn
)
_ONE_SIGN = 0.02  # share of the larger limit below which the other sign does not count


@style.styled
def pressure_maps(run: Run, wanted_s: Sequence[float] = ()) -> Figure:
    """Draw the pore pressure in chosen states on one colour scale; its change where depth shows.

    Where the pressure differs from place to place from the start on (depth, gravity), its change
    since the first written state is drawn, in which the wells are seen.

    Fractures that are small in the body get a second panel each, below the whole body; else the
    part of the body is shown that has fractures or changes. Raises
    `AbsentError` if the run wrote no VTU files, or none with a pressure (mechanics only).

    `wanted_s`: times [s]; the nearest written ones are drawn. Default: see `select_states`.
    """
    frames = read_frames(run, PRESSURE_COUNT, wanted_s, _check_pressure, since_growth=True)
    body = extent([frame.matrix for frame in frames])
    is_first = frames[0].moment == run.matrix[0].time_s
    first = frames[0] if is_first else read_frame(run, 0)
    changes = [changes_since(first, frame, "pressure") for frame in frames]
    fractures = [frame.fractures for frame in frames]
    close = [zoom_window(body, fractures), changed_window(body, frames, changes)]
    wide = [
        zoom_window(body, fractures, np.inf),
        changed_window(body, frames, changes, np.inf),
    ]
    zoom = min(filter(None, close), key=_width, default=None)
    whole = max(filter(None, wide), key=_width, default=body) if zoom is None else body
    fields, label = [frame.matrix.cell["pressure"] for frame in frames], "pore pressure"
    low, high = usual_range(first.matrix, first.matrix.cell["pressure"], body)
    if high - low > _DEPTH * max(map(_largest, changes)):
        fields, label = changes, f"change of pore pressure since {moment_label(run, first.moment)}"
        if frames[0].moment == first.moment and len(frames) > 1:  # nothing to see in it
            frames, fields = frames[1:], fields[1:]
    values = [MEGAPASCAL.of(field) for field in fields]
    norm, colours = _signed_scale(values, label)
    unit = run_length_unit(run)
    columns = min(style.across(PANELS_PER_ROW), len(frames))
    bands = -(-len(frames) // columns)
    views = [whole] if zoom is None else [whole, zoom]
    figure, grid = _panels(columns, bands, views)
    lettered = []
    for index, frame in enumerate(frames):
        band, column = divmod(index, columns)
        for depth, view in enumerate(views):
            axes = grid[band * len(views) + depth][column]
            draw_field(axes, frame, values[index], norm, colours, unit)
            width = 1.0 if depth == 0 and zoom is not None else 2.2
            draw_fractures(axes, frame.fractures, line_width(run, width), unit)
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
        ScalarMappable(norm, colours),
        ax=drawn,
        shrink=0.6 if bands > 1 else 0.9,
        aspect=30,
        pad=0.015,
    )
    bar.set_label(f"{label} [MPa]")
    if any(frame.fractures is not None for frame in frames):
        style.outside_legend(figure, _states(frames), len(style.STATES))
    return figure


def _states(frames: Sequence[Frame]) -> list[Line2D]:
    """Entries of the legend for the states that there are."""
    numbers = {int(n) for f in frames if f.fractures is not None for n in f.fractures.state}
    return [item for number, item in enumerate(style.state_handles()) if number in numbers]


def _width(window: Window) -> float:
    return window.x_max - window.x_min


def _largest(values: FloatArray) -> float:
    return float(np.abs(values).max())


def _signed_scale(values: Sequence[FloatArray], label: str) -> tuple[Normalize, Colormap | str]:
    """Scale for all states; where the change has both signs, colours tell them apart."""
    norm = value_scale(values)
    if not label.startswith("change") or not norm.vmin or not norm.vmin < 0.0 < (norm.vmax or 0.0):
        return norm, style.FIELD_COLOURS
    return norm, signed_colours(norm.vmin, norm.vmax or 0.0)


def signed_colours(low: float, high: float) -> Colormap | str:
    """Colours for values between two limits: of both signs those that change at zero."""
    if not low < 0.0 < high or min(-low, high) < _ONE_SIGN * max(-low, high):
        return style.FIELD_COLOURS
    places = TwoSlopeNorm(0.0, low, high)(np.linspace(low, high, 256))
    return ListedColormap(MEAN_COLOURS(places))


def _check_pressure(matrix: MatrixField) -> None:
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


# Purple in compression, orange in tension: seen by the colour-blind. Lighter and lighter: in grey
# print, where a map that is dark at both ends would not tell the signs apart, it can be read too.
MEAN_COLOURS = LinearSegmentedColormap.from_list(
    "mean_stress", ["#2D004B", "#6A51A3", "#A9A9B0", "#F0A94A", "#FFE680"]
)
_HEIGHT = 3.0  # [inch] of a panel at most


@style.styled
def stress_maps(run: Run, wanted_s: Sequence[float] = ()) -> Figure:
    """Draw the stress in chosen states, with the fractures coloured by their state.

    Panels of the same quantity share a scale, so default states are those from the start of growth
    on: earlier ones would be pale images of it. Raises `AbsentError` if the run wrote no VTU files,
    or has a pore pressure (whose maps say more).

    `wanted_s`: moments, in the unit of the tables; the nearest written ones are drawn. Default: see
    `select_states`.
    """
    frames = read_frames(
        run, min(DEFAULT_COUNT, 3 * style.across(2)), wanted_s, _check_stress, since_growth=True
    )
    body = extent([frame.matrix for frame in frames])
    view = zoom_window(body, [frame.fractures for frame in frames]) or body
    unit = run_length_unit(run)
    columns = min(style.across(PANELS_PER_ROW), len(frames))
    bands = -(-len(frames) // columns)
    width = {1: style.SINGLE_COLUMN + 0.7, 2: 5.6}.get(columns, style.DOUBLE_COLUMN)
    height = min(_HEIGHT, (width - 1.6) / columns * view.ratio)
    figure = style.new_figure(width, 2 * bands * (height + 0.3) + 0.85)
    rows = figure.subplots(2 * bands, columns, squeeze=False, sharex=True, sharey=True)
    quantities = (
        ("mean stress", [mean_stress(frame.matrix) for frame in frames]),
        ("largest shear stress", [_shear(frame.matrix) for frame in frames]),
    )
    lettered: list[Axes] = []
    for half, (name, fields) in enumerate(quantities):
        panels = list(rows[half * bands : (half + 1) * bands].flat)
        norm, scale = _stress_scale(frames, fields, view)
        colours = signed_colours(float(norm.vmin or 0.0), float(norm.vmax or 0.0))
        for axes, frame, field in zip(panels, frames, fields, strict=False):
            draw_field(axes, frame, scale.of(field), norm, colours, unit)
            draw_fractures(axes, frame.fractures, line_width(run, 1.1), unit)
            axes.set_title(moment_label(run, frame.moment, frame.row))
        lettered += panels[: len(frames)]
        bar = figure.colorbar(
            ScalarMappable(norm, colours),
            ax=panels,
            extend="both",
            aspect=20 * bands,
            pad=0.02,
        )
        bar.set_label(f"{name} [{scale.name}]")
    _label_outer([list(row) for row in rows], len(frames), unit)
    set_window(rows[0][0], view, unit)
    style.letter(lettered)
    if any(frame.fractures is not None for frame in frames):
        style.outside_legend(figure, _states(frames), len(style.STATES))
    return figure


def mean_stress(matrix: MatrixField) -> FloatArray:
    """Mean of the normal stresses in the plane [Pa]."""
    return np.asarray(matrix.cell["stress"][:, :2].mean(axis=1))


def _shear(matrix: MatrixField) -> FloatArray:
    """Largest shear stress in the plane [Pa]."""
    xx, yy, _zz, xy = (matrix.cell["stress"][:, k] for k in range(4))
    return np.asarray(np.hypot(0.5 * (xx - yy), xy))


def _check_stress(matrix: MatrixField) -> None:
    if "pressure" in matrix.cell:
        raise AbsentError("the run has a pore pressure: see its maps")
    if "stress" not in matrix.cell:
        raise AbsentError("the run wrote no stress")


def _stress_scale(
    frames: Sequence[Frame], fields: Sequence[FloatArray], view: Window
) -> tuple[Normalize, Unit]:
    """One scale for all panels of a quantity: what most of the area in view keeps to."""
    pairs = zip(frames, fields, strict=True)
    limits = np.array([usual_range(f.matrix, field, view) for f, field in pairs])
    return stress_norm(float(limits[:, 0].min()), float(limits[:, 1].max()))


def stress_norm(low: float, high: float) -> tuple[Normalize, Unit]:
    """Scale between two stresses [Pa], and its unit; a margin around a uniform stress."""
    unit = stress_unit(np.array([low, high]))
    if not high - low > 1.0e-6 * max(abs(low), abs(high)):
        margin = 0.01 * abs(low) or unit.size
        low, high = low - margin, high + margin
    return Normalize(float(unit.of(low)), float(unit.of(high))), unit


def _label_outer(rows: Sequence[Sequence[Axes]], count: int, unit: Unit) -> None:
    """Labels at the outer panels; places without a panel stay empty."""
    columns = len(rows[0])
    bands = len(rows) // 2
    for number, row in enumerate(rows):
        row[0].set_ylabel(f"$y$ [{unit.name}]")
        for column, axes in enumerate(row):
            place = number % bands * columns + column
            if place >= count:
                axes.set_visible(False)
            elif number >= bands and place + columns >= count:
                axes.set_xlabel(f"$x$ [{unit.name}]")
                axes.xaxis.set_tick_params(labelbottom=True)
