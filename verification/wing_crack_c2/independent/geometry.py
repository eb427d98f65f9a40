"""Cells and elements of the crack and of the outline of the body."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from .elastic import POINTS, Complexes, Elements, Numbers, shape_means


@dataclass(frozen=True)
class Resolution:
    """Sizes of the discretization."""

    fracture_cells: int = 8  # of half the fracture
    levels: int = 9  # elements on each side of the kink, each smaller by `ratio`
    ratio: float = 2.5
    tip_elements: int = 3  # in the piece at the tip
    piece_elements: int = 1  # in other pieces
    first_piece: float = 1.0e-3  # [m]
    largest_piece: float = 10.0e-3  # [m]
    piece_growth: float = 1.25
    first_step: float = 1.0  # [s]
    step_growth: float = 1.3
    side_cells: int = 10  # on a side of the body


@dataclass(frozen=True)
class Geometry:
    """Half of the crack, from its middle on, and half of the outline.

    Cells carry fluid and what has happened; elements, parts of the crack's cells, carry jumps. The
    numbers of outline cells come first.
    """

    centre: Complexes  # of cells [m]
    angle: Numbers  # of cells [rad]
    half: Numbers  # half-lengths of cells [m]
    outline_cells: int
    fracture_cells: int
    elements: Elements
    cell_of_element: npt.NDArray[np.int_]

    @property
    def wing(self) -> float:
        """Length of the wing [m]."""
        return float(2.0 * self.half[self.outline_cells + self.fracture_cells :].sum())

    def averages(self) -> Numbers:
        """Means over cells of the jumps: [cell, function].

        Functions are the constants on outline cells, then the shape functions of the elements.
        """
        elements, outer = self.elements, self.outline_cells
        result = np.zeros((self.half.size, outer + elements.half.size * POINTS))
        result[:outer, :outer] = np.eye(outer)
        for index, cell in enumerate(self.cell_of_element):
            share = elements.half[index] / self.half[cell]
            columns = slice(outer + index * POINTS, outer + (index + 1) * POINTS)
            result[cell, columns] = share * shape_means(bool(elements.tip[index]))
        return result

    @property
    def middles(self) -> Numbers:
        """Places of the cells along the crack; those of the outline mean nothing [m]."""
        lengths = 2.0 * self.half
        lengths[: self.outline_cells] = 0.0
        return np.asarray(np.cumsum(lengths) - 0.5 * lengths)

    @property
    def places(self) -> Numbers:
        """Places of the collocation points along the crack, from its middle on [m]."""
        cell = self.cell_of_element.repeat(POINTS)
        offset = (self.elements.points - self.centre[cell]) * np.exp(-1j * self.angle[cell])
        return np.asarray(self.middles[cell] + offset.real)

    def groups(self, length: float) -> npt.NDArray[np.int_]:
        """Number of the group of each cell of the crack: neighbours, together about as long."""
        part = slice(self.outline_cells, None)
        fracture = np.arange(self.half.size)[part] < self.outline_cells + self.fracture_cells
        place = self.middles[part]
        start = self.middles[part][fracture][-1] + self.half[part][fracture][-1]
        number = np.where(fracture, 0, 1 + np.floor((place - start) / length).astype(int))
        return np.asarray(np.unique(number, return_inverse=True)[1])

    def points_from_cells(self) -> Numbers:
        """Linear interpolation along the crack from cells to points, never past the first kink.

        Points are the middles of outline cells, then the collocation points of the crack.
        """
        outer, middle, place = self.outline_cells, self.middles, self.places
        cell = self.cell_of_element.repeat(POINTS)
        result = np.zeros((outer + place.size, self.half.size))
        result[:outer, :outer] = np.eye(outer)
        kink = outer + self.fracture_cells
        for part in (range(outer, kink), range(kink, self.half.size)):
            inside = np.flatnonzero((cell >= part.start) & (cell < part.stop))
            for index in part:
                unit = np.zeros(self.half.size)
                unit[index] = 1.0
                span = slice(part.start, part.stop)
                result[outer + inside, index] = np.interp(place[inside], middle[span], unit[span])
        return result


def cuts_of_cell(resolution: Resolution, index: int, last: int) -> Numbers:
    """Where elements end in a cell of the crack, as shares of it."""
    count = resolution.fracture_cells
    levels = np.concatenate([1.0 - resolution.ratio ** -np.arange(resolution.levels), [1.0]])
    if last < count:  # no wing yet: the cells grow shorter towards the tip by themselves
        return np.linspace(0.0, 1.0, 2 if index == last else 3)
    if index == count - 1:
        return levels
    if index == count:
        if index == last:  # both the kink and the tip
            return np.concatenate([0.5 * (1.0 - levels[::-1]), [0.75, 1.0]])
        return 1.0 - levels[::-1]
    if index == last:
        return np.linspace(0.0, 1.0, resolution.tip_elements + 1)
    return np.linspace(0.0, 1.0, (1 if index < count else resolution.piece_elements) + 1)


def build_geometry(
    resolution: Resolution,
    half_length: float,
    direction: float,
    half_width: float | None,
    wing: list[complex],
) -> Geometry:
    """Cells and elements of the fracture, of the pieces of its wing, and of the outline.

    Parameters
    ----------
    wing: ends of the pieces, relative to the end of the fracture [m]
    """
    count = resolution.fracture_cells
    outline: Complexes = np.zeros(1, dtype=np.complex128)
    if half_width is not None:  # the right side and the top, the body to the left
        steps = np.linspace(-1.0, 1.0, resolution.side_cells + 1)
        outline = np.asarray(half_width * np.concatenate([1.0 + 1j * steps, 1j - steps[1:]]))
    end = half_length * np.exp(1j * direction)
    places = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, count + 1))  # smaller towards the end
    crack = np.concatenate([end * places, end + np.array(wing, dtype=np.complex128)])
    spans = np.concatenate([np.diff(outline), np.diff(crack)])
    ends = np.concatenate([outline[1:] + outline[:-1], crack[1:] + crack[:-1]])
    centre = np.asarray(ends / 2.0, dtype=np.complex128)
    outer = outline.size - 1
    middles, angles, halves, cells = [], [], [], []
    for index in range(crack.size - 1):
        span = crack[index + 1] - crack[index]
        cuts = cuts_of_cell(resolution, index, crack.size - 2)
        for low, high in pairwise(cuts):
            middles.append(crack[index] + span * (low + high) / 2.0)
            angles.append(np.angle(span))
            halves.append(abs(span) * (high - low) / 2.0)
            cells.append(outer + index)
    tip = np.zeros(len(halves), dtype=np.bool_)
    tip[-1] = True
    elements = Elements(np.array(middles), np.array(angles), np.array(halves), tip)
    return Geometry(
        centre, np.angle(spans), np.abs(spans) / 2.0, outer, count, elements, np.array(cells)
    )
