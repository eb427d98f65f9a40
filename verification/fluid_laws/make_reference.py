"""Fluid laws: writes the reference of the diffusion in this case.

    .venv/bin/python verification/fluid_laws/make_reference.py

A series (README.md); it knows nothing of the solver. Also prints the tables of check.toml, which
sample laws of closed form, and the flow at a given pressure.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

HERE = Path(__file__).parent

VISCOSITY, APERTURE, REFERENCE = 1.0e-3, 1.0e-5, 1.0e7  # [Pa s], [m], [Pa]
COMPRESSIBILITY, EXPONENT = 1.0e-8, 3.0e-8  # c, beta [1/Pa]
SIDE, TIME = 6.0e7, 0.6  # of the diffusion: pressure of the side [Pa], when [s]
PLACES = [0.0025 * i for i in range(401)]  # s [m]


def diffusion(s: float) -> float:
    """Pressure after the side's has risen [Pa]."""
    diffusivity = APERTURE**2 / (12 * VISCOSITY * COMPRESSIBILITY)
    density = math.exp(COMPRESSIBILITY * (SIDE - REFERENCE))
    missing = 0.0
    for n in range(200):
        root = (n + 0.5) * math.pi
        decay = math.exp(-diffusivity * root**2 * TIME)
        missing += (-1) ** n * 2 / root * math.cos(root * s) * decay
    return REFERENCE + math.log(density + (1 - density) * missing) / COMPRESSIBILITY


def main() -> None:
    """Write all files."""
    with (HERE / "diffusion.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["s_m", "pressure_pa"])
        writer.writerows([[f"{s:.4f}", f"{diffusion(s):.15g}"] for s in PLACES])
    pressures = [1.0e7 * (i + 1) for i in range(7)]
    print("table_pressure", pressures)
    for name, value, rate in (
        ("table_viscosity", VISCOSITY, EXPONENT),
        ("table_density", 1000.0, COMPRESSIBILITY),
    ):
        print(name, [float(f"{value * math.exp(rate * (p - REFERENCE)):.13g}") for p in pressures])
    for n in (5, 9, 17):
        places = [6.0e7 * i / (n - 1) for i in range(n)]
        print("linear", [p + REFERENCE for p in places])
        print("      ", [float(f"{VISCOSITY * (1 + EXPONENT * p):.13g}") for p in places])
    k = COMPRESSIBILITY - EXPONENT
    flow = math.expm1(k * (SIDE - REFERENCE)) / k
    print("flow at a given pressure", flow * APERTURE**3 / (12 * VISCOSITY))


if __name__ == "__main__":
    main()
