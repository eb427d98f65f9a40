"""Growth of a fracture of 100 m with leak-off into tight rock: closed forms, across_leaking.nml.

    .venv/bin/python verification/reservoir_scale/leaking.py

The rock is undrained but for a layer of sqrt(c t) on the faces, centimetres thick. So the opening
is that of undrained rock, E'_u = E'/F with F = (1 - nu_u)/(1 - nu), and at the drained tip K_I is
F^(3/4) K_u less the back stress of the layer (docs/theory.md, "Layers thinner than a cell"). Per
length, each face has lost 2 C sqrt(t - tau) to the rock, C = S' dp sqrt(c/pi) with the storage
S' = S + alpha^2/(lambda + 2 G) at uniaxial strain, of which alpha dp/(lambda + 2 G) is the swelling
of the layer, which the fracture loses.

- Onset: the layer is as old as the injection,
      K_b = (1 + F)/2 sqrt(2)/Gamma(5/4) eta dp (c t)^(1/4),
      Q t = 2 sqrt(pi) a^(3/2) (K_IC + K_b)/(F^(3/4) E'_u) + 8 C a sqrt(t).
- Growth: behind a tip of speed V the layer is sqrt(c x/V) thick at the distance x, and
      K_b = (1 + F)/2 eta dp sqrt(c/(pi V)) 3.545
  (the number is the integral of erfc(n/(2 sqrt(x))) with the weight of a half-plane crack). Half-
  length and time are those of the KGD crack with K' for K_IC + K_b over F^(3/4) and E'_u, with
  Carter's leak-off (../kgd/leaking.py). A crack that has waited at its onset joins this solution.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from verification.kgd import leaking as kgd
from verification.kgd.make_reference import MODULUS as KGD_MODULUS
from verification.kgd.make_reference import RATE as KGD_RATE
from verification.kgd.self_similar import Crack

YOUNG, POISSON, BIOT, POROSITY = 40.0e9, 0.2, 0.8, 0.01
PERMEABILITY, VISCOSITY, COMPRESSIBILITY = 1.0e-19, 3.0e-4, 4.0e-10
TOUGHNESS, RATE, HALF, EXCESS = 1.0e6, 1.0e-4, 50.0, 7.0e6  # Pa m^1/2, m2/s, m, dp [Pa]

SHEAR = YOUNG / (2.0 * (1.0 + POISSON))
BULK = YOUNG / (3.0 * (1.0 - 2.0 * POISSON))
LAME = BULK - 2.0 * SHEAR / 3.0
UNIAXIAL = LAME + 2.0 * SHEAR
STORAGE = POROSITY * COMPRESSIBILITY + (BIOT - POROSITY) / BULK  # S [1/Pa]
DIFFUSIVITY = PERMEABILITY / VISCOSITY / (STORAGE + BIOT**2 / UNIAXIAL)
UNDRAINED = LAME + BIOT**2 / STORAGE
F = (UNDRAINED + 2.0 * SHEAR) / (UNDRAINED + SHEAR) * (LAME + SHEAR) / UNIAXIAL
MODULUS = YOUNG / (1.0 - POISSON**2) / F  # E'_u [Pa]
ETA = BIOT * SHEAR / UNIAXIAL
LOSS = (STORAGE + BIOT**2 / UNIAXIAL - BIOT / UNIAXIAL) * EXCESS  # less the swelling [-]
CARTER = LOSS * math.sqrt(DIFFUSIVITY / math.pi)  # C of a face [m/s^1/2]


def apparent(back_stress: float) -> float:
    """Give K_u at which a tip with a back stress grows [Pa m^1/2]."""
    return (TOUGHNESS + back_stress) / math.pow(F, 0.75)


def onset() -> float:
    """Give the time of the onset [s]."""

    def missing(time: float) -> float:
        back = ETA * EXCESS * math.pow(DIFFUSIVITY * time, 0.25)
        back *= 0.5 * (1.0 + F) * math.sqrt(2.0) / math.gamma(1.25)
        volume = 2.0 * math.sqrt(math.pi) * math.pow(HALF, 1.5) * apparent(back) / MODULUS
        return volume + 8.0 * CARTER * HALF * math.sqrt(time) - RATE * time

    low, high = 1.0, 1.0e5
    while high - low > 1.0e-6 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if missing(middle) > 0.0 else (low, middle)
    return low


def doubled(speed: float) -> float:
    """Give the time of the doubled length [s], at about this speed of the tips."""
    back = 0.5 * (1.0 + F) * ETA * EXCESS * 3.545 * math.sqrt(DIFFUSIVITY / (math.pi * speed))
    thick = 12.0 * VISCOSITY
    tough = math.sqrt(32.0 / math.pi) * apparent(back)
    k_m = tough / (MODULUS**3 * thick * RATE) ** 0.25
    # The same crack in the units of kgd.leaking: K_m is equal, and so is what has leaked off over
    # what was injected.
    other = (kgd.STIFF / k_m) ** 4 / (KGD_MODULUS**3 * KGD_RATE)
    gamma = kgd.self_similar(Crack(60), other)[1]
    time = (2.0 * HALF / gamma) ** 1.5 / (MODULUS * RATE**3 / thick) ** 0.25
    end = kgd.TIMES[-1]
    half = gamma * (KGD_MODULUS * KGD_RATE**3 * end**4 / other) ** (1.0 / 6.0)
    leaked = 2.0 * CARTER * 2.0 * HALF / (RATE * math.sqrt(time))
    rows = kgd.solution(60, 24, other / 12.0, leaked * KGD_RATE * math.sqrt(end) / half)
    slope = math.log(rows[-1, 0] / rows[-2, 0]) / math.log(end / kgd.TIMES[-2])
    print(f"K_m {k_m:.3f}, K_b {back / 1e6:.3f} MPa m^1/2, without leak-off {time:.1f} s")
    return float(time * (half / rows[-1, 0]) ** (1.0 / slope))


if __name__ == "__main__":
    print(f"F {F:.4f}, c {DIFFUSIVITY:.4g} m2/s, C {CARTER:.4g} m/s^1/2")
    print(f"onset {onset():.1f} s")
    print(f"doubled {doubled(speed=0.08):.1f} s")
