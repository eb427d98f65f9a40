"""Error against unknowns and work: rates, comparison of methods, place of the default setting.

A setting applies to all quantities of its scene, so a setting that improves one of them and worsens
another does not dominate it: all checks of a case with the front of the same runs count together.

Work is unknowns times accepted states: it is proportional to the run time (within a third for the
scenes of `verification/default_settings`), but is the same on every machine, however busy.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import model_validator

from wingcrack.figures.text_files import read_json
from wingcrack.sweeps.fields import Entry, Positive, Text
from wingcrack_verify.orders import Point


class Economy(Entry):
    """What is asked for.

    `method` has the error with at most the share `at_most` of the unknowns that `than` needs.
    """

    method: Text
    than: Text
    error: Positive
    at_most: Positive

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if self.method == self.than:
            raise ValueError(f"'{self.method}' would be compared with itself")
        if not self.at_most < 1.0:
            raise ValueError("'at_most' must be less than 1")
        return self


@dataclass(frozen=True)
class Saving:
    """What was found; `share` is None where it is not known."""

    wanted: Economy
    unknowns: float | None
    unknowns_than: float | None
    share: float | None
    good: bool
    reason: str


def run_record(output: Path) -> Any:
    """What run.json of a run says, which many checks ask: read once."""
    path = output / "run.json"
    return _read(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=1024)
def _read(path: Path, _changed: int) -> Any:
    return read_json(path)


def unknowns_of(output: Path) -> float | None:
    """Unknowns of all kinds of a run; None where its run.json tells none."""
    try:
        blocks = run_record(output).get("dofs", {})
        total = float(sum(blocks.values()))
    except (OSError, ValueError, AttributeError, TypeError):
        return None
    return total if math.isfinite(total) and total > 0.0 else None


def observed_rate(points: Sequence[Point]) -> float | None:
    """Slope of log error over log unknowns, by least squares; None for fewer than two points."""
    known = [(point.unknowns, point.error) for point in points if point.unknowns and point.error]
    if len({unknowns for unknowns, _ in known}) < 2:
        return None
    unknowns, error = np.log(np.array(known)).T
    return float(np.polyfit(unknowns - unknowns.mean(), error, 1)[0])


def unknowns_needed(points: Sequence[Point], error: float, favourably: bool) -> float | None:
    """Unknowns with which a method has an error, interpolated between its runs (both in logs).

    Errors need not fall from run to run. Favourably it is the first place where they pass the
    target, else the last one, behind which all are below it.

    Returns
    -------
    float or None
        None where the target lies outside of what was measured.
    """
    known = sorted((point.unknowns, point.error) for point in points if point.unknowns is not None)
    below = [measured <= error for _, measured in known]
    if not any(below) or (not favourably and not below[-1]):
        return None
    if favourably:
        place = below.index(True)
    else:
        place = len(below) - below[::-1].index(False) if False in below else 0
    if place == 0:
        return None
    (fewer, larger), (more, smaller) = known[place - 1], known[place]
    if smaller <= 0.0:
        return more
    share = math.log(larger / error) / math.log(larger / smaller)
    return float(fewer * (more / fewer) ** share)


def saving(wanted: Economy, points: Sequence[Point]) -> Saving:
    """Compare two methods at an error, in favour of the one that is to be beaten.

    A method `than` that never gets as far needs more than it was measured with; so its largest
    number of unknowns stands for what it needs.
    """
    ours = [point for point in points if point.method == wanted.method]
    theirs = [point for point in points if point.method == wanted.than]
    need = unknowns_needed(ours, wanted.error, favourably=False)
    need_than = unknowns_needed(theirs, wanted.error, favourably=True)
    known = [point.unknowns for point in theirs if point.unknowns is not None]
    if need_than is None and known and all(point.error > wanted.error for point in theirs):
        need_than = max(known)
    share = None if need is None or need_than is None else need / need_than
    what = f"unknowns of '{wanted.method}' over those of '{wanted.than}' at {wanted.error:.3g}"
    if share is None:
        return Saving(wanted, need, need_than, None, False, f"{what}: outside of the runs")
    good = share <= wanted.at_most
    text = f"{what}: {need:.0f}/{need_than:.0f} = {share:.3g}"
    return Saving(wanted, need, need_than, share, good, f"{text}, at most {wanted.at_most:.3g}")


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
