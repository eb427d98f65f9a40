"""The report as data: what report.json holds, and what page and PDF are filled with."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from wingcrack_verify.economy import observed_rate
from wingcrack_verify.judge import (
    ERROR,
    PASSED,
    VERDICTS,
    CaseReport,
    CheckReport,
    Measured,
    worst_of,
)
from wingcrack_verify.metrics import METRICS
from wingcrack_verify.orders import Point
from wingcrack_verify.stability import StabilityReport, TrialReport
from wingcrack_verify.suite import JudgedSuite


@dataclass(frozen=True)
class Context:
    """Where, when and with what the report was made."""

    made: str
    revision: str
    machine: Mapping[str, str]
    packages: Mapping[str, str]
    scope: str
    call: Mapping[str, float]


@dataclass(frozen=True)
class Row:
    """A row of the summary; `error` and `tolerance` as texts with their unit."""

    case: str
    quantity: str
    error: str
    tolerance: str
    verdict: str
    cpu_s: float | None
    reasons: tuple[str, ...]


def rows_of(judged: JudgedSuite) -> Iterator[Row]:
    """Rows of the summary: a row per check, map and table of trials."""
    for case in judged.cases:
        if case.broken:
            yield Row(case.name, "check.toml", "", "", ERROR, None, (case.broken,))
        for check in case.checks:
            yield _check_row(case.name, check)
        for figure in case.figures:
            if figure.broken:
                title = figure.request.title
                yield Row(case.name, title, "", "", ERROR, None, (figure.broken,))
    for item in judged.stability:
        if item.broken:
            yield Row(item.name, "stability.toml", "", "", ERROR, None, (item.broken,))
        yield from _trial_rows(item)
        for chart in item.maps:
            bad = sum(cell.verdict != PASSED for cell in chart.cells)
            yield Row(
                item.name,
                f"map: {chart.chart.title}",
                f"{bad} of {len(chart.cells)} runs",
                "0 runs",
                chart.verdict,
                sum(cell.cpu_s for cell in chart.cells),
                _texts(chart.chart.known_gap, chart.reason),
            )


def _check_row(case: str, report: CheckReport) -> Row:
    check, worst = report.check, report.worst
    unit = _unit(report)
    return Row(
        case,
        check.quantity,
        "" if worst is None or worst.error is None else quantity_text(worst.error, unit),
        quantity_text(check.tolerance, unit),
        report.verdict,
        None if worst is None else worst.outcome.cpu_s,
        _texts(check.known_gap, *report.reasons),
    )


def _trial_rows(item: StabilityReport) -> Iterator[Row]:
    """A row for all trials that passed, and one for each of the others."""
    passed = [trial for trial in item.trials if trial.verdict == PASSED]
    if passed:
        masses = [trial.mass_error for trial in passed if trial.mass_error is not None]
        yield Row(
            item.name,
            f"{len(passed)} of {len(item.trials)} trials as expected; largest mass error",
            f"{max(masses, default=0.0):.1e}",
            f"{item.limits[0]:.0e}",
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
                trial.verdict,
                trial.cpu_s,
                _texts(trial.trial.known_gap, trial.reason),
            )


def _texts(*texts: str | None) -> tuple[str, ...]:
    return tuple(text for text in texts if text)


def _unit(report: CheckReport) -> str:
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


def record_of(
    judged: JudgedSuite, rows: Sequence[Row], counts: Mapping[str, int], context: Context
) -> dict[str, Any]:
    """All that the report says, for machines; a number that is not finite becomes null."""
    cases = [_case_record(case) for case in judged.cases]
    stability = [_stability_record(item) for item in judged.stability]
    record = {
        "verdict": judged.verdict,
        "counts": dict(counts),
        **asdict(context),
        "cpu_s": sum(item["cpu_s"] for item in (*cases, *stability)),
        "overview": _overview(rows),
        "summary": [asdict(row) for row in rows],
        "settings": _settings(judged),
        "cases": cases,
        "stability": stability,
    }
    cleaned = _finite(record)
    assert isinstance(cleaned, dict)
    return cleaned


def _overview(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Number of rows of each case by verdict."""
    found: dict[str, Counter[str]] = {}
    for row in rows:
        found.setdefault(row.case, Counter())[row.verdict] += 1
    return [
        {
            "case": case,
            "verdict": worst_of(list(counts)),
            "counts": ", ".join(f"{counts[word]} {word}" for word in VERDICTS if counts[word]),
        }
        for case, counts in found.items()
    ]


