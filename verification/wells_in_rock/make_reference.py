"""Pressure of a well in a square whose sides have the pressure 0, by images: prints it.

    .venv/bin/python verification/wells_in_rock/make_reference.py

Sinks and sources at (+-x + 2 i, +-y + 2 j), with the sign of each mirror; rows are summed in closed
form, ln|sin|, so that the sum over the other direction converges like exp(-pi k).
"""

from __future__ import annotations

import cmath
import math

UNIT = 1.0e-7 * 1.0e-3 / (2 * math.pi * 1.0e-15)  # Q mu/(2 pi K) [Pa]
HALF = 1.0  # half-side [m]


def log_sine(z: complex) -> float:
    """Logarithm of |sin(pi z/(4 HALF))|, without overflow."""
    w = math.pi * z / (4 * HALF)
    if abs(w.imag) > 20.0:
        return abs(w.imag) - math.log(2.0)
    return math.log(abs(cmath.sin(w)))


def pressure(x: float, y: float, radius: float) -> float:
    """Pressure at the wall of a well at (x, y) [Pa]."""
    total = 0.0
    for j in range(-8, 9):
        for mirror_y in (1, -1):
            above = mirror_y * y + 2 * HALF * (2 * j + (0 if mirror_y == 1 else 1)) - y
            for mirror_x in (1, -1):
                aside = mirror_x * x + (0 if mirror_x == 1 else 2 * HALF) - x
                sign = mirror_x * mirror_y
                if abs(aside) + abs(above) < 1e-12:
                    total -= sign * math.log(math.pi * radius / (4 * HALF))
                else:
                    total -= sign * log_sine(complex(aside, above))
    return UNIT * total


if __name__ == "__main__":
    print("in the middle", pressure(0.0, 0.0, 0.004), UNIT * math.log(1.0787052 / 0.004))
    print("at (0.3, 0.2)", pressure(0.3, 0.2, 0.004))
    print("at (-0.55, 0.7)", pressure(-0.55, 0.7, 0.004))
