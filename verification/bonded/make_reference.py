"""Reference of bonded: slip of a fracture whose bond breaks, where the rock can hold it.

Faces of a shear crack of half-length a in an infinite plane that have slipped by D carry the shear

    E'/(4 pi) fp-int D(t)/(t - x)^2 dt + tau,    tau the shear without the crack,

which the strength balances, C (1 - D/D_c) + mu S. It is linear; with
D = sqrt(1 - X^2) sum a_n U_n(X) the integral is -(pi/a) sum (n + 1) a_n U_n(X) (Kaya and Erdogan
1987). Nothing of the solver is used.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

YOUNG, POISSON = 40.0e9, 0.2  # [Pa], [-]
HALF_LENGTH = 0.1  # [m]
SHEAR, PRESSED, FRICTION = 11.0e6, 10.0e6, 0.5  # at load factor 1 [Pa], [Pa], [-]
COHESION, BREAKING_SLIP = 6.0e6, 2.0e-4  # [Pa], [m]
LOAD_FACTOR = 2.0
TERMS = 60


def slip_of_crack(places: np.ndarray) -> np.ndarray:
    """Slip [m] at places between -1 and 1."""
    modulus = YOUNG / (1.0 - POISSON**2)
    angle = np.pi * np.arange(1, TERMS + 1) / (TERMS + 1)
    order = np.arange(TERMS)
    u = np.sin(np.outer(angle, order + 1)) / np.sin(angle)[:, None]
    rock = -modulus / (4.0 * HALF_LENGTH) * (order + 1) * u
    bond = COHESION / BREAKING_SLIP * np.sin(angle)[:, None] * u
    excess = LOAD_FACTOR * (SHEAR - FRICTION * PRESSED) - COHESION
    a = np.linalg.solve(rock + bond, np.full(TERMS, -excess))
    return np.asarray(np.sin(np.outer(np.arccos(places), order + 1)) @ a)


def main() -> None:
    """Write the slip along the fracture, from its start."""
    places = np.linspace(-1.0, 1.0, 401)
    slip = slip_of_crack(places)
    if slip.max() > BREAKING_SLIP:
        raise SystemExit("the bond is broken in the middle: the reference is that before")
    with Path(__file__).with_name("shear.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["s_m", "slip_m"])
        for place, value in zip(places, slip, strict=True):
            writer.writerow([repr(float(HALF_LENGTH * (1.0 + place))), repr(float(value))])


if __name__ == "__main__":
    main()
