"""Results of each well: pressures, flow, volume and injectivity against time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.load import abscissa
from wingcrack.figures.read import Run, needed
from wingcrack.figures.table import FloatArray, Table
from wingcrack.figures.units import MEGAPASCAL, volume_label, volume_unit

MOST_WELLS = len(style.CYCLE)  # more have no colour of their own
_GREY = "#555555"

Rows = npt.NDArray[np.intp]


def well_rows(table: Table) -> Iterator[tuple[int, str, Rows]]:
    """Give number, name and rows of each well of wells.csv, in the order of the file."""
    names = table.text("well")
    for index, name in enumerate(dict.fromkeys(names.tolist())):
        yield index, str(name), np.flatnonzero(names == name)


@style.styled
def well_histories(run: Run) -> Figure:
    """Pressure at depth and at the head, flow, volume and injectivity of each well.

    Raises `AbsentError` if the run has no wells, or one state only.
    """
    table = needed(run.wells, "wells.csv", "what each well did")
    if run.history.rows == 1:
        raise AbsentError("the run has one state, so nothing has flowed yet")
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.6)
    panels = list(figure.subplots(2, 2).flat)
    pressure, flow, volume, injectivity = panels
    unit = volume_unit(run.thickness_m, table.number("injected_m2"))
    for index, _, rows in well_rows(table):
        time, below = abscissa(run, table.moments()[rows])
        colour = style.CYCLE[index % MOST_WELLS]
        draw_well_pressure(pressure, table, rows, time, colour)
        draw_well_flow(flow, table, rows, time, colour)
        volume.plot(time, unit.of(table.number("injected_m2")[rows]), color=colour)
        answer = table.number("injectivity_m2_s_pa")[rows]
        injectivity.plot(time, np.where(answer > 0.0, answer, np.nan), color=colour)
    if any(np.any(line.get_ydata() > 0.0) for line in injectivity.lines):
        injectivity.set_yscale("log")
    for axes, title, label in (
        (pressure, "pressure", "pressure [MPa]"),
        (flow, "rate at the head, flow into fracture or rock", "flow [m²/s]"),
        (volume, "volume so far", volume_label(unit)),
        (injectivity, "injectivity: flow over rise of pressure", "injectivity [m²/(s Pa)]"),
    ):
        axes.set(title=title, ylabel=label)
    for axes in panels[2:]:
        axes.set_xlabel(below)
    style.letter(panels)
    handles = [
        style.handle(color=style.CYCLE[index % MOST_WELLS], label=name)
        for index, name, _ in well_rows(table)
    ]
    handles += [
        style.handle(color=_GREY, linestyle="-", label="at depth; out of the well"),
        style.handle(color=_GREY, linestyle=":", label="at the head"),
    ]
    style.outside_legend(figure, handles, 4)
    return figure


def draw_well_pressure(axes: Axes, table: Table, rows: Rows, time: FloatArray, colour: str) -> None:
    """Draw the pressure at depth, and that at the head where it is another one."""
    depth = table.number("pressure_pa")[rows]
    head = table.number("head_pressure_pa")[rows]
    axes.plot(time, MEGAPASCAL.of(depth), color=colour)
    if np.nanmax(np.abs(head - depth)) > 1.0e-9 * np.nanmax(np.abs(depth)):
        axes.plot(time, MEGAPASCAL.of(head), ":", color=colour)


def draw_well_flow(axes: Axes, table: Table, rows: Rows, time: FloatArray, colour: str) -> None:
    """Draw the flow out of the well, and the rate at its head where a store lies between."""
    flow = table.number("flow_m2_s")[rows]
    rate = table.number("rate_m2_s")[rows]
    axes.step(time, flow, where="pre", color=colour, lw=1.0)
    if np.nanmax(np.abs(rate - flow)) > 1.0e-9 * np.nanmax(np.abs(rate)):
        axes.step(time, rate, ":", where="pre", color=colour, lw=1.0)
    axes.ticklabel_format(axis="y", style="sci", scilimits=(0, 0))
