"""Growth with viscosity, toughness and Carter's leak-off, in time: writes leaking.csv.

    .venv/bin/python verification/kgd/leaking.py

Opening and K follow from the pressures at the nodes of self_similar.py, whose places xi = x/l are
fixed. With S(x, t) = int_x^l (w + 2 C' sqrt(t - tau)) dx, what lies beyond x and what leaked off
there since the tip passed at the time tau, the flow through each place is dS/dt at a fixed x: with
the rate at a fixed xi by backward Euler

    -w^3/mu' dp/dx = dS(xi, t)/dt + xi dl/dt (w + 2 C' sqrt(t - tau)),   Q/2 = dS(0, t)/dt

and K_I = K_IC gives the half-length l. It begins with the self-similar solution at a time when
hardly any fluid has leaked off. Carter's coefficient is that of the rock for a constant difference
of the pressures, that of the confinement (make_reference.py). The values of two step sizes are
extrapolated. Without leak-off the result is the self-similar solution, without viscosity that of
make_reference.py: both are printed.
"""

from __future__ import annotations

import csv
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from verification.kgd.make_reference import (
    MODULUS,
    RATE,
    TOUGHNESS,
    grow,
    leak_off_coefficient,
)
from verification.kgd.self_similar import Crack, FloatArray

STIFF = math.sqrt(32.0 / math.pi) * TOUGHNESS  # K' [Pa m^1/2]
TIMES = [20.0, 30.0, 40.0]  # [s]


@dataclass
class State:
    """Pressures at the nodes [Pa], half-length [m], openings [m], S at the nodes [m2]."""

    time: float
    pressure: FloatArray
    half: float
    opening: FloatArray
    beyond: FloatArray


class Leaking:
    """A crack with one viscosity and one coefficient of leak-off."""

    def __init__(self, crack: Crack, thick: float, coefficient: float) -> None:
        """Take mu' [Pa s] and C' [m/s^1/2]; the tip has come nowhere yet."""
        self.crack, self.thick, self.coefficient = crack, thick, coefficient
        self.lengths: list[float] = [0.0]  # half-lengths [m] at
        self.passed: list[float] = [0.0]  # these times [s]

    def leaked(self, x: FloatArray, time: float, half: float) -> tuple[FloatArray, FloatArray]:
        """Give 2 C' sqrt(t - tau) [m] and its integral from x to l [m2]; tau is linear per step."""
        length, passed = np.append(self.lengths, half), np.append(self.passed, time)
        age = np.maximum(time - passed, 0.0)
        step, fall = np.diff(length), age[:-1] - age[1:]
        mean = (age[:-1] ** 1.5 - age[1:] ** 1.5) / (1.5 * np.maximum(fall, 1e-300))
        total = np.append(0.0, np.cumsum(mean * step))
        x = np.minimum(x, half)
        i = np.clip(np.searchsorted(length, x, side="right") - 1, 0, step.size - 1)
        share = (x - length[i]) / step[i]
        here = age[i] - share * fall[i]
        part = (age[i] ** 1.5 - here**1.5) / (1.5 * np.maximum(fall[i], 1e-300)) * step[i]
        factor = 2.0 * self.coefficient
        return factor * np.sqrt(here), factor * (total[-1] - total[i] - part)

    def stored(self, opening: FloatArray, half: float) -> FloatArray:
        """Give int_x^l w dx at the nodes [m2], w a power of the distance between two of them."""
        s = self.crack.s
        steps = np.diff(self.crack.log_s)
        power = np.diff(np.log(opening)) / steps
        parts = opening[:-1] * s[:-1] * (np.exp(steps * (power + 1.0)) - 1.0) / (power + 1.0)
        return half * np.cumsum(np.append(opening[0] * s[0] / 1.5, parts))

    def beyond(
        self, opening: FloatArray, half: float, time: float
    ) -> tuple[FloatArray, FloatArray]:
        """Give w + 2 C' sqrt(t - tau) [m] and S [m2] at the nodes."""
        left, leaked = self.leaked((1.0 - self.crack.s) * half, time, half)
        return opening + left, self.stored(opening, half) + leaked

    def residual(self, unknowns: FloatArray, time: float, old: State) -> FloatArray:
        """Misfit of a step, for pressures over a scale and the logarithm of the half-length."""
        scale = float(np.max(np.abs(old.pressure[-1])))
        pressure, half = unknowns[:-1] * scale, math.exp(unknowns[-1])
        opening = np.maximum(half / MODULUS * (self.crack.opening @ pressure), 1e-12)
        held, now = self.beyond(opening, half, time)
        moved = (1.0 - self.crack.s) * (half - old.half)
        flow = (now - old.beyond + moved * held) / (time - old.time)
        s, steps = self.crack.s, np.diff(self.crack.log_s)
        # dp/d ln s = mu' q l s/w^3 at both ends of a piece, its logarithm linear in ln s.
        slope = np.maximum(self.thick * flow * half * s / opening**3, 1e-300)
        ratio = np.log(slope[1:] / slope[:-1])
        mean = np.where(
            np.abs(ratio) > 1e-6,
            (slope[1:] - slope[:-1]) / np.where(ratio == 0.0, 1.0, ratio),
            slope[1:],
        )
        rise = mean * steps
        return np.concatenate(
            [
                (np.diff(pressure) - rise) / np.maximum(scale, np.abs(rise)),
                [2.0 * flow[-1] / RATE - 1.0],
                [math.sqrt(half) * float(self.crack.toughness @ pressure) / STIFF - 1.0],
            ]
        )

    def step(self, time: float, old: State) -> State:
        """Newton iterations with derivatives by differences, damped."""
        scale = float(np.max(np.abs(old.pressure[-1])))
        grown = old.half * (time / old.time) ** 0.6
        unknowns = np.append(old.pressure / scale, math.log(grown))
        misfit = self.residual(unknowns, time, old)
        for _ in range(40):
            if np.linalg.norm(misfit) < 1e-7:
                break
            columns = []
            for j in range(unknowns.size):
                shifted = unknowns.copy()
                shifted[j] += 1e-6 * max(1.0, abs(unknowns[j]))
                change = self.residual(shifted, time, old) - misfit
                columns.append(change / (shifted[j] - unknowns[j]))
            change = np.linalg.solve(np.column_stack(columns), -misfit)
            for share in 0.5 ** np.arange(20):
                tried = unknowns + share * change
                new = self.residual(tried, time, old)
                if np.linalg.norm(new) < np.linalg.norm(misfit):
                    break
            unknowns, misfit = tried, new
        else:
            raise RuntimeError(f"{time} s: misfit {np.linalg.norm(misfit)}")
        pressure, half = unknowns[:-1] * scale, math.exp(unknowns[-1])
        opening = half / MODULUS * (self.crack.opening @ pressure)
        _, beyond = self.beyond(opening, half, time)
        self.lengths.append(half)
        self.passed.append(time)
        return State(time, pressure, half, opening, beyond)


