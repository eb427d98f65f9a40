"""Pressure and settlement of a column whose load and pressure at its top rise at once.

One-dimensional consolidation (Terzaghi 1923; Wang 2000, section 6.5, loading efficiency) with the
factor of backward Euler, (1 + M**2 dT)**-n for exp(-M**2 T): the error in time is left out, which
the terzaghi case has. Written without the solver: python make_reference.py >reference.csv prints
pressures over the load, and the settlement of the top to stderr.
"""

import math
import sys

YOUNG, POISSON, BIOT, POROSITY, PERMEABILITY = 1.0e9, 0.2, 0.8, 0.1, 1.0e-14
COMPRESSIBILITY, VISCOSITY, HEIGHT, LOAD = 4.5e-10, 1.0e-3, 100.0, 98.1e3
STEP, STEPS = 23512.5, 32

bulk = YOUNG / (3.0 * (1.0 - 2.0 * POISSON))
storage = POROSITY * COMPRESSIBILITY + (BIOT - POROSITY) / bulk
oedometric = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
held = storage + BIOT**2 / oedometric
diffusivity = PERMEABILITY / VISCOSITY / held
efficiency = BIOT / oedometric / held
dt = diffusivity * STEP / HEIGHT**2


def decay(k: int) -> float:
    """The factor of mode k after all steps, M = (2 k + 1) pi/2."""
    return (1.0 + ((2 * k + 1) * math.pi / 2.0) ** 2 * dt) ** -STEPS


def pressure(depth: float) -> float:
    """Pressure beyond the hydrostatic one over the load; depth over the height from the top."""
    terms = (
        2.0 / m * math.sin(m * depth) * decay(k)
        for k in range(400)
        for m in [(2 * k + 1) * math.pi / 2.0]
    )
    return 1.0 - (1.0 - efficiency) * math.fsum(terms)


mean = 1.0 - (1.0 - efficiency) * math.fsum(
    2.0 / ((2 * k + 1) * math.pi / 2.0) ** 2 * decay(k) for k in range(400)
)
settlement = LOAD * HEIGHT * (BIOT * mean - 1.0) / oedometric
sys.stderr.write(f"efficiency {efficiency!r}, dT {dt!r}, settlement {settlement!r} m\n")
print("z_over_h,pressure")
for tenth in range(0, 11, 2):
    print(f"{tenth / 10},{pressure(tenth / 10)!r}")
