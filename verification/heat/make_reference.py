"""Heat: writes the pressure along the fracture with a viscosity that follows temperature.

    .venv/bin/python verification/heat/make_reference.py

The integral of 12 mu(T) q/a^3 from the outlet, T of Lauwerier (1955): trapezoids of 1 cm.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

FLOW, APERTURE, LENGTH = 5.0e-5, 1.0e-3, 500.0  # [m2/s], [m], [m]
CONDUCTIVITY, CAPACITY, FLUID = 2.6, 2.2e6, 4.2e6  # [W/(m K)], [J/(m3 K)] of rock and fluid
TIME = 157788000.0  # [s]
COLD, HOT = 9.0e-4, 3.0e-4  # viscosities; ln mu is linear in between [Pa s]
STEP = 0.01  # [m]


def gradient(x: float) -> float:
    """Fall of the pressure [Pa/m]."""
    time = TIME - x * APERTURE / FLOW
    chill = math.erfc(CONDUCTIVITY * x / (FLUID * FLOW) / math.sqrt(CONDUCTIVITY / CAPACITY * time))
    return 12 * FLOW / APERTURE**3 * HOT * math.pow(COLD / HOT, chill)


def main() -> None:
    """Write the pressures every metre."""
    pressure, rows = 0.0, [(LENGTH, 0.0)]
    for i in range(round(LENGTH / STEP), 0, -1):
        pressure += 0.5 * STEP * (gradient(STEP * i) + gradient(STEP * (i - 1)))
        if (i - 1) % 100 == 0:
            rows.append((STEP * (i - 1), pressure))
    with (Path(__file__).parent / "viscosity.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["s_m", "pressure_pa"])
        writer.writerows([[f"{s:.1f}", f"{p:.8g}"] for s, p in reversed(rows)])


if __name__ == "__main__":
    main()