def _case_record(case: CaseReport) -> dict[str, Any]:
    return {
        "name": case.name,
        "title": case.title,
        "source": case.source,
        "verdict": case.verdict,
        "broken": case.broken,
        "cpu_s": sum(outcome.cpu_s for outcome in case.outcomes.values()),
        "wall_s": sum(outcome.wall_s for outcome in case.outcomes.values()),
        "checks": [_check_record(report) for report in case.checks],
    }


def _check_record(report: CheckReport) -> dict[str, Any]:
    check = report.check
    return {
        "quantity": check.quantity,
        "unit": check.unit,
        "metric": check.metric,
        "normalise": "range" if check.by_range else "magnitude",
        "tolerance": check.tolerance,
        "tolerance_text": quantity_text(check.tolerance, _unit(report)),
        "verdict": report.verdict,
        "known_gap": check.known_gap,
        "reasons": list(report.reasons),
        "runs": [_measured_record(report, item) for item in report.measured],
        "order_expected": asdict(check.order) if check.order else None,
        "orders": [
            {
                "method": order.method,
                "observed": order.fit.overall if order.fit else None,
                "between": list(order.fit.between) if order.fit else [],
                "good": order.good,
                "reason": order.reason,
            }
            for order in report.orders
        ],
        "rates": _rates(report) if check.work_precision or check.economy else [],
        "saving": "" if report.saving is None else report.saving.reason,
        "front": "" if report.front is None else report.front.reason,
    }


def _rates(report: CheckReport) -> list[dict[str, Any]]:
    """Observed rate of each method: error proportional to unknowns to this power."""
    found = []
    for method in dict.fromkeys(point.method for point in report.points):
        rate = observed_rate([point for point in report.points if point.method == method])
        if rate is not None:
            found.append({"method": method, "observed": rate})
    return found


def _measured_record(report: CheckReport, item: Measured) -> dict[str, Any]:
    relative = item.error / item.signal if item.error is not None and item.signal else None
    point = next((point for point in report.points if point.run == item.run.name), None)
    single = item.pair if item.pair is not None and item.pair.result.size == 1 else None
    return {
        "run": item.run.name,
        "method": item.run.method,
        "size": item.run.size,
        "default": item.run.default,
        "judged": item.judged,
        "status": item.outcome.status,
        "reason": item.broken or item.outcome.reason,
        "result": float(single.result[0]) if single else None,
        "reference": float(single.reference[0]) if single else None,
        "error": item.error,
        "error_relative": relative,
        "error_text": "" if item.error is None else quantity_text(item.error, _unit(report)),
        "good": item.good,
        "cpu_s": item.outcome.cpu_s,
        "wall_s": item.outcome.wall_s,
        "unknowns": None if point is None else point.unknowns,
    }


def _settings(judged: JudgedSuite) -> list[dict[str, Any]]:
    """Which setting to use for which error, from the measured points."""
    found = []
    for case in judged.cases:
        for report in case.checks:
            if not report.advice:
                continue
            default = next((point for point in report.points if point.default), None)
            found.append(
                {
                    "case": case.name,
                    "quantity": report.check.quantity,
                    "default": _point_record(default),
                    "targets": [
                        {
                            "target": advice.target,
                            "setting": _point_record(advice.point),
                        }
                        for advice in report.advice
                    ],
                }
            )
    return found


def _point_record(point: Point | None) -> dict[str, Any] | None:
    if point is None:
        return None
    told = point.method in point.run
    return asdict(point) | {"label": point.run if told else f"{point.method}: {point.run}"}


def _stability_record(item: StabilityReport) -> dict[str, Any]:
    cells = [cell for chart in item.maps for cell in chart.cells]
    return {
        "name": item.name,
        "title": item.title,
        "source": item.source,
        "verdict": item.verdict,
        "broken": item.broken,
        "cpu_s": sum(trial.cpu_s for trial in (*item.trials, *cells)),
        "estimates": any(trial.condition_estimate is not None for trial in item.trials),
        "trials": [_trial_record(trial) for trial in item.trials],
        "maps": [
            {
                "title": chart.chart.title,
                "verdict": chart.verdict,
                "reason": chart.reason,
                "known_gap": chart.chart.known_gap,
                "cells": [_trial_record(cell) for cell in chart.cells],
            }
            for chart in item.maps
        ],
    }


def _trial_record(report: TrialReport) -> dict[str, Any]:
    numbers = {
        key: value
        for key, value in vars(report).items()
        if key not in ("trial", "verdict", "reason", "status")
    }
    trial = report.trial
    return {
        "name": trial.run.name,
        "note": trial.note,
        "expect": trial.expect,
        "known_gap": trial.known_gap,
        "verdict": report.verdict,
        "status": report.status,
        "reason": report.reason,
        **numbers,
    }


def _finite(value: Any) -> Any:
    """JSON knows no NaN and no infinity."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value
