"""The fixed set of error measures, and the rule that no tolerance is as large as its signal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wingcrack.errors import CaseError
from wingcrack.sweeps.expressions import Array
from wingcrack.sweeps.paths import path_distance

TENTH = 0.1  # a tolerance is at most this share of the signal


@dataclass(frozen=True)
class Pair:
    """Result and reference at the same points."""

    # result, reference: (n,) in the unit of the check
    result: Array
    reference: Array
    x: Array | None  # (n,) abscissa, increasing; of a path in the order of its points
    # (m,) abscissa of a reference with points of its own (m of them), for paths only
    reference_x: Array | None = None


@dataclass(frozen=True)
class Metric:
    """A measure of error."""

    # error of a pair; the second argument says whether to divide by the range
    error: Callable[[Pair, bool], float]
    # whether the error has the unit of the quantity; otherwise it is relative
    has_unit: bool = False
    one_value: bool = False  # whether it is for a single value only
    can_normalise: bool = False  # whether `normalise = "range"` makes sense
    # whether result and reference are curves, each with its own points (x, y)
    is_path: bool = False


def _absolute(pair: Pair, _by_range: bool) -> float:
    return float(np.max(np.abs(pair.result - pair.reference)))


def _relative(pair: Pair, _by_range: bool) -> float:
    return float(abs(pair.result[0] - pair.reference[0]) / _nonzero(abs(pair.reference[0])))


def _ratio(pair: Pair, _by_range: bool) -> float:
    result, reference = float(pair.result[0]), float(pair.reference[0])
    _nonzero(abs(reference))
    if not result * reference > 0.0:
        return float("inf")
    return max(result / reference, reference / result) - 1.0


def _max_relative(pair: Pair, by_range: bool) -> float:
    size = np.ptp(pair.reference) if by_range else np.max(np.abs(pair.reference))
    return _absolute(pair, by_range) / _nonzero(float(size))


def _l2_relative(pair: Pair, by_range: bool) -> float:
    if pair.x is None or pair.x.size < 2:
        raise CaseError("the metric l2_relative needs a profile with x")
    reference = pair.reference
    if by_range:
        mean = np.trapezoid(reference, pair.x) / (pair.x[-1] - pair.x[0])
        reference = reference - mean
    size = np.trapezoid(reference**2, pair.x)
    error = np.trapezoid((pair.result - pair.reference) ** 2, pair.x)
    return float(np.sqrt(error / _nonzero(float(size))))


def _wrong_way(pair: Pair, _by_range: bool) -> float:
    """Largest step down over the range; a falling profile comes with its sign changed."""
    if pair.result.size < 3 or pair.x is None:
        raise CaseError("the metric monotonic needs a profile with x and at least 3 values")
    total = _nonzero(float(np.ptp(pair.result)))
    if pair.result[-1] < pair.result[0]:
        return float("inf")
    return float(max(0.0, np.max(-np.diff(pair.result))) / total)


def _apart(pair: Pair, _by_range: bool) -> float:
    if pair.x is None or pair.reference_x is None:
        raise CaseError("the metric path needs x, and a reference with x")
    return path_distance(
        np.column_stack((pair.x, pair.result)), np.column_stack((pair.reference_x, pair.reference))
    )


def _shortfall(pair: Pair, _by_range: bool) -> float:
    missing = float(pair.reference[0] - pair.result[0])
    return max(0.0, missing) / _nonzero(abs(float(pair.reference[0])))


def _excess(pair: Pair, _by_range: bool) -> float:
    above = float(pair.result[0] - pair.reference[0])
    return max(0.0, above) / _nonzero(abs(float(pair.reference[0])))


METRICS: dict[str, Metric] = {
    "absolute": Metric(_absolute, has_unit=True),
    "relative": Metric(_relative, one_value=True),
    "ratio": Metric(_ratio, one_value=True),
    "max_relative": Metric(_max_relative, can_normalise=True),
    "l2_relative": Metric(_l2_relative, can_normalise=True),
    "range": Metric(_absolute, has_unit=True),
    "monotonic": Metric(_wrong_way),
    "at_least": Metric(_shortfall, one_value=True),
    "at_most": Metric(_excess, one_value=True),
    "path": Metric(_apart, has_unit=True, is_path=True),
}


def measure(name: str, pair: Pair, by_range: bool) -> float:
    """Error of a pair in the named metric.

    Raises `CaseError` if result or reference hold a NaN or an infinity, or if there is nothing to
    compare with.
    """
    metric = METRICS[name]
    for what, values in (("result", pair.result), ("reference", pair.reference)):
        if values.size == 0:
            raise CaseError(f"the {what} holds no value")
        if not np.all(np.isfinite(values)):
            raise CaseError(f"the {what} holds a NaN or an infinity")
    if metric.one_value and pair.result.size != 1:
        raise CaseError(f"the metric {name} takes one value, and there are {pair.result.size}")
    return metric.error(pair, by_range)


def signal(name: str, pair: Pair, scale: float | None) -> float:
    """Size of what is measured, which a tolerance is compared with; 1 for relative metrics.

    Raises `CaseError` if the reference is 0 and no scale is given, or if one is given where it is
    not 0. Paths need a scale: the length with which their distance is compared.
    """
    if not METRICS[name].has_unit:
        if scale is not None:
            raise CaseError(f"'scale' is for the metric absolute and a reference of 0, not {name}")
        return 1.0
    if METRICS[name].is_path:
        if scale is None:
            raise CaseError(
                "'scale' must be the length with which the distance of the paths is compared"
            )
        return scale
    size = float(np.max(np.abs(pair.reference)))
    if size == 0.0:
        if scale is None:
            raise CaseError("the reference is 0: 'scale' must say what size the signal has")
        return scale
    if scale is not None:
        raise CaseError("'scale' is only for a reference of 0")
    return size


def check_tolerance(tolerance: float, size: float) -> None:
    """Refuse a tolerance above a tenth of the signal.

    Raises `CaseError` if it is.
    """
    if not tolerance <= TENTH * size * (1.0 + 1.0e-12):
        raise CaseError(
            f"the tolerance {tolerance:g} is more than a tenth of the signal ({size:g})"
        )


def _nonzero(size: float) -> float:
    if not size > 0.0:
        raise CaseError("nothing to compare with: magnitude or range is 0")
    return size
