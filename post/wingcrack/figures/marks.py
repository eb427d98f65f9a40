"""Marks of events in a run: first growth, and a well that starts or stops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from wingcrack.figures import style
from wingcrack.figures.load import abscissa, has_load, states_abscissa
from wingcrack.figures.read import Run
from wingcrack.figures.states import growth_start

STARTS, STOPS = "well starts", "well stops"


def well_marks(run: Run) -> list[tuple[float, str]]:
    """When wells start and stop within the run [s], and what to call it."""
    if run.scene is None or has_load(run):
        return []
    moments = run.history.moments()
    marks = []
    for well in run.scene.wells:
        marks.append((well.start_s, STARTS))
        if well.stop_s is not None:
            marks.append((well.stop_s, STOPS))
    inside = [mark for mark in marks if moments[0] < mark[0] <= moments[-1]]
    return sorted(set(inside))


def well_mark(run: Run, moment: float) -> str:
    """What the well does at this moment; nothing mostly."""
    return next((name for time, name in well_marks(run) if abs(time - moment) <= 1e-9 * time), "")


def mark_moments(run: Run, panels: Sequence[Axes]) -> list[Line2D]:
    """Draw thin lines at first growth and where wells start and stop; gives their legend.

    Names next to the lines would cross curves.
    """
    growth, wells = growth_start(run), [moment for moment, _ in well_marks(run)]
    handles = []
    for moments, name, dashes in (
        ([] if growth is None else [growth], "first growth", (0, (1, 1))),
        (wells, "well starts or stops", (0, (5, 2, 1, 2))),
    ):
        look: dict[str, Any] = {"color": "#555555", "linewidth": 1.0, "linestyle": dashes}
        for place in [_place(run, moment) for moment in moments]:
            for axes in panels:
                axes.axvline(place, zorder=1, **look)
        if moments:
            handles.append(style.handle(label=name, **look))
    return handles


def _place(run: Run, moment: float) -> float:
    """Where a moment stands on the axes of `states_abscissa`."""
    if has_load(run):
        row = int(np.argmin(np.abs(run.history.moments() - moment)))
        return float(states_abscissa(run, run.history)[0][row])
    return float(abscissa(run, np.array([moment]))[0][0])
