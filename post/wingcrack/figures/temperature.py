"""Temperature along a fracture and by time: the arrival of cold or hot fluid."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.load import abscissa
from wingcrack.figures.read import Run, needed
from wingcrack.figures.table import FloatArray, Table
from wingcrack.figures.units import time_unit

_PROFILES = 5  # times of which a profile is drawn


@style.styled
def temperature(run: Run) -> Figure:
    """Draw the fracture in which temperatures differ most, its ends by time, and the wells.

    Raises `AbsentError` without temperatures.
    """
    table = needed(run.fractures, "fractures.csv", "values along fractures")
    if not table.has("temperature_k"):
        raise AbsentError("the scene has no &heat")
    figure = style.new_figure(style.DOUBLE_COLUMN, 3.2)
    along, by_time = figure.subplots(1, 2)
    chosen = _widest(table)
    _draw_profiles(along, run, table, chosen)
    _draw_times(by_time, run, table, chosen)
    style.letter([along, by_time])
    return figure


def _widest(table: Table) -> str:
    """Fracture whose temperatures span the largest range."""
    names, values = table.text("fracture"), table.number("temperature_k")
    spans = {str(name): float(np.ptp(values[names == name])) for name in dict.fromkeys(names)}
    return max(spans, key=spans.__getitem__)


def _draw_profiles(axes: Axes, run: Run, table: Table, chosen: str) -> None:
    """Draw profiles at times that are evenly spaced over the run."""
    here = table.text("fracture") == chosen
    time, s, value = (table.number(name)[here] for name in ("time_s", "s_m", "temperature_k"))
    moments = np.unique(time)
    wanted = np.linspace(moments[0], moments[-1], _PROFILES)
    drawn = np.unique([moments[np.argmin(np.abs(moments - moment))] for moment in wanted])
    unit = time_unit(float(moments[-1]))
    for moment, colour in zip(
        drawn, style.time_colours()(np.linspace(0, 1, drawn.size)), strict=True
    ):
        order = np.argsort(s[time == moment])
        axes.plot(
            s[time == moment][order],
            value[time == moment][order],
            color=colour,
            label=f"{float(unit.of(moment)):.3g} {unit.name}",
        )
    axes.set(
        title=f"along {run.fracture_name(chosen)}",
        xlabel="distance along the fracture [m]",
        ylabel="temperature [K]",
    )
    _legend_below(axes)


def _legend_below(axes: Axes) -> None:
    """Put the legend below the axes: curves leave no corner free."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2)


def _draw_times(axes: Axes, run: Run, table: Table, chosen: str) -> None:
    """Draw the temperatures of the first and the last cell of the fracture, and of the wells."""
    here = table.text("fracture") == chosen
    time, s, value = (table.number(name)[here] for name in ("time_s", "s_m", "temperature_k"))
    for place, look in ((float(s.min()), "-"), (float(s.max()), "--")):
        at = s == place
        moments, below = abscissa(run, time[at])
        axes.plot(moments, value[at], look, color="black", label=f"fracture at {place:.4g} m")
    if run.wells is not None and run.wells.has("temperature_k"):
        for index, well in enumerate(dict.fromkeys(run.wells.text("well"))):
            own = run.wells.text("well") == well
            of_well: FloatArray = run.wells.number("temperature_k")[own]
            moments, _ = abscissa(run, run.wells.number("time_s")[own])
            axes.plot(
                moments, of_well, ":", color=style.CYCLE[index % len(style.CYCLE)], label=well
            )
    axes.set(title="by time", xlabel=below, ylabel="temperature [K]")
    _legend_below(axes)
