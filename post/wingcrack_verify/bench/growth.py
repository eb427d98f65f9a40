"""How cost grows with size."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from wingcrack_verify.bench.catalogue import Growth
from wingcrack_verify.bench.measure import Measurement


@dataclass(frozen=True)
class Exponent:
    """How CPU time grows over measurements of one kind.

    Attributes
    ----------
    of : str
        What is counted.
    sizes : tuple of int
    cpu_s : tuple of float
        Median CPU time [s] of each size.
    fitted : float
        Slope of its logarithm over that of the size, by least squares.
    fourfold : tuple of float
        CPU(4n)/CPU(n) from each size to the next one, at the slope between the two.
    """

    of: str
    sizes: tuple[int, ...]
    cpu_s: tuple[float, ...]
    fitted: float
    fourfold: tuple[float, ...]


def exponents(kinds: Sequence[Growth], measured: Mapping[str, Measurement]) -> tuple[Exponent, ...]:
    """Fit each kind of which at least two sizes were measured."""
    found = []
    for kind in kinds:
        mine = [measured[name] for name in kind.names if name in measured]
        sizes = tuple(m.typical.sizes[kind.of] for m in mine)
        if len(set(sizes)) >= 2:
            found.append(fit(kind.of, sizes, tuple(m.median_s for m in mine)))
    return tuple(found)


def fit(of: str, sizes: tuple[int, ...], cpu_s: tuple[float, ...]) -> Exponent:
    """Fit a power of the size to CPU times."""
    x, y = [math.log(n) for n in sizes], [math.log(seconds) for seconds in cpu_s]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True)) / sum(
        (a - mean_x) ** 2 for a in x
    )
    between = [
        4.0 ** ((y[k + 1] - y[k]) / (x[k + 1] - x[k])) for k in range(len(x) - 1) if x[k + 1] > x[k]
    ]
    return Exponent(of, sizes, cpu_s, slope, tuple(between))
