"""Seismic events: magnitude against frequency with b, by time and place."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.load import abscissa
from wingcrack.figures.read import Run, needed
from wingcrack.figures.slip import SEISMIC_COLOUR, seismic
from wingcrack.figures.table import FloatArray

BIN = 0.1  # of magnitudes
FEWEST = 50  # events for a b value
_BEYOND_PEAK = 0.2  # of the completeness beyond the fullest bin (Woessner and Wiemer 2005)


@dataclass(frozen=True)
class Frequency:
    """Slope of the Gutenberg-Richter line, log10 of the number of events = a - b magnitude."""

    events: int  # those of the fit, at or above the completeness
    completeness: float  # smallest magnitude of the fit: the centre of a bin
    b: float = np.nan
    error: float = np.nan  # standard error (Shi and Bolt 1982)
    reason: str = ""  # why there is no b

    def words(self) -> str:
        """Say b and its error, or why there is none."""
        if self.reason:
            return f"no b value: {self.reason}"
        return (
            f"b = {self.b:.2f} ± {self.error:.2f}"
            f" ({self.events} events from magnitude {self.completeness:.1f})"
        )


def frequency(magnitudes: FloatArray, width: float = BIN) -> Frequency:
    """Fit b by maximum likelihood (Aki 1965), with magnitudes in bins of a width (Utsu 1966).

    Complete are the magnitudes from 0.2 above the fullest bin on.
    """
    if magnitudes.size == 0:
        return Frequency(0, np.nan, reason="there is no seismic event")
    numbers = np.round(magnitudes / width).astype(int)
    bins, counts = np.unique(numbers, return_counts=True)
    least = int(bins[np.argmax(counts)]) + round(_BEYOND_PEAK / width)
    chosen = width * numbers[numbers >= least]
    complete = width * least
    if chosen.size < FEWEST:
        few = f"{chosen.size} of {magnitudes.size} events from magnitude {complete:.1f} on, "
        return Frequency(chosen.size, complete, reason=few + f"fewer than {FEWEST}")
    mean = float(chosen.mean())
    b = float(math.log10(math.e) / (mean - (complete - 0.5 * width)))
    spread = float(np.sum((chosen - mean) ** 2)) / (chosen.size * (chosen.size - 1))
    return Frequency(chosen.size, complete, b, float(np.log(10.0) * b**2 * np.sqrt(spread)))


@style.styled
def seismicity(run: Run) -> Figure:
    """Magnitude against frequency, against time, and by place.

    Raises `AbsentError` without seismic events.
    """
    events = needed(run.slip_events, "slip_events.csv", "slip events")
    fast = seismic(events)
    if not fast.any():
        raise AbsentError("no slip was fast enough to be seismic (seismic_slip_rate of &output)")
    magnitude = events.number("magnitude")[fast]
    time, below = abscissa(run, events.number("time_s")[fast])
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.36 * style.DOUBLE_COLUMN)
    counts, times, places = figure.subplots(1, 3)
    draw_frequency(counts, magnitude)
    times.vlines(time, min(float(magnitude.min()), 0.0) - 0.2, magnitude, color="#999999", lw=0.4)
    times.plot(time, magnitude, "o", color=SEISMIC_COLOUR, ms=3)
    times.set(title="magnitude by time", xlabel=below, ylabel="magnitude $M_w$")
    size = 4.0 + 12.0 * (magnitude - magnitude.min()) / max(float(np.ptp(magnitude)), 0.1)
    x, y = (events.number(name)[fast] for name in ("x_m", "y_m"))
    drawn = places.scatter(x, y, size**1.5, time, cmap=style.time_colours(), edgecolors="none")
    figure.colorbar(drawn, ax=places, label=below)
    places.set(title="place, size by magnitude", xlabel="x [m]", ylabel="y [m]")
    places.set_aspect("equal", adjustable="datalim")
    style.letter([counts, times, places])
    return figure


def draw_frequency(axes: Axes, magnitude: FloatArray) -> None:
    """Draw numbers per bin, numbers from each magnitude on, and the line of the fit."""
    found = frequency(magnitude)
    bins, number = np.unique(np.round(magnitude / BIN).astype(int), return_counts=True)
    centre = BIN * bins
    beyond = number[::-1].cumsum()[::-1]
    axes.semilogy(centre, number, "s", color="#999999", ms=3, label="in bins of 0.1")
    axes.semilogy(centre, beyond, "o", color=SEISMIC_COLOUR, ms=3, label="this large or larger")
    if not found.reason:
        ends = np.array([found.completeness, centre[-1]])
        line = found.events * 10.0 ** (-found.b * (ends - found.completeness))
        axes.semilogy(ends, line, color="black")
    axes.set(title=found.words(), xlabel="magnitude $M_w$", ylabel="events")
    axes.title.set_fontsize(6)
    axes.legend()
