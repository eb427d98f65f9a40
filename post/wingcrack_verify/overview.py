"""The first part of the report: groups with their counts, and the largest errors."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from wingcrack_verify.groups import GROUPS, UNREADABLE, title_of
from wingcrack_verify.judge import PASSED, VERDICTS, CaseReport, worst_of
from wingcrack_verify.rows import Row
from wingcrack_verify.stability import StabilityReport
from wingcrack_verify.suite import JudgedSuite

NEAREST = 10  # rows that passed and are nearest to their tolerances


def groups_of(
    judged: JudgedSuite, rows: Sequence[Row], cpu_s: Mapping[str, float]
) -> list[dict[str, Any]]:
    """The groups that have cases, in their order, each with its cases, counts and worst row.

    Cases are in the order of their names, those with trials beside those with checks.

    Parameters
    ----------
    judged : JudgedSuite
    rows : sequence of Row
        Those of all cases.
    cpu_s : mapping of str to float
        CPU seconds of all runs, by case.
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
                "title": title_of(name),
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
