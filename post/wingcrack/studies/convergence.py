"""Observed order of convergence and the extrapolated value of a quantity over a size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wingcrack.errors import CaseError
from wingcrack.studies.groups import grouped
from wingcrack.studies.study import Study
from wingcrack.studies.table import StudyTable, cell_text, write_rows
from wingcrack.sweeps.expressions import Array

_ORDERS = (0.05, 12.0)  # in which an observed one is looked for


@dataclass(frozen=True)
class Extrapolation:
    """Limit of three values on sizes that fall: q = limit + c h^order."""

    order: float
    limit: float
    error: float  # of the value on the finest size: its distance from the limit


def extrapolate(
    size: Sequence[float] | Array, value: Sequence[float] | Array
) -> Extrapolation | None:
    """Richardson's extrapolation from the three finest sizes, whose ratios may differ.

    None if there are fewer, or if the values do not converge monotonically at an order that can
    be observed.

    >>> extrapolate([4.0, 2.0, 1.0], [17.0, 5.0, 2.0])
    Extrapolation(order=2.0, limit=1.0, error=1.0)
    """
    from scipy.optimize import brentq

    order = np.argsort(size)
    h, q = np.asarray(size, float)[order][:3], np.asarray(value, float)[order][:3]
    if h.size < 3 or np.any(np.diff(h) <= 0.0) or q[1] == q[0]:
        return None
    ratio = (q[2] - q[1]) / (q[1] - q[0])

    def excess(p: float) -> float:
        return float((h[2] ** p - h[1] ** p) / (h[1] ** p - h[0] ** p) - ratio)

    if excess(_ORDERS[0]) * excess(_ORDERS[1]) > 0.0:
        return None
    p = float(brentq(excess, *_ORDERS, xtol=1e-12))
    away = float((q[1] - q[0]) / ((h[1] / h[0]) ** p - 1.0))
    return Extrapolation(round(p, 10), float(q[0] - away), abs(away))


def write_convergence(study: Study, table: StudyTable, path: Path) -> None:
    """Write order and extrapolated value of the quantities of the figures of convergence.

    Nothing without such figures.
    """
    rows = []
    for plot in study.plots:
        if plot.kind != "convergence":
            continue
        try:
            groups = grouped(study, plot, table)[2]
        except CaseError:  # no run has both numbers: the figure says so
            continue
        for group, x, y in groups:
            found = extrapolate(x, y)
            numbers = (found.order, found.limit, found.error) if found else (None, None, None)
            finest = float(y[0])
            cells = (plot.quantity, plot.over, group, finest, *numbers)
            rows.append([cell_text(cell) for cell in cells])
    if rows:
        header = ("quantity", "over", "others", "finest", "order", "limit", "error_of_finest")
        write_rows(path, header, rows)
