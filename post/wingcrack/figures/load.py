"""Mechanics-only runs: the load against growth, and the coordinate of figures instead of time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.read import Run
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.states import growth_start
from wingcrack.figures.table import FloatArray, Table
from wingcrack.figures.units import time_unit

LOAD_LABEL = "load factor [-]"
STEP_LABEL = "step [-]"


def has_load(run: Run) -> bool:
    """Whether a load factor drives the run, and time is only a parameter."""
    return run.history.has("load_factor")


def abscissa(run: Run, moments: FloatArray) -> tuple[FloatArray, str]:
    """Give what stands below curves: time in a unit that reads well, or the load factor."""
    if has_load(run):
        return moments, LOAD_LABEL
    clock = time_unit(float(run.history.moments()[-1]))
    return clock.of(moments), f"time [{clock.name}]"


def states_abscissa(run: Run, table: Table) -> tuple[FloatArray, str]:
    """What stands below curves of a table: time, or under a load at which tips grow the step."""
    if has_load(run) and growth_start(run) is not None:
        steps = tip_steps(table) if table.has("tip") else np.arange(1.0, table.rows + 1.0)
        return steps, STEP_LABEL
    return abscissa(run, table.moments())


def moment_label(run: Run, moment: float, row: int | None = None) -> str:
    """How a title calls a moment of the run; states of one load by their step (row, from 0) too."""
    value, label = abscissa(run, np.array([moment]))
    if has_load(run):
        name = f"load factor {value[0]:.4g}"
        loads = run.history.moments()
        shared = row is not None and np.count_nonzero(loads == loads[row]) > 1
        return f"{name}, step {row + 1}" if row is not None and shared else name
    return f"$t$ = {value[0]:.4g} {label[6:-1]}"


def tip_steps(table: Table) -> FloatArray:
    """Number of the step, from 1, of each row of tips.csv: a tip has one in each until it joins."""
    tips = table.text("tip")
    steps = np.zeros(table.rows)
    for tip in np.unique(tips):
        rows = np.flatnonzero(tips == tip)
        steps[rows] = np.arange(1, rows.size + 1)
    return steps


@style.styled
def load_figure(run: Run) -> Figure:
    """Load factor against the fractures' length, and both against the step.

    Raises `AbsentError` if no load factor drives the run, or nothing has grown.
    """
    if not has_load(run):
        raise AbsentError("no load factor drives the run")
    if growth_start(run) is None:
        raise AbsentError("nothing has grown")
    load = run.history.number("load_factor")
    length = run.history.number("fracture_length_m")
    unit = run_length_unit(run)
    steps = np.arange(1, load.size + 1)
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.5)
    against, rising, growing = figure.subplots(1, 3)
    draw_load(against, run)
    rising.plot(steps, load, color=style.CYCLE[0])
    rising.set(title="load", ylabel=LOAD_LABEL)
    rising.set_ylim(bottom=0.0 if load.min() >= 0.0 else None)
    growing.plot(steps, unit.of(length), color=style.CYCLE[1])
    growing.set(title="growth", ylabel=f"total length [{unit.name}]")
    for axes in (rising, growing):
        axes.set_xlabel(STEP_LABEL)
        axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    style.letter([against, rising, growing])
    return figure


def draw_load(axes: Axes, run: Run) -> None:
    """Draw the load factor against the fractures' length into axes.

    Raises `AbsentError` if no load factor drives the run.
    """
    if not has_load(run):
        raise AbsentError("no load factor drives the run")
    load = run.history.number("load_factor")
    unit = run_length_unit(run)
    length = unit.of(run.history.number("fracture_length_m"))
    axes.plot(length, load, color=style.CYCLE[0], marker=".", markersize=2)
    axes.set(title="load against length", xlabel=f"total length [{unit.name}]", ylabel=LOAD_LABEL)
    axes.set_ylim(bottom=0.0 if load.min() >= 0.0 else None)
