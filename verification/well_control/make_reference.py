"""Wells at rates, pressures and limits: writes the references of this case and the schedule.

    .venv/bin/python verification/well_control/make_reference.py

A fracture through the whole body feeds rock on both of its sides, which is sealed at H: pressure
diffuses in y alone. The model here is finite volumes in y, graded to 0.1 mm at the fracture, with
steps of 10 ms by the trapezoidal rule (0.1 mm and 20 ms give the same within 1e-4). It knows
nothing of the solver. The well's flow is found in each step by bisection on its own conditions.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

HERE = Path(__file__).parent
FloatArray = npt.NDArray[np.float64]

# Rock
YOUNG, POISSON, BIOT, POROSITY = 40.0e9, 0.2, 0.8, 0.1
PERMEABILITY, VISCOSITY, COMPRESSIBILITY = 1.0e-15, 1.0e-3, 4.0e-10
LOAD = 20.0e6  # compression across the fracture [Pa]
HEIGHT = 2.0  # H of the rock on either side [m]
WIDTH = 2.0  # of the body, and length of the fracture [m]
APERTURE = 1.0e-3  # of the fracture [m]

UNIAXIAL = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))  # lambda + 2 G [Pa]
DRAINED = YOUNG / (3 * (1 - 2 * POISSON))  # bulk modulus [Pa]
STORAGE = (
    POROSITY * COMPRESSIBILITY + (BIOT - POROSITY) / DRAINED + BIOT**2 / UNIAXIAL
)  # at constant stress across [1/Pa]
START = BIOT / UNIAXIAL * LOAD / STORAGE  # undrained pressure [Pa]

STEP = 0.01  # [s]
LIMIT = START + 4.0e6  # [Pa]


@dataclass(frozen=True)
class Well:
    """What a well is; per metre of thickness."""

    storage: float = 0.0  # [m2/Pa]
    friction: float = 0.0  # [Pa s/m2]
    turbulence: float = 0.0  # [Pa s2/m4]


class Rock:
    """Pressures of the fracture and of the rock on one side of it."""

    def __init__(self, step: float = STEP) -> None:
        """Set the grid and the matrices of a step."""
        size = np.concatenate([[0.0], 1.0e-4 * np.cumsum(1.02 ** np.arange(300))])
        faces = np.concatenate([size[size < HEIGHT], [HEIGHT]])
        thick = np.diff(faces)
        centre = 0.5 * (faces[1:] + faces[:-1])
        mobility = PERMEABILITY / VISCOSITY
        between = 2 * WIDTH * mobility / np.diff(np.concatenate([[0.0], centre]))
        held = np.concatenate([[APERTURE * WIDTH * COMPRESSIBILITY], 2 * WIDTH * thick * STORAGE])
        n = held.size
        flow = np.zeros((n, n))
        for i, conductance in enumerate(between):
            flow[i, i] += conductance
            flow[i + 1, i + 1] += conductance
            flow[i, i + 1] -= conductance
            flow[i + 1, i] -= conductance
        self.step = step
        self.pressure = np.full(n, START)
        source = np.zeros(n)
        source[0] = 1.0
        self.matrices = {}
        for theta in (0.5, 1.0):
            left = np.linalg.inv(np.diag(held) + theta * step * flow)
            self.matrices[theta] = (
                left @ (np.diag(held) - (1 - theta) * step * flow),
                left @ source * step,
            )

    def advance(self, rate_for: Callable[[float, float], float], theta: float) -> float:
        """One step; rate_for(a, b) gives the flow q where the pressure after it is a + b q."""
        matrix, source = self.matrices[theta]
        before = matrix @ self.pressure
        flow = rate_for(before[0], source[0])
        self.pressure = before + source * flow
        return flow


def flow_of(
    well: Well, a: float, b: float, head_before: float, rate: float, limit: float, step: float
) -> tuple[float, float, float]:
    """Flow, pressure at the head and rate into the head, by bisection: all rise with the flow."""

    def head(flow: float) -> float:
        return a + b * flow + (well.friction + well.turbulence * abs(flow)) * flow

    def into(flow: float) -> float:
        return flow + well.storage * (head(flow) - head_before) / step

    def condition(flow: float) -> float:
        if math.isnan(rate):
            return head(flow) - limit
        if rate == 0.0 or math.isinf(limit):
            return into(flow) - rate
        # In units in which both are of the size of 1.
        beyond = (head(flow) - limit) / 1.0e6
        return max((into(flow) - rate) / 1.0e-5, min(beyond, into(flow) / 1.0e-5))

    low, high = -1.0e-2, 1.0e-2
    for _ in range(80):
        middle = 0.5 * (low + high)
        if condition(middle) > 0.0:
            high = middle
        else:
            low = middle
    return middle, head(middle), into(middle)


def simulate(
    well: Well, stages: list[tuple[float, float, float]], end: float
) -> list[tuple[float, ...]]:
    """Rows of time, flow, pressure in the fracture, pressure at the head, fluid into the head."""
    rock = Rock()
    head, injected = START, 0.0
    rows: list[tuple[float, ...]] = []
    n = round(end / STEP)
    for k in range(n):
        time = k * STEP
        stage = max(i for i, (start, _, _) in enumerate(stages) if start <= time + 1e-9)
        start, rate, limit = stages[stage]
        theta = 1.0 if time - start < 10 * STEP else 0.5
        found: list[float] = []

        def rate_for(
            a: float,
            b: float,
            head: float = head,
            rate: float = rate,
            limit: float = limit,
            found: list[float] = found,
        ) -> float:
            found[:] = flow_of(well, a, b, head, rate, limit, STEP)
            return found[0]

        rock.advance(rate_for, theta)
        flow, head, into = found
        injected += into * STEP
        # Often where values change fast.
        if (k + 1) % 20 == 0 or time - start < 2.0:
            rows.append((time + STEP, flow, float(rock.pressure[0]), head, injected))
    return rows


def laplace_check(rows: list[tuple[float, ...]], rate: float, end: float) -> float:
    """Compare the first stage with the Laplace transform, inverted by Talbot's contour."""

    def transform(s: complex) -> complex:
        root = np.sqrt(s * STORAGE / (PERMEABILITY / VISCOSITY))
        rock = 2 * WIDTH * PERMEABILITY / VISCOSITY * root * np.tanh(root * HEIGHT)
        return complex(rate / s / (rock + s * APERTURE * WIDTH * COMPRESSIBILITY))

    worst = 0.0
    for time, _, pressure, _, _ in rows:
        if time > end or time < 1.0:
            continue
        n = 24
        total = 0.5 * math.exp(2 * n / 5) * transform(2 * n / (5 * time)).real
        for k in range(1, n):
            angle = k * math.pi / n
            cot = 1 / math.tan(angle)
            s = 2 * n / (5 * time) * angle * complex(cot, 1)
            weight = complex(1, angle * (1 + cot**2) - cot)
            total += (np.exp(s * time) * transform(s) * weight).real
        exact = START + 2 / (5 * time) * total
        worst = max(worst, abs(pressure - exact) / (exact - START))
    return worst


