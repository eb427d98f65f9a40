"""Whether the default setting lies on the Pareto front of errors against work.

A setting applies to all quantities of its scene, so a setting that improves one of them and worsens
another does not dominate it: all checks of a case with the front of the same runs count together.

Work is unknowns times accepted states: it is proportional to the run time (within a third for the
scenes of `verification/default_settings`), but is the same on every machine, however busy.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from wingcrack_verify.economy import run_record, unknowns_of
from wingcrack_verify.orders import Point


@dataclass(frozen=True)
class Front:
    """Where the default setting lies; `rival` is the cheapest run that beats it, if one does."""

    default: Point | None
    rival: Point | None
    share: float
    reason: str

    @property
    def good(self) -> bool:
        """Whether there is one default setting, and none beats it."""
        return self.default is not None and self.rival is None


def work_of(output: Path) -> float | None:
    """Unknowns times states of a run; None where its run.json does not tell."""
    unknowns = unknowns_of(output)
    try:
        record = run_record(output)
        states = float(record["steps"]) + 1.0
    except (OSError, ValueError, KeyError, TypeError):
        return None
    if unknowns is None or not (math.isfinite(states) and states > 0.0):
        return None
    return unknowns * states


def front(points: Sequence[Point], share: float, others: Sequence[Sequence[Point]] = ()) -> Front:
    """Look for a run that has at most the default's errors with less than a share of its work.

    `points`: runs that solve the same problem; one of them is the default. `share`: of the work,
    from 0 to 1: savings that are smaller do not count. `others`: the errors of the same runs in
    other quantities. A run of which one of them tells nothing does not count.
    """
    defaults = [point for point in points if point.default]
    if len(defaults) != 1 or defaults[0].work is None:
        return Front(None, None, share, "front: needs one default run that tells its work")
    default = defaults[0]
    cheaper = [
        (point.work, point)
        for point in points
        if point.work is not None
        and all(_is_as_good(point.run, default.run, quantity) for quantity in (points, *others))
        and point.work < share * (default.work or 0.0)
    ]
    if not cheaper:
        what = "its error" if not others else f"its {1 + len(others)} errors"
        text = f"no other setting has {what} with less than {share:g} of its work"
        return Front(default, None, share, f"{default.run}: {text}")
    work, rival = min(cheaper, key=lambda item: item[0])
    ratio = work / (default.work or math.inf)
    errors = f"{rival.error:.3g} for {default.error:.3g}"
    reason = f"{default.run} is off the front: {rival.run} has {ratio:.2f} of its work ({errors})"
    return Front(default, rival, share, reason)


def _is_as_good(run: str, default: str, points: Sequence[Point]) -> bool:
    """Whether a run's error in a quantity is at most that of the default run."""
    errors = {point.run: point.error for point in points}
    return run in errors and default in errors and errors[run] <= errors[default]
