"""The rows of the report: each measured value, its reference and the result of the comparison."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from wingcrack_verify.judge import ERROR, PASSED, CheckReport
from wingcrack_verify.metrics import METRICS
from wingcrack_verify.stability import StabilityReport
from wingcrack_verify.suite import JudgedSuite


@dataclass(frozen=True)
class Row:
    """What one check, map or table of trials came to."""

    case: str
    quantity: str
    # error, tolerance: with their unit
    error: str
    tolerance: str
    share: float | None  # error over tolerance, where both are numbers
    verdict: str
    cpu_s: float | None  # of the run with this error, or of all trials [s]
    reasons: tuple[str, ...]  # why it is no pass


def rows_of(judged: JudgedSuite) -> Iterator[Row]:
    """Rows of the summary: a row per check, map and table of trials."""
    for case in judged.cases:
        if case.broken:
            yield Row(case.name, "check.toml", "", "", None, ERROR, None, (case.broken,))
        for check in case.checks:
            yield _check_row(case.name, check)
        for figure in case.figures:
            if figure.broken:
                title = figure.request.title
                yield Row(case.name, title, "", "", None, ERROR, None, (figure.broken,))
    for item in judged.stability:
        if item.broken:
            yield Row(item.name, "stability.toml", "", "", None, ERROR, None, (item.broken,))
        yield from _trial_rows(item)
        for chart in item.maps:
            bad = sum(cell.verdict != PASSED for cell in chart.cells)
            yield Row(
                item.name,
                f"map: {chart.chart.title}",
                f"{bad} of {len(chart.cells)} runs",
                "0 runs",
                None,
                chart.verdict,
                sum(cell.cpu_s for cell in chart.cells),
                _texts(chart.chart.known_gap, chart.reason),
            )


def _check_row(case: str, report: CheckReport) -> Row:
    check, worst = report.check, report.worst
    error = None if worst is None else worst.error
    return Row(
        case,
        check.quantity,
        worst_text(report),
        quantity_text(check.tolerance, unit_of(report)),
        None if error is None else error / check.tolerance,
        report.verdict,
        None if worst is None else worst.outcome.cpu_s,
        _texts(check.known_gap, *report.reasons),
    )


def _trial_rows(item: StabilityReport) -> Iterator[Row]:
    """A row for all trials that passed, and one for each of the others."""
    passed = [trial for trial in item.trials if trial.verdict == PASSED]
    if passed:
        masses = [trial.mass_error for trial in passed if trial.mass_error is not None]
        largest = max(masses, default=0.0)
        yield Row(
            item.name,
            f"{len(passed)} of {len(item.trials)} trials as expected; largest mass error",
            f"{largest:.1e}",
            f"{item.limits[0]:.0e}",
            largest / item.limits[0],
            PASSED,
            sum(trial.cpu_s for trial in passed),
            (),
        )
    for trial in item.trials:
        if trial.verdict != PASSED:
            yield Row(
                item.name,
                f"trial: {trial.trial.run.name}",
                trial.status,
                trial.trial.expect,
                None,
                trial.verdict,
                trial.cpu_s,
                _texts(trial.trial.known_gap, trial.reason),
            )


def _texts(*texts: str | None) -> tuple[str, ...]:
    return tuple(text for text in texts if text)


def worst_text(report: CheckReport) -> str:
    """Largest error of the judged runs; empty if none could be measured."""
    worst = report.worst
    if worst is None or worst.error is None:
        return ""
    return quantity_text(worst.error, unit_of(report))


def unit_of(report: CheckReport) -> str:
    """Unit of a check's error."""
    return report.check.unit if METRICS[report.check.metric].has_unit else "%"


def quantity_text(value: float, unit: str) -> str:
    """Number for a reader: relative ones in per cent, tiny ones as they are."""
    if not math.isfinite(value):
        return "infinite"
    if unit == "%":
        if 0.0 < value < 1.0e-5:
            return f"{value:.1e}"
        value *= 100.0
    number = f"{value:.3g}" if value == 0.0 or 1.0e-3 <= abs(value) < 1.0e4 else f"{value:.2e}"
    return number if unit == "-" else f"{number} {unit}"
