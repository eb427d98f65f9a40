"""Several runs in one figure."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

from wingcrack.errors import RunError
from wingcrack.figures import style
from wingcrack.figures.load import has_load
from wingcrack.figures.units import time_unit
from wingcrack.runs.plots import default_column, draw_history, fitting_unit, new_axes
from wingcrack.runs.run import Run
from wingcrack.runs.units import column_words


@style.styled
def compare(
    runs: Sequence[Run],
    column: str | None = None,
    ax: Axes | None = None,
    labels: Sequence[str] = (),
) -> Axes:
    """Draw a column of the history of several runs into one panel.

    Parameters
    ----------
    runs : sequence of Run
        All with a fluid, or all without: time and load factor do not share an axis.
    column : str, optional
        As ``well_pressure_pa``; default: pressure, without a fluid the fractures' length.
    ax : matplotlib.axes.Axes, optional
        Where to draw; default: axes of a new figure.
    labels : sequence of str
        One for each run; default: their scenes' names, with the folder where these are the same.

    Examples
    --------
    >>> runs = [wingcrack.open(f"out/rate_{k}") for k in (1, 2, 5)]  # doctest: +SKIP
    >>> wingcrack.compare(runs, "fracture_length_m")  # doctest: +SKIP
    """
    if not runs:
        raise RunError("compare needs at least one run")
    if labels and len(labels) != len(runs):
        raise RunError(f"compare got {len(runs)} runs and {len(labels)} labels")
    if len({has_load(run.files) for run in runs}) > 1:
        raise RunError("compare: runs with time and runs with a load factor share no axis")
    name = column or default_column(runs[0])
    unit = fitting_unit(name, *(run.column(name).astype(float) for run in runs))
    axes = new_axes(ax)
    for index, (run, label) in enumerate(zip(runs, labels or _labels(runs), strict=True)):
        draw_history(axes, run, name, unit, label=label, **style.line_look(index))
    if not has_load(runs[0].files):
        _share_clock(axes, runs)
    axes.set_ylabel(f"{column_words(name)} [{unit.name}]")
    axes.legend()
    return axes


def _share_clock(axes: Axes, runs: Sequence[Run]) -> None:
    """Give all curves the unit of time of the longest run: each came in its own."""
    clock = time_unit(max(float(run.moments[-1]) for run in runs))
    for line, run in zip(axes.lines[-len(runs) :], runs, strict=True):
        line.set_xdata(clock.of(run.moments))
    axes.set_xlabel(f"time [{clock.name}]")
    axes.relim()
    axes.autoscale_view()


def _labels(runs: Sequence[Run]) -> list[str]:
    names = [run.name for run in runs]
    folders = [run.directory.resolve().name for run in runs]
    return [
        name if names.count(name) == 1 else f"{name} ({folder})"
        for name, folder in zip(names, folders, strict=True)
    ]
