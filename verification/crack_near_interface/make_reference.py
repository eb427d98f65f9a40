"""Pressurized crack beside the interface of two rocks: dislocations, apart from the program.

`python make_reference.py` writes reference.csv. The stress of an edge dislocation in a plane of two
bonded rocks follows from Muskhelishvili's potentials (Suo 1989): with Phi0, Omega0 of a dislocation
in one rock, the rock that holds it has Phi0 + P conj(Omega0), Omega0 + L conj(Phi0); conj(F)(z)
is the conjugate of F at the conjugate of z, P = (mu2 - mu1)/(kappa1 mu2 + mu1) and
L = (kappa1 mu2 - kappa2 mu1)/(mu2 + kappa2 mu1). The crack is a distribution of dislocations with
square roots at both ends, found by Gauss-Chebyshev collocation. Plane strain; the pressure and the
half-length of the crack are 1, the interface is the line y = 0, and the crack is above it.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import numpy.typing as npt

Complex = npt.NDArray[np.complex128]
Array = npt.NDArray[np.float64]


class Plane:
    """Two rocks: that of the crack, above, and the one below."""

    def __init__(self, ratio: float, poisson: tuple[float, float]) -> None:
        """Take Young's modulus below over that above, and both Poisson's ratios."""
        shear = (0.5 / (1.0 + poisson[0]), 0.5 * ratio / (1.0 + poisson[1]))
        kappa = (3.0 - 4.0 * poisson[0], 3.0 - 4.0 * poisson[1])
        self.factor = shear[0] / (np.pi * (kappa[0] + 1.0))
        self.upper = (shear[1] - shear[0]) / (kappa[0] * shear[1] + shear[0])
        self.lower = (kappa[0] * shear[1] - kappa[1] * shear[0]) / (shear[1] + kappa[1] * shear[0])

    def stress(self, z: Complex, s: Complex, burgers: complex) -> tuple[Array, Array, Array]:
        """Return xx, yy, xy at z, above, of dislocations at s, above, with bx + i by."""
        b = self.factor * burgers / 1j
        c = np.conj(b)
        phi = b / (z - s)
        slope = -b / (z - s) ** 2
        omega = c / (z - s) - b * (s - np.conj(s)) / (z - s) ** 2
        # The images: of Omega0, b/(z - s') - c (s' - s)/(z - s')^2; of Phi0, c/(z - s').
        t = np.conj(s)
        phi = phi + self.upper * (b / (z - t) - c * (t - s) / (z - t) ** 2)
        slope = slope + self.upper * (-b / (z - t) ** 2 + 2.0 * c * (t - s) / (z - t) ** 3)
        omega = omega + self.lower * c / (z - t)
        traction = phi + np.conj(omega) + (z - np.conj(z)) * np.conj(slope)  # yy - i xy
        return 4.0 * phi.real - traction.real, traction.real, -traction.imag


def intensities(
    plane: Plane, middle: complex, way: complex, points: int
) -> list[tuple[float, float]]:
    """K_I and K_II over p sqrt(pi a) at the start and at the end of a crack along a unit vector."""
    n = points
    nodes = np.cos((2 * np.arange(1, n + 1) - 1) * np.pi / (2 * n))
    places = np.cos(np.arange(1, n) * np.pi / n)
    z = (middle + way * places)[:, None] + np.zeros((1, n))
    s = (middle + way * nodes)[None, :] + np.zeros((n - 1, 1))
    matrix, right = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    normal = way * 1j
    for part, burgers in enumerate((normal, way)):  # opening, slip
        xx, yy, xy = plane.stress(z, s, burgers)
        tx, ty = xx * normal.real + xy * normal.imag, xy * normal.real + yy * normal.imag
        columns = slice(part * n, part * n + n)
        matrix[: n - 1, columns] = (tx * normal.real + ty * normal.imag) * np.pi / n
        matrix[n : 2 * n - 1, columns] = (tx * way.real + ty * way.imag) * np.pi / n
        matrix[(part + 1) * n - 1, columns] = np.pi / n  # the crack closes at its ends
    right[: n - 1] = -1.0
    density = np.linalg.solve(matrix, right)
    result = []
    for end in (-1.0, 1.0):
        values = [
            float(
                np.polynomial.chebyshev.chebval(
                    end, np.polynomial.chebyshev.chebfit(nodes, density[k * n : k * n + n], n - 1)
                )
            )
            for k in (0, 1)
        ]
        result.append(
            (
                2.0 * np.pi * plane.factor * values[0] * end,
                2.0 * np.pi * plane.factor * values[1] * end,
            )
        )
    return result


def main() -> None:
    """Write the table."""
    rows = []
    for ratio in (1.0, 1.0 / 3.0, 3.0):
        for name, middle, way in (("parallel", 0.5j, 1.0 + 0j), ("perpendicular", 1.5j, 1j)):
            fine = intensities(Plane(ratio, (0.2, 0.3)), middle, way, 400)
            coarse = intensities(Plane(ratio, (0.2, 0.3)), middle, way, 200)
            change = max(
                abs(a - b)
                for p, q in zip(fine, coarse, strict=True)
                for a, b in zip(p, q, strict=True)
            )
            for tip, (k1, k2) in enumerate(fine, start=1):
                rows.append([f"{ratio:.6f}", name, tip, f"{k1:.8f}", f"{k2:.8f}"])
            print(f"{ratio:.4f} {name} {fine} halving the points changes {change:.1e}")
    with (Path(__file__).parent / "reference.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(
            ["young_ratio", "crack", "tip", "k1_over_p_sqrt_pi_a", "k2_over_p_sqrt_pi_a"]
        )
        table.writerows(rows)


if __name__ == "__main__":
    main()
