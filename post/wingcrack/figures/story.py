"""A stimulation on one page: the network at the end, and the effects of the injection over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpecFromSubplotSpec

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.load import abscissa
from wingcrack.figures.pressures import (
    highest_pressures,
    injected_and_produced,
    pumped_volumes,
    well_pressures,
)
from wingcrack.figures.read import Run, needed
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.slip import ASEISMIC_COLOUR, SEISMIC_COLOUR, seismic, slip_words
from wingcrack.figures.states import growth_start
from wingcrack.figures.story_map import HALO, draw_map, map_ratio
from wingcrack.figures.table import FloatArray, Table
from wingcrack.figures.units import MEGAPASCAL, rate_unit, time_unit, volume_label, volume_unit
from wingcrack.figures.wells import MOST_WELLS, well_rows

_FLAT = 0.45  # height of a map over its width, up to which it is as wide as the page
COLUMNS = (
    "injection_rate_m2_s",
    "fracture_fluid_m2",
    "rock_fluid_m2",
    "stimulated_length_m",
    "connected_length_m",
)
_MOST_MARKS = 9  # joints with a line of their own
_MOST_FACTS = 17  # lines for which there is room
_WIDEST = 38  # characters of the line of a well
_MOST_PEAKS = 2  # of wells, the highest
_NEAR = 0.03  # share of the axis between marks that are both named
_EARLY = 0.02  # share of the run in which the injectivity may leave its panel
_GREY = "#555555"
# from dark to light, and hatched: they differ in grey print
_FLUID = (
    ("fractures", "#0072B2", ""),
    ("rock", "#A6CBE3", "...."),
    ("out of the body", "#E8E8E8", "////"),
)
_LENGTHS = (
    ("all", "fracture_length_m", "#000000", "-"),
    ("connected", "connected_length_m", "#0072B2", "--"),
    ("stimulated", "stimulated_length_m", "#D55E00", "-"),
    ("both", "connected_stimulated_m", "#009E73", ":"),
)


@dataclass(frozen=True)
class Mark:
    """A moment that all panels show."""

    moment: float  # [s]
    name: str  # at the line
    what: str  # in words
    dashes: tuple[float, tuple[float, ...]]


@style.styled
def story(run: Run) -> Figure:
    """Map of the network with slip events; pressure, injectivity, fluid, lengths, moment.

    Raises `AbsentError` if the run has no wells, no fractures, one state only, or is of an earlier
    version.
    """
    table = run.history
    if not table.has("injected_m2"):
        raise AbsentError("the run has no fluid (mechanics only)")
    if not table.has(*COLUMNS):
        raise AbsentError("history.csv has no rate (no well, or an earlier version)")
    if table.rows == 1:
        raise AbsentError("the run has one state, so nothing has flowed yet")
    cells = needed(run.fractures, "fractures.csv", "the states of the fractures")
    draws = {
        "pressure": draw_pressure,
        "injectivity": _draw_injectivity,
        "fluid": _draw_fluid,
        "lengths": draw_lengths,
        "moment": _draw_moment,
        "events": _draw_events,
    }
    shown = [name for name in draws if name not in _empty(run)]
    marks = find_marks(run)
    facts = _facts(run, marks)[: style.chosen(page=_MOST_FACTS, column=_MOST_FACTS, slide=8)]
    columns = style.chosen(page=2, column=1, slide=3)
    rows = -(-len(shown) // columns)
    # a flat map leaves no space at its side: the facts stand below
    beside = style.chosen(page=map_ratio(run) > _FLAT, column=False, slide=True)
    width = style.whole_width()
    stacked = style.chosen(page=beside, column=True, slide=True)
    text = style.text_height(len(facts) + 11 if stacked else max(len(facts), 7) + 1)
    heights = [(0.62 if beside else 1.0) * (width - 0.8) * map_ratio(run) + 0.7]
    heights = [max(*heights, text)] if beside else [*heights, text]
    heights = style.chosen(page=heights, column=heights, slide=[text])
    panel = 1.9
    figure = style.new_figure(width, sum(heights) + panel * rows, whole=True)
    grid = figure.add_gridspec(len(heights) + 1, 1, height_ratios=(*heights, panel * rows))
    above = grid[0].subgridspec(1, 2, width_ratios=(2.3, 1.0)) if beside else grid
    network = figure.add_subplot(above[0, 0])
    handles = draw_map(network, run, cells)
    network.set_title("network at the end")
    place = (above[0, 1] if beside else above[1, 0]).subgridspec(*((2, 1) if stacked else (1, 2)))
    _draw_facts(figure, place, handles, "\n".join(facts))
    below = grid[-1].subgridspec(rows, columns)
    panels = {name: figure.add_subplot(below[divmod(k, columns)]) for k, name in enumerate(shown)}
    for name, axes in panels.items():
        draws[name](axes, run)
    end = float(abscissa(run, table.moments())[0][-1])
    for k, axes in enumerate(panels.values()):
        axes.set_xlim(0.0, end)
        title, label = axes.get_title(loc="left"), axes.get_ylabel()
        axes.set_title(style.chosen(page=title, column=title, slide=title.partition(":")[0]))
        axes.set_ylabel(
            style.chosen(page=label, column=label, slide=label.replace(" per ", "\nper "))
        )
        if k + columns >= len(shown):
            axes.set_xlabel(abscissa(run, table.moments())[1])
    named = [axes for name, axes in panels.items() if name not in ("fluid", "lengths")]
    draw_marks(list(panels.values()), named, run, marks)
    style.letter([network, *panels.values()])
    return figure


def _empty(run: Run) -> set[str]:
    """Panels that would show nothing."""
    empty = set()
    if not any(np.any(values > 0.0) for *_, values in _injectivities(run)):
        empty.add("injectivity")
    if not np.any(np.diff(run.history.number("seismic_moment_nm")) > 0.0):
        empty.add("moment")
    if run.slip_events is None or run.slip_events.rows == 0:
        empty.add("events")
    return empty


def find_marks(run: Run) -> list[Mark]:
    """First growth, and what fractures have met since the start, numbered in this order."""
    marks = []
    growth = growth_start(run)
    if growth is not None:
        marks.append(Mark(growth, "g", "growth begins", (0, (1, 1.5))))
    found: dict[float, list[str]] = {}
    for joint in (run.network or {}).get("joints", []):
        if float(joint["time_s"]) > 0.0:
            names = " and ".join(run.fracture_name(str(k)) for k in joint["fractures"])
            beside = " at the boundary" if joint["kind"] == "boundary" else " meet"
            found.setdefault(float(joint["time_s"]), []).append(names + beside)
    for k, moment in enumerate(sorted(found)[:_MOST_MARKS], start=1):
        marks.append(Mark(moment, str(k), "; ".join(found[moment]), (0, (4, 2))))
    return marks


def draw_marks(
    panels: Sequence[Axes],
    named: Sequence[Axes],
    run: Run,
    marks: Sequence[Mark],
    near: float = _NEAR,
) -> None:
    """Thin lines in all panels, with their names at the top of some.

    Those nearer to the one before than a share of the axis, `near`, get no name.
    """
    ordered = sorted(marks, key=lambda mark: mark.moment)
    places = abscissa(run, np.array([mark.moment for mark in ordered]))[0]
    end = panels[0].get_xlim()[1]
    before = -np.inf
    for mark, place in zip(ordered, places, strict=True):
        for axes in panels:
            axes.axvline(float(place), color=_GREY, linewidth=0.7, linestyle=mark.dashes, zorder=1)
        if place - before < near * end:
            continue  # its name would run into the one before
        before = float(place)
        for axes in named:
            axes.annotate(
                mark.name,
                (before, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(1.5, -1),
                textcoords="offset points",
                ha="left",
                va="top",
                fontsize=6,
                color=_GREY,
                path_effects=HALO,
            )


def draw_pressure(axes: Axes, run: Run) -> None:
    """Pressure and rate of the only well, or pressures of each by name."""
    if run.wells is not None and len(list(well_rows(run.wells))) > 1:
        _draw_pressures(axes, run, run.wells)
        return
    time = abscissa(run, run.history.moments())[0]
    (pressure,) = well_pressures(run.history).values()
    axes.plot(time, MEGAPASCAL.of(pressure), color=style.CYCLE[0], label="pressure")
    axes.set(ylabel="well pressure [MPa]", title="well pressure and rate")
    rate = run.history.number("injection_rate_m2_s")
    beside = axes.twinx()
    unit = rate_unit(rate)
    rate = unit.of(rate)
    beside.step(time, rate, "--", where="pre", color=style.CYCLE[1], lw=1.0, label="rate")
    beside.spines.right.set_visible(True)
    beside.grid(visible=False)
    beside.set_ylim(min(0.0, 1.25 * float(rate.min())), max(1.25 * float(rate.max()), 1e-300))
    beside.set_ylabel(f"rate [{unit.name}]")
    lines = [axes.lines[0], beside.lines[0]]
    # the legend avoids what its own axes have: the pressure once more, unseen
    (low, high), (least, most) = axes.get_ylim(), beside.get_ylim()
    share = (MEGAPASCAL.of(pressure) - low) / (high - low)
    beside.plot(time, least + (most - least) * share, lw=0.0)
    beside.set_ylim(least, most)
    beside.legend(handles=lines, loc="best")


def _draw_pressures(axes: Axes, run: Run, wells: Table) -> None:
    for index, name, rows in well_rows(wells):
        time = abscissa(run, wells.moments()[rows])[0]
        colour = style.CYCLE[index % MOST_WELLS]
        axes.plot(time, MEGAPASCAL.of(wells.number("pressure_pa")[rows]), color=colour, label=name)
    axes.set(ylabel="pressure at depth [MPa]", title="pressure of the wells")
    _legend_above(axes)


def _draw_injectivity(axes: Axes, run: Run) -> None:
    axes.set(title="injectivity: rate over rise of pressure", ylabel="injectivity [m²/(s Pa)]")
    lows, highs = [], []
    for index, name, time, values in _injectivities(run):
        shown = np.where(values > 0.0, values, np.nan)
        if not np.any(np.isfinite(shown)):
            continue
        axes.semilogy(time, shown, color=style.CYCLE[index % MOST_WELLS], label=name)
        # at first the pressure has hardly risen: that would squeeze all that follows
        later = shown[time >= _EARLY * time[-1]]
        if np.any(np.isfinite(later)):
            lows.append(float(np.nanmin(shown)))
            highs.append(float(np.nanmax(later)))
    if lows:
        axes.set_ylim(0.8 * min(lows), max(1.25 * max(highs), 3.0 * min(lows)))


def _injectivities(run: Run) -> Iterator[tuple[int, str, FloatArray, FloatArray]]:
    """Number, name, times and injectivity of each well."""
    if run.history.has("injectivity_m2_s_pa"):
        time = abscissa(run, run.history.moments())[0]
        yield 0, "", time, run.history.number("injectivity_m2_s_pa")
        return
    wells = needed(run.wells, "wells.csv", "what each well did")
    for index, name, rows in well_rows(wells):
        time = abscissa(run, wells.moments()[rows])[0]
        yield index, name, time, wells.number("injectivity_m2_s_pa")[rows]


def _draw_fluid(axes: Axes, run: Run) -> None:
    table = run.history
    time = abscissa(run, table.moments())[0]
    parts = [
        table.number("fracture_fluid_m2"),
        table.number("rock_fluid_m2"),
        table.number("rock_outflow_m2") + table.number("outflow_m2"),
    ]
    given = table.number("injected_m2") + table.number("prefilled_m2")
    unit = volume_unit(run.thickness_m, *parts, given)
    below = np.zeros_like(time)
    for (name, colour, hatch), part in zip(_FLUID, parts, strict=True):
        if np.abs(part).max() <= 1.0e-6 * np.abs(given).max():
            continue
        above = below + part
        axes.fill_between(
            time,
            unit.of(below),
            unit.of(above),
            facecolor=colour,
            edgecolor="white" if hatch == "...." else _GREY,
            hatch=hatch,
            linewidth=0.0,
            label=f"in {name}" if name in ("fractures", "rock") else name,
        )
        below = above
    label = (
        "injected, less produced" if np.any(injected_and_produced(table)[1] > 0.0) else "injected"
    )
    axes.plot(time, unit.of(given), color="#000000", lw=1.0, label=label)
    axes.set(title="where the fluid is", ylabel=volume_label(unit))
    axes.set_ylim(bottom=min(0.0, float(unit.of(below).min())))
    _legend_above(axes)


def _legend_above(axes: Axes) -> None:
    """Legend in two columns, with room for it above what is drawn."""
    entries = len(axes.get_legend_handles_labels()[0])
    low, high = axes.get_ylim()
    row = style.chosen(page=0.14, column=0.14, slide=0.25)
    axes.set_ylim(low, high + (0.06 + row * -(-entries // 2)) * (high - low))
    axes.legend(loc="upper left", ncols=2)


def draw_lengths(axes: Axes, run: Run) -> None:
    """Draw lengths: all, connected with a well, stimulated, both."""
    time = abscissa(run, run.history.moments())[0]
    unit = run_length_unit(run)
    for name, column, colour, dashes in _LENGTHS:
        values = unit.of(run.history.number(column))
        axes.plot(time, values, dashes, color=colour, label=name)
    axes.set(title="length: connected with a well, stimulated", ylabel=f"length [{unit.name}]")
    axes.set_ylim(bottom=0.0)
    _legend_above(axes)


def _draw_moment(axes: Axes, run: Run) -> None:
    """Moment of all slip since the first state, and the largest slip."""
    time = abscissa(run, run.history.moments())[0]
    breadth = run.scene.breadth_m if run.scene else 1.0
    moment = run.history.number("seismic_moment_nm")
    axes.plot(time, breadth * (moment - moment[0]), color=style.CYCLE[1])
    axes.set(title="seismic moment of all slip", ylabel="moment [N m]")
    axes.ticklabel_format(axis="y", style="sci", scilimits=(0, 0))
    axes.yaxis.get_offset_text().set_fontsize(6)
    axes.set_ylim(bottom=0.0)


def _draw_events(axes: Axes, run: Run) -> None:
    """Slip events from their beginning to their end, at their moment; seismic ones stand out."""
    axes.set(title="slip events: seismic (orange), aseismic", ylabel="moment [N m]")
    table = needed(run.slip_events, "slip_events.csv", "what has slipped when")
    begin, end = (abscissa(run, table.number(name))[0] for name in ("time_s", "end_s"))
    moment = table.number("moment_nm")
    size, fast = np.log10(moment), seismic(table)
    over = table.text("ended_by") == "stick"
    for k in np.argsort(fast, kind="stable"):
        look: dict[str, Any] = {"color": SEISMIC_COLOUR if fast[k] else ASEISMIC_COLOUR}
        axes.plot([begin[k], end[k]], [moment[k]] * 2, lw=1.6, solid_capstyle="butt", **look)
        axes.plot(begin[k], moment[k], "o", ms=3.5, **look)
        axes.plot(end[k], moment[k], "|" if over[k] else ">", ms=5, mew=1.2, clip_on=False, **look)
    low, high = float(size.min()), float(size.max())
    room = max(0.25 * (high - low), 0.2)
    axes.set_yscale("log")
    axes.set_ylim(10.0 ** (low - room), 10.0 ** (high + 1.6 * room))
    _name_events(axes, run, table, begin, size)


def _name_events(axes: Axes, run: Run, table: Table, begin: FloatArray, size: FloatArray) -> None:
    """Fractures of the largest events, above or below their beginning, as far as there is room."""
    taken: list[tuple[float, float]] = []
    low, high = np.log10(axes.get_ylim())
    end = float(abscissa(run, run.history.moments())[0][-1])
    for k in np.argsort(-size):
        across, up = float(begin[k]) / end, float(size[k] - low) / (high - low)
        for shift, align, offset in ((0.05, "bottom", 1.5), (-0.06, "top", -2.5)):
            if any(abs(across - x) < 0.14 and abs(up + shift - y) < 0.09 for x, y in taken):
                continue
            taken.append((across, up + shift))
            axes.annotate(
                run.fracture_name(str(table.text("fracture")[k])),
                (float(begin[k]), 10.0 ** float(size[k])),
                xytext=(4, offset),
                textcoords="offset points",
                va=align,
                fontsize=6.5,
                path_effects=HALO,
            )
            break


def _draw_facts(
    figure: Figure, places: GridSpecFromSubplotSpec, handles: Sequence[Artist], facts: str
) -> None:
    """Legend of the map, and the run in numbers, below or beside it."""
    labels = [str(handle.get_label()) for handle in handles]
    heights = (sum(label.count("\n") + 1.0 for label in labels) + 1.0, facts.count("\n") + 2.0)
    if places.nrows > 1:
        places.set_height_ratios(heights)
    legend, text = figure.add_subplot(places[0]), figure.add_subplot(places[1])
    for axes in (legend, text):
        axes.axis("off")
    legend.legend(
        handles=list(handles),
        loc="upper left",
        borderaxespad=0.0,
        bbox_to_anchor=(0.0, 1.0),
        handlelength=1.6,
    )
    text.text(
        0.0,
        1.0,
        facts,
        transform=text.transAxes,
        va="top",
        fontsize=style.text_size(),
        linespacing=1.35,
    )


def _facts(run: Run, marks: Sequence[Mark]) -> list[str]:
    table = run.history
    clock = time_unit(float(table.moments()[-1]))
    injected, produced = pumped_volumes(run)
    unit = run_length_unit(run)

    def at(moment: float) -> str:
        return f"{float(clock.of(moment)):.3g} {clock.name}"

    def length(column: str) -> str:
        return f"{float(unit.of(table.number(column)[-1])):.3g} {unit.name}"

    lines = [f"after {at(float(table.moments()[-1]))}:"]
    size = volume_unit(run.thickness_m, injected, produced)
    lines.append(f"injected {float(size.of(injected)):.3g} {size.name}")
    if produced > 0.0:
        lines.append(f"produced {float(size.of(produced)):.3g} {size.name}")
    elif injected > 0.0:
        share = table.number("leakoff_m2")[-1] / injected
        lines.append(f"leaked off {100.0 * share:z.0f} %")
    for name, row, highest in highest_pressures(table)[:_MOST_PEAKS]:
        when = at(float(table.moments()[row]))
        of_well = f"{name}: peak" if name else "peak pressure"
        words = f"{of_well} {float(MEGAPASCAL.of(highest)):.2f} MPa at {when}"
        lines += wrap(words, _WIDEST, subsequent_indent="  ")
    lines.append(f"stimulated {length('stimulated_length_m')},")
    lines.append(f"  of it connected {length('connected_stimulated_m')}")
    clusters = int(table.number("n_clusters")[-1])
    connections = table.number("connections_per_branch")[-1]
    lines.append(f"{clusters} cluster{'s' if clusters != 1 else ''}, $C_B$ = {connections:.2f}")
    slips = slip_words(run)
    if slips:
        breadth = run.scene.breadth_m if run.scene else 1.0
        lines += [*slips, f"  ({breadth:g} m thick)"]
    for mark in marks:
        lines.append(f"{mark.name}: {mark.what}, {at(mark.moment)}")
    return lines[:_MOST_FACTS]
