"""All figures of a report, made once for page and PDF."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from wingcrack_verify.figures import Drawing, check_drawings, map_drawing, requested_drawing
from wingcrack_verify.judge import CaseReport
from wingcrack_verify.stability import StabilityReport
from wingcrack_verify.suite import JudgedSuite


@dataclass(frozen=True)
class Illustrations:
    """Figures by the case's name."""

    by_case: dict[str, Sequence[Drawing]]


def illustrate(judged: JudgedSuite, jobs: int) -> Illustrations:
    """Draw the figures of all cases, several cases at a time."""
    items: list[CaseReport | StabilityReport] = [*judged.stability, *judged.cases]
    names = [item.name for item in items]
    with ProcessPoolExecutor(jobs) as pool:
        drawn = pool.map(_drawings, items)
        return Illustrations(dict(zip(names, drawn, strict=True)))


def _drawings(item: CaseReport | StabilityReport) -> Sequence[Drawing]:
    if isinstance(item, StabilityReport):
        return [map_drawing(chart) for chart in item.maps]
    requested = [requested_drawing(figure) for figure in item.figures]
    of_checks = [drawing for check in item.checks for drawing in check_drawings(check)]
    return [*(drawing for drawing in requested if drawing is not None), *of_checks]
