"""Crack in poroelastic rock under a sudden load: boundary elements in Laplace's variable.

`python make_reference.py` writes reference.csv: K over p sqrt(pi a) at a time in rock at rest, of
    mode_1    a sudden traction p on the faces, whose fluid stays at the pressure 0,
    mode_2    a sudden fluid pressure p in the rock's pores at the faces, without traction,
    shear     a sudden shear traction p.
A sudden pressure of the fluid in the crack has p - sigma times the first, sigma the compression
that held it closed, and p - p_0 times the second, p_0 the pressure of the rock.

With the heat kernel K0(q r)/(2 pi c), q^2 = s/c, the jumps and sources of Detournay and Cheng (Int.
J. Solids Struct. 27 (1991)) that are constant on an element have closed forms on the line of the
crack. Elements grow by a constant ratio from the tips, whose smallest are 0.02 sqrt(c t). The
values are extrapolated (Romberg) from the ratios 1.2, 1.1, 1.05, 1.025 to 1, and inverted by
Stehfest's method with 8 terms. K is the jump near the tip over that in drained rock.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from itertools import pairwise
from math import factorial, log
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.special import iti0k0, k0, k1

Array = npt.NDArray[np.float64]

TERMS = 8
RATIOS = (1.2, 1.1, 1.05, 1.025)


@dataclass(frozen=True)
class Rock:
    """Constants that enter: E', its undrained excess B, A, k/mu and c."""

    modulus: float
    stiffening: float
    pressing: float
    mobility: float
    diffusivity: float

    @classmethod
    def of_scene(cls) -> Rock:
        """Take the rock of the scenes of this case."""
        young, poisson, biot, porosity = 4.0e10, 0.2, 0.8, 0.01
        mobility, compressibility = 5.0e-20 / 1.0e-4, 4.4e-10
        shear = young / (2.0 * (1.0 + poisson))
        bulk = young / (3.0 * (1.0 - 2.0 * poisson))
        oedometric = 2.0 * shear * (1.0 - poisson) / (1.0 - 2.0 * poisson)
        storage = porosity * compressibility + (biot - porosity) / bulk + biot**2 / oedometric
        pressing = 2.0 * shear * biot / (oedometric * storage)
        return cls(
            modulus=young / (1.0 - poisson**2),
            stiffening=pressing**2 * storage,
            pressing=pressing,
            mobility=mobility,
            diffusivity=mobility / storage,
        )


def undrained_parts(z: Array) -> tuple[Array, Array]:
    """Return 1 - z K1(z) and 1 - 4/z^2 + 2 K2(z), without loss of digits at small z."""
    logarithm = np.log(z / 2.0) + np.euler_gamma
    small = z < 1.0e-2
    safe = np.where(small, 1.0, z)
    first = np.where(small, -(z**2) / 2.0 * (logarithm - 0.5), 1.0 - safe * k1(safe))
    second = 1.0 - 4.0 / safe**2 + 2.0 * (k0(safe) + 2.0 * k1(safe) / safe)
    return first, np.where(small, -(z**2) / 4.0 * (logarithm - 0.75), second)


def elements(half_length: float, smallest: float, ratio: float) -> Array:
    """Ends of elements on half the crack, from its middle; the last one is the smallest."""
    sizes = [smallest]
    while sum(sizes) < half_length:
        sizes.append(min(sizes[-1] * ratio, (ratio - 1.0) * half_length, 0.05 * half_length))
    ends = np.concatenate([[0.0], np.cumsum(sizes[::-1])])
    return np.asarray(ends * (half_length / ends[-1]))


def effects(rock: Rock, ends: Array, s: float) -> dict[str, Array]:
    """Stress and pressure at the middles of unit jumps and sources on both halves of the crack."""
    q = np.sqrt(s / rock.diffusivity)
    middle = 0.5 * (ends[1:] + ends[:-1])[:, None]
    found = {name: np.zeros((ends.size - 1, ends.size - 1)) for name in "dopqr"}
    for start, end in ((ends[:-1], ends[1:]), (-ends[1:], -ends[:-1])):
        for sign, x in ((1.0, middle - start), (-1.0, middle - end)):
            z = q * np.abs(x)
            first, second = undrained_parts(z)
            e = sign / (2.0 * np.pi * x)
            found["o"] -= e * (0.5 * rock.modulus + rock.stiffening * (first - 0.5 * second))
            found["d"] -= e * 0.5 * (rock.modulus + rock.stiffening * second)
            found["p"] += e * rock.pressing * first
            found["r"] -= e * rock.pressing / s * first
            area = np.sign(x) * iti0k0(np.minimum(z, 500.0))[1] / q
            found["q"] += sign * area / (2.0 * np.pi * rock.mobility)
    return found


def intensities(rock: Rock, half_length: float, time: float, ratio: float) -> Array:
    """K over p sqrt(pi a) of the three loads."""
    smallest = 0.02 * np.sqrt(rock.diffusivity * time)
    ends = elements(half_length, min(smallest, 0.04 * (ratio - 1.0) * half_length), ratio)
    n = ends.size - 1
    at = n - 3
    drained = effects(Rock(rock.modulus, 0.0, 0.0, 1.0, 1.0), ends, 1.0)["o"]
    usual = np.linalg.solve(drained, -np.ones(n))
    result = np.zeros(3)
    for i in range(1, TERMS + 1):
        s = i * log(2.0) / time
        e = effects(rock, ends, s)
        scale = np.repeat([usual.max(), rock.mobility], n)
        load = np.zeros((2 * n, 2))
        load[:n, 0], load[n:, 1] = -1.0 / s, 1.0 / s
        matrix = np.block([[e["o"], e["r"]], [e["p"], e["q"]]]) * scale
        both = (np.linalg.solve(matrix, load) * scale[:, None])[at]
        slip = np.linalg.solve(e["d"], -np.ones(n) / s)[at]
        result += stehfest(i) * log(2.0) / time * np.array([*both, slip])
    return np.asarray(result / usual[at])


def stehfest(i: int) -> float:
    """Weight of the i-th term."""
    half = TERMS // 2
    total = sum(
        k**half
        * factorial(2 * k)
        / (
            factorial(half - k)
            * factorial(k)
            * factorial(k - 1)
            * factorial(i - k)
            * factorial(2 * k - i)
        )
        for k in range((i + 1) // 2, min(i, half) + 1)
    )
    return float((-1) ** (half + i) * total)


def extrapolated(rock: Rock, half_length: float, time: float) -> Array:
    """Romberg's extrapolation to elements of equal neighbours."""
    values = [intensities(rock, half_length, time, ratio) for ratio in RATIOS]
    for k in range(1, len(RATIOS)):
        values = [(2.0**k * b - a) / (2.0**k - 1.0) for a, b in pairwise(values)]
    return values[0]


def main() -> None:
    """Write the reference of this case."""
    with (Path(__file__).parent / "reference.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time_s", "mode_1", "mode_2", "shear"])
        for time in (1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0):
            values = extrapolated(Rock.of_scene(), 0.2, time)
            writer.writerow([time, *(f"{value:.5f}" for value in values)])


if __name__ == "__main__":
    main()
