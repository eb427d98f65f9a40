"""Pressure, displacement and stress at the probe points against time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.load import states_abscissa
from wingcrack.figures.marks import mark_moments
from wingcrack.figures.read import Run, needed
from wingcrack.figures.table import Table
from wingcrack.figures.tabulated import table_figure
from wingcrack.figures.units import MEGAPASCAL, displacement_unit, stress_unit


@dataclass(frozen=True)
class _Quantity:
    title: str
    label: str
    parts: tuple[tuple[str, str], ...]  # end of the column name, symbol
    stress: bool


_QUANTITIES = (
    _Quantity("pore pressure", "pressure", (("_p_pa", "$p$"),), stress=True),
    _Quantity(
        "displacement", "displacement", (("_ux_m", "$u_x$"), ("_uy_m", "$u_y$")), stress=False
    ),
    _Quantity(
        "total stress",
        "stress",
        (
            ("_sxx_pa", r"$\sigma_{xx}$"),
            ("_syy_pa", r"$\sigma_{yy}$"),
            ("_sxy_pa", r"$\sigma_{xy}$"),
        ),
        stress=True,
    ),
)


def probe_names(table: Table) -> list[str]:
    """Names of the probe points, from the columns ``NAME_ux_m``."""
    return [name.removesuffix("_ux_m") for name in table.cells if name.endswith("_ux_m")]


@style.styled
def probe_histories(run: Run) -> Figure:
    """Draw every quantity at every probe: colour tells the probe, dashes the component.

    Raises `AbsentError` if the run has no probes.
    """
    table = needed(run.probes, "probes.csv", "values at probe points")
    names = probe_names(table)
    if not names:
        raise AbsentError("probes.csv has no probe points")
    quantities = [q for q in _QUANTITIES if any(table.has(names[0] + end) for end, _ in q.parts)]
    if table.rows == 1:
        return _values_table(table, names, quantities)
    time, below = states_abscissa(run, table)
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.8)
    panels = list(figure.subplots(1, len(quantities), squeeze=False).flat)
    for axes, quantity in zip(panels, quantities, strict=True):
        columns = [name + end for name in names for end, _ in quantity.parts]
        unit = (
            MEGAPASCAL
            if quantity.stress
            else displacement_unit(*(table.number(column) for column in columns))
        )
        for index, name in enumerate(names):
            for part, (end, _) in enumerate(quantity.parts):
                axes.plot(
                    time,
                    unit.of(table.number(name + end)),
                    linestyle=style.LINE_STYLES[part],
                    **_look(index),
                    markevery=(index % 7, max(1, time.size // 7)),
                )
        axes.set(title=quantity.title, ylabel=f"{quantity.label} [{unit.name}]", xlabel=below)
    style.letter(panels)
    handles = [*_handles(names, quantities), *mark_moments(run, panels)]
    style.outside_legend(figure, handles, 6 if len(handles) <= 6 else 4)
    return figure


def _look(index: int) -> dict[str, Any]:
    """Colour and marker of a probe."""
    return {
        "color": style.CYCLE[index % len(style.CYCLE)],
        "marker": style.MARKERS[index % len(style.MARKERS)],
    }


def _values_table(table: Table, names: Sequence[str], quantities: Sequence[_Quantity]) -> Figure:
    """All values of a run of one state."""
    head, units = ["probe"], []
    for quantity in quantities:
        columns = [name + end for name in names for end, _ in quantity.parts]
        fitting = stress_unit if quantity.stress else displacement_unit
        unit = fitting(*(table.number(column) for column in columns))
        head += [f"{symbol} [{unit.name}]" for _, symbol in quantity.parts]
        units += [(end, unit) for end, _ in quantity.parts]
    rows = [
        [name, *(f"{float(unit.of(table.number(name + end))[0]):.5g}" for end, unit in units)]
        for name in names
    ]
    return table_figure("values at the probe points", head, rows)


def _handles(names: list[str], quantities: list[_Quantity]) -> list[Line2D]:
    """Colours of the probes, then which component has which dashes."""
    handles = [
        style.handle(label=f"probe {name}", **_look(index)) for index, name in enumerate(names)
    ]
    for part, dashes in enumerate(style.LINE_STYLES):
        symbols = [q.parts[part][1] for q in quantities if part < len(q.parts)]
        if symbols:
            label = ", ".join(symbols)
            handles.append(style.handle(color="#555555", linestyle=dashes, label=label))
    return handles
