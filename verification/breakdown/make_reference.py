"""A crack full of compressible fluid that jumps at its onset: writes reference.csv.

    .venv/bin/python verification/breakdown/make_reference.py

A crack of half-length a under a uniform pressure p in a large body has K_I = p sqrt(pi a) and holds
2 pi a^2 p/E' beside what its faces are apart without a load, here w 2 a_0. Its fluid V, with the
compressibility c, changes by dV + c V dp = Q dt.

Until p = K/sqrt(pi a_0) the length does not change. Then cracks at their toughness, with V(a) and
p(a) = K/sqrt(pi a), would need less fluid as they grow: the crack jumps, without time for the well,
to the next length at which the balance holds, and goes on from there.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

MODULUS = 30.0e9 / (1.0 - 0.25**2)  # E' [Pa]
TOUGHNESS = 1.0e6  # K [Pa m^1/2]
RATE = 1.0e-6  # Q [m2/s]
HALF = 0.126  # a_0 [m]
FACES = 1.0e-2  # w [m]
COMPRESSIBILITY = 1.0e-8  # c [1/Pa]
TIMES = (46.0, 48.0, 50.0, 52.0)  # [s]


def pressure(half: float) -> float:
    """Give p at the toughness [Pa]."""
    return TOUGHNESS / math.sqrt(math.pi * half)


def fluid(half: float) -> float:
    """Give V at the toughness [m2]."""
    return 2.0 * HALF * FACES + 2.0 * math.pi * half**2 * pressure(half) / MODULUS


def onset() -> float:
    """Give the time at which p = K/sqrt(pi a_0) [s]."""
    first = pressure(HALF)
    stored = 2.0 * HALF * FACES * COMPRESSIBILITY * first
    opened = 2.0 * math.pi * HALF**2 * first / MODULUS
    return (opened + stored + 0.5 * opened * COMPRESSIBILITY * first) / RATE


def surplus(half: float) -> float:
    """Give what the crack would hold beyond what it held at the onset [m2]."""
    before = fluid(HALF) * math.exp(COMPRESSIBILITY * pressure(HALF))
    return fluid(half) * math.exp(COMPRESSIBILITY * pressure(half)) - before


def length_after_jump() -> float:
    """Give the half-length at which the balance holds again [m]."""
    low, high = 1.2 * HALF, 10.0 * HALF
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if surplus(middle) < 0.0 else (low, middle)
    return low


def growth(times: tuple[float, ...]) -> list[tuple[float, float]]:
    """Give half-lengths and pressures [m, Pa] at times after the jump, by Heun's method."""

    def speed(half: float) -> float:
        step = 1.0e-6 * half
        opens = (fluid(half + step) - fluid(half - step)) / (2.0 * step)
        eases = (pressure(half + step) - pressure(half - step)) / (2.0 * step)
        return RATE / (opens + COMPRESSIBILITY * fluid(half) * eases)

    time, half, found = onset(), length_after_jump(), []
    for until in times:
        count = 2000
        step = (until - time) / count
        for _ in range(count):
            slope = speed(half)
            half += 0.5 * step * (slope + speed(half + step * slope))
        time = until
        found.append((half, pressure(half)))
    return found


def main() -> None:
    """Write the reference."""
    rows = [(onset(), HALF, pressure(HALF))]
    rows += [(time, *state) for time, state in zip(TIMES, growth(TIMES), strict=True)]
    path = Path(__file__).parent / "reference.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time_s", "half_length_m", "pressure_pa"])
        writer.writerows([f"{value:.6g}" for value in row] for row in rows)
    print(f"after the jump: {length_after_jump():.6g} m")


if __name__ == "__main__":
    main()
