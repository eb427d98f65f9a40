"""Small pictures of runs, to be kept with the sources."""

from __future__ import annotations

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

import wingcrack
from wingcrack.figures.style import line_look
from wingcrack.runs.colours import default_field
from wingcrack.runs.units import column_words

_INCHES = (4.8, 3.6)
_DOTS_PER_INCH = 130
_COLOURS = 200  # of the palette


def new_figure(width: float = _INCHES[0], height: float = _INCHES[1]) -> Figure:
    """Give an empty figure of a size in inches, drawn without a display."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def draw_thumbnail(run: wingcrack.Run, path: Path) -> None:
    """Draw the end of a run: its field with the fractures, or, without fields, its history."""
    figure = new_figure()
    _draw_end(run, figure.add_subplot())
    save_small(figure, path)


def draw_story(run: wingcrack.Run, path: Path) -> None:
    """Draw a run with a fluid and growth: its end, its pressure and its length over time."""
    figure = new_figure(9.0, 3.6)
    left, right = figure.subfigures(1, 2, width_ratios=(1.15, 1.0), squeeze=False)[0]
    _draw_end(run, left.add_subplot())
    above, below = right.subplots(2, 1, sharex=True)
    pressures = [column for column in run.history if column.endswith("well_pressure_pa")]
    for index, column in enumerate(pressures):
        label = column_words(column)
        run.plot_history(column, ax=above, label=label, **line_look(index))
    if len(pressures) > 1:
        above.set_ylabel("well pressure [MPa]")
        above.legend()
    run.plot_history("fracture_length_m", ax=below)
    above.set_xlabel("")
    save_small(figure, path)


def draw_summary(run: wingcrack.Run, path: Path) -> None:
    """Draw the page of a run, as wide as a page of the site."""
    save_small(run.figure("summary"), path, dots_per_inch=100)


def draw_states(run: wingcrack.Run, path: Path) -> None:
    """Draw the fractures at the end of a run, by state."""
    figure = new_figure()
    run.plot_network("state", ax=figure.add_subplot())
    save_small(figure, path)


def _draw_end(run: wingcrack.Run, axes: Axes) -> None:
    try:
        run.plot_map(default_field(run.fields()), ax=axes, close=True)
    except wingcrack.AbsentError:
        run.plot_history(ax=axes)


def save_small(figure: Figure, path: Path, dots_per_inch: int = _DOTS_PER_INCH) -> None:
    """Save a figure as PNG with a palette."""
    figure.savefig(path, dpi=dots_per_inch, metadata={"Software": None})
    with Image.open(path) as picture:
        small = picture.convert("RGB").quantize(_COLOURS, dither=Image.Dither.NONE)
    small.save(path, optimize=True)
