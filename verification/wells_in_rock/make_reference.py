"""Pressure of a well in a square whose sides have the pressure 0, by images: prints it.

    .venv/bin/python verification/wells_in_rock/make_reference.py

Sinks and sources at (+-x + 2 i, +-y + 2 j), with the sign of each mirror; rows are summed in closed
form, ln|sin|, so that the sum over the other direction converges like exp(-pi k). And the rise of a
well in a narrow fracture (narrow.nml), by Stehfest's inversion of its integral over wave numbers.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from functools import partial

from scipy.integrate import quad

UNIT = 1.0e-7 * 1.0e-3 / (2 * math.pi * 1.0e-15)  # Q mu/(2 pi K) [Pa]
HALF = 1.0  # half-side [m]


def log_sine(z: complex) -> float:
    """Logarithm of |sin(pi z/(4 HALF))|, without overflow."""
    w = math.pi * z / (4 * HALF)
    if abs(w.imag) > 20.0:
        return abs(w.imag) - math.log(2.0)
    return math.log(abs(cmath.sin(w)))


def pressure(x: float, y: float, radius: float, well: tuple[float, float] | None = None) -> float:
    """Pressure at (x, y) by a well there, at its wall, or elsewhere [Pa]."""
    x_well, y_well = well or (x, y)
    total = 0.0
    for j in range(-8, 9):
        for mirror_y in (1, -1):
            above = mirror_y * y_well + 2 * HALF * (2 * j + (0 if mirror_y == 1 else 1)) - y
            for mirror_x in (1, -1):
                aside = mirror_x * x_well + (0 if mirror_x == 1 else 2 * HALF) - x
                sign = mirror_x * mirror_y
                if abs(aside) + abs(above) < 1e-12:
                    total -= sign * math.log(math.pi * radius / (4 * HALF))
                else:
                    total -= sign * log_sine(complex(aside, above))
    return UNIT * total


def next_to_rock(distance: float, ratio: float) -> float:
    """Pressure of a well in rock of `ratio` times the permeability beyond the line x = 0 [Pa].

    The pressure by the well plus (ratio - 1)/(ratio + 1) times that by a well mirrored there, over
    ratio: both fulfil the conditions at the sides, and together those at the line.
    """
    own = pressure(-distance, 0.0, 0.004)
    mirrored = pressure(-distance, 0.0, 0.004, (distance, 0.0))
    return (own + (ratio - 1.0) / (ratio + 1.0) * mirrored) / ratio


def in_line(s: float) -> float:
    """Laplace transform of the rise of a well in a narrow fracture [Pa s]."""
    young, poisson, biot, aperture, compressibility = 16e9, 0.2, 0.7, 5e-6, 4.4e-10
    mobility = 4.5e-16 / 5e-4
    storage = 0.02 * compressibility + (biot - 0.02) * 3 * (1 - 2 * poisson) / young
    storage += biot**2 * (1 + poisson) * (1 - 2 * poisson) / (young * (1 - poisson))
    conductance = aperture**3 / (12 * 5e-4)

    def density(x: float) -> float:
        k = math.exp(x)
        taken = 2 * mobility * math.sqrt(k**2 + s * storage / mobility)
        return k / (conductance * k**2 + taken + s * aperture * compressibility)

    return 1e-6 / math.pi / s * float(quad(density, -40.0, 30.0, limit=1000)[0])


def stretched(ratio: float) -> float:
    """Pressure in the middle of rock of `ratio` times the permeability along x [Pa].

    Stretched, the square is a rectangle: images in its long direction, a strip in the other.
    The wall is an ellipse with one pressure, like a circle of the mean of its half-axes.
    """
    a = ratio**-0.25
    total = math.log(4 * a * HALF / math.pi) - math.log(0.004 * (a + 1 / a) / 2)
    for n in range(1, 20):
        total -= 2 * (-1) ** n * math.log(math.tanh(math.pi * n / (2 * a**2)))
    return UNIT * total / math.sqrt(ratio)


def into_line(s: float, aperture: float) -> float:
    """Laplace transform of what enters a narrow fracture at a side with 1 MPa more [m2 s].

    The rock has its front, exp(-x sqrt(s/c)); the line differs from it by sines.
    """
    young, poisson, biot, viscosity = 16e9, 0.2, 0.7, 5e-4
    mobility = 4.5e-16 / viscosity
    storage = 0.02 * 4.4e-10 + (biot - 0.02) * 3 * (1 - 2 * poisson) / young
    storage += biot**2 * (1 + poisson) * (1 - 2 * poisson) / (young * (1 - poisson))
    conductance = aperture**3 / (12 * viscosity)
    front = s * storage / mobility

    def density(x: float) -> float:
        k = math.exp(x)
        taken = 2 * mobility * math.sqrt(k**2 + front)
        return k * front / (k**2 + front) * taken / (conductance * k**2 + taken)

    total = float(quad(density, -40.0, 30.0, limit=1000)[0])
    return 1e6 * 2 / math.pi * conductance * total / s**2


def at_time(transform: Callable[[float], float], t: float, n: int = 7) -> float:
    """Inverse of a Laplace transform by Stehfest's sum."""
    total = 0.0
    for i in range(1, 2 * n + 1):
        weight = sum(
            j ** (n + 1)
            * math.comb(n, j)
            * math.comb(2 * j, j)
            * math.comb(j, i - j)
            / math.factorial(n)
            for j in range((i + 1) // 2, min(i, n) + 1)
        )
        total += (-1) ** (i + n) * weight * transform(i * math.log(2.0) / t)
    return total * math.log(2.0) / t


if __name__ == "__main__":
    print("in the middle", pressure(0.0, 0.0, 0.004), UNIT * math.log(1.0787052 / 0.004))
    print("at (0.3, 0.2)", pressure(0.3, 0.2, 0.004))
    print("at (-0.55, 0.7)", pressure(-0.55, 0.7, 0.004))
    print("in a disc", UNIT * (math.log(0.1 / 0.004) / 0.1 + math.log(1.0787052 / 0.1)))
    print("next to other rock", next_to_rock(0.05, 0.1))
    print("narrow fracture, 100 and 1000 s", *(at_time(in_line, t) for t in (100.0, 1000.0)))
    for a in (5e-6, 2e-5):
        until, late = (at_time(partial(into_line, aperture=a), t) for t in (1000.0, 100.0))
        print("from a side, 1000 s, the last 100 s, the others", a, until, late, until - late)
    print("in anisotropic rock, 10 times", stretched(10.0))
