"""Whether the default run lies on the Pareto front of error against work."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from wingcrack_verify.economy import front, work_of
from wingcrack_verify.orders import Point


def point(name: str, work: float | None, error: float) -> Point:
    return Point(name, "plain", 1.0, error, name == "default", None, work)


def test_the_cheapest_run_that_beats_the_default_is_named() -> None:
    runs = [point("default", 100.0, 0.1), point("a", 70.0, 0.1), point("b", 60.0, 0.09)]
    found = front(runs, 0.8)
    assert not found.good
    assert found.rival is runs[2]
    assert "default is off the front: b has 0.60 of its work" in found.reason


@pytest.mark.parametrize(
    "rival", [point("a", 70.0, 0.11), point("a", 81.0, 0.01), point("a", None, 0.01)]
)
def test_larger_errors_and_small_savings_do_not_count(rival: Point) -> None:
    assert front([point("default", 100.0, 0.1), rival], 0.8).good


def test_a_run_that_is_worse_in_another_quantity_does_not_beat_the_default() -> None:
    runs = [point("default", 100.0, 0.1), point("a", 70.0, 0.1), point("b", 60.0, 0.09)]
    other = [point("default", 100.0, 3.0), point("a", 70.0, 2.0), point("b", 60.0, 3.1)]
    assert front(runs, 0.8, [other]).rival is runs[1]
    assert front(runs, 0.8, [other, other]).rival is runs[1]
    found = front(runs, 0.8, [other, [point("default", 100.0, 1.0), point("b", 60.0, 0.5)]])
    assert found.good
    assert "its 3 errors" in found.reason


def test_without_one_default_that_tells_its_work_nothing_is_good() -> None:
    assert not front([point("a", 1.0, 0.1)], 0.8).good
    assert not front([point("default", None, 0.1)], 0.8).good
    assert not front([point("default", 1.0, 0.1)] * 2, 0.8).good


def test_work_is_unknowns_times_states(tmp_path: Path) -> None:
    record = tmp_path / "run.json"
    assert work_of(tmp_path) is None
    record.write_text(json.dumps({"dofs": {"a": 3, "b": 4}, "steps": 9}), encoding="utf-8")
    assert work_of(tmp_path) == 70.0
    record.write_text(json.dumps({"dofs": {"a": 3}}), encoding="utf-8")
    assert work_of(tmp_path) is None
