"""Values drawn at random: from distributions with bounds, evenly (Latin hypercube) or freely."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from wingcrack.errors import CaseError
from wingcrack.sweeps.expressions import Array
from wingcrack.sweeps.fields import Entry, Numbers, Table, Values, choice, read_entry, whole

KINDS = ("uniform", "log_uniform", "normal", "lognormal", "integers", "of")
METHODS = ("latin_hypercube", "random")
SAMPLE = "sample"  # the parameter that numbers the draws, from 1


class _Draw(Entry):
    """``[draw]`` of a study."""

    count: Annotated[int, whole(1)]
    seed: Annotated[int, whole(0)]
    method: Annotated[str, choice(METHODS)] = METHODS[0]
    parameters: Annotated[Table, Field(min_length=1)]  # a distribution for each name


class _Distribution(Entry):
    """One distribution, perhaps cut off at bounds."""

    uniform: Numbers | None = None
    log_uniform: Numbers | None = None
    normal: Numbers | None = None
    lognormal: Numbers | None = None
    integers: Numbers | None = None
    of: Values | None = None
    min: float = -math.inf
    max: float = math.inf


def read_draws(data: Any, place: str, most: int, count: int | None = None) -> Table:
    """Lists of equal length, one per drawn parameter, and the numbers of the samples.

    There may be at most `most` samples; `count` replaces that of the table. Raises `CaseError` if
    there are too many, or a distribution is unknown, impossible, or has no probability within its
    bounds.
    """
    draw = read_entry(_Draw, data, place)
    count = draw.count if count is None else count
    if count > most:
        raise CaseError(f"{place}: {count} runs are more than {most}")
    shares = _shares(count, len(draw.parameters), draw.seed, draw.method)
    points: Table = {SAMPLE: list(range(1, count + 1))}
    for (name, entry), column in zip(draw.parameters.items(), shares.T, strict=True):
        if name == SAMPLE:
            raise CaseError(f"{place}: '{SAMPLE}' numbers the draws; give the parameter a name")
        points[name] = _values(entry, column, f"{place}: parameters.{name}")
    return points


def _shares(count: int, dimension: int, seed: int, method: str) -> Array:
    """(count, dimension) numbers between 0 and 1."""
    generator = np.random.default_rng(seed)
    if method == "random":
        return generator.random((count, dimension))
    (generator,) = generator.spawn(1)  # as scipy.stats.qmc does, which takes a second to import
    within = generator.random((count, dimension))
    strata = np.tile(np.arange(1, count + 1), (dimension, 1))
    for of_parameter in strata:
        generator.shuffle(of_parameter)
    return (strata.T - within) / count


def _values(data: Any, shares: Array, place: str) -> list[Any]:
    """Values of a distribution at shares of its probability, within its bounds."""
    if not isinstance(data, Mapping):
        raise CaseError(f"{place} must be a table with one of: {', '.join(KINDS)}")
    kinds = [kind for kind in KINDS if kind in data]
    if len(kinds) != 1:
        raise CaseError(f"{place} must have exactly one of: {', '.join(KINDS)}")
    law, kind = read_entry(_Distribution, data, place), kinds[0]
    if law.of is not None:
        return [law.of[min(int(share * len(law.of)), len(law.of) - 1)] for share in shares]
    numbers = getattr(law, kind)
    if len(numbers) != 2:
        raise CaseError(f"{place}: '{kind}' takes two numbers")
    first, second = numbers
    if not law.min < law.max:
        raise CaseError(f"{place}: 'min' must be less than 'max'")
    _refuse_impossible(kind, first, second, place)
    if kind == "integers":
        return _integers(first, second, law.min, law.max, shares, place)
    return _within(kind, first, second, (law.min, law.max), shares, place)


def _refuse_impossible(kind: str, first: float, second: float, place: str) -> None:
    if kind in ("uniform", "log_uniform", "integers") and not first < second:
        raise CaseError(f"{place}: '{kind}' takes the lower number first")
    if kind in ("log_uniform", "lognormal") and not first > 0.0:
        raise CaseError(f"{place}: '{kind}' needs numbers above 0")
    if kind == "normal" and not second > 0.0:
        raise CaseError(f"{place}: the standard deviation must be above 0")
    if kind == "lognormal" and not second > 1.0:
        raise CaseError(
            f"{place}: 'lognormal' takes the median and the factor of one standard deviation, "
            "which must be above 1"
        )


def _integers(
    first: float, second: float, lower: float, upper: float, shares: Array, place: str
) -> list[Any]:
    if first != int(first) or second != int(second):
        raise CaseError(f"{place}: 'integers' takes two whole numbers")
    least, most = max(int(first), math.ceil(max(lower, first))), int(min(second, upper))
    if least > most:
        raise CaseError(f"{place}: no whole number lies within 'min' and 'max'")
    return [min(least + int(share * (most - least + 1)), most) for share in shares]


def _within(
    kind: str, first: float, second: float, bounds: tuple[float, float], shares: Array, place: str
) -> list[Any]:
    """Quantiles of the distribution cut off at the bounds (no heap of values at them)."""
    from scipy.special import ndtr, ndtri  # scipy.stats takes a second to import

    ends = np.array(bounds)
    if kind in ("log_uniform", "lognormal"):
        with np.errstate(divide="ignore"):
            ends = np.log(np.maximum(ends, 0.0))
    if kind == "log_uniform":
        first, second = math.log(first), math.log(second)
    if kind in ("uniform", "log_uniform"):
        below, above = np.clip((ends - first) / (second - first), 0.0, 1.0)
    elif kind == "normal":
        below, above = ndtr((ends - first) / second)
    else:
        below, above = ndtr((ends - math.log(first)) / math.log(second))
    if not above - below > 1.0e-9:
        raise CaseError(f"{place}: the distribution has nothing between 'min' and 'max'")
    inside = np.clip(shares, 1.0e-12, 1.0 - 1.0e-12)  # the ends of a normal law are infinite
    shares = below + inside * (above - below)
    if kind in ("uniform", "log_uniform"):
        values = first + shares * (second - first)
    elif kind == "normal":
        values = first + second * ndtri(shares)
    else:
        values = first * np.exp(math.log(second) * ndtri(shares))
    if kind == "log_uniform":
        values = np.exp(values)
    return [float(value) for value in np.clip(values, *bounds)]
