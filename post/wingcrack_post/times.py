"""Which of the written times a figure shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wingcrack_post.errors import RunError
from wingcrack_post.read import Run
from wingcrack_post.table import FloatArray


def select_times(
    run: Run, written_s: Sequence[float] | FloatArray, count: int, wanted_s: Sequence[float] = ()
) -> list[float]:
    """Choose some of the written times, in increasing order.

    With `wanted_s` these are the written times nearest to them. Without, they are the first one,
    the first one with growth, times of equally spaced fracture length up to the last one; without
    growth, equally spaced times.
    """
    written = np.unique(np.asarray(written_s, dtype=float))
    if written.size == 0:
        raise RunError(f"{run.directory}: no fields are written yet.")
    targets = np.asarray(wanted_s, dtype=float) if len(wanted_s) else _targets(run, written, count)
    chosen = {int(np.argmin(np.abs(written - target))) for target in targets}
    return [float(written[index]) for index in sorted(chosen)]


def growth_start(run: Run) -> float | None:
    """Time of the first step with longer fractures than at the start [s]; None without growth."""
    if not run.history.has("fracture_length_m"):
        return None
    length = run.history.number("fracture_length_m")
    grown = np.flatnonzero(length > length[0] * (1.0 + 1e-9))
    return float(run.history.moments()[grown[0]]) if grown.size else None


def _targets(run: Run, written: FloatArray, count: int) -> FloatArray:
    start = growth_start(run)
    if start is None or start >= written[-1]:
        return np.linspace(written[0], written[-1], count)
    later = written[written >= start]
    time, length = run.history.moments(), run.history.number("fracture_length_m")
    lengths = np.interp(later, time, length)
    # lengths never shrink, so the time of a length is the first one that reaches it
    steps = np.linspace(lengths[0], lengths[-1], count - 1)
    reached = np.minimum(np.searchsorted(lengths, steps * (1.0 - 1e-12)), later.size - 1)
    return np.concatenate(([written[0]], later[reached[:-1]], [written[-1]]))
