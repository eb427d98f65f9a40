"""Random networks by density, orientation and length laws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString

from wingcrack.runs.units import FARTHEST
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Line, Map

Law: TypeAlias = tuple[str, tuple[float, ...]]
Numbers: TypeAlias = NDArray[np.float64]
Box: TypeAlias = tuple[float, ...]

_TRIES = 2000  # places drawn for one fracture before it is given up
_MOST = 20_000  # fractures


@dataclass(frozen=True)
class Set:
    """Laws of one set of fractures."""

    density: tuple[str, float]  # ``p20`` [1/m2] or ``p21`` [m/m2]
    # length, orientation: name and numbers, lengths in m, angles in degrees
    length: Law
    orientation: Law


def draw_lengths(law: Law, count: int, generator: np.random.Generator) -> Numbers:
    """Draw lengths [m].

    `law`: ``constant`` L; ``power`` with exponent a of the density l^-a between two bounds;
    ``lognormal`` with median and the standard deviation of ln l, ``exponential`` with its mean
    before truncation, both perhaps with bounds.
    """
    name, numbers = law
    if name == "constant":
        return np.full(count, numbers[0])
    if name == "power":
        exponent, low, high = numbers
        share = generator.random(count)
        if exponent == 1.0:
            return np.asarray(low * (high / low) ** share)
        k = 1.0 - exponent  # by the ratio of the bounds, lest powers overflow
        return np.asarray(low * (1.0 + share * ((high / low) ** k - 1.0)) ** (1.0 / k))
    if name == "lognormal":
        bounds = numbers[2:]
        return _bounded(
            lambda n: numbers[0] * np.exp(numbers[1] * generator.standard_normal(n)), bounds, count
        )
    return _bounded(lambda n: generator.exponential(numbers[0], n), numbers[1:], count)


def _bounded(draw, bounds: tuple[float, ...], count: int) -> Numbers:  # type: ignore[no-untyped-def]
    """Draw until as many lie within the bounds."""
    if not bounds:
        return np.asarray(draw(count))
    found = np.empty(0)
    for _ in range(1000):
        drawn = np.asarray(draw(max(count, 1000)))
        found = np.concatenate([found, drawn[(drawn >= bounds[0]) & (drawn <= bounds[1])]])
        if found.size >= count:
            return found[:count]
    raise SceneError(
        f"the length law hardly ever gives lengths between {bounds[0]:g} and {bounds[1]:g} m;"
        " choose bounds nearer to its middle"
    )


def draw_angles(law: Law, count: int, generator: np.random.Generator) -> Numbers:
    """Draw angles from the x axis, counter-clockwise [rad].

    `law`: ``uniform`` on the half circle or between two angles, ``constant``, or ``vonmises``: the
    doubled angle has the von Mises law, since fractures are axes without direction (Mardia and Jupp
    2000).
    """
    name, numbers = law
    if name == "constant":
        return np.full(count, math.radians(numbers[0]))
    if name == "vonmises":
        return math.radians(numbers[0]) + 0.5 * generator.vonmises(0.0, numbers[1], count)
    low, high = numbers or (0.0, 180.0)
    return np.radians(generator.uniform(low, high, count))


def sizes_of(fractures: Set, area: float, generator: np.random.Generator) -> Numbers:
    """Lengths of one set such that its density comes out [m].

    By number it is the nearest whole one. By length the last one is taken or left, whichever is
    nearer.
    """
    kind, density = fractures.density
    if kind == "p20":
        count = round(min(density * area, 2.0 * _MOST))
        _judge_count(count)
        return draw_lengths(fractures.length, count, generator)
    wanted, found = density * area, np.empty(0)
    while found.sum() < wanted:
        found = np.concatenate([found, draw_lengths(fractures.length, 256, generator)])
        _judge_count(int(np.searchsorted(np.cumsum(found), wanted)) + 1)
    total = np.cumsum(found)
    count = int(np.searchsorted(total, wanted)) + 1
    if count > 1 and wanted - total[count - 2] < total[count - 1] - wanted:
        count -= 1
    return found[:count]


def _judge_count(count: int) -> None:
    if count < 1:
        raise SceneError("the density gives no fracture in this box: enlarge one of them")
    if count > _MOST:
        raise SceneError(f"the density gives more than {_MOST} fractures in this box: lower it")


def random_network(
    sets: Sequence[Set], box: Box, seed: int, distance: float, crossings: bool
) -> Map:
    """Draw a network.

    Raises `SceneError` if a fracture finds no place.

    `box` (x_0, y_0, x_1, y_1): where the centres lie [m]. `distance`: least distance of two
    fractures, or with crossings of ends from other fractures [m].
    """
    generator = np.random.default_rng(seed)
    area = (box[2] - box[0]) * (box[3] - box[1])
    found = Map()
    drawn: list[tuple[float, float, int]] = []
    for number, one in enumerate(sets, start=1):
        lengths = sizes_of(one, area, generator)
        if lengths.max() > FARTHEST:
            raise SceneError(f"the length law gives fractures of more than {FARTHEST:.0e} m")
        angles = draw_angles(one.orientation, lengths.size, generator)
        drawn.extend((float(s), float(a), number) for s, a in zip(lengths, angles, strict=True))
    # the longest first, which are hardest to place
    order = sorted(range(len(drawn)), key=lambda k: -drawn[k][0])
    placed, rejected = _place([drawn[k] for k in order], box, generator, distance, crossings)
    for k, (points, number) in enumerate(placed, start=1):
        name = f"f{k}" if len(sets) == 1 else f"set{number}_{k}"
        found.lines.append(Line(name, points, {}, f"set {number}"))
    total = sum(line.length for line in found.lines)
    found.note(
        "density",
        f"{len(placed)} fractures in {area:.6g} m2:"
        f" P20 = {len(placed) / area:.6g} 1/m2, P21 = {total / area:.6g} m/m2",
    )
    if distance > 0.0:
        found.note("rejected", f"{rejected} places nearer than {distance:g} m to another fracture")
    return found


def _place(
    drawn: Sequence[tuple[float, float, int]],
    box: Box,
    generator: np.random.Generator,
    distance: float,
    crossings: bool,
) -> tuple[list[tuple[Numbers, int]], int]:
    """Find a place for each, and count those that were rejected."""
    placed: list[tuple[Numbers, int]] = []
    shapes: list[LineString] = []
    bounds = np.empty((len(drawn), 4))
    rejected = 0
    for k, (length, angle, number) in enumerate(drawn):
        half = 0.5 * length * np.array([math.cos(angle), math.sin(angle)])
        for _ in range(_TRIES):
            centre = generator.uniform(box[:2], box[2:])
            points = np.vstack([centre - half, centre + half])
            shape = LineString(points)
            if distance == 0.0 or not _is_near(shape, shapes, bounds[:k], distance, crossings):
                break
            rejected += 1
        else:
            raise SceneError(
                f"{k} of {len(drawn)} fractures found a place, and the next one, {length:.4g} m"
                f" long, none in {_TRIES} tries: lower density or --distance, or let them cross"
                " (--crossings)"
            )
        placed.append((points, number))
        shapes.append(shape)
        bounds[k] = shape.bounds
    return placed, rejected


def _is_near(
    shape: LineString, others: list[LineString], bounds: Numbers, distance: float, crossings: bool
) -> bool:
    low_x, low_y, high_x, high_y = shape.bounds
    beside = np.flatnonzero(
        (bounds[:, 0] < high_x + distance) & (bounds[:, 2] > low_x - distance)
        & (bounds[:, 1] < high_y + distance) & (bounds[:, 3] > low_y - distance)
    )  # fmt: skip
    near = [others[k] for k in beside]
    if not near:
        return False
    if not crossings:
        return bool((shapely.distance(shape, near) < distance).any())
    ends = shapely.points(shapely.get_coordinates(shape))
    if any((shapely.distance(end, near) < distance).any() for end in ends):
        return True
    return any(
        (shapely.distance(shapely.points(shapely.get_coordinates(other)), shape) < distance).any()
        for other in near
    )
