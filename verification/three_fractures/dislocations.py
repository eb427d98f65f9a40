"""Slip that drives wings of scene B5, by dislocations: a second method, apart from the program.

Two straight wings, vertical, from the ends of a fracture of 1 m with a uniform slip, upwards on the
left and downwards on the right, in an infinite plane; the neighbours are closed and glide without
friction. Wings and neighbours are continuous distributions of edge dislocations (Hills, Kelly, Dai
and Korsunsky 1996, Solution of Crack Problems): the slip enters each wing as its net Burgers
vector. Gauss-Chebyshev collocation, square roots at both ends. Writes dislocations.csv.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

YOUNG, POISSON, TOUGHNESS = 70.0e9, 0.21, 1.5e6  # [Pa], [-], [Pa m^1/2]
PRESSURE = 7.040848e6  # horizontal stress in situ on the wings, compressive [Pa]
MODULUS = YOUNG / (1.0 - POISSON**2)  # plane strain [Pa]
FACTOR = YOUNG / (4.0 * np.pi * (1.0 - POISSON**2))  # G/(2 pi (1 - nu)) [Pa]
POINTS = 160

# Start, unit vector, and components of the Burgers vector of wings (2) and neighbours (2).
LINES = (
    ((-0.5, 0.0), (0.0, 1.0), "xy"),
    ((0.5, 0.0), (0.0, -1.0), "xy"),
    ((-1.0, 1.0), (1.0, 0.0), "x"),
    ((0.0, -1.0), (1.0, 0.0), "x"),
)


def stresses(dx: Array, dy: Array, component: str) -> tuple[Array, Array]:
    """Return sigma_xx and sigma_xy of a unit dislocation, per metre of Burgers vector [Pa/m]."""
    fourth = (dx**2 + dy**2) ** 2
    if component == "x":
        return -FACTOR * dy * (3 * dx**2 + dy**2) / fourth, FACTOR * dx * (dx**2 - dy**2) / fourth
    return FACTOR * dx * (dx**2 - dy**2) / fourth, FACTOR * dy * (dx**2 - dy**2) / fourth


def opening_intensity(length: float, slip: float, pressure: float, lines: int) -> float:
    """K_I of the left wing [Pa m^1/2] for wings of a length [m], a slip [m] and a pressure [Pa]."""
    n = POINTS
    nodes = np.cos((2 * np.arange(1, n + 1) - 1) * np.pi / (2 * n))
    places = np.cos(np.arange(1, n) * np.pi / n)
    unknowns = [(k, part) for k in range(lines) for part in LINES[k][2]]
    lengths = [length, length, 1.0, 1.0]
    matrix, right = np.zeros((n * len(unknowns),) * 2), np.zeros(n * len(unknowns))
    for i, (k, part) in enumerate(unknowns):
        start, way = np.array(LINES[k][0]), np.array(LINES[k][1])
        at = start + np.outer((1 + places) * lengths[k] / 2, way)
        rows = slice(i * n, i * n + n - 1)
        for j, (other, component) in enumerate(unknowns):
            start, way = np.array(LINES[other][0]), np.array(LINES[other][1])
            source = start + np.outer((1 + nodes) * lengths[other] / 2, way)
            dx, dy = (at[:, None, axis] - source[None, :, axis] for axis in (0, 1))
            opening, shear = stresses(dx, dy, component)
            is_opening = k < 2 and part == "x"
            matrix[rows, j * n : (j + 1) * n] = (opening if is_opening else shear) * np.pi / n
        if k < 2 and part == "x":
            right[rows] = pressure
            right[i * n + n - 1] = -slip if k == 0 else slip
        matrix[i * n + n - 1, i * n : (i + 1) * n] = np.pi / n
    scale = np.abs(matrix).max(axis=1)
    density = np.linalg.solve(matrix / scale[:, None], right / scale)[:n]
    series = np.polynomial.chebyshev.chebfit(nodes, density, n - 1)
    end = float(np.polynomial.chebyshev.chebval(1.0, series))
    return float(-MODULUS * np.sqrt(np.pi / 8.0) * end / np.sqrt(length))


def main() -> None:
    """Write the slip at K_I = K_IC against the wings' length."""
    rows = ["length_m,slip_free_mm,slip_free_alone_mm,slip_in_situ_mm,slip_in_situ_alone_mm"]
    for length in np.arange(0.05, 0.951, 0.05):
        found = []
        for pressure in (0.0, PRESSURE):
            for lines in (4, 2):
                per_slip = opening_intensity(length, 1.0, 0.0, lines)
                closing = opening_intensity(length, 0.0, pressure, lines)
                found.append(1.0e3 * (TOUGHNESS - closing) / per_slip)
        rows.append(f"{length:.2f}," + ",".join(f"{value:.6f}" for value in found))
    Path("dislocations.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
