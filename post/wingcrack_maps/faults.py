"""Faults of a network, and features that are probably not intended; with and without repair."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Point, Polygon
from shapely.strtree import STRtree

from wingcrack_maps.features import Line, Points

BODY = "(body)"
"""What stands for the body among the names of a fault."""

SAME = 1e-9
"""Two places are one: distance over the extent of the map."""


@dataclass(frozen=True)
class Limits:
    """What counts as near."""

    near: float  # distance below which things that do not touch were hardly meant to be apart [m]
    # angle below which two fractures that meet, or run beside each other, count as one [degree]
    angle_deg: float
    same: float  # distance of what is one place [m]


@dataclass(frozen=True)
class Fault:
    """One place where something is wrong."""

    kind: str  # one of `KINDS`
    lines: tuple[int, ...]  # indices of the fractures, the one to be changed first
    place: tuple[float, float]  # where [m]
    size: float  # the distance, length [m] or angle [degree] that is too small
    vertex: int = -1  # of the first fracture, if it is about one


KINDS = {
    "outside": "leaves the body",
    "repeated vertex": "has a vertex twice",
    "short segment": "has a segment shorter than the distance",
    "hairpin": "turns back at a vertex",
    "short fracture": "is shorter than the distance",
    "duplicate": "lies on another fracture from end to end",
    "overlap": "runs along another fracture or the boundary, nearer than the distance",
    "flat crossing": "crosses another fracture at too small an angle",
    "end past": "ends just behind a fracture that it crosses",
    "near end": "ends near a fracture or the boundary without touching it",
    "near vertex": "has a vertex near a fracture, which is not on it",
    "near crossings": "crosses others at places nearer to each other than the distance",
    "near corner": "ends on the boundary near a corner of the body",
    "inner vertex": "touches the boundary with an inner vertex",
    "self-crossing": "crosses itself: allowed, a joint of the fracture with itself",
}
"""All kinds in the order in which they are repaired, with what the fracture does."""

HARMLESS = ("self-crossing",)
ANGLES = ("hairpin", "flat crossing")
"""Kinds whose size is an angle."""

_ORDER = list(KINDS)


def extent(lines: Sequence[Line]) -> float:
    """Diagonal of what the fractures cover [m]."""
    places = np.vstack([line.points for line in lines])
    return float(np.hypot(*(places.max(axis=0) - places.min(axis=0))))


def place_text(place: tuple[float, float], grain: float) -> tuple[str, str]:
    """Write a place to a tenth of a length at least, however large its coordinates are.

    Examples
    --------
    >>> place_text((109800.25, 6720000.125), 0.05)
    ('109800.250', '6720000.125')
    """
    decimals = max(0, 1 - math.floor(math.log10(grain)))
    return f"{place[0]:.{decimals}f}", f"{place[1]:.{decimals}f}"


def find_faults(lines: Sequence[Line], body: Polygon | None, limits: Limits) -> list[Fault]:
    """All faults of a network, in the order of `KINDS`."""
    return Search(body, limits).faults(lines)


def vertex_angle(points: Points, vertex: int) -> float:
    """Angle between the two segments at an inner vertex [degree]; 180 is straight on."""
    a = points[vertex - 1] - points[vertex]
    b = points[vertex + 1] - points[vertex]
    return math.degrees(abs(math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))))


def stretches_beside(line: LineString, other: LineString, limits: Limits) -> shapely.Geometry:
    """Where a line runs along another one: nearer than the distance, at less than the angle."""
    ours, others = _segments(line), _segments(other)
    i, j = np.nonzero(_angles_deg(ours, others) < limits.angle_deg)
    if len(i) == 0:
        return LineString()
    own, along = shapely.linestrings(ours[i]), shapely.linestrings(others[j])
    near = shapely.dwithin(own, along, limits.near)
    pieces = shapely.intersection(own[near], shapely.buffer(along[near], limits.near))
    # a cap or two are what segments have that only follow each other
    pieces = pieces[shapely.length(pieces) > 1.5 * limits.near]
    return shapely.union_all(pieces) if len(pieces) else LineString()


def _segments(line: LineString) -> Points:
    """(n, 2, 2): segment, end, coordinate."""
    points = shapely.get_coordinates(line)
    return np.stack([points[:-1], points[1:]], axis=1)


def _angles_deg(a: Points, b: Points) -> Points:
    """(n, m) angles between undirected segments [degree]."""
    p, q = (a[:, 1] - a[:, 0])[:, None], (b[:, 1] - b[:, 0])[None]
    sine = np.abs(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0])
    return np.asarray(np.degrees(np.arctan2(sine, np.abs((p * q).sum(axis=-1)))))


@dataclass(frozen=True)
class _Pair:
    """What two fractures near each other have; `lines` of its faults are 0 and 1 for the two."""

    faults: tuple[Fault, ...]
    along: tuple[Points, Points]  # where they meet, along each [m]; of an overlap nothing


_NOWHERE = (np.empty(0), np.empty(0))


class Search:
    """Search for faults that examines again only what has changed since the last network.

    `Line` objects are never changed, but replaced; those that stay keep their order.
    """

    def __init__(self, body: Polygon | None, limits: Limits) -> None:
        self.body, self.limits = body, limits
        self.rim = None if body is None else body.exterior
        self.inside = None if body is None else body.buffer(limits.same)
        shapely.prepare([shape for shape in (self.rim, self.inside) if shape is not None])
        self.shapes: dict[Line, LineString] = {}
        self._alone: dict[Line, list[Fault]] = {}
        self._pairs: dict[Line, dict[Line, _Pair]] = {}  # of both, each under the other
        self._crossings: dict[Line, list[tuple[Line, Line, Fault]]] = {}
        self._tree, self._number = STRtree([]), dict[Line, int]()

    def faults(self, lines: Sequence[Line]) -> list[Fault]:
        """All faults of a network, in the order of `KINDS`."""
        self._update(lines)
        found = [
            replace(fault, lines=(i,))
            for i, line in enumerate(lines)
            for fault in self._alone[line]
        ]
        for i, line in enumerate(lines):
            for other, pair in self._pairs[line].items():
                both = (i, self._number[other])
                if pair.faults and both[0] < both[1]:
                    found.extend(
                        replace(fault, lines=tuple(both[k] for k in fault.lines))
                        for fault in pair.faults
                    )
            for one, other, fault in self._crossings[line]:
                found.append(replace(fault, lines=(i, self._number[one], self._number[other])))
        return sorted(found, key=lambda fault: (_ORDER.index(fault.kind), fault.lines))

    def is_met(self, line: Line, place: Points) -> bool:
        """Whether another fracture passes through a place."""
        found = self._tree.query(Point(place), predicate="dwithin", distance=self.limits.same)
        return bool((found != self._number[line]).any())

    def _update(self, lines: Sequence[Line]) -> None:
        gone = self.shapes.keys() - set(lines)
        changed = {other for line in gone for other in self._pairs[line]} - gone
        for line in gone:
            for other in self._pairs.pop(line):
                if other not in gone:
                    del self._pairs[other][line]
            del self.shapes[line], self._alone[line], self._crossings[line]
        new = [line for line in lines if line not in self.shapes]
        for line in new:
            self.shapes[line] = LineString(line.points)
            self._pairs[line] = {}
        shapes = [self.shapes[line] for line in lines]
        self._tree, self._number = STRtree(shapes), {line: i for i, line in enumerate(lines)}
        for line in new:
            self._alone[line] = [*self._of_one(line), *self._with_body(line)]
        queried = np.array([self.shapes[line] for line in new], dtype=object)
        found = self._tree.query(queried, predicate="dwithin", distance=self.limits.near)
        for k, j in found.T:
            one, other = new[k], lines[j]
            if other is one or other in self._pairs[one]:
                continue
            first, second = sorted((one, other), key=self._number.__getitem__)
            pair = self._examine(first, second)
            self._pairs[first][second] = pair
            self._pairs[second][first] = pair
            changed.update((one, other))
        for line in changed.union(new):
            self._crossings[line] = list(self._near_crossings(line))

    def _of_one(self, line: Line) -> Iterator[Fault]:
        points, limits, shape = line.points, self.limits, self.shapes[line]
        gaps = np.hypot(*np.diff(points, axis=0).T)
        for k in np.flatnonzero(gaps < limits.near).tolist():
            if gaps[k] <= limits.same:
                yield _fault("repeated vertex", (0,), points[k + 1], gaps[k], k + 1)
            elif len(points) > 2:
                yield _fault("short segment", (0,), points[k], gaps[k], k)
        for k in range(1, len(points) - 1):
            if min(gaps[k - 1], gaps[k]) > limits.same:
                angle = vertex_angle(points, k)
                if angle < limits.angle_deg:
                    yield _fault("hairpin", (0,), points[k], angle, k)
        if line.length < limits.near:
            yield _fault("short fracture", (0,), points[0], line.length)
        if len(points) > 2 and not shape.is_simple and not shape.is_ring:
            yield _fault("self-crossing", (0,), self._own_crossing(shape), 0.0)

    def _own_crossing(self, shape: LineString) -> Points:
        """A place that a line passes twice."""
        segments = shapely.linestrings(_segments(shape))
        for k, first in enumerate(segments):
            met = segments[k + 2 :][shapely.intersects(first, segments[k + 2 :])]
            if len(met):
                return np.asarray(shapely.get_coordinates(first.intersection(met[0]))[0])
        return np.asarray(shape.coords[0])

    def _with_body(self, line: Line) -> Iterator[Fault]:
        if self.rim is None or self.inside is None:
            return
        points, limits, shape = line.points, self.limits, self.shapes[line]
        if not self.inside.covers(shape):
            outside = shape.difference(self.inside)
            if outside.length > limits.same:
                first = shapely.get_coordinates(outside)[0]
                yield _fault("outside", (0,), first, outside.length)
                return
        if not shapely.dwithin(shape, self.rim, limits.near):
            return
        beside = stretches_beside(shape, self.rim, limits)
        if beside.length > 0.0:
            place = beside.interpolate(0.5, normalized=True)
            yield _fault("overlap", (0,), place.coords[0], place.distance(self.rim))
            return
        flat = _flat_meeting(shape, self.rim, points, limits)
        if flat is not None:
            yield _fault("overlap", (0,), flat, 0.0)
            return
        corners = np.array(self.rim.coords)
        for k, depth in enumerate(shapely.distance(shapely.points(points), self.rim)):
            is_end = k in (0, len(points) - 1)
            if limits.same < depth < limits.near:
                kind = "near end" if is_end else "near vertex"
                yield _fault(kind, (0,), points[k], depth, k)
            elif depth <= limits.same and not is_end:
                yield _fault("inner vertex", (0,), points[k], depth, k)
            elif depth <= limits.same:
                gap = float(np.hypot(*(corners - points[k]).T).min())
                if limits.same < gap < limits.near:
                    yield _fault("near corner", (0,), points[k], gap, k)

    def _examine(self, first: Line, second: Line) -> _Pair:
        lines = (first, second)
        met = shapely.get_coordinates(self.shapes[first].intersection(self.shapes[second]))
        together = self._run_together(lines, met)
        if together is not None:
            return _Pair((together,), _NOWHERE)
        places = shapely.points(met)
        along = tuple(np.atleast_1d(self.shapes[line].project(places)) for line in lines)
        pair = _Pair((), (along[0], along[1]))
        near = [shapely.distance(shapely.points(lines[k].points), self.shapes[lines[1 - k]])
                for k in (0, 1)]  # fmt: skip
        faults = [*self._ends_and_vertices(lines, 0, pair, near),
                  *self._ends_and_vertices(lines, 1, pair, near)]  # fmt: skip
        return replace(pair, faults=tuple(faults))

    def _run_together(self, lines: tuple[Line, Line], met: Points) -> Fault | None:
        # of two the shorter one gives way; of two alike the later one
        is_shorter = lines[0].length < lines[1].length - self.limits.near
        roles = (0, 1) if is_shorter else (1, 0)
        shape, other = (self.shapes[lines[k]] for k in roles)
        beside = stretches_beside(shape, other, self.limits)
        if beside.length == 0.0:
            places = np.vstack([met, *(line.points for line in lines)])
            flat = _flat_meeting(shape, other, places, self.limits)
            return None if flat is None else _fault("overlap", roles, flat, 0.0)
        if len(met) == 1:
            ends = np.vstack([line.points[[0, -1]] for line in lines])
            if np.hypot(*(ends - met[0]).T).min() >= self.limits.near:
                angles = _angles_deg(*(_segments_at(line, met[0]) for line in (shape, other)))
                return _fault("flat crossing", roles, met[0], angles.min())
        place = shapely.get_coordinates(beside)[0]
        if shape.difference(other.buffer(self.limits.near)).length <= self.limits.same:
            return _fault("duplicate", roles, place, float(shape.hausdorff_distance(other)))
        return _fault("overlap", roles, place, beside.distance(other))

    def _ends_and_vertices(
        self, lines: tuple[Line, Line], own: int, pair: _Pair, near: Sequence[NDArray[np.float64]]
    ) -> Iterator[Fault]:
        limits, points = self.limits, lines[own].points
        last = len(points) - 1
        roles = (own, 1 - own)
        for k in np.flatnonzero((near[own] > limits.same) & (near[own] < limits.near)).tolist():
            if k not in (0, last):
                yield _fault("near vertex", roles, points[k], near[own][k], k)
        for k in (0, last):
            gap = near[own][k]
            if gap <= limits.same:
                continue
            stub = self._stub(lines[own], pair.along[own], is_start=k == 0)
            if limits.same < stub < limits.near:
                yield _fault("end past", roles, points[k], stub, k)
            elif gap < limits.near and not (
                own == 0 and self._is_told(lines, pair, points[k], near)
            ):
                yield _fault("near end", roles, points[k], gap, k)

    def _is_told(
        self,
        lines: tuple[Line, Line],
        pair: _Pair,
        end: Points,
        near: Sequence[NDArray[np.float64]],
    ) -> bool:
        """Two ends that are near to each other are told once, as of the later fracture."""
        gaps = np.hypot(*(lines[1].points[[0, -1]] - end).T)
        nearest = int(gaps.argmin())
        return bool(
            gaps[nearest] < self.limits.near
            and near[1][-nearest] > self.limits.same
            and self._stub(lines[1], pair.along[1], nearest == 0) >= self.limits.near
        )

    def _stub(self, line: Line, along: Points, is_start: bool) -> float:
        """Length of what a line has behind the last place where it crosses another one [m]."""
        if len(along) == 0:
            return math.inf
        return float(along.min() if is_start else self.shapes[line].length - along.max())

    def _near_crossings(self, line: Line) -> Iterator[tuple[Line, Line, Fault]]:
        """Places on one line where others cross it, too near to each other."""
        met = sorted(
            (
                (float(place), self._number[other], other)
                for other, pair in self._pairs[line].items()
                for place in pair.along[self._number[line] > self._number[other]]
            ),
            key=lambda item: item[:2],
        )
        for (first, _, one), (second, _, other) in pairwise(met):
            if self.limits.same < second - first < self.limits.near:
                place = self.shapes[line].interpolate(first).coords[0]
                yield one, other, _fault("near crossings", (0,), place, second - first)


def _flat_meeting(
    line: LineString, other: LineString, places: Points, limits: Limits
) -> Points | None:
    """One of the places, at which two lines meet at less than the angle, however short."""
    points = shapely.points(places)
    near_both = [shapely.dwithin(points, shape, limits.same) for shape in (line, other)]
    for place in places[near_both[0] & near_both[1]]:
        ways = [_ways_from(place, shape, limits.same) for shape in (line, other)]
        sine = ways[0][:, None, 0] * ways[1][None, :, 1] - ways[0][:, None, 1] * ways[1][None, :, 0]
        angles = np.degrees(np.arctan2(np.abs(sine), ways[0] @ ways[1].T))
        if (angles < limits.angle_deg).any():
            return np.asarray(place)
    return None


def _ways_from(place: Points, shape: LineString, same: float) -> Points:
    """(n, 2) ways from a place of a line to the ends of the segments that it lies on [m]."""
    segments = _segments(shape)
    is_there = shapely.dwithin(shapely.linestrings(segments), Point(place), same)
    ways = segments[is_there].reshape(-1, 2) - place
    return np.asarray(ways[np.hypot(*ways.T) > same])


def _segments_at(shape: LineString, place: Points) -> Points:
    """The segment of a line that is nearest to a place, (1, 2, 2)."""
    segments = _segments(shape)
    nearest = int(shapely.distance(shapely.linestrings(segments), Point(place)).argmin())
    return segments[nearest : nearest + 1]


def _fault(
    kind: str,
    lines: tuple[int, ...],
    place: Sequence[float] | Points,
    size: float,
    vertex: int = -1,
) -> Fault:
    where = (float(place[0]), float(place[1]))
    return Fault(kind, lines, where, float(size), vertex)