def self_similar(crack: Crack, thick: float) -> tuple[float, float, FloatArray]:
    """Give K_m, gamma and the pressures over eps E' without leak-off."""
    toughness = STIFF / (MODULUS**3 * thick * RATE) ** 0.25
    gamma = 2.0 / (8.0 * math.pi) ** (2.0 / 3.0)
    shape = 1.0 + 0.05 * np.log(np.maximum(crack.s, 1e-6))
    first = 8.0 / (math.sqrt(gamma) * float(crack.toughness @ shape))
    unknowns = np.append(first * shape, math.log(gamma))
    for value in [*(v for v in (8.0, 4.0, 2.0, 1.0, 0.7, 0.5, 0.3) if v > toughness), toughness]:
        unknowns = crack.solve(value, unknowns)
    return toughness, math.exp(unknowns[-1]), unknowns[:-1]


def solution(nodes: int, steps: int, viscosity: float, coefficient: float) -> FloatArray:
    """Give half-length, opening and pressure at the centre, in `steps` steps per factor e."""
    crack = Crack(nodes)
    thick = 12.0 * viscosity
    _, gamma, pi = self_similar(crack, thick)
    model = Leaking(crack, thick, coefficient)
    first = 1.0e-3 * TIMES[0]
    epsilon = (thick / (MODULUS * first)) ** (1.0 / 3.0)
    half = gamma * (MODULUS * RATE**3 * first**4 / thick) ** (1.0 / 6.0)
    # The tip's times before that; between two of them tau is linear.
    for share in np.linspace(0.0, 1.0, 41)[1:]:
        model.lengths.append(half * share)
        model.passed.append(first * share**1.5)
    pressure = pi * epsilon * MODULUS
    opening = half / MODULUS * (crack.opening @ pressure)
    state = State(first, pressure, half, opening, model.beyond(opening, half, first)[1])
    count = math.ceil(steps * math.log(TIMES[-1] / first))
    rows = [(math.log(first), half, opening[-1], pressure[-1])]
    for time in np.geomspace(first, TIMES[-1], count + 1)[1:]:
        state = model.step(float(time), state)
        rows.append((math.log(time), state.half, state.opening[-1], state.pressure[-1]))
    table = np.log(np.array(rows)[:, 1:])
    at = np.array(rows)[:, 0]
    return np.array([[math.exp(np.interp(math.log(t), at, c)) for c in table.T] for t in TIMES])


def extrapolated(viscosity: float, coefficient: float) -> FloatArray:
    """Twice the values of short steps minus those of steps twice as long."""
    coarse, fine = (solution(60, n, viscosity, coefficient) for n in (12, 24))
    print("change with the steps:", np.max(np.abs(fine / coarse - 1.0), axis=0))
    return 2.0 * fine - coarse


def main() -> None:
    """Write the reference, and compare with what is known."""
    carter = 2.0 * leak_off_coefficient()
    crack = Crack(60)
    without = extrapolated(2.6385724906858806e-2, 0.0)
    _, gamma, pi = self_similar(crack, 12.0 * 2.6385724906858806e-2)
    for time, row in zip(TIMES, without, strict=True):
        size = (MODULUS * RATE**3 * time**4 / (12.0 * 2.6385724906858806e-2)) ** (1.0 / 6.0)
        thin = (12.0 * 2.6385724906858806e-2 / (MODULUS * time)) ** (1.0 / 3.0)
        print(
            "no leak-off:", row[0] / (gamma * size) - 1.0, row[2] / (pi[-1] * thin * MODULUS) - 1.0
        )
    thin = extrapolated(1.0e-6, carter)
    print("no viscosity:", thin[0, 0] / np.interp(TIMES[0], *grow(1000)) - 1.0)
    with (Path(__file__).parent / "leaking.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["k_m", "time_s", "half_length_m", "opening_m", "pressure_pa"])
        for viscosity in (2.6385724906858806e-2, 0.42217159854):
            values = extrapolated(viscosity, carter)
            k_m = STIFF / (MODULUS**3 * 12.0 * viscosity * RATE) ** 0.25
            for time, row in zip(TIMES, values, strict=True):
                table.writerow([f"{value:.6g}" for value in (k_m, time, *row)])


if __name__ == "__main__":
    main()
