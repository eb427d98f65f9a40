"""A disc and a column whose sides are loaded in the course of time: Laplace transforms of both.

`python make_reference.py` writes disc.csv, springs.csv and inflow.csv, which check.toml compares
with. The transforms are turned back by Stehfest's sum, which has nothing in common with the solver;
loads that are straight between times are sums of ramps.

Disc (de Leeuw 1965; plane strain, drained rim): with M = lambda + 2 G and axial symmetry the
equilibrium gives M eps = alpha p + C(t), so S' dp/dt + alpha/M dC/dt = (k/mu) lap p with
S' = S + alpha^2/M, and the radial stress is C - 2 G u/r. Column (uniaxial strain): the same with
C the axial stress, and u the settlement of the top.
"""

import csv
import math
from collections.abc import Callable
from pathlib import Path

YOUNG, POISSON, BIOT, POROSITY = 1.0e10, 0.25, 0.8, 0.1
PERMEABILITY, VISCOSITY, COMPRESSIBILITY = 1.0e-15, 1.0e-3, 4.0e-10
SHEAR = YOUNG / (2.0 * (1.0 + POISSON))
LAME = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
M = LAME + 2.0 * SHEAR
BULK = YOUNG / (3.0 * (1.0 - 2.0 * POISSON))
STORAGE = POROSITY * COMPRESSIBILITY + (BIOT - POROSITY) / BULK + BIOT**2 / M
MOBILITY = PERMEABILITY / VISCOSITY
RADIUS = 1.0
SPRING = 1.0e10  # [Pa/m]
HEIGHT = 1.0

Transform = Callable[[float], float]


def stehfest(transform: Transform, time: float, n: int = 14) -> float:
    """Return the function of time whose Laplace transform is given."""
    total = 0.0
    for i in range(1, n + 1):
        weight = 0.0
        for k in range((i + 1) // 2, min(i, n // 2) + 1):
            weight += (
                k ** (n // 2)
                * math.factorial(2 * k)
                / (
                    math.factorial(n // 2 - k)
                    * math.factorial(k)
                    * math.factorial(k - 1)
                    * math.factorial(i - k)
                    * math.factorial(2 * k - i)
                )
            )
        s = i * math.log(2.0) / time
        total += (-1) ** (i + n // 2) * weight * transform(s)
    return total * math.log(2.0) / time


def bessel(order: int, z: float) -> float:
    """Return I_0 or I_1 of a positive number, times exp(-z), by its power series."""
    term = math.exp(-z) * (0.5 * z) ** order
    total = 0.0
    k = 0
    while term > 1e-18 * total or k < 2:
        total += term
        k += 1
        term *= 0.25 * z * z / (k * (k + order))
        if k > 100000:
            break
    return total


def disc(s: float, r: float, spring: float) -> float:
    """Pressure at a radius per unit pressure 1/1 on the rim (transform of the load: 1) [-]."""
    wave = math.sqrt(s * STORAGE / MOBILITY)
    ratio = bessel(0, wave * r) / bessel(0, wave * RADIUS) * math.exp(wave * (r - RADIUS))
    mean = 2.0 * bessel(1, wave * RADIUS) / (bessel(0, wave * RADIUS) * wave * RADIUS)
    b = BIOT / (M * STORAGE)
    # p = b C (ratio - 1); u/R at the rim = alpha/(2 M) mean p + C/(2 M)
    strain = (BIOT * b * (mean - 1.0) + 1.0) / (2.0 * M)
    constant = -1.0 / (1.0 - (2.0 * SHEAR - spring * RADIUS) * strain)
    return b * constant * (ratio - 1.0)


def column(s: float, z: float) -> float:
    """Pressure at a height per unit inflow through the top, which stands on springs [Pa s/m]."""
    wave = math.sqrt(s * STORAGE / MOBILITY)
    shape = math.cosh(wave * z) / (MOBILITY * wave * math.sinh(wave * HEIGHT))
    mean = 1.0 / (MOBILITY * wave**2 * HEIGHT)
    b = BIOT / (M * STORAGE)
    # p = shape - b C; C = -k u, u = H (alpha mean p + C)/M
    give = SPRING * HEIGHT / M
    constant = -give * BIOT * mean / (1.0 + give * (1.0 - BIOT * b))
    return shape - b * constant


def in_time(response: Transform, times: list[float], values: list[float], time: float) -> float:
    """Response to a load that is straight between times and jumps where two are equal."""
    total = 0.0
    slope = 0.0
    for k in range(len(times)):
        if time <= times[k]:
            break
        since = time - times[k]
        if k > 0 and times[k] == times[k - 1]:
            jump = values[k] - values[k - 1]
            total += jump * stehfest(lambda s: response(s) / s, since)
        further = 0.0
        if k + 1 < len(times) and times[k + 1] > times[k]:
            further = (values[k + 1] - values[k]) / (times[k + 1] - times[k])
        change = further - slope
        slope = further
        if change != 0.0:
            total += change * stehfest(lambda s: response(s) / s**2, since)
    return total


# Times [s] and values of the loads: pressure on the rim [Pa], inflow [m/s].
LOAD = ([0.0, 20.0, 100.0, 100.0, 200.0], [0.0, 1.0e7, 1.0e7, 5.0e6, 5.0e6])
INFLOW = ([0.0, 50.0, 150.0, 150.0, 300.0], [0.0, 1.0e-6, 1.0e-6, -5.0e-7, -5.0e-7])


def write(
    name: str, columns: dict[str, Transform], course: tuple[list[float], list[float]]
) -> None:
    """Write pressures over time."""
    with (Path(__file__).parent / name).open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time_s", *columns])
        for k in range(1, 2 * int(course[0][-1]) + 1):
            time = 0.5 * k
            values = [in_time(f, *course, time) for f in columns.values()]
            table.writerow([f"{time:g}"] + [f"{v:.7e}" for v in values])


def at_radius(r: float, spring: float) -> Transform:
    """Return the transform of the disc's pressure at a radius."""
    return lambda s: disc(s, r, spring)


def at_height(z: float) -> Transform:
    """Return the transform of the column's pressure at a height."""
    return lambda s: column(s, z)


def main() -> None:
    """Write the tables."""
    for name, spring in (("disc.csv", 0.0), ("springs.csv", SPRING)):
        places = {"centre_pa": at_radius(0.0, spring), "half_pa": at_radius(0.5, spring)}
        write(name, places, LOAD)
    write("inflow.csv", {"bottom_pa": at_height(0.0), "middle_pa": at_height(0.5)}, INFLOW)


if __name__ == "__main__":
    main()
