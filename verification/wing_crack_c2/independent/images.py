"""Copies of the crack and of the outline of the body that stand for its symmetry and its rollers.

The crack is its own image under a turn by 180 degrees. So is a body with given tractions on all
sides. One that stands on rollers at the left and at the bottom is a quarter of a body of twice the
size, with four cracks: then the wings differ a little, and what acts on the crack is taken as the
mean of what acts on its two halves, half of each copy and half of that copy turned by 180 degrees.

Fluid that the body keeps in is that of a lattice of mirrored cracks. What is too far off to be felt
as a pressure is left out: its stress is even, without a change of volume, and the outline takes it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from .elastic import Complexes, Numbers

Supports = Literal["none", "tractions", "rollers"]


@dataclass(frozen=True)
class Copy:
    """What is at z acts also at factor z + shift (z conjugate where mirrored)."""

    factor: float = 1.0
    shift: complex = 0j
    mirrored: bool = False
    weight: float = 1.0

    def places(self, z: Complexes) -> Complexes:
        """Places of the copies."""
        return np.asarray(self.factor * (np.conj(z) if self.mirrored else z) + self.shift)

    def directions(self, angle: Numbers) -> Numbers:
        """Directions of the copies."""
        turned = -angle if self.mirrored else angle
        return np.asarray(turned + (np.pi if self.factor < 0.0 else 0.0))

    @property
    def slip_sign(self) -> float:
        """A mirror image slips the other way, and opens the same way."""
        return -1.0 if self.mirrored else 1.0

    def after(self, other: Copy) -> Copy:
        """The copy of a copy."""
        shift = self.places(np.array([other.shift]))[0]
        return Copy(
            self.factor * other.factor,
            complex(shift),
            self.mirrored != other.mirrored,
            self.weight * other.weight,
        )


ITSELF = Copy()
TURN = Copy(factor=-1.0)


@dataclass(frozen=True)
class Images:
    """Copies that act on the crack and on the outline; those of the crack on itself beyond TURN."""

    crack_on_crack: list[Copy]
    outline_on_crack: list[Copy]
    crack_on_outline: list[Copy]
    outline_on_outline: list[Copy]
    fluid_on_crack: list[Copy]
    fluid_on_outline: list[Copy]


def lattice(low: int, high: int, half_width: float) -> list[Copy]:
    """The crack mirrored again and again in the sides of a square, at places low..high each way."""
    copies = []
    for column in range(low, high + 1):
        for row in range(low, high + 1):
            shift = 2.0 * half_width * (column + 1j * row)
            factor = -1.0 if column % 2 else 1.0
            copy = Copy(factor, shift, mirrored=(column + row) % 2 == 1)
            copies += [copy, copy.after(TURN)]
    return copies


def beyond(copies: list[Copy]) -> list[Copy]:
    """Copies that are not the crack itself."""
    return [copy for copy in copies if copy.shift != 0.0]


def images(supports: Supports, half_width: float) -> Images:
    """Copies of a body that is supported in the given way."""
    both = [ITSELF, TURN]
    if supports == "none":
        return Images([], [], [], [], [], [])
    if supports == "tractions":
        fluid = lattice(-2, 2, half_width)
        return Images([], both, both, both, beyond(fluid), fluid)
    left = Copy(-1.0, -2.0 * half_width, True)
    bottom = Copy(1.0, -2.0j * half_width, True)
    mirrors = [left, bottom, left.after(bottom)]
    halves = [Copy(weight=0.5), Copy(factor=-1.0, weight=0.5)]
    mirrored_cracks = [mirror.after(own) for mirror in mirrors for own in both]
    bodies = [ITSELF, *mirrors]
    fluid = lattice(-3, 2, half_width)  # its own mirror image in the left and in the bottom
    return Images(
        [half.after(copy) for copy in mirrored_cracks for half in halves],
        [half.after(copy) for copy in bodies for half in halves],
        [*both, *mirrored_cracks],
        bodies,
        [half.after(copy) for copy in beyond(fluid) for half in halves],
        fluid,
    )
