"""Observed orders of convergence, and error against run time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wingcrack.errors import CaseError

ROUND_OFF = 1.0e-13  # relative errors below this say nothing about discretization

TARGETS = (0.05, 0.01, 0.001)  # relative errors that users ask for


@dataclass(frozen=True)
class Fit:
    """Observed order of one method: of all runs together and between neighbours, coarse first."""

    overall: float
    between: tuple[float, ...]


def observed_order(sizes: Sequence[float], errors: Sequence[float], signal: float) -> Fit:
    """Slope of log error over log size, by least squares.

    Raises `CaseError` if there are too few runs, or if an error is at round-off or no number.
    """
    size, error = np.array(sizes), np.array(errors)
    if size.size < 2 or np.unique(size).size != size.size:
        raise CaseError("an order needs at least two runs, each with a 'size' of its own")
    if not np.all(np.isfinite(error)):
        raise CaseError("an order cannot be fitted: an error is no number")
    if not np.all(error > ROUND_OFF * signal):
        raise CaseError("an error is at round-off: there is no order to observe")
    coarse_first = np.argsort(-size)
    log_size, log_error = np.log(size[coarse_first]), np.log(error[coarse_first])
    slope = np.polyfit(log_size - log_size.mean(), log_error, 1)[0]
    between = np.diff(log_error) / np.diff(log_size)
    return Fit(float(slope), tuple(float(value) for value in between))


@dataclass(frozen=True)
class Point:
    """A run in a work-precision diagram."""

    run: str
    method: str
    cpu_s: float  # CPU seconds
    error: float  # relative to the signal
    default: bool  # whether the run has the program's default settings
    unknowns: float | None = None  # unknowns of all kinds; None where the run does not tell
    work: float | None = None  # unknowns times states; None where the run does not tell


@dataclass(frozen=True)
class Advice:
    """The cheapest of the measured settings within a target error, or none."""

    target: float
    point: Point | None


def pareto_front(points: Sequence[Point]) -> list[Point]:
    """Points that no other beats in both error and time, cheapest first."""
    front: list[Point] = []
    for point in sorted(points, key=lambda point: (point.cpu_s, point.error)):
        if not front or point.error < front[-1].error:
            front.append(point)
    return front


def advise(points: Sequence[Point]) -> list[Advice]:
    """Cheapest measured setting for each of the targets."""
    advice = []
    for target in TARGETS:
        within = [point for point in points if point.error <= target]
        best = min(within, key=lambda point: (point.cpu_s, point.error), default=None)
        advice.append(Advice(target, best))
    return advice
