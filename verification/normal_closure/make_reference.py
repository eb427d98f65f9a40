"""Reference of normal_closure: a joint of finite length that closes by Bandis' hyperbola.

The faces of a crack of half-length a in an infinite plane, apart by w (negative: closed), carry

    p(x) = E'/(4 pi) fp-int w(t)/(t - x)^2 dt + P(x)

with P the traction of the load without the crack, which the joint's contact pressure balances,
s(w) = k (-w)/(1 + w/d). With w = sqrt(1 - X^2) sum a_n U_n(X) the integral is
-(pi/a) sum (n + 1) a_n U_n(X) (Kaya and Erdogan 1987), and

    K_I = E'/4 sqrt(pi/a) sum (n + 1) a_n.

Collocated at the zeros of the next U; half as many change K_I by 1e-4. Nothing of the solver is
used.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

YOUNG, POISSON = 40.0e9, 0.2  # [Pa], [-]
STIFFNESS, CLOSURE = 5.0e10, 8.0e-5  # k_ni [Pa/m], d_max [m]
HALF_LENGTH, LOAD = 1.0, 5.0e6  # [m], [Pa] across the joint, compression
TERMS = 320


def joint_under(load: float, at_rest: float = 0.0, terms: int = TERMS) -> tuple[float, float]:
    """K_I [Pa sqrt(m)] and volume [m2] of the joint.

    `load` is the compression across it less its fluid pressure, `at_rest` that under which rock
    and joint fit each other [Pa]; both count from there.
    """
    modulus = YOUNG / (1.0 - POISSON**2)
    angle = np.pi * np.arange(1, terms + 1) / (terms + 1)
    order = np.arange(terms)
    u = np.sin(np.outer(angle, order + 1)) / np.sin(angle)[:, None]
    opening = np.sin(angle)[:, None] * u
    rock = modulus / (4.0 * HALF_LENGTH) * (order + 1) * u
    by_opening = rock @ np.linalg.inv(opening)
    # In the pressure, not in w, whose pole at -d_max Newton's method would jump over.
    pressure = np.full(terms, at_rest)
    for _ in range(50):
        w = at_rest / (STIFFNESS + at_rest / CLOSURE) - pressure / (STIFFNESS + pressure / CLOSURE)
        slope = -STIFFNESS / (STIFFNESS + pressure / CLOSURE) ** 2
        residual = by_opening @ w + load - pressure
        step = np.linalg.solve(by_opening * slope - np.eye(terms), -residual)
        pressure = pressure + step
        if np.max(np.abs(step)) < 1e-14 * load:
            break
    if pressure.min() < 0.0:
        raise SystemExit("the joint opens, for which this is not made")
    w = at_rest / (STIFFNESS + at_rest / CLOSURE) - pressure / (STIFFNESS + pressure / CLOSURE)
    a = np.linalg.solve(opening, w)
    k1 = 0.25 * modulus * np.sqrt(np.pi / HALF_LENGTH) * np.sum((order + 1) * a)
    return float(k1), float(0.5 * np.pi * HALF_LENGTH * a[0])


def opened_joint(terms: int = 1600) -> float:
    """K_I [Pa sqrt(m)] of the joint of opened.nml, parts of which open.

    Newton's method in the opening w, whose pole is far where the joint relaxes: faces apart bear
    nothing, the others what the law says. Half as many terms change K_I by 7e-5.
    """
    young, poisson, half_length = 18.0e9, 0.17, 5.0
    stiffness, closure = 6.0e9, 9.0e-4
    at_rest, net = 11.0e6, 2.0e6  # contact pressure at rest, fluid less stress across [Pa]
    modulus = young / (1.0 - poisson**2)
    angle = np.pi * np.arange(1, terms + 1) / (terms + 1)
    order = np.arange(terms)
    to_coefficients = 2.0 / (terms + 1) * np.sin(np.outer(order + 1, angle))
    u = np.sin(np.outer(angle, order + 1)) / np.sin(angle)[:, None]
    rock = modulus / (4.0 * half_length) * (order + 1) * u @ to_coefficients
    closed_at_rest = at_rest / (stiffness + at_rest / closure)
    w = 4.0 * net * half_length / modulus * np.sin(angle)
    for _ in range(50):
        d = np.maximum(closed_at_rest - w, 0.0)
        pressure = stiffness * d / (1.0 - d / closure)
        slope = np.where(d > 0.0, stiffness / (1.0 - d / closure) ** 2, 0.0)
        step = np.linalg.solve(rock + np.diag(slope), net + pressure - rock @ w)
        w = w + step
        if np.max(np.abs(step)) < 1e-14 * np.max(np.abs(w)):
            break
    a = to_coefficients @ w
    return float(0.25 * modulus * np.sqrt(np.pi / half_length) * np.sum((order + 1) * a))


def main() -> None:
    """Write K_I and volume at the four steps of the load."""
    with Path(__file__).with_name("pressed.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["load_factor", "k1_pa_sqrtm", "volume_m2"])
        for step in range(1, 5):
            k1, volume = joint_under(0.25 * step * LOAD)
            writer.writerow([0.25 * step, repr(k1), repr(volume)])
    k1, volume = joint_under(LOAD - 3.0e6, LOAD)
    print(f"relaxed by 3 of 5 MPa: K_I = {k1:.6g} Pa sqrt(m), volume {volume:.6g} m2")
    print(f"opened: K_I = {opened_joint():.6g} Pa sqrt(m)")


if __name__ == "__main__":
    main()
