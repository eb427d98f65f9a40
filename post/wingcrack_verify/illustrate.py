"""All figures of a report, made once for page and PDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from wingcrack_verify.figures import Drawing, check_drawings, map_drawing, requested_drawing
from wingcrack_verify.suite import JudgedSuite


@dataclass(frozen=True)
class Illustrations:
    """Figures by the case's name."""

    by_case: dict[str, Sequence[Drawing]]


def illustrate(judged: JudgedSuite) -> Illustrations:
    """Draw the figures of all cases."""
    by_case: dict[str, Sequence[Drawing]] = {}
    for case in judged.cases:
        requested = [requested_drawing(figure) for figure in case.figures]
        of_checks = [drawing for check in case.checks for drawing in check_drawings(check)]
        by_case[case.name] = [
            *(drawing for drawing in requested if drawing is not None),
            *of_checks,
        ]
    for item in judged.stability:
        by_case[item.name] = [map_drawing(chart) for chart in item.maps]
    return Illustrations(by_case)