def write(name: str, rows: list[tuple[float, ...]]) -> None:
    """Write one reference."""
    with (HERE / name).open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time_s", "flow_m2_s", "pressure_pa", "head_pressure_pa", "injected_m2"])
        for row in rows:
            writer.writerow([f"{row[0]:.2f}"] + [f"{value:.7g}" for value in row[1:]])


def main() -> None:
    """Write all files."""
    nothing = math.inf
    steps = [(0.0, 8.0e-6, nothing), (30.0, 1.6e-5, nothing), (60.0, 2.4e-5, nothing)]
    steps.append((90.0, 0.0, nothing))
    rows = simulate(Well(), steps, 180.0)
    print("Laplace transform:", laplace_check(rows, 8.0e-6, 30.0))
    write("steps.csv", rows)
    write("storage.csv", simulate(Well(5.0e-11, 3.0e10, 1.0e15), steps, 180.0))
    write("pressure.csv", simulate(Well(), [(0.0, math.nan, LIMIT)], 100.0))
    limited = [(0.0, 2.3e-5, LIMIT), (80.0, 5.0e-6, LIMIT)]
    rows = simulate(Well(), limited, 140.0)
    print("the limit is reached before", next(row[0] for row in rows if row[2] > LIMIT - 1.0))
    write("limit.csv", rows)
    with (HERE / "schedule.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time_s", "rate_m2_s"])
        writer.writerows([[start, rate] for start, rate, _ in steps])
    print("undrained pressure", START, "limit", LIMIT)


if __name__ == "__main__":
    main()
