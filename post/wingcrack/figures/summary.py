"""One page for any run: the scene, the results, and their error estimates."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from wingcrack.figures import style
from wingcrack.figures.facts import Facts, gather_facts
from wingcrack.figures.geometry import draw_geometry
from wingcrack.figures.growth import read_growth
from wingcrack.figures.history import draw_jumps, draw_length, draw_pressure, draw_states
from wingcrack.figures.load import STEP_LABEL, abscissa, draw_load, has_load, tip_steps
from wingcrack.figures.read import Run
from wingcrack.figures.states import growth_start
from wingcrack.figures.story import COLUMNS, Mark, draw_lengths, draw_marks, find_marks
from wingcrack.figures.story import draw_pressure as draw_pressure_and_rate
from wingcrack.figures.story_map import draw_map

_SIZE = (style.DOUBLE_COLUMN, 9.6)  # [inch] on A4
_GREY = "#555555"
_STATUS_COLOURS = {"finished": "#009E73", "stopped": "#E69F00", "failed": "#D55E00"}
_NEAR = 0.09  # share of the axis between marks that are both named
_LINE = 58  # characters of half a page
_TITLE = 96
_MOST_LINES = 21  # of a column of text; what has no room is counted


@style.styled
def summary(run: Run) -> Figure:
    """Draw geometry, network by state, pressure or load, lengths, K_eq over K_IC, and the facts."""
    figure = style.new_figure(*_SIZE)
    grid = figure.add_gridspec(5, 2, height_ratios=(0.24, 2.45, 0.5, 1.75, 2.3))
    facts = gather_facts(run)
    _draw_head(figure, grid[0, :], facts)
    geometry, network = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
    entries = draw_geometry(geometry, run)
    geometry.set_title("body, loads, wells")
    _legend(figure, grid[2, 0], entries)
    _legend(figure, grid[2, 1], _draw_network(network, run))
    middle = grid[3, :].subgridspec(1, 3, wspace=0.1)
    drive, length, ratio = (figure.add_subplot(middle[0, k]) for k in range(3))
    marks = [] if has_load(run) else find_marks(run)
    if run.history.rows > 1:
        _draw_drive(drive, run)
        _draw_length(length, run)
    else:
        _say(drive, "one state:")
        _say(length, "no curves")
    _draw_ratio(ratio, run)
    if marks and run.history.rows > 1:
        _draw_marks([drive, length, ratio], run, marks)
    _draw_text(figure, grid[4, 0], facts.left(), "what came of it")
    _draw_text(figure, grid[4, 1], facts.right(_words(run, marks)), "what to know")
    style.letter([geometry, network, drive, length, ratio])
    return figure


def _draw_head(figure: Figure, place: SubplotSpec, facts: Facts) -> None:
    """Title, and how the run ended."""
    axes = figure.add_subplot(place)
    axes.set_axis_off()
    title = textwrap.shorten(facts.title, _TITLE, placeholder=" ...")
    axes.text(0.0, 1.0, title, fontsize=9, va="top")
    colour = _STATUS_COLOURS.get(facts.status, _GREY)
    ended = textwrap.shorten(facts.ended, 2 * _LINE, placeholder=" ...")
    axes.text(0.0, 0.05, ended, fontsize=8, va="bottom", color=colour)


def _draw_network(axes: Axes, run: Run) -> list[Artist]:
    """The network at the end by contact state."""
    axes.set_title("fractures at the end, by state")
    network = run.network or {}
    drawn = bool(network.get("steps")) and bool(read_growth(network))
    if not drawn or run.fractures is None or run.fractures.rows == 0:
        _say(axes, "no fractures written")
        return []
    return draw_map(axes, run, run.fractures)


def _say(axes: Axes, words: str) -> None:
    """Put words in the place of a panel."""
    axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", color=_GREY)
    axes.set_axis_off()


def _legend(figure: Figure, place: SubplotSpec, handles: Sequence[Artist]) -> None:
    axes = figure.add_subplot(place)
    axes.set_axis_off()
    if handles:
        axes.legend(handles=list(handles), loc="upper left", ncols=2, fontsize=6, borderaxespad=0.0)


def _draw_drive(axes: Axes, run: Run) -> None:
    """What drives the run: pressure and rate, or the load."""
    history = run.history
    if has_load(run):
        draw_load(axes, run)
    elif history.has(*COLUMNS) and history.rows > 1:
        draw_pressure_and_rate(axes, run)
        axes.set_xlabel(abscissa(run, history.moments())[1])
    elif history.has("injected_m2"):
        draw_pressure(axes, run)
    else:
        draw_jumps(axes, run)


def _draw_length(axes: Axes, run: Run) -> None:
    if growth_start(run) is None:
        draw_states(axes, run)  # nothing grows: what the fractures do is the story
    elif has_load(run):
        draw_jumps(axes, run)  # the load stands over the length already
    elif run.history.has(*COLUMNS):
        draw_lengths(axes, run)
        axes.set(title="length", xlabel=abscissa(run, run.history.moments())[1])
    else:
        draw_length(axes, run)


def _draw_ratio(axes: Axes, run: Run) -> None:
    """Largest K_eq of all tips over K_IC of the rock, where nothing else is known than K_eq."""
    axes.set_title(r"largest $K_\mathrm{eq}/K_\mathrm{IC}$")
    toughness = run.scene.toughness_pa_sqrtm if run.scene else None
    if run.tips is None or run.tips.rows == 0 or not toughness:
        if run.history.rows > 1:
            draw_jumps(axes, run)  # nothing can grow: how far fractures slip and open
        else:
            _say(axes, "no tips" if toughness else "no toughness")
        return
    if has_load(run) and growth_start(run) is not None:
        place, below = tip_steps(run, run.tips), STEP_LABEL
    else:
        place, below = abscissa(run, run.tips.moments())
    ratio = run.tips.number("keq_pa_sqrtm") / toughness
    moments, groups = np.unique(place, return_inverse=True)
    largest = np.full(moments.size, -np.inf)
    np.maximum.at(largest, groups, ratio)
    axes.plot(moments, largest, color=style.CYCLE[0], marker=style.lone_marker(moments.size))
    axes.axhline(1.0, color=_GREY, linewidth=0.8, linestyle="--")
    axes.set(ylabel="ratio [-]", xlabel=below)
    axes.set_ylim(min(0.0, float(largest.min())), 1.08 * max(1.0, float(largest.max())))


def _draw_marks(panels: Sequence[Axes], run: Run, marks: Sequence[Mark]) -> None:
    end = float(abscissa(run, run.history.moments())[0][-1])
    for axes in panels:
        if axes.axison:
            axes.set_xlim(0.0, end)
    draw_marks(panels, panels[:1], run, marks, near=_NEAR)


def _words(run: Run, marks: Sequence[Mark]) -> list[str]:
    """What the names of the marks mean."""
    moments = np.array([mark.moment for mark in marks])
    places, below = abscissa(run, moments)
    unit = below.partition("[")[2][:-1]
    return [
        f"{mark.name}: {mark.what}, {place:.3g} {unit}"
        for mark, place in zip(marks, places, strict=True)
    ]


def _draw_text(figure: Figure, place: SubplotSpec, lines: Sequence[str], title: str) -> None:
    axes = figure.add_subplot(place)
    axes.set_axis_off()
    axes.set_title(title)
    wrapped: list[str] = []
    for line in lines:
        wrapped += textwrap.wrap(line, _LINE, subsequent_indent="   ") or [""]
    if len(wrapped) > _MOST_LINES:
        more = len(wrapped) - _MOST_LINES + 1
        wrapped = [*wrapped[: _MOST_LINES - 1], f"... and {more} lines more: see run.json"]
    axes.text(0.0, 1.0, "\n".join(wrapped), va="top", fontsize=7, linespacing=1.3)
