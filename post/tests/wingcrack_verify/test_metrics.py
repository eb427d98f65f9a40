"""Error measures, orders and work-precision against values found by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from wingcrack.errors import CaseError
from wingcrack.sweeps.expressions import Array, evaluate, names_in
from wingcrack_verify.metrics import Pair, measure
from wingcrack_verify.orders import Point, advise, observed_order, pareto_front

X = np.linspace(0.0, 1.0, 2001)


def pair(result: list[float], reference: list[float]) -> Pair:
    return Pair(np.array(result), np.array(reference), np.arange(float(len(result))))


@pytest.mark.parametrize(
    ("name", "result", "reference", "expected"),
    [
        ("absolute", [1.0, -2.0], [1.5, -2.25], 0.5),
        ("relative", [3.0], [-4.0], 1.75),
        ("ratio", [2.0], [4.0], 1.0),
        ("ratio", [4.0], [2.0], 1.0),
        ("ratio", [-4.0], [2.0], math.inf),
        ("max_relative", [1.0, -3.0], [1.0, -4.0], 0.25),
        ("monotonic", [0.0, 2.0, 1.5, 4.0], [0.0] * 4, 0.125),
        ("monotonic", [4.0, 2.0, 1.5, 0.0], [0.0] * 4, math.inf),
        ("at_least", [5.0], [4.0], 0.0),
        ("at_least", [3.0], [4.0], 0.25),
        ("at_least", [-3.0], [-2.0], 0.5),
        ("at_most", [3.0], [4.0], 0.0),
        ("at_most", [5.0], [4.0], 0.25),
        ("at_most", [-1.0], [-2.0], 0.5),
    ],
)
def test_error_of_few_values(
    name: str, result: list[float], reference: list[float], expected: float
) -> None:
    assert measure(name, pair(result, reference), by_range=False) == pytest.approx(expected)


def test_l2_error_is_that_of_the_integrals() -> None:
    # int (x^2 - x)^2 = 1/30 and int x^2 = 1/3 over (0, 1)
    found = measure("l2_relative", Pair(X**2, X, X), by_range=False)
    assert found == pytest.approx(math.sqrt(0.1), rel=1.0e-6)


def test_l2_error_by_range_sees_only_the_variation() -> None:
    # a shift of 0.1 against x + 100, whose deviation from its mean has the norm sqrt(1/12)
    found = measure("l2_relative", Pair(X + 100.1, X + 100.0, X), by_range=True)
    assert found == pytest.approx(0.1 * math.sqrt(12.0), rel=1.0e-6)


def test_largest_error_by_range_sees_only_the_variation() -> None:
    found = measure("max_relative", Pair(X + 100.1, X + 100.0, X), by_range=True)
    assert found == pytest.approx(0.1)


@pytest.mark.parametrize("name", ["relative", "ratio", "max_relative", "l2_relative"])
def test_nothing_is_relative_to_zero(name: str) -> None:
    zeros = Pair(np.ones(1), np.zeros(1), None)
    if name == "l2_relative":
        zeros = Pair(np.ones(3), np.zeros(3), np.arange(3.0))
    with pytest.raises(CaseError, match="nothing to compare with"):
        measure(name, zeros, by_range=False)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("name", ["absolute", "max_relative", "monotonic", "range"])
def test_no_metric_takes_a_nan(name: str, bad: float) -> None:
    for spoilt in (pair([1.0, 2.0, bad], [1.0, 2.0, 3.0]), pair([1.0, 2.0, 3.0], [1.0, 2.0, bad])):
        with pytest.raises(CaseError, match="NaN"):
            measure(name, spoilt, by_range=False)


def test_order_of_a_power_law() -> None:
    fit = observed_order([0.1, 0.4, 0.2], [3.0 * h**1.5 for h in (0.1, 0.4, 0.2)], signal=1.0)
    assert fit.overall == pytest.approx(1.5)
    assert fit.between == pytest.approx((1.5, 1.5))


@pytest.mark.parametrize("errors", [[1.0, math.nan], [1.0, 0.0], [1.0, 1.0e-14]])
def test_no_order_without_errors_to_fit(errors: list[float]) -> None:
    with pytest.raises(CaseError):
        observed_order([0.2, 0.1], errors, signal=1.0)


def point(cpu_s: float, error: float) -> Point:
    return Point(f"{cpu_s}", "method", cpu_s, error, False)


def test_front_and_advice_take_what_nothing_beats() -> None:
    cheap, slow, beaten, exact = point(1, 0.03), point(3, 0.02), point(2, 0.04), point(9, 0.005)
    points = [exact, beaten, slow, cheap]
    assert pareto_front(points) == [cheap, slow, exact]
    assert [advice.point for advice in advise(points)] == [cheap, exact, None]


def test_expressions_compute_and_nothing_else() -> None:
    values: dict[str, Array | float] = {"a": np.array([1.0, 4.0]), "b": 2.0}
    assert evaluate("-sqrt(a)**b + 3*b/4 - 1e0", values) == pytest.approx([-0.5, -3.5])
    assert evaluate("hypot(3, 4) + sin(pi/2) + erfc(0)", {}) == pytest.approx(7.0)
    assert names_in("sqrt(a) + b") == {"sqrt", "a", "b"}
    for text in (
        "c",
        "__import__('os')",
        "a.real",
        "a[0]",
        "a if b else 1",
        "sqrt(1, 2, 3)",
        "1 +",
        "sqrt(1, 2)",
        "1\0",
        "9" * 400,
        "9" * 5000,
        "(" * 5000 + "1" + ")" * 5000,
        "1" + "+1" * 5000,
    ):
        with pytest.raises(CaseError):
            evaluate(text, values)
