"""Error against unknowns: rates, what a method saves, and what a check of it must notice."""

from __future__ import annotations

from pathlib import Path

import pytest

from small_case import SmallCase, small_case
from wingcrack_verify.economy import Economy, observed_rate, saving, unknowns_needed
from wingcrack_verify.figures import check_drawings
from wingcrack_verify.judge import ERROR, FAILED, PASSED
from wingcrack_verify.orders import Point

SIZES = (100.0, 200.0, 400.0, 800.0)


def runs(method: str, factor: float, rate: float) -> list[Point]:
    """Points with the error factor * unknowns**rate."""
    return [
        Point(f"{method} {size:.0f}", method, 1.0, factor * size**rate, False, size)
        for size in SIZES
    ]


def test_the_rate_is_the_slope() -> None:
    assert observed_rate(runs("a", 3.0, -2.0)) == pytest.approx(-2.0)
    assert observed_rate(runs("a", 3.0, -2.0)[:1]) is None
    assert observed_rate([Point("a", "a", 1.0, 0.1, False), *runs("a", 3.0, -2.0)[:1]]) is None


def test_unknowns_are_interpolated_in_logs() -> None:
    points = runs("a", 3.0, -2.0)
    for favourably in (True, False):
        assert unknowns_needed(points, 3.0 * 300.0**-2, favourably) == pytest.approx(300.0)
        assert unknowns_needed(points, 3.0 * 900.0**-2, favourably) is None
        assert unknowns_needed(points, 3.0 * 90.0**-2, favourably) is None


def test_errors_that_rise_again_count_against_the_method() -> None:
    errors = (0.04, 0.01, 0.04, 0.01)
    points = [Point("a", "a", 1.0, e, False, n) for n, e in zip(SIZES, errors, strict=True)]
    assert unknowns_needed(points, 0.02, favourably=True) == pytest.approx(141.42, rel=1e-4)
    assert unknowns_needed(points, 0.02, favourably=False) == pytest.approx(565.69, rel=1e-4)
    assert unknowns_needed(points[:3], 0.02, favourably=False) is None


def test_a_saving_is_the_share_of_the_unknowns() -> None:
    points = [*runs("slow", 30.0, -1.0), *runs("fast", 30.0 * 150.0, -2.0)]
    found = saving(
        Economy(method="fast", than="slow", error=0.1, at_most=0.75), points
    )  # 212.1 of 300
    assert found.share == pytest.approx(150.0**0.5 * 300.0**0.5 / 300.0)
    assert found.good
    assert not saving(Economy(method="fast", than="slow", error=0.1, at_most=0.7), points).good


def test_a_method_that_never_gets_there_needs_more_than_it_had() -> None:
    points = [*runs("slow", 3000.0, -1.0), *runs("fast", 30.0 * 150.0, -2.0)]
    found = saving(Economy(method="fast", than="slow", error=0.1, at_most=0.5), points)
    assert found.unknowns_than == 800.0
    assert found.good
    turned = saving(Economy(method="slow", than="fast", error=0.1, at_most=0.5), points)
    assert turned.share is None
    assert not turned.good


@pytest.fixture
def case(tmp_path: Path) -> SmallCase:
    """Errors of 4, 1 and 0.25 %, the first by a method with many unknowns."""
    case = small_case(tmp_path, "economy")
    for name, unknowns in (("coarse", 500), ("middle", 100), ("fine", 200)):
        case.write_record(name, cpu_s=1.0, dofs={"displacement": unknowns, "pressure": unknowns})
    case.toml = case.toml.replace(
        'name = "coarse"\nmethod = "plain"', 'name = "coarse"\nmethod = "poor"'
    )
    return case


def test_a_check_of_unknowns_passes_and_tells_its_numbers(case: SmallCase) -> None:
    (report,) = case.judge().checks
    assert report.verdict == PASSED
    assert [point.unknowns for point in report.points] == [1000.0, 200.0, 400.0]
    titles = [drawing.title for drawing in check_drawings(report)]
    assert titles == [
        "largest, with few unknowns: error against run time",
        "largest, with few unknowns: error against unknowns",
    ]


def test_too_many_unknowns_fail(case: SmallCase) -> None:
    for name, unknowns in (("middle", 1000), ("fine", 2000)):
        case.write_record(name, cpu_s=1.0, dofs={"displacement": unknowns})
    (report,) = case.judge().checks
    assert report.verdict == FAILED
    assert "unknowns of 'plain' over those of 'poor'" in report.reasons[0]


def test_runs_that_do_not_tell_their_unknowns_fail(case: SmallCase) -> None:
    case.write_record("fine", cpu_s=1.0)
    (report,) = case.judge().checks
    assert report.verdict == FAILED


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('than = "poor"', 'than = "best"', "no measured run has the method 'best'"),
        ('than = "poor"', 'than = "plain"', "compared with itself"),
        ("at_most = 0.9", "at_most = 1.5", "less than 1"),
        ("error = 0.005", "error = 0.0", "must be positive"),
        ("at_most = 0.9", "most = 0.9", "'at_most' is missing"),
    ],
)
def test_a_wrong_table_is_an_error(case: SmallCase, old: str, new: str, message: str) -> None:
    assert old in case.toml
    case.toml = case.toml.replace(old, new)
    report = case.judge()
    assert report.verdict == ERROR
    assert message in report.broken
