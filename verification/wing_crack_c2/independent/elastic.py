"""Tractions of straight elements whose faces are displaced against each other, in closed form.

An element lies along its own x axis; its jump D = (normal, slip) is that of the upper face (y > 0)
against the lower one, opening and left-lateral slip positive. With the potential

    Z(z) = E'/(4 pi) int D(s)/(s - z)^2 ds

the stresses are those of Westergaard: normal jump (Re Z - y Im Z', Re Z + y Im Z', -y Re Z'), slip
(2 Im Z + y Re Z', -y Re Z', Re Z - y Im Z') for (xx, yy, xy). Stresses are positive in tension.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from numpy.polynomial.legendre import leggauss

Numbers: TypeAlias = npt.NDArray[np.float64]
Complexes: TypeAlias = npt.NDArray[np.complex128]

POINTS = 4  # collocation points and shape functions of an element
NODES, WEIGHTS = leggauss(POINTS)
# Beyond this distance, in half-lengths, quadrature is exact to round-off and recursion is not.
FAR = 6.0
FAR_NODES, FAR_WEIGHTS = leggauss(12)
# Lagrange polynomials of the collocation points, as coefficients of powers: [power, function]
LAGRANGE: Numbers = np.asarray(
    np.linalg.inv(np.vander(NODES, POINTS, increasing=True)), dtype=np.float64
)


@dataclass(frozen=True)
class Elements:
    """Straight elements; `tip` says which end in a free tip at their far end."""

    centre: Complexes  # [m]
    angle: Numbers  # direction of the x axis [rad]
    half: Numbers  # half-length [m]
    tip: npt.NDArray[np.bool_]

    @property
    def points(self) -> Complexes:
        """Collocation points, element by element [m]."""
        along = self.half[:, None] * NODES * np.exp(1j * self.angle)[:, None]
        return np.asarray(self.centre[:, None] + along).ravel()

    @property
    def point_angles(self) -> Numbers:
        """Direction of the element of each collocation point [rad]."""
        return np.repeat(self.angle, POINTS)


def shapes(at: Numbers, tip: bool) -> Numbers:
    """Shape functions at places in -1..1: [place, function]; at a tip r^(1/2), r^(3/2), r^(5/2)."""
    if tip:
        reach = 1.0 - at
        return np.stack([reach ** (k + 0.5) for k in range(POINTS)], axis=-1)
    return np.asarray(np.vander(at, POINTS, increasing=True) @ LAGRANGE)


def shape_means(tip: bool) -> Numbers:
    """Means of the shape functions over an element."""
    if tip:
        return np.array([2.0 ** (k + 1.5) / (k + 1.5) / 2.0 for k in range(POINTS)])
    return np.asarray(WEIGHTS @ shapes(NODES, False)) / 2.0


def polynomial_integrals(at: Complexes) -> tuple[Complexes, Complexes]:
    """Integrals of xi^k/(xi - at)^2 over -1..1, and their derivatives."""
    value = np.log((at - 1.0) / (at + 1.0))
    first = 1.0 / (at - 1.0) - 1.0 / (at + 1.0)
    second = 1.0 / (at + 1.0) ** 2 - 1.0 / (at - 1.0) ** 2
    firsts, seconds = [first], [second]
    for k in range(1, POINTS):
        second = 2.0 * first + at * second
        first = value + at * first
        value = at * value + (2.0 / k if k % 2 == 1 else 0.0)
        firsts.append(first)
        seconds.append(second)
    return np.stack(firsts, axis=-1) @ LAGRANGE, np.stack(seconds, axis=-1) @ LAGRANGE


def root_integrals(at: Complexes) -> tuple[Complexes, Complexes]:
    """Integrals of r^(k + 1/2)/(xi - at)^2 with r = 1 - xi over -1..1, and their derivatives."""
    w = 1.0 - at
    root = np.sqrt(w)
    side = np.sqrt(2.0)
    logarithm = np.log((root - side) / (root + side))
    value = 2.0 * side + root * logarithm
    first = logarithm / (2.0 * root) - side / (2.0 - w)
    second = -logarithm / (4.0 * w * root) - side / (2.0 * w * (2.0 - w)) - side / (2.0 - w) ** 2
    firsts, seconds = [first], [second]
    for k in range(1, POINTS):
        second = 2.0 * first + w * second
        first = value + w * first
        value = w * value + 2.0 ** (k + 0.5) / (k + 0.5)
        firsts.append(first)
        seconds.append(second)
    return np.stack(firsts, axis=-1), -np.stack(seconds, axis=-1)


def integrals(at: Complexes, tip: bool) -> tuple[Complexes, Complexes]:
    """Integrals of shape functions over (xi - at)^2, and derivatives: [place, function]."""
    first = np.empty((at.size, POINTS), dtype=np.complex128)
    second = np.empty_like(first)
    far = np.abs(at) > FAR
    near = ~far
    first[near], second[near] = root_integrals(at[near]) if tip else polynomial_integrals(at[near])
    if np.any(far):
        if tip:  # xi = 1 - 2 v^2 makes the roots powers of v
            v = (FAR_NODES + 1.0) / 2.0
            xi, weight = 1.0 - 2.0 * v**2, 2.0 * v * FAR_WEIGHTS
        else:
            xi, weight = FAR_NODES, FAR_WEIGHTS
        density = weight[:, None] * shapes(xi, tip)
        inverse = 1.0 / (xi - at[far][:, None])
        first[far] = inverse**2 @ density
        second[far] = 2.0 * inverse**3 @ density
    return first, second


def turned(xx: Numbers, yy: Numbers, xy: Numbers, turn: Numbers) -> tuple[Numbers, Numbers]:
    """Normal and shear traction on a line turned by `turn` from the axes of the stresses."""
    mean, half = (xx + yy) / 2.0, (xx - yy) / 2.0
    cosine, sine = np.cos(2.0 * turn), np.sin(2.0 * turn)
    return mean - half * cosine - xy * sine, xy * cosine - half * sine


def influence(elements: Elements, points: Complexes, angles: Numbers, modulus: float) -> Numbers:
    """Tractions at points from unit shape functions.

    Returns
    -------
    [traction, point, jump, shape function of element]: 0 normal, 1 shear [Pa/m]
    """
    count = elements.half.size
    result = np.empty((2, points.size, 2, count * POINTS))
    for element in range(count):
        half = elements.half[element]
        at = (points - elements.centre[element]) * np.exp(-1j * elements.angle[element]) / half
        on_line = np.abs(at.imag) < 1e-12
        at = np.where(on_line, at.real + 0.0j, at)
        first, second = integrals(at, bool(elements.tip[element]))
        z = modulus / (4.0 * np.pi * half) * first
        dz = modulus / (4.0 * np.pi * half) * second * at.imag[:, None]  # y Z'
        turn = (angles - elements.angle[element])[:, None]
        columns = slice(element * POINTS, (element + 1) * POINTS)
        opening = turned(z.real - dz.imag, z.real + dz.imag, -dz.real, turn)
        slip = turned(2.0 * z.imag + dz.real, -dz.real, z.real - dz.imag, turn)
        for traction in range(2):
            result[traction, :, 0, columns] = opening[traction]
            result[traction, :, 1, columns] = slip[traction]
    return result


def symmetric_influence(elements: Elements, modulus: float) -> Numbers:
    """Influence on their own points of elements and of their images turned by 180 degrees."""
    points, angles = elements.points, elements.point_angles
    image = Elements(-elements.centre, elements.angle + np.pi, elements.half, elements.tip)
    own = influence(elements, points, angles, modulus)
    return own + influence(image, points, angles, modulus)


def intensity(coefficient: float, half: float, modulus: float) -> float:
    """K from the coefficient of r^(1/2) of a tip element of half-length `half`."""
    return float(modulus * coefficient / 8.0 * np.sqrt(2.0 * np.pi / half))


def equivalent_intensity(k1: float, k2: float) -> tuple[float, float]:
    """K_eq of the largest hoop stress and its direction [rad] (Erdogan, Sih 1963)."""
    whole = k1 + np.sqrt(k1 * k1 + 8.0 * k2 * k2)
    angle = 2.0 * np.arctan2(-2.0 * k2, whole)
    cosine = np.cos(angle / 2.0)
    return float(k1 * cosine**3 - 1.5 * k2 * cosine * np.sin(angle)), float(angle)
