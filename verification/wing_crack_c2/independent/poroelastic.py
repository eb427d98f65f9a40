"""Fluid sources and jumps of displacement in an infinite poroelastic plane, in closed form in time.

With T_ij = d_i d_j - delta_ij laplace, the heat kernel g(r, t) = exp(-u)/(4 pi c t), u = r^2/4ct,
and the potentials psi, chi with laplace psi = g, laplace chi = psi, Biot's equations give

    fluid V at t = 0:   p = V/S' g,            sigma_ij = A V T_ij psi
    jump D, normal n:   p = -A T_kl e_kl psi,  sigma_ij = drained elastic - B T_ij T_kl e_kl chi
    e_kl = (D_k n_l + n_k D_l)/2,  S' = S + alpha^2/(lambda + 2G),  c = (k/mu)/S'
    A = 2G alpha/((lambda + 2G) S'),  B = 2G alpha/(lambda + 2G) A = E'_u - E'

(a source moves the rock without rotation, and a jump is an eigenstrain: both leave u = elastic +
grad phi with (lambda + 2G) laplace phi = alpha p). Because d psi/dt = c g and d chi/dt = c psi, a
source of constant rate has p = (psi_t - psi_0)/(S' c), sigma_ij = A/c T_ij (chi_t - chi_0). Jumps
that are constant on a cell, and the tractions of sources along their own line, need no quadrature:
in all of them one derivative is along the cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import exp

import numpy as np
from numpy.polynomial.legendre import leggauss

from .elastic import Complexes, Numbers, turned

EULER = 0.57721566490153286
NEAR_NODES, NEAR_WEIGHTS = leggauss(8)
FAR_NODES, FAR_WEIGHTS = leggauss(2)


@dataclass(frozen=True)
class Rock:
    """Poroelastic rock in plane strain and its fluid, in SI units."""

    young: float
    poisson: float
    biot: float
    porosity: float
    permeability: float
    compressibility: float
    viscosity: float

    @cached_property
    def shear(self) -> float:
        """G [Pa]."""
        return self.young / (2.0 * (1.0 + self.poisson))

    @cached_property
    def oedometric(self) -> float:
        """The oedometric modulus lambda + 2G [Pa]."""
        return 2.0 * self.shear * (1.0 - self.poisson) / (1.0 - 2.0 * self.poisson)

    @cached_property
    def modulus(self) -> float:
        """E' = E/(1 - nu^2), drained [Pa]."""
        return self.young / (1.0 - self.poisson**2)

    @cached_property
    def storage(self) -> float:
        """S of model.md, section 2 [1/Pa]."""
        bulk = self.young / (3.0 * (1.0 - 2.0 * self.poisson))
        return self.porosity * self.compressibility + (self.biot - self.porosity) / bulk

    @cached_property
    def uniaxial_storage(self) -> float:
        """S' = S + alpha^2/(lambda + 2G) [1/Pa]."""
        return self.storage + self.biot**2 / self.oedometric

    @cached_property
    def mobility(self) -> float:
        """Permeability over viscosity [m2/(Pa s)]."""
        return self.permeability / self.viscosity

    @cached_property
    def diffusivity(self) -> float:
        """Coefficient c of the diffusion of fluid content [m2/s]."""
        return self.mobility / self.uniaxial_storage

    @cached_property
    def pressing(self) -> float:
        """A: pressure per jump over length, stress per fluid over area [Pa]."""
        return 2.0 * self.shear * self.biot / (self.oedometric * self.uniaxial_storage)

    @cached_property
    def stiffening(self) -> float:
        """B = E'_u - E' [Pa]."""
        return 2.0 * self.shear * self.biot / self.oedometric * self.pressing

    def undrained_pressure(self, stress_xx: float, stress_yy: float) -> float:
        """Pressure of the rock loaded in plane strain without flow [Pa]."""
        lame = self.oedometric - 2.0 * self.shear
        return (
            -(stress_xx + stress_yy)
            / 2.0
            / ((lame + self.shear) * self.storage / self.biot + self.biot)
        )


def exponential_integral(u: Numbers) -> Numbers:
    """E1(u), u > 0, to 2e-7 of 1: Abramowitz, Stegun 5.1.53 and 5.1.56."""
    small = u <= 1.0
    result = np.zeros_like(u)
    v = u[small]
    series = -0.57721566 + v * (
        0.99999193 + v * (-0.24991055 + v * (0.05519968 + v * (-0.00976004 + v * 0.00107857)))
    )
    result[small] = series - np.log(v)
    rest = ~small & (u < 600.0)
    v = u[rest]
    over = 0.2677737343 + v * (8.6347608925 + v * (18.0590169730 + v * (8.5733287401 + v)))
    under = 3.9584969228 + v * (21.0996530827 + v * (25.6329561486 + v * (9.5733223454 + v)))
    result[rest] = np.exp(-v) * over / (under * v)
    return result


