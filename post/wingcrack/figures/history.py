"""The run against time: stress intensities, length, well pressure, states, fluid balance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.load import abscissa, has_load, states_abscissa
from wingcrack.figures.marks import mark_moments
from wingcrack.figures.pressures import injected_and_produced, well_pressures
from wingcrack.figures.read import Run, needed
from wingcrack.figures.scales import jump_scale, run_length_unit, without_round_off
from wingcrack.figures.states import growth_start, settled_rows
from wingcrack.figures.table import BoolArray, FloatArray, Table
from wingcrack.figures.tabulated import intensities_table, state_table
from wingcrack.figures.units import (
    MEGAPASCAL,
    Unit,
    displacement_unit,
    intensity_unit,
    volume_label,
    volume_unit,
)

_Mode: TypeAlias = tuple[str, str, str, str | None, str | None]

INTENSITIES = ("k1", "k2", "keq")
_MODES: tuple[_Mode, ...] = (
    ("mode I", r"$K_\mathrm{I}$", "k1_pa_sqrtm", "k1_dc_pa_sqrtm", "k1_error_pa_sqrtm"),
    ("mode II", r"$K_\mathrm{II}$", "k2_pa_sqrtm", "k2_dc_pa_sqrtm", "k2_error_pa_sqrtm"),
    ("equivalent", r"$K_\mathrm{eq}$", "keq_pa_sqrtm", None, None),
)
_MOST_MARKERS = 25  # per line: more run into each other
_LEGEND_COLUMNS = 4
_LONG_LABEL = 34  # characters
_EARLY = 0.02  # share of the time before growth below which time is logarithmic
_EQUAL = 0.01  # tips whose curves differ by less, of the largest in the panel, share one line


@style.styled
def intensities(run: Run) -> Figure:
    """Stress intensity factors of every tip by both methods, and K_IC if the scene tells it.

    Raises `AbsentError` if the run has no tips.
    """
    table = needed(run.tips, "tips.csv", "stress intensity factors")
    if run.history.rows == 1:
        return intensities_table(run)
    time, label = states_abscissa(run, table)
    tips = _groups(table, _tips(table))
    unit = intensity_unit(*(table.number(column) for _, _, column, _, _ in _MODES))
    toughness = run.scene.toughness_pa_sqrtm if run.scene else None
    handles = _tip_handles(run, tips, toughness)
    longest = max(len(str(handle.get_label())) for handle in handles)
    columns = _LEGEND_COLUMNS if longest <= _LONG_LABEL else _LEGEND_COLUMNS // 2
    legend_rows = -(-len(handles) // columns)
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.45 + 0.17 * legend_rows)
    panels = list(figure.subplots(1, len(_MODES)))
    for axes, mode in zip(panels, _MODES, strict=True):
        _draw_mode(axes, table, mode, [rows for _, rows in tips], (time, label), unit)
        _spread_beginning(axes, run)
    if toughness is not None:
        panels[-1].axhline(float(unit.of(toughness)), color="#555555", linewidth=0.8, ls="--")
    style.letter(panels)
    style.outside_legend(figure, handles, columns)
    return figure


def _spread_beginning(axes: Axes, run: Run) -> None:
    """Logarithmic time where growth begins in the first part of a run with a fluid."""
    start, moments = growth_start(run), run.history.moments()
    if has_load(run) or start is None or not 0.0 < start < _EARLY * moments[-1]:
        return
    first = float(abscissa(run, moments[moments > 0.0])[0][0])
    axes.set_xscale("log")
    axes.set_xlim(left=first)


def draw_intensity(axes: Axes, run: Run, quantity: str = "keq") -> list[Artist]:
    """Draw one stress intensity factor of every tip into axes and give the legend's entries.

    Raises `AbsentError` if the run has no tips.
    """
    table = needed(run.tips, "tips.csv", "stress intensity factors")
    mode = _MODES[INTENSITIES.index(quantity)]
    tips = _groups(table, _tips(table))
    unit = intensity_unit(*(table.number(column) for _, _, column, _, _ in _MODES))
    _draw_mode(axes, table, mode, [rows for _, rows in tips], states_abscissa(run, table), unit)
    toughness = run.scene.toughness_pa_sqrtm if run.scene and quantity == "keq" else None
    if toughness is not None:
        axes.axhline(float(unit.of(toughness)), color="#555555", linewidth=0.8, ls="--")
    handles = _tip_handles(run, tips, toughness)
    return handles if mode[3] else [handle for handle in handles if not _of_methods(handle)]


def _of_methods(handle: Artist) -> bool:
    """Whether an entry of the legend tells methods apart, which K_eq does not show."""
    return str(handle.get_label()).startswith(("lines:", "circles:", "bands:"))


def _draw_mode(
    axes: Axes,
    table: Table,
    mode: _Mode,
    tips: Sequence[BoolArray],
    below: tuple[FloatArray, str],
    unit: Unit,
) -> None:
    """Curves of one stress intensity factor, a line for the rows of each tip."""
    title, symbol, integral, correlation, error = mode
    time, label = below
    for index, rows in enumerate(tips):
        look = style.line_look(index)
        marker = style.lone_marker(int(rows.sum()))
        values = unit.of(table.number(integral)[rows])
        axes.plot(time[rows], values, marker=marker, **look)
        if error is not None and table.has(error):
            spread = unit.of(table.number(error)[rows])
            axes.fill_between(
                time[rows],
                values - spread,
                values + spread,
                color=look["color"],
                alpha=0.25,
                linewidth=0.0,
            )
        if correlation is not None:
            every = max(1, int(rows.sum()) // _MOST_MARKERS)
            axes.plot(
                time[rows],
                unit.of(table.number(correlation)[rows]),
                linestyle="none",
                marker="o",
                markerfacecolor="none",
                markeredgecolor=look["color"],
                markeredgewidth=0.7,
                markevery=every,
            )
    _finish(axes, title, f"{symbol} [{unit.name}]", label)
    style.steady(axes, [unit.of(table.number(integral))])


@style.styled
def development(run: Run) -> Figure:
    """Fracture length, well pressure (with a fluid), largest slip and opening, and the states."""
    table = run.history
    if table.rows == 1:
        return state_table(run)
    fluid = table.has("injected_m2")
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.6 if fluid else 2.5)
    panels = list((figure.subplots(2, 2) if fluid else figure.subplots(1, 3)).flat)
    draw_length(panels[0], run)
    if fluid:
        draw_pressure(panels[1], run)
    draw_jumps(panels[-2], run)
    draw_states(panels[-1], run)
    style.outside_legend(figure, mark_moments(run, panels), 3)
    style.letter(panels)
    return figure


def draw_length(axes: Axes, run: Run) -> None:
    """Draw the length of all fractures into axes."""
    time, label = states_abscissa(run, run.history)
    unit = run_length_unit(run)
    values = unit.of(run.history.number("fracture_length_m"))
    axes.plot(time, values, color=style.CYCLE[0])
    style.steady(axes, [values])
    _finish(axes, "fracture length", f"total length [{unit.name}]", label)


def draw_pressure(axes: Axes, run: Run) -> None:
    """Draw the pressure of each well into axes."""
    time, label = states_abscissa(run, run.history)
    pressures = well_pressures(run.history)
    for index, (name, pressure) in enumerate(pressures.items()):
        axes.plot(time, MEGAPASCAL.of(pressure), label=name, **style.line_look(index))
    if len(pressures) > 1:
        axes.legend()
    _finish(axes, "well pressure", "pressure [MPa]", label)


def draw_jumps(axes: Axes, run: Run) -> None:
    """Draw largest slip and opening into axes."""
    time, label = states_abscissa(run, run.history)
    slip, opening = (
        without_round_off(run.history.number(name), jump_scale(run))
        for name in ("max_slip_m", "max_opening_m")
    )
    unit = displacement_unit(slip, opening)
    # the colours of the states that go with them
    for name, jump, colour, dashes in (
        ("slip", slip, style.STATE_COLOURS["slip"], "-"),
        ("opening", opening, style.STATE_COLOURS["open"], "--"),
    ):
        axes.plot(time, unit.of(jump), dashes, color=colour, label=name)
    axes.legend()
    _finish(axes, "largest slip and opening", f"displacement jump [{unit.name}]", label)


def draw_states(axes: Axes, run: Run) -> None:
    """Draw how many fracture cells stick, slip and are open into axes."""
    time, label = states_abscissa(run, run.history)
    rows = settled_rows(run)  # in the short steps after growth fractures stick that slip else
    for state, dashes in zip(style.STATES, ("-", "-", "--"), strict=True):
        # a state holds for the step that ends at its time
        axes.step(
            time[rows],
            run.history.number(f"n_{state}")[rows],
            dashes,
            where="pre",
            color=style.STATE_COLOURS[state],
            label=state,
        )
    axes.set_ylim(bottom=0.0)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend()
    _finish(axes, "contact state", "fracture cells [-]", label)


@style.styled
def balance(run: Run) -> Figure:
    """Where the injected fluid went, and how well mass is conserved.

    Raises `AbsentError` if the run has no fluid.
    """
    table = run.history
    if not table.has("injected_m2"):
        raise AbsentError("the run has no fluid (mechanics only)")
    if table.rows == 1:
        raise AbsentError("the run has one state, so nothing has flowed yet")
    time, below = abscissa(run, table.moments())
    volume = table.number("fracture_volume_m2")
    injected, produced = injected_and_produced(table)
    series: list[tuple[str, FloatArray]] = [
        ("injected", injected),
        ("leaked off into the rock", table.number("leakoff_m2")),
        ("fracture volume, change", volume - volume[0]),
    ]
    if np.any(produced > 0.0):
        series.insert(1, ("produced", produced))
    for name, label in (
        ("prefilled_m2", "prefilled new cells"),
        ("outflow_m2", "out through ends of fractures"),
    ):
        if table.has(name) and np.any(table.number(name) != 0.0):
            series.append((label, table.number(name)))
    unit = volume_unit(run.thickness_m, *(values for _, values in series))
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    volumes, errors = figure.subplots(1, 2)
    for index, (label, values) in enumerate(series):
        dashes = style.LINE_STYLES[index % len(style.LINE_STYLES)]
        volumes.plot(time, unit.of(values), dashes, color=style.CYCLE[index], label=label)
    volumes.legend()
    _finish(volumes, "fluid volumes", volume_label(unit), below)
    error = np.abs(table.number("mass_error_relative"))
    # zero cannot stand on a logarithmic axis; such steps are exact to round-off
    shown = np.maximum(error, np.finfo(float).eps)
    errors.semilogy(time, shown, color=style.CYCLE[0])
    _finish(errors, "mass conservation", "relative mass error [-]", below)
    style.outside_legend(figure, mark_moments(run, [volumes, errors]), 3)
    style.letter([volumes, errors])
    return figure


def _tips(table: Table) -> list[tuple[str, BoolArray]]:
    names = table.text("tip")
    first_rows = np.unique(names, return_index=True)[1]
    return [(str(name), names == name) for name in names[np.sort(first_rows)]]


def _groups(
    table: Table, tips: Sequence[tuple[str, BoolArray]]
) -> list[tuple[list[str], BoolArray]]:
    """Tips whose intensities are the same, as symmetry has it: one line for all, named so.

    Gives the names of each group and the rows of its first tip.
    """
    columns = [table.number(column) for _, _, column, _, _ in _MODES]
    largest = [float(np.nanmax(np.abs(values), initial=0.0)) for values in columns]
    moments = table.moments()
    groups: list[tuple[list[str], BoolArray]] = []
    for name, rows in tips:
        for names, first in groups:
            if np.array_equal(moments[first], moments[rows]) and all(
                np.all(np.abs(values[first] - values[rows]) <= _EQUAL * bound)
                for values, bound in zip(columns, largest, strict=True)
            ):
                names.append(name)
                break
        else:
            groups.append(([name], rows))
    return groups


def _group_label(run: Run, table: Table, names: Sequence[str]) -> str:
    """Call tips by number and fracture."""
    tips, fractures = table.text("tip"), table.text("fracture")
    owners: dict[str, list[str]] = {}
    for name in names:
        owner = run.fracture_name(str(fractures[np.argmax(tips == name)]))
        owners.setdefault(owner, []).append(name)
    parts = [f"{', '.join(mine)} ({owner})" for owner, mine in owners.items()]
    return f"{'tip' if len(names) == 1 else 'tips'} {', '.join(parts)}"


def _tip_handles(
    run: Run, tips: Sequence[tuple[list[str], BoolArray]], toughness: float | None
) -> list[Artist]:
    table = needed(run.tips, "tips.csv", "stress intensity factors")
    handles: list[Artist] = [
        style.handle(**style.line_look(index), label=_group_label(run, table, names))
        for index, (names, _) in enumerate(tips)
    ]
    handles.append(style.handle(color="#555555", label="lines: interaction integral"))
    handles.append(
        style.handle(
            color="#555555",
            linestyle="none",
            marker="o",
            markerfacecolor="none",
            label="circles: displacement correlation",
        )
    )
    if table.has("k1_error_pa_sqrtm"):
        handles.append(Patch(facecolor="#555555", alpha=0.25, label="bands: estimated error"))
    if toughness is not None:
        handles.append(
            style.handle(color="#555555", ls="--", lw=0.8, label=r"toughness $K_\mathrm{IC}$")
        )
    return handles


def _finish(axes: Axes, title: str, label: str, below: str) -> None:
    axes.set(title=title, ylabel=label, xlabel=below)
