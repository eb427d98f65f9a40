"""One page for any run: the scene, the results, and their error estimates."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias

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
from wingcrack.figures.load import abscissa, draw_load, has_load, states_abscissa
from wingcrack.figures.read import Run, needed
from wingcrack.figures.states import growth_start, slips_or_opens
from wingcrack.figures.story import COLUMNS, Mark, draw_lengths, draw_marks, find_marks
from wingcrack.figures.story import draw_pressure as draw_pressure_and_rate
from wingcrack.figures.story_map import draw_map, map_ratio

# Draws into a place of a figure, and gives the axes that get letters.
Cell: TypeAlias = Callable[[Run, Figure, SubplotSpec], list[Axes]]
_GREY = "#555555"
_STATUS_COLOURS = {"finished": "#009E73", "stopped": "#E69F00", "failed": "#D55E00"}
_NEAR = 0.09  # share of the axis between marks that are both named
_LINE = 58  # characters of half a page
_TITLE = 96
_MOST_LINES = 21  # of a column of text; what has no room is counted


@style.styled
def summary(run: Run) -> Figure:
    """Draw geometry, network by state, pressure or load, lengths, K_eq over K_IC, and the facts."""
    facts = gather_facts(run)
    marks = [] if has_load(run) else find_marks(run)
    texts: list[Cell] = [
        partial(_draw_text, facts.left(), "results"),
        partial(_draw_text, facts.right(_words(run, marks)), "warnings and notes"),
    ]
    maps: list[Cell] = [_geometry, *([_network] if _has_network(run) else [])]
    curves = [_draw_drive, _draw_length] if run.history.rows > 1 else []
    curves += [_draw_ratio] if _has_ratio(run) else []
    panels: list[Cell] = [partial(_panel, draw) for draw in curves]
    if len(maps) == 1 or style.chosen(page=False, column=False, slide=True):
        maps.append(texts.pop(0))
    if style.chosen(page=False, column=False, slide=True):
        texts.clear()  # they do not fit
    columns = style.chosen(page=2, column=1, slide=3)
    side = style.whole_width() / columns - 0.7
    words = style.text_height(2.0 + max(map(len, map(_wrapped, (facts.left(), facts.right([]))))))
    groups = [
        (maps, columns, side * min(max(map_ratio(run), 0.5), 1.0) + 0.6 + style.text_height(5.0)),
        (panels, style.across(min(3, len(panels))), 2.2),
        (texts, columns, words),
    ]
    groups = [group for group in groups if group[0]]
    heights = [0.45, *(-(-len(cells) // across) * height for cells, across, height in groups)]
    figure = style.new_figure(style.whole_width(), sum(heights), whole=True)
    grid = figure.add_gridspec(len(heights), 1, height_ratios=heights)
    _draw_head(figure, grid[0], facts)
    drawn: list[Axes] = []
    for row, (cells, across, _) in enumerate(groups, start=1):
        places = grid[row].subgridspec(-(-len(cells) // across), across)
        for k, cell in enumerate(cells):
            drawn += cell(run, figure, places[divmod(k, across)])
    if marks and run.history.rows > 1:
        _draw_marks(drawn[-len(panels) :], run, marks)
    style.letter(drawn)
    return figure


def _has_network(run: Run) -> bool:
    network = run.network or {}
    written = run.fractures is not None and run.fractures.rows > 0
    return written and bool(network.get("steps")) and bool(read_growth(network))


def _has_tips(run: Run) -> bool:
    toughness = run.scene.toughness_pa_sqrtm if run.scene else None
    return run.tips is not None and run.tips.rows > 0 and bool(toughness)


def _has_ratio(run: Run) -> bool:
    """Whether tips are driven, or fractures slip or open where nothing can grow."""
    return _has_tips(run) or (run.history.rows > 1 and slips_or_opens(run))


def _geometry(run: Run, figure: Figure, place: SubplotSpec) -> list[Axes]:
    return _with_legend(figure, place, "body, loads, wells", lambda axes: draw_geometry(axes, run))


def _network(run: Run, figure: Figure, place: SubplotSpec) -> list[Axes]:
    """The network at the end by contact state."""
    cells = needed(run.fractures, "fractures.csv", "the states of the fractures")
    title = "fractures at the end, by state"
    return _with_legend(figure, place, title, lambda axes: draw_map(axes, run, cells))


def _with_legend(
    figure: Figure, place: SubplotSpec, title: str, draw: Callable[[Axes], Sequence[Artist]]
) -> list[Axes]:
    grid = place.subgridspec(2, 1, height_ratios=(4.0, 1.0))
    axes, below = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    handles = draw(axes)
    axes.set_title(title)
    below.set_axis_off()
    if handles:
        size = style.text_size() - 1.0
        below.legend(
            handles=list(handles), loc="upper left", ncols=2, fontsize=size, borderaxespad=0.0
        )
    return [axes]


def _panel(
    draw: Callable[[Axes, Run], None], run: Run, figure: Figure, place: SubplotSpec
) -> list[Axes]:
    axes = figure.add_subplot(place)
    draw(axes, run)
    return [axes]


def _draw_head(figure: Figure, place: SubplotSpec, facts: Facts) -> None:
    """Title, and how the run ended."""
    axes = figure.add_subplot(place)
    axes.set_axis_off()
    title = textwrap.shorten(
        facts.title, style.chosen(page=_TITLE, column=_LINE - 10, slide=_TITLE), placeholder=" ..."
    )
    axes.text(0.0, 1.0, title, fontsize=style.text_size() + 2.0, va="top")
    colour = _STATUS_COLOURS.get(facts.status, _GREY)
    ended = textwrap.shorten(
        facts.ended, style.chosen(page=2, column=1, slide=2) * _LINE, placeholder=" ..."
    )
    axes.text(0.0, 0.05, ended, fontsize=style.text_size() + 1.0, va="bottom", color=colour)


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
        draw_jumps(axes, run)  # nothing can grow: how far fractures slip and open
        return
    place, below = states_abscissa(run, run.tips)
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


def _wrapped(lines: Sequence[str]) -> list[str]:
    wrapped: list[str] = []
    for line in lines:
        wrapped += textwrap.wrap(line, _LINE, subsequent_indent="   ") or [""]
    most = style.chosen(page=_MOST_LINES, column=_MOST_LINES, slide=_MOST_LINES - 4)
    if len(wrapped) <= most:
        return wrapped
    more = len(wrapped) - most + 1
    return [*wrapped[: most - 1], f"... and {more} lines more: see run.json"]


def _draw_text(
    lines: Sequence[str], title: str, _run: Run, figure: Figure, place: SubplotSpec
) -> list[Axes]:
    axes = figure.add_subplot(place)
    axes.set_axis_off()
    axes.set_title(title)
    words = "\n".join(_wrapped(lines))
    axes.text(0.0, 1.0, words, va="top", fontsize=style.text_size(), linespacing=1.3)
    return []
