"""All figures of a report, several cases at a time."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from wingcrack_verify.figures import Drawing, check_drawings, map_drawing, requested_drawing
from wingcrack_verify.judge import CaseReport
from wingcrack_verify.stability import StabilityReport
from wingcrack_verify.suite import JudgedSuite


@dataclass(frozen=True)
class Illustration:
    """Figures of a case: those that it asks for, and those of each of its checks."""

    of_case: Sequence[Drawing]
    of_checks: Sequence[Sequence[Drawing]]


def illustrate(judged: JudgedSuite, jobs: int) -> dict[str, Illustration]:
    """Draw the figures of all cases, several cases at a time; by the case's name."""
    items: list[CaseReport | StabilityReport] = [*judged.stability, *judged.cases]
    names = [item.name for item in items]
    with ProcessPoolExecutor(jobs) as pool:
        return dict(zip(names, pool.map(_drawings, items), strict=True))


def _drawings(item: CaseReport | StabilityReport) -> Illustration:
    if isinstance(item, StabilityReport):
        return Illustration([map_drawing(chart) for chart in item.maps], ())
    requested = [requested_drawing(figure) for figure in item.figures]
    return Illustration(
        [drawing for drawing in requested if drawing is not None],
        [check_drawings(check) for check in item.checks],
    )
