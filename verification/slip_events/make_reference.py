"""Slip events: a model of the run-away event of its own; prints the references of check.toml.

    .venv/bin/python verification/slip_events/make_reference.py

A fracture in an infinite plane, symmetric to its middle: constant slip per cell, stresses of edge
dislocations, linear slip weakening, radiation damping, backward Euler. The pressure is that of a
source in the middle of a sealed fracture of constant aperture, by its cosine series. It knows
nothing of the solver.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

YOUNG, POISSON = 40.0e9, 0.2
SHEAR = YOUNG / (2 * (1 + POISSON))
HALF = 0.45  # a [m]
NORMAL, LOAD = 200.0e6, 119.4e6  # compression, shear [Pa]
STATIC, RESIDUAL, CRITICAL = 0.6, 0.2, 1.3263e-3  # friction, D_c [m]
DAMPING = 3.4e6  # [Pa s/m]
APERTURE, VISCOSITY, COMPRESSIBILITY, RATE = 1.0e-5, 0.1, 1.0e-8, 6.0e-9
BIOT, POROSITY, SIDES = 1.0e-6, 1.0e-6, 50.0e6
THRESHOLD = 1.0e-3  # [m/s]
END = 4.8  # [s]

# Undrained pressure of the load
PLANE = YOUNG / (2 * (1 + POISSON) * (1 - 2 * POISSON))
START = BIOT * 0.5 * (NORMAL + SIDES) / (PLANE * POROSITY * COMPRESSIBILITY + BIOT**2)


@dataclass
class Event:
    """The seismic event."""

    onset: float
    arrest: float
    moment: float  # per metre [N m/m]
    drop: float  # [Pa]
    largest: float  # slip rate [m/s]


class Fluid:
    """Pressures in the cells."""

    def __init__(self, x: FloatArray) -> None:
        """Modes of a fracture of length 2 a with a source in its middle."""
        n = np.arange(1, 400)
        diffusivity = APERTURE**2 / (12 * VISCOSITY * COMPRESSIBILITY)
        self.decay = diffusivity * (n * math.pi / HALF) ** 2
        self.shape = np.cos(np.outer(x, n * math.pi / HALF))

    def pressure(self, time: float) -> FloatArray:
        """At a time."""
        source = RATE / (APERTURE * COMPRESSIBILITY * 2 * HALF)
        amplitude = 2 * (1 - np.exp(-self.decay * time)) / self.decay
        value: FloatArray = START + source * (time + self.shape @ amplitude)
        return value


def stiffness(x: FloatArray, h: float) -> FloatArray:
    """Shear stress released per slip, of the cell and its mirror image [Pa/m]."""
    factor = SHEAR / (2 * math.pi * (1 - POISSON))

    def of(distance: FloatArray) -> FloatArray:
        value: FloatArray = factor * h / ((h / 2) ** 2 - distance**2)
        return value

    return of(x[:, None] - x[None, :]) + of(x[:, None] + x[None, :])


def step(
    matrix: FloatArray, slip: FloatArray, effective: FloatArray, dt: float
) -> tuple[FloatArray, bool]:
    """One step: cells stick, or bear their strength and the damping; by active sets."""
    after = slip.copy()
    slides = np.zeros(slip.size, dtype=bool)
    eta = DAMPING / dt
    drop = (STATIC - RESIDUAL) / CRITICAL
    for _ in range(60):
        weakens = after < CRITICAL
        strength = np.where(weakens, STATIC - drop * after, RESIDUAL) * effective
        excess = LOAD - matrix @ after - strength - eta * (after - slip)
        now = (after > slip) | (excess > 0)
        if np.all(now == slides) and np.max(np.abs(excess[now]), initial=0.0) < 1.0e-2:
            return after, True
        slides = now
        slope = matrix[np.ix_(now, now)].copy()
        slope[np.diag_indices_from(slope)] += eta - np.where(weakens, drop * effective, 0)[now]
        after = np.where(now, after, slip)
        residual = LOAD - matrix @ after - eta * (after - slip)
        residual -= np.where(weakens, STATIC - drop * after, RESIDUAL) * effective
        after[now] += np.linalg.solve(slope, residual[now])
        after = np.maximum(after, slip)
    return after, False


def simulate(n: int, share: float, fine: float) -> Event:
    """With n cells on half of the fracture; steps that slip by a share of D_c, fine ones in it."""
    h = HALF / n
    x = h * (np.arange(n) + 0.5)
    matrix = stiffness(x, h)
    fluid = Fluid(x)
    slip = np.zeros(n)
    time, dt = 0.0, 1.0e-3
    event: Event | None = None
    start_slip = slip
    steps = 0
    while time < END:
        dt = min(dt, END - time)
        effective = NORMAL - fluid.pressure(time + dt)
        after, found = step(matrix, slip, effective, dt)
        change = float(np.max(after - slip))
        if not found or change > 2 * share * CRITICAL:
            dt *= 0.5
            continue
        rate = change / dt
        if rate >= THRESHOLD:
            if event is None:
                event = Event(time, time, 0.0, 0.0, 0.0)
                start_slip = slip
            event.arrest = time + dt
            event.largest = max(event.largest, rate)
            event.moment = SHEAR * 2 * h * float(np.sum(after - start_slip))
            event.drop = float(np.mean(matrix @ (after - start_slip)))
        slip = after
        time += dt
        steps += 1
        dt *= 1.4 if change < share * CRITICAL else 1.0
        dt = min(dt, 0.02 if rate < 0.1 * THRESHOLD else fine)
    assert event is not None
    print(n, share, fine, steps, event)
    return event


def main() -> None:
    """Print all."""
    for n in (90, 180, 360):
        simulate(n, 0.02, 2.0e-5)
    simulate(180, 0.01, 1.0e-5)


if __name__ == "__main__":
    main()
