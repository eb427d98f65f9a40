"""Curves of a fall-off: Bourdet's derivative and the G-function.

Sources: Bourdet, Ayoub and Pirard, SPE Formation Evaluation 4 (1989) 293 (derivative); Nolte,
SPE 8341 (1979) (G-function for evenly exposed faces).
"""

from __future__ import annotations

import numpy as np

from wingcrack.figures.table import FloatArray


def g_function(since: FloatArray, injection: float) -> FloatArray:
    """Nolte's dimensionless time of leak-off after a shut-in: 0 at its start.

    G = (4/pi) (4/3) ((1 + d)^1.5 - d^1.5 - 1) with d = dt/tp, for faces that were exposed evenly
    over the time of injection (efficient fluid).

    `since`: time since the shut-in [s]; `injection`: time of injection before it [s].
    """
    ratio = since / injection
    return 16.0 / (3.0 * np.pi) * ((1.0 + ratio) ** 1.5 - ratio**1.5 - 1.0)


def g_rate(since: FloatArray, injection: float) -> FloatArray:
    """Derivative of `g_function` by the time since the shut-in [1/s]."""
    ratio = since / injection
    return 8.0 / (np.pi * injection) * (np.sqrt(1.0 + ratio) - np.sqrt(ratio))


def derivative(place: FloatArray, value: FloatArray, smoothing: float) -> FloatArray:
    """Slope of value against place by Bourdet's weighted means of two chords; nan at the ends.

    The neighbours are the nearest ones farther away than `smoothing`. The weights make the slope
    exact for a parabola.

    `place`: increasing, a logarithm where `smoothing` is to be one of logarithms.
    """
    slope = np.full_like(value, np.nan)
    below = np.searchsorted(place, place - smoothing, side="right") - 1
    above = np.searchsorted(place, place + smoothing, side="left")
    for row in range(1, place.size - 1):
        left = min(below[row], row - 1)
        right = max(above[row], row + 1)
        if left < 0 or right >= place.size:
            continue
        before, behind = place[row] - place[left], place[right] - place[row]
        first = (value[row] - value[left]) / before
        second = (value[right] - value[row]) / behind
        slope[row] = (first * behind + second * before) / (before + behind)
    return slope
