"""Self-similar growth without leak-off and lag, at any dimensionless toughness.

    .venv/bin/python verification/kgd/self_similar.py

Writes self_similar.csv: half-length gamma L, opening Omega eps L and pressure Pi eps E' at the
centre, with eps = (mu'/(E' t))^(1/3) and L = (E' Q^3 t^4/mu')^(1/6), depend on K_m alone. With xi =
x/l and one for E', mu', Q and t,

    Omega(xi) = 4 gamma/pi int_0^1 G(xi, eta) Pi(eta) d eta
    -Omega^3 dPi/dxi = gamma^2 (int_xi^1 Omega d eta + 2/3 xi Omega)
    2 gamma int_0^1 Omega d eta = 1,   K_m = 8 sqrt(2 gamma)/pi int_0^1 Pi/sqrt(1 - eta^2) d eta

with G = ln |(a + b)/(a - b)|, a = sqrt(1 - xi^2), b = sqrt(1 - eta^2). The pressure is linear in
eta between nodes that are dense toward the tip, which makes all integrals of it exact, and beyond
the last one it is linear in the logarithm of the distance. The values of two meshes are
extrapolated.
They are compared with those of the catalogue (5.1, 5.2) and with the closed form for toughness
alone.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

NEAREST = 3.0e-7  # distance of the last node from the tip [half-lengths]
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)


class Crack:
    """Nodes from the tip to the centre, and what acts on them."""

    def __init__(self, nodes: int) -> None:
        """Place three quarters of the nodes near the tip, evenly in the logarithm."""
        near = int(0.75 * nodes)
        self.s = np.concatenate(
            [
                np.geomspace(NEAREST, 0.3, near, endpoint=False),
                np.linspace(0.3, 1.0, nodes - near + 1),
            ]
        )
        self.log_s = np.log(self.s)
        self.opening = self._opening_matrix()
        self.toughness = self._toughness_weights()

    def _add_linear(self, zeroth: FloatArray, first: FloatArray) -> FloatArray:
        """Weights of the nodes, from antiderivatives of a kernel and of eta times it."""
        step = np.diff(self.s)
        outer, inner = 1.0 - self.s[:-1], 1.0 - self.s[1:]
        zero = zeroth[..., :-1] - zeroth[..., 1:]
        one = first[..., :-1] - first[..., 1:]
        weights = np.zeros_like(zeroth)
        weights[..., :-1] += (one - inner * zero) / step
        weights[..., 1:] += (outer * zero - one) / step
        return weights

    def _add_tail(self, weights: FloatArray, tail: FloatArray) -> None:
        """Mean pressure between the last node and the tip, with the weight 1/sqrt(s)."""
        share = 2.0 / math.log(self.s[1] / self.s[0])
        weights[..., 0] += tail * (1.0 + share)
        weights[..., 1] -= tail * share

    def _opening_matrix(self) -> FloatArray:
        """Give the openings over gamma by the pressures."""
        s_xi, s_eta = self.s[:, None], np.append(0.0, self.s)[None, :]
        xi, eta = np.maximum(1.0 - s_xi, 1e-30), 1.0 - s_eta
        a, b = np.sqrt(s_xi * (2.0 - s_xi)), np.sqrt(s_eta * (2.0 - s_eta))
        gap = (s_xi - s_eta) * (2.0 - s_xi - s_eta)  # eta^2 - xi^2
        gap = np.where(np.abs(gap) < 1e-60, 1e-60, gap)
        kernel = np.log((a + b) ** 2 / np.abs(gap))
        zeroth = (
            eta * kernel
            + 2.0 * a * np.arcsin(eta)
            - xi * np.log((a * eta + xi * b) ** 2 / np.abs(gap))
        )
        first = 0.5 * gap * kernel - a * b
        weights = self._add_linear(zeroth[:, 1:], first[:, 1:])
        self._add_tail(weights, zeroth[:, 0] - zeroth[:, 1])
        return 4.0 / math.pi * weights

    def _toughness_weights(self) -> FloatArray:
        """Give K_m over sqrt(gamma) by the pressures."""
        zeroth = math.pi / 2.0 - 2.0 * np.arcsin(np.sqrt(self.s / 2.0))
        weights = self._add_linear(zeroth, -np.sqrt(self.s * (2.0 - self.s)))
        self._add_tail(weights, np.asarray(math.pi / 2.0 - zeroth[0]))
        return 8.0 * math.sqrt(2.0) / math.pi * weights

    def residual(self, unknowns: FloatArray, toughness: float) -> FloatArray:
        """Misfit for the pressures at the nodes and the logarithm of gamma."""
        pressure, gamma = unknowns[:-1], math.exp(unknowns[-1])
        opening = np.maximum(gamma * (self.opening @ pressure), 1e-14)
        # The opening is a power of the distance between two nodes.
        steps = np.diff(self.log_s)
        power = np.diff(np.log(opening)) / steps
        ratio = np.exp(steps)
        parts = opening[:-1] * self.s[:-1] * (ratio ** (power + 1.0) - 1.0) / (power + 1.0)
        volume = np.cumsum(np.append(opening[0] * self.s[0] / 1.5, parts))
        x = np.exp(0.5 * steps[:, None] * (1.0 + POINTS[None, :]))
        s = self.s[:-1, None] * x
        w = opening[:-1, None] * x ** power[:, None]
        v = (
            volume[:-1, None]
            + opening[:-1, None]
            * self.s[:-1, None]
            * (x ** (power + 1.0)[:, None] - 1.0)
            / (power + 1.0)[:, None]
        )
        slope = gamma**2 * (v + 2.0 / 3.0 * (1.0 - s) * w) / w**3
        rise = 0.5 * steps * ((slope * s) @ WEIGHTS)
        return np.concatenate(
            [
                (np.diff(pressure) - rise) / np.maximum(1.0, np.abs(rise)),
                [2.0 * gamma * volume[-1] - 1.0],
                [math.sqrt(gamma) * float(self.toughness @ pressure) - toughness],
            ]
        )

    def solve(self, toughness: float, guess: FloatArray) -> FloatArray:
        """Damped Newton iterations with derivatives by differences."""
        unknowns, misfit = guess, self.residual(guess, toughness)
        for _ in range(60):
            if np.linalg.norm(misfit) < 1e-8:
                return unknowns
            columns = []
            for j in range(unknowns.size):
                shifted = unknowns.copy()
                shifted[j] += 1e-6 * max(1.0, abs(unknowns[j]))
                change = self.residual(shifted, toughness) - misfit
                columns.append(change / (shifted[j] - unknowns[j]))
            step = np.linalg.solve(np.column_stack(columns), -misfit)
            for share in 0.5 ** np.arange(20):
                tried = unknowns + share * step
                new = self.residual(tried, toughness)
                is_open = np.all(self.opening @ tried[:-1] > 0.0)
                if is_open and np.linalg.norm(new) < np.linalg.norm(misfit):
                    break
            unknowns, misfit = tried, new
        raise RuntimeError(f"K_m = {toughness}: misfit {np.linalg.norm(misfit)}")


def solutions(toughnesses: list[float], nodes: int) -> FloatArray:
    """Give gamma, Omega(0) and Pi(0) at falling K_m, each of them the guess of the next."""
    crack = Crack(nodes)
    gamma = 2.0 / (math.pi * toughnesses[0]) ** (2.0 / 3.0)
    shape = 1.0 + 0.05 * np.log(np.maximum(crack.s, 1e-6))
    scale = toughnesses[0] / (math.sqrt(gamma) * float(crack.toughness @ shape))
    unknowns = np.append(scale * shape, math.log(gamma))
    rows = []
    for toughness in toughnesses:
        unknowns = crack.solve(toughness, unknowns)
        gamma = math.exp(unknowns[-1])
        rows.append([gamma, gamma * float(crack.opening[-1] @ unknowns[:-1]), unknowns[-2]])
    return np.array(rows)


def main() -> None:
    """Write the table and compare it with what is known."""
    toughnesses = [8.0, 4.0, 2.0, 1.0, 0.7, 0.5, 0.3, 0.2]
    coarse, fine = solutions(toughnesses, 60), solutions(toughnesses, 120)
    values = (4.0 * fine - coarse) / 3.0
    gamma = 2.0 / (8.0 * math.pi) ** (2.0 / 3.0)
    pressure = 8.0 / math.sqrt(32.0 * gamma)
    known = {
        8.0: [gamma, 4.0 * gamma * pressure, pressure],  # no viscosity
        4.0: [0.3660035934, 1.746117999, 1.204788485],
        2.0: [0.5239673259, 1.255263919, 0.6477506659],
        1.0: [0.5992540886, 1.141553244, 0.5558339183],
        0.2: [0.6154113040, 1.1258345924, 0.5448170788],  # no toughness
    }
    for toughness, row in zip(toughnesses, values, strict=True):
        if toughness in known:
            print(f"K_m = {toughness}, relative to the known values:", row / known[toughness] - 1.0)
    with (Path(__file__).parent / "self_similar.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["k_m", "gamma", "omega", "pi"])
        for toughness, row in zip(toughnesses, values, strict=True):
            table.writerow([f"{value:.6g}" for value in (toughness, *row)])


if __name__ == "__main__":
    main()
