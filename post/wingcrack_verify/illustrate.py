"""All figures of a report, several cases at a time."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

from wingcrack_verify.figures import Drawing, check_drawings, map_drawing, requested_drawing
from wingcrack_verify.judge import PASSED, CaseReport
from wingcrack_verify.stability import StabilityReport
from wingcrack_verify.suite import JudgedSuite


@dataclass(frozen=True)
class Illustration:
    """Figures of a case: those that it asks for, and those of each of its checks."""

    of_case: Sequence[Drawing]
    of_checks: Sequence[Sequence[Drawing]]


def illustrate(judged: JudgedSuite, jobs: int, passed: bool = True) -> dict[str, Illustration]:
    """Draw the figures of all cases, several cases at a time; by the case's name.

    Without those of what has `passed`, only checks, maps and cases that did not are drawn.
    """
    items: list[CaseReport | StabilityReport] = [*judged.stability, *judged.cases]
    found = {item.name: Illustration((), [()] * len(getattr(item, "checks", ()))) for item in items}
    drawn = [item for item in items if passed or item.verdict != PASSED]
    if drawn:
        with ProcessPoolExecutor(min(jobs, len(drawn))) as pool:
            pictures = pool.map(partial(_drawings, passed=passed), drawn)
            found |= zip((item.name for item in drawn), pictures, strict=True)
    return found


def _drawings(item: CaseReport | StabilityReport, passed: bool) -> Illustration:
    if isinstance(item, StabilityReport):
        maps = [chart for chart in item.maps if passed or chart.verdict != PASSED]
        return Illustration([map_drawing(chart) for chart in maps], ())
    requested = [requested_drawing(figure) for figure in item.figures]
    return Illustration(
        [drawing for drawing in requested if drawing is not None],
        [
            check_drawings(check) if passed or check.verdict != PASSED else ()
            for check in item.checks
        ],
    )
