"""Faults of a network, and features that are probably not intended; with and without repair."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
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


def extent(lines: Sequence[Line]) -> float:
    """Diagonal of what the fractures cover [m]."""
    places = np.vstack([line.points for line in lines])
    return float(np.hypot(*(places.max(axis=0) - places.min(axis=0))))


def find_faults(lines: Sequence[Line], body: Polygon | None, limits: Limits) -> list[Fault]:
    """All faults of a network, in the order of `KINDS`."""
    search = _Search(lines, body, limits)
    found = list(search.all())
    order = list(KINDS)
    return sorted(found, key=lambda fault: (order.index(fault.kind), fault.lines))


def vertex_angle(points: Points, vertex: int) -> float:
    """Angle between the two segments at an inner vertex [degree]; 180 is straight on."""
    a = points[vertex - 1] - points[vertex]
    b = points[vertex + 1] - points[vertex]
    return math.degrees(abs(math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))))


def stretches_beside(line: LineString, other: LineString, limits: Limits) -> shapely.Geometry:
    """Where a line runs along another one: nearer than the distance, at less than the angle."""
    pieces = []
    ours, others = _segments(line), _segments(other)
    for ends in others:
        near = LineString(ends).buffer(limits.near)
        for own in ours:
            if _angle_deg(own, ends) >= limits.angle_deg:
                continue
            piece = LineString(own).intersection(near)
            # a cap or two are what segments have that only follow each other
            if piece.length > 1.5 * limits.near:
                pieces.append(piece)
    return shapely.union_all(pieces) if pieces else LineString()


def _segments(line: LineString) -> list[Points]:
    points = shapely.get_coordinates(line)
    return [points[k : k + 2] for k in range(len(points) - 1)]


def _angle_deg(a: Points, b: Points) -> float:
    """Between two undirected segments [degree]."""
    p, q = a[1] - a[0], b[1] - b[0]
    sine = abs(float(p[0] * q[1] - p[1] * q[0]))
    return math.degrees(math.atan2(sine, abs(float(p @ q))))


class _Search:
    def __init__(self, lines: Sequence[Line], body: Polygon | None, limits: Limits) -> None:
        self.lines, self.body, self.limits = lines, body, limits
        self.shapes = [LineString(line.points) for line in lines]
        self.tree = STRtree(self.shapes)
        self.rim = None if body is None else body.exterior
        self.pairs = list(self._pairs())

    def all(self) -> Iterator[Fault]:
        for i in range(len(self.lines)):
            yield from self._alone(i)
            yield from self._with_body(i)
        beside = set()
        for i, j in self.pairs:
            pair = list(self._run_together(i, j))
            yield from pair
            if pair:
                beside.add((i, j))
        for i, j in self.pairs:
            if (i, j) not in beside:
                yield from self._ends_and_vertices(i, j)
                yield from self._ends_and_vertices(j, i)
        yield from self._crossings(beside)

    def _pairs(self) -> Iterator[tuple[int, int]]:
        for i, shape in enumerate(self.shapes):
            found = self.tree.query(shape, predicate="dwithin", distance=self.limits.near)
            yield from ((i, int(j)) for j in sorted(found) if j > i)

    def _alone(self, i: int) -> Iterator[Fault]:
        points, limits = self.lines[i].points, self.limits
        gaps = np.hypot(*np.diff(points, axis=0).T)
        for k, gap in enumerate(gaps):
            if gap <= limits.same:
                yield self._fault("repeated vertex", (i,), points[k + 1], gap, k + 1)
            elif gap < limits.near and len(points) > 2:
                yield self._fault("short segment", (i,), points[k], gap, k)
        for k in range(1, len(points) - 1):
            if min(gaps[k - 1], gaps[k]) > limits.same:
                angle = vertex_angle(points, k)
                if angle < limits.angle_deg:
                    yield self._fault("hairpin", (i,), points[k], angle, k)
        if self.lines[i].length < limits.near:
            yield self._fault("short fracture", (i,), points[0], self.lines[i].length)
        if not self.shapes[i].is_simple and not self.shapes[i].is_ring:
            yield self._fault("self-crossing", (i,), self._own_crossing(i), 0.0)

    def _own_crossing(self, i: int) -> Points:
        """A place that a line passes twice."""
        segments = [LineString(ends) for ends in _segments(self.shapes[i])]
        for k, first in enumerate(segments):
            for second in segments[k + 2 :]:
                if first.intersects(second):
                    return np.asarray(shapely.get_coordinates(first.intersection(second))[0])
        return np.asarray(self.lines[i].points[0])

    def _with_body(self, i: int) -> Iterator[Fault]:
        if self.rim is None or self.body is None:
            return
        points, limits, shape = self.lines[i].points, self.limits, self.shapes[i]
        outside = shape.difference(self.body.buffer(limits.same))
        if outside.length > limits.same:
            yield self._fault(
                "outside",
                (i,),
                outside.coords[0]
                if outside.geom_type == "LineString"
                else outside.geoms[0].coords[0],
                outside.length,
            )
            return
        if stretches_beside(shape, self.rim, limits).length > 0.0:
            place = stretches_beside(shape, self.rim, limits).interpolate(0.5, normalized=True)
            yield self._fault("overlap", (i,), place.coords[0], place.distance(self.rim))
            return
        for k, point in enumerate(points):
            depth = Point(point).distance(self.rim)
            is_end = k in (0, len(points) - 1)
            if limits.same < depth < limits.near:
                kind = "near end" if is_end else "near vertex"
                yield self._fault(kind, (i,), point, depth, k)
            elif depth <= limits.same and not is_end:
                yield self._fault("inner vertex", (i,), point, depth, k)
            elif depth <= limits.same:
                corners = np.array(self.rim.coords)
                gap = float(np.hypot(*(corners - point).T).min())
                if limits.same < gap < limits.near:
                    yield self._fault("near corner", (i,), point, gap, k)

    def _run_together(self, i: int, j: int) -> Iterator[Fault]:
        # of two the shorter one gives way; of two alike the later one
        is_shorter = self.lines[i].length < self.lines[j].length - self.limits.near
        shorter, longer = (i, j) if is_shorter else (j, i)
        shape, other = self.shapes[shorter], self.shapes[longer]
        beside = stretches_beside(shape, other, self.limits)
        if beside.length == 0.0:
            return
        place = shapely.get_coordinates(beside)[0]
        if shape.difference(other.buffer(self.limits.near)).length <= self.limits.same:
            size = float(shape.hausdorff_distance(other))
            yield self._fault("duplicate", (shorter, longer), place, size)
        else:
            yield self._fault("overlap", (shorter, longer), place, beside.distance(other))

    def _ends_and_vertices(self, i: int, j: int) -> Iterator[Fault]:
        points, limits, other = self.lines[i].points, self.limits, self.shapes[j]
        last = len(points) - 1
        for k, point in enumerate(points):
            gap = Point(point).distance(other)
            if k not in (0, last):
                if limits.same < gap < limits.near:
                    yield self._fault("near vertex", (i, j), point, gap, k)
                continue
            if gap <= limits.same:
                continue
            stub = self._stub(i, j, is_start=k == 0)
            if limits.same < stub < limits.near:
                yield self._fault("end past", (i, j), point, stub, k)
            elif gap < limits.near and not self._is_told(i, j, point):
                yield self._fault("near end", (i, j), point, gap, k)

    def _is_told(self, i: int, j: int, point: Points) -> bool:
        """Two ends that are near to each other are told once, as of the later fracture."""
        if i > j:
            return False
        ends = self.lines[j].points[[0, -1]]
        gaps = np.hypot(*(ends - point).T)
        nearest = float(gaps.min())
        end = ends[int(gaps.argmin())]
        return (
            nearest < self.limits.near
            and Point(end).distance(self.shapes[i]) > self.limits.same
            and self._stub(j, i, int(gaps.argmin()) == 0) >= self.limits.near
        )

    def _stub(self, i: int, j: int, is_start: bool) -> float:
        """Length of what a line has behind the last place where it crosses another one [m]."""
        met = shapely.get_coordinates(self.shapes[i].intersection(self.shapes[j]))
        if len(met) == 0:
            return math.inf
        places = [self.shapes[i].project(Point(place)) for place in met]
        return float(min(places) if is_start else self.shapes[i].length - max(places))

    def _crossings(self, beside: set[tuple[int, int]]) -> Iterator[Fault]:
        """Places on one line where others cross it, too near to each other or to its vertices."""
        limits = self.limits
        met: dict[int, list[tuple[float, int]]] = {}
        for i, j in self.pairs:
            if (i, j) in beside:
                continue
            for place in shapely.get_coordinates(self.shapes[i].intersection(self.shapes[j])):
                for own, other in ((i, j), (j, i)):
                    along = float(self.shapes[own].project(Point(place)))
                    met.setdefault(own, []).append((along, other))
        for i, places in met.items():
            places.sort()
            for (first, one), (second, other) in pairwise(places):
                if limits.same < second - first < limits.near:
                    place = self.shapes[i].interpolate(first).coords[0]
                    yield self._fault("near crossings", (i, one, other), place, second - first)

    @staticmethod
    def _fault(
        kind: str,
        lines: tuple[int, ...],
        place: Sequence[float] | Points,
        size: float,
        vertex: int = -1,
    ) -> Fault:
        return Fault(kind, lines, (float(place[0]), float(place[1])), float(size), vertex)
