"""Opening, slip and tractions along each fracture, lines coloured by time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.growth import MOST, foremost, read_growth
from wingcrack.figures.load import moment_label
from wingcrack.figures.read import Run, needed
from wingcrack.figures.scales import jump_scale, run_length_unit, traction_scale, without_round_off
from wingcrack.figures.states import select_states
from wingcrack.figures.table import BoolArray, FloatArray, Table
from wingcrack.figures.units import Unit, displacement_unit, stress_unit
from wingcrack.figures.vtu import IntArray

DEFAULT_COUNT = 8
_DASHED: dict[str, Any] = {"linestyle": (0, (3, 2)), "linewidth": 0.8}
_FAR = 10.0  # largest over smallest aperture from which their axis is logarithmic


@dataclass(frozen=True)
class _Panel:
    column: str
    title: str
    label: str
    stress: bool


_PANELS = (
    _Panel("jump_n_m", "opening", r"opening $[u]_n$", stress=False),
    _Panel("jump_t_m", "slip", r"slip $[u]_\tau$", stress=False),
    _Panel("traction_n_pa", "normal traction", r"normal traction $f_n$", stress=True),
    _Panel("traction_t_pa", "tangential traction", r"tangential traction $f_\tau$", stress=True),
)
_FLUID_PANELS = (
    _Panel("aperture_m", "aperture", r"aperture $a$", stress=False),
    _Panel("pressure_pa", "fluid pressure", r"fluid pressure $p_\mathrm{F}$", stress=True),
)


def fracture_profiles(
    run: Run, wanted_s: Sequence[float] = (), *, every: bool = True
) -> Iterator[tuple[str, Figure]]:
    """Draw one figure per fracture; yields its label in the files and the figure.

    Of many fractures only the foremost get one, unless `every` one shall. Raises `AbsentError` if
    the run has no fracture cells; at the end, if fractures were left out.
    """
    table = needed(run.fractures, "fractures.csv", "the state along fractures")
    labels = table.text("fracture")
    all_labels = fracture_labels(table)
    chosen = all_labels if every else _foremost_labels(run, _eventful(run, table, all_labels))
    for label in chosen:
        yield label, _profile(run, table, label, labels == label, wanted_s)
    if len(chosen) < len(all_labels):
        raise AbsentError(
            f"{len(all_labels) - len(chosen)} of {len(all_labels)} fractures: they stick without a"
            " well, or others have grown or are longer; --only fractures draws all"
        )


def _eventful(run: Run, table: Table, labels: Sequence[str]) -> Sequence[str]:
    """Labels of fractures that have a well, slip, open or grow; all where none does."""
    wells = {well.fracture for well in run.scene.wells} if run.scene else set()
    moved = set(table.text("fracture")[table.text("state") != "stick"].tolist())
    if run.events is not None and run.events.rows:
        moved |= set(run.events.text("fracture").tolist())
    found = [one for one in labels if one in moved or run.fracture_name(one) in wells]
    return found or labels


def _foremost_labels(run: Run, labels: Sequence[str]) -> Sequence[str]:
    """Labels of the fractures that matter most, in the order of the file."""
    if len(labels) <= MOST:
        return labels
    network = run.network or {}
    growths = read_growth(network) if network.get("steps") else []
    first = {str(item.number) for item in foremost(growths, run.scene)}
    return [label for label in labels if label in first] or labels[:MOST]


def state_numbers(moments: FloatArray, s: FloatArray) -> FloatArray:
    """Number of the written state of each row of one fracture, from 0.

    A new state begins where the moment changes, and where the arc length starts again: several
    states can share a load factor.
    """
    begins = (np.diff(moments) != 0.0) | (np.diff(s) <= 0.0)
    return np.concatenate(([0.0], np.cumsum(begins)))


def arc_length(time: FloatArray, s: FloatArray, xy: FloatArray) -> FloatArray:
    """Arc length with an origin that stays in place when the fracture grows at its start.

    The middle of the fracture at the first time keeps its arc length at all times, so a wing at
    the start has negative values. Arguments are per row: time [s], arc length [m], (n, 2) points.
    """
    shifted = s.copy()
    first = time == time[0]
    middle = int(np.argmin(np.abs(s[first] - s[first].mean())))
    anchor, anchor_s = xy[first][middle], s[first][middle]
    for moment in np.unique(time):
        rows = np.flatnonzero(time == moment)
        rows = rows[np.argsort(s[rows])]
        shifted[rows] += anchor_s - _arc_length_at(anchor, s[rows], xy[rows])
    return shifted


def _arc_length_at(point: FloatArray, s: FloatArray, xy: FloatArray) -> float:
    """Arc length of the point on the polyline nearest to `point`."""
    if len(s) == 1:
        return float(s[0])
    edge = np.diff(xy, axis=0)
    squared = np.maximum(np.sum(edge**2, axis=1), np.finfo(float).tiny)
    share = np.clip(np.sum((point - xy[:-1]) * edge, axis=1) / squared, 0.0, 1.0)
    foot = xy[:-1] + share[:, None] * edge
    nearest = int(np.argmin(np.sum((foot - point) ** 2, axis=1)))
    return float(s[nearest] + share[nearest] * (s[nearest + 1] - s[nearest]))


@dataclass(frozen=True)
class _Lines:
    """The chosen states of one fracture: where its cells are, and which rows belong to which."""

    run: Run
    label: str
    table: Table
    mine: BoolArray
    place: FloatArray  # arc length in the unit of the axes
    initial: FloatArray  # that of the first state
    rows: list[IntArray]  # of each chosen state, along the fracture
    names: list[str]  # of the chosen states
    colours: list[tuple[float, float, float, float]]


def fracture_labels(table: Table) -> list[str]:
    """Fractures of fractures.csv in the order of the file, which is the order of the scene."""
    return [str(label) for label in dict.fromkeys(table.text("fracture").tolist())]


@style.styled
def _profile(
    run: Run, table: Table, label: str, mine: BoolArray, wanted_s: Sequence[float]
) -> Figure:
    lines = _lines(run, table, label, mine, wanted_s)
    panels = _panels(table)
    columns = len(panels) // 2
    halves = [panels[:columns], panels[columns:]]
    # of a fracture that is stuck stresses only, of one that is open without a fluid jumps only
    halves = [half for half in halves if _says_something(run, table, mine, half)] or halves[1:]
    panels, rows = [panel for half in halves for panel in half], len(halves)
    figure = style.new_figure(style.DOUBLE_COLUMN, 1.9 * rows + 1.1)
    axes = list(figure.subplots(rows, columns, sharex=True).flat)
    for panel, axis in zip(panels, axes, strict=True):
        _draw_panel(axis, lines, panel)
    friction = _draw_bound(axes[-1], lines) if panels[-1].stress else None
    for axis in axes[-columns:]:
        axis.set_xlabel(f"distance along the fracture [{run_length_unit(run).name}]")
    style.letter(axes)
    figure.suptitle(run.fracture_name(label), fontsize=9)
    style.outside_legend(figure, _time_handles(lines.names, lines.colours, friction), 4)
    return figure


def _says_something(run: Run, table: Table, mine: BoolArray, panels: Sequence[_Panel]) -> bool:
    """Whether not all is zero; an aperture alone does not count."""
    return any(
        without_round_off(
            table.number(panel.column)[mine],
            traction_scale(run) if panel.stress else jump_scale(run),
        ).any()
        for panel in panels
        if panel.column != "aperture_m"
    )


def draw_profile(
    axes: Axes, run: Run, column: str, label: str, wanted_s: Sequence[float] = ()
) -> list[Line2D]:
    """Draw a column of fractures.csv along one fracture into axes; gives the legend's entries.

    Raises `AbsentError` if the run has no fracture cells.

    `column`: one of `profile_columns`. `label`: the fracture in fractures.csv. `wanted_s`: moments,
    in the unit of the tables; the nearest written ones are drawn. Default: see `select_states`.
    """
    table = needed(run.fractures, "fractures.csv", "the state along fractures")
    panel = next(panel for panel in _panels(table) if panel.column == column)
    lines = _lines(run, table, label, table.text("fracture") == label, wanted_s)
    _draw_panel(axes, lines, panel)
    friction = _draw_bound(axes, lines) if column == "traction_t_pa" else None
    axes.set_xlabel(f"distance along the fracture [{run_length_unit(run).name}]")
    return _time_handles(lines.names, lines.colours, friction)


def profile_columns(table: Table) -> list[str]:
    """Columns of fractures.csv that can be drawn along a fracture."""
    return [panel.column for panel in _panels(table)]


def _panels(table: Table) -> list[_Panel]:
    if table.has("pressure_pa", "aperture_m"):
        return [_FLUID_PANELS[0], *_PANELS[:2], _FLUID_PANELS[1], *_PANELS[2:]]
    return list(_PANELS)


def _lines(
    run: Run, table: Table, label: str, mine: BoolArray, wanted_s: Sequence[float]
) -> _Lines:
    moments, s = table.moments()[mine], table.number("s_m")[mine]
    xy = np.column_stack((table.number("x_m")[mine], table.number("y_m")[mine]))
    told = table.number("history_row")[mine] if table.has("history_row") else None
    states = state_numbers(moments, s)
    if told is not None:
        states = np.searchsorted(np.unique(told), told).astype(float)
    s = arc_length(states, s, xy)
    firsts = np.searchsorted(states, np.unique(states))
    written = moments[firsts]
    in_history = [] if told is None else [int(row) - 1 for row in told[firsts]]
    chosen = select_states(run, written, DEFAULT_COUNT, wanted_s, rows=in_history)
    length = run_length_unit(run)
    rows = [np.flatnonzero(states == state) for state in chosen]
    names = [
        moment_label(run, float(written[state]), in_history[state] if in_history else None)
        for state in chosen
    ]
    return _Lines(
        run,
        label,
        table,
        mine,
        place=length.of(s),
        initial=length.of(s[states == 0.0]),
        rows=[one[np.argsort(s[one])] for one in rows],
        names=names,
        colours=style.ordered_colours(len(chosen)),
    )


def _draw_panel(axis: Axes, lines: _Lines, panel: _Panel) -> None:
    """Draw one quantity, a line for each state."""
    scale = traction_scale(lines.run) if panel.stress else jump_scale(lines.run)
    values = without_round_off(lines.table.number(panel.column)[lines.mine], scale)
    shown = [values[rows] for rows in lines.rows]
    unit = stress_unit(*shown) if panel.stress else _jump_unit(panel, axis, shown)
    for rows, colour in zip(lines.rows, lines.colours, strict=True):
        marker = style.lone_marker(rows.size)
        axis.plot(lines.place[rows], unit.of(values[rows]), color=colour, marker=marker)
    axis.set(title=panel.title, ylabel=f"{panel.label} [{unit.name}]")
    style.steady(axis, [unit.of(value) for value in shown])
    _mark_initial_ends(axis, lines.initial)


def _draw_bound(axis: Axes, lines: _Lines) -> float | None:
    """Draw the bound of friction with the tangential traction; gives the coefficient."""
    friction = _friction(lines.run, lines.label)
    if friction is not None:
        values = lines.table.number("traction_t_pa")[lines.mine]
        unit = stress_unit(
            *(without_round_off(values[rows], traction_scale(lines.run)) for rows in lines.rows)
        )
        bound = _bound(lines.run, lines.table, lines.mine, friction)
        for rows, colour in zip(lines.rows, lines.colours, strict=True):
            axis.plot(lines.place[rows], unit.of(bound[rows]), color=colour, **_DASHED)
    return friction


def _jump_unit(panel: _Panel, axis: Axes, shown: Sequence[FloatArray]) -> Unit:
    """Unit of a jump; apertures that differ much (new wings) get a logarithmic axis."""
    values = np.concatenate(shown)
    smallest = float(np.nanmin(values))
    if panel.column != "aperture_m" or not 0.0 < _FAR * smallest < float(np.nanmax(values)):
        return displacement_unit(values)
    axis.set_yscale("log")
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    return displacement_unit(smallest)


def _mark_initial_ends(axis: Axes, initial_s: FloatArray) -> None:
    """Thin lines where the fracture ended at first, half a cell beyond the outermost centres."""
    if initial_s.size < 2:
        return
    ordered = np.sort(initial_s)
    ends = (1.5 * ordered[0] - 0.5 * ordered[1], 1.5 * ordered[-1] - 0.5 * ordered[-2])
    for end in ends:
        axis.axvline(end, color="#999999", linewidth=0.6, linestyle=":", zorder=0)


def _friction(run: Run, label: str) -> float | None:
    law = run.scene.fracture(label) if run.scene else None
    return law.friction if law and law.friction else None


def _bound(run: Run, table: Table, mine: BoolArray, friction: float) -> FloatArray:
    """Friction bound mu_s |f_n| on the side of zero where the tangential traction is [Pa]."""
    scale = traction_scale(run)
    normal = without_round_off(table.number("traction_n_pa")[mine], scale)
    tangential = without_round_off(table.number("traction_t_pa")[mine], scale)
    side = -1.0 if np.nansum(tangential) < 0.0 else 1.0
    return np.asarray(side * friction * np.maximum(0.0, -normal))


def _time_handles(
    names: Sequence[str],
    colours: Sequence[tuple[float, float, float, float]],
    friction: float | None,
) -> list[Line2D]:
    handles = [
        style.handle(color=colour, label=name) for name, colour in zip(names, colours, strict=True)
    ]
    if friction is not None:
        bound = rf"friction bound $\mu_s |f_n|$, $\mu_s$ = {friction:g}"
        handles.append(style.handle(color="#555555", label=bound, **_DASHED))
    return handles
