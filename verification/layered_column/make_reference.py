"""Consolidation of a column of two layers: eigenfunctions of both, independent of the solver.

`python make_reference.py` writes reference.csv, which check.toml compares with. With the fixed
total stress -s, p obeys C dp/dt = d/dz (m dp/dz) in either layer, C = S + alpha^2/(lambda + 2 G),
m = k/mu, from p0 = alpha s/((lambda + 2 G) C), which differs between the layers; p and m dp/dz are
continuous, p = 0 at the drained top z = 0, dp/dz = 0 at the sealed bottom.
"""

import csv
import math
from collections.abc import Callable
from pathlib import Path

VISCOSITY = 1.0e-4  # [Pa s]
COMPRESSIBILITY = 4.0e-10  # [1/Pa]
LOAD = 10.0e6  # s [Pa]
TOP = {"young": 40.0e9, "poisson": 0.2, "biot": 0.8, "porosity": 0.01, "k": 5.0e-20, "h": 0.4}
BOTTOM = {"young": 8.0e9, "poisson": 0.35, "biot": 0.95, "porosity": 0.1, "k": 4.0e-19, "h": 0.6}
END = 50000.0  # [s]
STEP = 1250.0  # of the runs that vary the cells [s]


Mode = tuple[float, float, float, float, float]


def layer(rock: dict[str, float]) -> tuple[float, float, float, float, float]:
    """Return m [m2/(Pa s)], C [1/Pa], undrained p0 [Pa], height [m], lambda + 2 G [Pa]."""
    e, nu, alpha = rock["young"], rock["poisson"], rock["biot"]
    stiff = e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    bulk = e / (3.0 * (1.0 - 2.0 * nu))
    storage = rock["porosity"] * COMPRESSIBILITY + (alpha - rock["porosity"]) / bulk
    capacity = storage + alpha**2 / stiff
    return rock["k"] / VISCOSITY, capacity, alpha * LOAD / (stiff * capacity), rock["h"], stiff


M1, C1, P1, H1, S1 = layer(TOP)
M2, C2, P2, H2, S2 = layer(BOTTOM)


def shapes(rate: float) -> tuple[float, float]:
    """Wave numbers of both layers for decay with a rate [1/s]."""
    return math.sqrt(rate * C1 / M1), math.sqrt(rate * C2 / M2)


def condition(rate: float) -> float:
    """Zero at an eigenvalue: sin(a z) above meets B cos(b (H - z)) below with the same flux."""
    a, b = shapes(rate)
    return M1 * a * math.cos(a * H1) * math.cos(b * H2) - M2 * b * math.sin(a * H1) * math.sin(
        b * H2
    )


def eigenvalues(count: int) -> list[float]:
    """The first rates, each found by bisection between changes of sign on a fine grid of roots."""
    found: list[float] = []
    step = 0.01 * math.pi / (H1 * math.sqrt(C1 / M1) + H2 * math.sqrt(C2 / M2))
    low = 1e-6 * step
    while len(found) < count:
        high = low + step
        if condition(low**2) * condition(high**2) < 0.0:
            a, b = low, high
            for _ in range(200):
                middle = 0.5 * (a + b)
                if condition(a**2) * condition(middle**2) <= 0.0:
                    b = middle
                else:
                    a = middle
            found.append((0.5 * (a + b)) ** 2)
        low = high
    return found


def terms(count: int) -> list[Mode]:
    """Rate, wave numbers, factor below, and what the initial state has of each eigenfunction."""
    result = []
    for rate in eigenvalues(count):
        a, b = shapes(rate)
        if abs(math.cos(b * H2)) > 1e-3:
            below = math.sin(a * H1) / math.cos(b * H2)
        else:
            below = M1 * a * math.cos(a * H1) / (M2 * b * math.sin(b * H2))
        norm = C1 * (H1 / 2 - math.sin(2 * a * H1) / (4 * a))
        norm += C2 * below**2 * (H2 / 2 + math.sin(2 * b * H2) / (4 * b))
        start = C1 * P1 * (1 - math.cos(a * H1)) / a + C2 * P2 * below * math.sin(b * H2) / b
        result.append((rate, a, b, below, start / norm))
    return result


def pressure(z: float, factor: Callable[[float], float], modes: list[Mode]) -> float:
    """Return p [Pa] at the depth z [m]; factor(rate) is what time leaves of a mode."""
    total = 0.0
    for rate, a, b, below, share in modes:
        shape = math.sin(a * z) if z < H1 else below * math.cos(b * (H1 + H2 - z))
        total += share * shape * factor(rate)
    return total


def settlement(factor: Callable[[float], float], modes: list[Mode]) -> float:
    """Of the top, downwards [m]: the integral of (s - alpha p)/(lambda + 2 G)."""
    total = LOAD * (H1 / S1 + H2 / S2)
    for rate, a, b, below, share in modes:
        first = TOP["biot"] / S1 * (1 - math.cos(a * H1)) / a
        second = BOTTOM["biot"] / S2 * below * math.sin(b * H2) / b
        total -= share * factor(rate) * (first + second)
    return total


def main() -> None:
    """Write the table."""
    modes = terms(400)

    def exact(rate: float) -> float:
        return math.exp(-rate * END)

    def stepped(rate: float) -> float:
        return (1.0 + rate * STEP) ** -round(END / STEP)

    with (Path(__file__).parent / "reference.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["depth_m", "series_pa", "series_backward_euler_pa"])
        for k in range(1, 11):
            z = 0.1 * k if k != 4 else 0.4
            table.writerow(
                [f"{z:.1f}"] + [f"{pressure(z, f, modes):.9e}" for f in (exact, stepped)]
            )
    print(
        "undrained pressures",
        P1,
        P2,
        "settlement",
        settlement(exact, modes),
        settlement(stepped, modes),
    )
    print("at rest", settlement(lambda _: 0.0, modes), "at once", settlement(lambda _: 1.0, modes))


if __name__ == "__main__":
    main()