def decay(u: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Values e = 1 - exp(-u), 1 - e/u and e - 2 (1 - e/u), without loss of digits at small u."""
    gone = -np.expm1(-u)
    small = u < 1e-2
    safe = np.where(small, 1.0, u)
    one_less = np.where(small, u / 2.0 - u**2 / 6.0 + u**3 / 24.0, 1.0 - gone / safe)
    series = -(u**2) / 6.0 + u**3 / 12.0 - u**4 / 40.0
    return gone, one_less, np.where(small, series, gone - 2.0 * one_less)


def logarithm_integral(x: Numbers, y: Numbers) -> Numbers:
    """Antiderivative of ln sqrt(x^2 + y^2) in x."""
    square = x * x + y * y
    result = 0.5 * x * np.log(np.where(square > 0.0, square, 1.0)) - x
    return np.asarray(result + np.abs(y) * np.arctan2(x, np.abs(y)))


class Pairs:
    """Where a set of points lies in the axes of a set of elements (cells), and what these do there.

    All results are [point, cell]. Tractions are those on a line of direction `point_angle`.
    """

    def __init__(
        self,
        rock: Rock,
        point: Complexes,
        point_angle: Numbers,
        centre: Complexes,
        angle: Numbers,
        half: Numbers,
    ) -> None:
        self.rock = rock
        local = (point[:, None] - centre[None, :]) * np.exp(-1j * angle)[None, :]
        self.turn = point_angle[:, None] - angle[None, :]
        self.y = np.where(np.abs(local.imag) < 1e-12, 0.0, local.imag)
        self.ends = (local.real + half[None, :], local.real - half[None, :])
        self.half = np.broadcast_to(half[None, :], self.y.shape)
        self.squares = [np.maximum(x * x + self.y**2, 1e-24) for x in self.ends]
        far = bool(np.abs(local).min() > 5.0 * half.max()) if local.size else True
        nodes, self.weights = (FAR_NODES, FAR_WEIGHTS) if far else (NEAR_NODES, NEAR_WEIGHTS)
        along = local.real[..., None] - self.half[..., None] * nodes
        self.inner = along**2 + self.y[..., None] ** 2
        self.logarithm = logarithm_integral(self.ends[0], self.y) - logarithm_integral(
            self.ends[1], self.y
        )

    def jump(self, lag: float) -> Numbers:
        """Effects of a unit jump a time `lag` ago, beyond those of drained elasticity.

        Returns
        -------
        [jump: normal, slip; effect: pressure, normal traction, shear traction; point, cell]
        """
        rock = self.rock
        result = np.zeros((2, 3, *self.y.shape))
        y = self.y
        for sign, x, square in zip((1.0, -1.0), self.ends, self.squares, strict=True):
            u = square / (4.0 * rock.diffusivity * lag)
            gone, one_less, third = decay(u)
            psi = gone / (2.0 * np.pi * square)  # of d_i psi = psi x_i
            f2 = one_less / (4.0 * np.pi * square)
            f3 = third / (2.0 * np.pi * square**2)
            xxx = x * (3.0 * f2 + f3 * x * x)
            xxy = y * (f2 + f3 * x * x)
            xyy = x * (f2 + f3 * y * y)
            yyy = y * (3.0 * f2 + f3 * y * y)
            result[0, 0] += sign * rock.pressing * psi * x
            result[1, 0] -= sign * rock.pressing * psi * y
            for jump, stresses in enumerate(((-xyy, -xxx, xxy), (yyy, xxy, -xyy))):
                normal, shear = turned(*stresses, self.turn)
                result[jump, 1] += sign * rock.stiffening * normal
                result[jump, 2] += sign * rock.stiffening * shear
        return result

    def elastic(self) -> Numbers:
        """Tractions of unit jumps for E' = 1: [jump, traction, point, cell].

        What is undrained beyond what is drained is elastic: B in the place of E'.
        """
        return self.jump(1e-9)[:, 1:3] / self.rock.stiffening

    def source(self, lag: float) -> Numbers:
        """Effects of a unit rate of fluid per length since a time `lag` ago.

        Returns
        -------
        [effect: pressure, normal traction, shear traction; point, cell]
        """
        rock = self.rock
        reach = 4.0 * rock.diffusivity * lag
        # int E1 ds = int (E1 + ln u) ds - int ln u ds; the first is smooth on the scale of `reach`
        u = self.inner / reach
        inner = exponential_integral(u)
        smooth = (inner + np.log(np.maximum(u, 1e-300))) @ self.weights
        plain = inner @ self.weights
        near = self.inner.min(axis=-1) < (2.0 * self.half) ** 2
        logarithm = 2.0 * self.logarithm - 2.0 * self.half * np.log(reach)
        whole = np.where(near, self.half * smooth - logarithm, self.half * plain)
        difference = whole / (4.0 * np.pi)  # int (psi_t - psi_0) ds
        x_part = np.zeros_like(self.y)
        y_part = np.zeros_like(self.y)
        ends = [exponential_integral(square / reach) for square in self.squares]
        for sign, x, square, e1 in zip((1.0, -1.0), self.ends, self.squares, ends, strict=True):
            _, one_less, _ = decay(square / reach)
            # of d_i (chi_t - chi_0) = factor x_i
            factor = (e1 + 1.0 - one_less) / (8.0 * np.pi)
            x_part += sign * factor * x
            y_part += sign * factor * self.y
        scale = rock.pressing / rock.diffusivity
        normal, shear = turned(x_part - difference, -x_part, y_part, self.turn)
        return np.stack([difference / rock.mobility, scale * normal, scale * shear])


def point_source(rock: Rock, distance: float, time: float) -> tuple[float, float, float]:
    """Pressure, radial and tangential stress of a line source of unit rate, for tests."""
    u = distance**2 / (4.0 * rock.diffusivity * time)
    e1 = float(exponential_integral(np.array([u]))[0])
    strength = 1.0 / (4.0 * np.pi * rock.mobility)
    stretch = rock.biot * strength / (2.0 * rock.oedometric) * (e1 + (1.0 - exp(-u)) / u)
    pressure = strength * e1
    radial = -2.0 * rock.shear * stretch
    tangential = -2.0 * rock.shear * (rock.biot * pressure / rock.oedometric - stretch)
    return pressure, radial, tangential
