"""Toughness-dominated growth with Carter's leak-off: writes reference.csv.

    .venv/bin/python verification/kgd/make_reference.py

A crack of half-length l at its toughness K holds 2 sqrt(pi) K l^(3/2)/E'. Each of its two faces has
lost 2 C sqrt(t - tau(x)) of fluid per length since the tip passed x at the time tau. So

    Q t = 2 sqrt(pi) K l^(3/2)/E' + 8 C int_0^l sqrt(t - tau(x)) dx

which is solved for t at one l after the other, tau linear in between and the integral exact.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

MODULUS = 30.0e9 / (1.0 - 0.25**2)  # E' [Pa]
TOUGHNESS = 1.0e6  # K_IC [Pa m^1/2]
RATE = 1.0e-5  # Q [m2/s]
STRESS = 100.0e6  # compression far away [Pa]
POROSITY = 6.0e-4  # also Biot's coefficient
STORAGE = POROSITY * 5.0e-9  # S = phi c_p [1/Pa]
MOBILITY = 5.0e-16  # k/mu [m2/(Pa s)]
END = 20.0  # [s]

FloatArray = npt.NDArray[np.float64]


def leak_off_coefficient() -> float:
    """Give C [m/s^1/2]: difference of the pressures times sqrt((k/mu) S/pi)."""
    lame_and_shear = 24.0e9  # lambda + G of E = 30 GPa, nu = 0.25 [Pa]
    at_first = STRESS / (lame_and_shear * STORAGE / POROSITY + POROSITY)  # undrained pressure
    return (STRESS - at_first) * math.sqrt(MOBILITY * STORAGE / math.pi)


def lost(at: float, length: FloatArray, passed: FloatArray) -> float:
    """Give int sqrt(t - tau) dx over the pieces of the crack [m s^1/2]."""
    first, last = at - passed[:-1], at - passed[1:]
    fall = first - last
    safe = np.where(fall > 0.0, fall, 1.0)
    mean = np.where(fall > 1e-12 * at, (first**1.5 - last**1.5) / (1.5 * safe), np.sqrt(first))
    return float(np.sum(mean * np.diff(length)))


def grow(pieces: int) -> tuple[FloatArray, FloatArray]:
    """Give the times at which the half-length has some values, and these."""
    volume = 2.0 * math.sqrt(math.pi) * TOUGHNESS / MODULUS
    coefficient = leak_off_coefficient()
    longest = (RATE * END / volume) ** (2.0 / 3.0)
    length = longest * np.linspace(0.0, 1.0, pieces + 1) ** 2
    time = np.zeros(pieces + 1)
    for i in range(1, pieces + 1):

        def excess(at: float, i: int = i) -> float:
            passed = np.append(time[:i], at)
            gone = 8.0 * coefficient * lost(at, length[: i + 1], passed)
            return RATE * at - volume * math.pow(length[i], 1.5) - gone

        low, high = time[i - 1], max(2.0 * time[i - 1], 1.0)
        while excess(high) < 0.0:
            high *= 2.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
        time[i] = high
        if high > END:
            return time[: i + 1], length[: i + 1]
    return time, length


def main() -> None:
    """Write the reference at some times."""
    times = [10.0, 15.0, 20.0]
    half = np.interp(times, *grow(2000))
    check = np.interp(times, *grow(1000))
    print("change with twice the pieces:", float(np.max(np.abs(check / half - 1.0))))
    pressure = TOUGHNESS / np.sqrt(math.pi * half)
    opening = 4.0 * pressure * half / MODULUS
    with (Path(__file__).parent / "reference.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["time_s", "half_length_m", "opening_m", "pressure_pa"])
        for row in zip(times, half, opening, pressure, strict=True):
            table.writerow([f"{value:.6g}" for value in row])


if __name__ == "__main__":
    main()
