"""The report as data: the contents of report.json and of the page."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from wingcrack_verify.contents import GROUPS, UNREADABLE
from wingcrack_verify.economy import observed_rate
from wingcrack_verify.judge import PASSED, VERDICTS, CaseReport, CheckReport, Measured, worst_of
from wingcrack_verify.orders import Point
from wingcrack_verify.rows import Row, quantity_text, unit_of, worst_text
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
        "groups": groups_of(
            judged, rows, {item["name"]: item["cpu_s"] for item in (*cases, *stability)}
        ),
        "nearest": [asdict(row) for row in nearest(rows)],
        "summary": [asdict(row) for row in rows],
        "settings": _settings(judged),
        "cases": cases,
        "stability": stability,
    }
    cleaned = _finite(record)
    assert isinstance(cleaned, dict)
    return cleaned


_OF_ALL = ("name", "title", "group", "source", "verdict", "broken")


def _case_record(case: CaseReport) -> dict[str, Any]:
    return {
        **{name: getattr(case, name) for name in _OF_ALL},
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
        "tolerance_text": quantity_text(check.tolerance, unit_of(report)),
        "verdict": report.verdict,
        "worst": worst_text(report),
        "known_gap": check.known_gap,
        "reasons": list(report.reasons),
        "runs": [_measured_record(report, item) for item in report.measured],
        "order_expected": check.order.model_dump() if check.order else None,
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
        "held": "" if report.holding is None else report.holding.reason,
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
        "error_text": "" if item.error is None else quantity_text(item.error, unit_of(report)),
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
                        {"target": advice.target, "setting": _point_record(advice.point)}
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
        **{name: getattr(item, name) for name in _OF_ALL},
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


NEAREST = 10  # rows that passed and are nearest to their tolerances


def groups_of(
    judged: JudgedSuite, rows: Sequence[Row], cpu_s: Mapping[str, float]
) -> list[dict[str, Any]]:
    """The groups that have cases, in their order, each with its cases, counts and worst row.

    Cases are in the order of their names, those with trials among those with checks.

    `rows`: those of all cases. `cpu_s`: CPU seconds of all runs, by case.
    """
    items: list[CaseReport | StabilityReport] = [*judged.cases, *judged.stability]
    items.sort(key=lambda item: item.name)
    by_case: dict[str, list[Row]] = {item.name: [] for item in items}
    for row in rows:
        by_case[row.case].append(row)
    groups = []
    for name in (UNREADABLE, *GROUPS):
        inside = [item for item in items if item.group == name]
        if not inside:
            continue
        found = [row for item in inside for row in by_case[item.name]]
        groups.append(
            {
                "name": name or "unreadable",
                "title": GROUPS.get(name, "Files that cannot be used"),
                "verdict": worst_of([item.verdict for item in inside]),
                "counts": _counts(found),
                "cpu_s": sum(cpu_s[item.name] for item in inside),
                "worst": _asdict(_worst(found)),
                "cases": [
                    {
                        "name": item.name,
                        "title": item.title,
                        "verdict": item.verdict,
                        "counts": _counts(by_case[item.name]),
                    }
                    for item in inside
                ],
            }
        )
    return groups


def nearest(rows: Sequence[Row]) -> list[Row]:
    """Rows that passed with the largest shares of their tolerances, the largest first."""
    passed = [row for row in rows if row.verdict == PASSED and row.share is not None]
    return sorted(passed, key=lambda row: -(row.share or 0.0))[:NEAREST]


def _worst(rows: Sequence[Row]) -> Row | None:
    """The row with the largest share of its tolerance, whatever became of it."""
    return max(
        (row for row in rows if row.share is not None),
        key=lambda row: row.share or 0.0,
        default=None,
    )


def _counts(rows: Sequence[Row]) -> dict[str, int]:
    found = Counter(row.verdict for row in rows)
    return {verdict: found[verdict] for verdict in VERDICTS}


def _asdict(row: Row | None) -> dict[str, Any] | None:
    return None if row is None else asdict(row)
