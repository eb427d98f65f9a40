"""Repairs of a network, fault by fault, until no fault remains that can be repaired."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon

from wingcrack_maps.faults import BODY, HARMLESS, Fault, Limits, Search, place_text
from wingcrack_maps.features import Line, Points

_ROUNDS = 2000
# Where the repairs of a fracture, and of the one that it is a part of, go round in circles: after
# so many the place is cut out, after twice as many the fracture is removed.
_PATIENCE = 12
_MOVED = ("near end", "near vertex", "near crossings", "overlap", "flat crossing", "end past")


@dataclass(frozen=True)
class Repair:
    """One thing that was done."""

    kind: str  # the fault, as in `faults.KINDS`
    names: tuple[str, ...]  # the fractures, the changed one first
    place: tuple[float, float]  # where [m]
    size: float  # the distance or length [m] or angle [degree] that was too small
    what: str  # what was done, in words
    length_change: float  # of all fractures together [m]


def repair(
    lines: Sequence[Line],
    body: Polygon | None,
    limits: Limits,
    ends: str,
    tell: Callable[[int, int], None] = lambda done, left: None,
) -> tuple[list[Line], list[Repair]]:
    """Repair what can be repaired.

    Parameters
    ----------
    ends : str
        ``join`` moves an end onto what it is near to, ``gap`` cuts it back.
    tell : callable
        Is told after each round how many repairs are made and how many faults were left before it.

    Returns
    -------
    list of Line, list of Repair
        The fractures, and what was done in this order. What is left, `find_faults` tells.
    """
    network = _Network(list(lines), body, limits, ends)
    done: list[Repair] = []
    for _ in range(_ROUNDS):
        faults = [f for f in network.search.faults(network.lines) if f.kind not in HARMLESS]
        tell(len(done), len(faults))
        made = network.round(faults)
        done.extend(made)
        if not made:
            break
    return network.lines, done


class _Network:
    def __init__(self, lines: list[Line], body: Polygon | None, limits: Limits, ends: str) -> None:
        self.lines, self.body, self.limits, self.ends = lines, body, limits, ends
        self.names = {line.name for line in lines}
        self.search = Search(body, limits)
        self.after: dict[int, list[Line]] = {}
        self.tries: dict[Line, int] = {}  # repairs that led to a line
        self.ways: dict[str, Callable[[Fault], str]] = {
            "outside": self._clip,
            "repeated vertex": self._drop_vertex,
            "short segment": self._drop_vertex,
            "hairpin": self._split,
            "short fracture": self._remove,
            "duplicate": self._remove,
            "overlap": self._take_out,
            "flat crossing": self._take_out,
            "end past": self._cut_stub,
            "near end": self._mend_end,
            "near vertex": self._move_vertex,
            "near crossings": self._gather,
            "near corner": self._to_corner,
            "inner vertex": self._split,
        }

    def round(self, faults: Sequence[Fault]) -> list[Repair]:
        """Repair faults of one kind, each fracture once; the rest comes when all is examined."""
        made: list[Repair] = []
        touched: set[int] = set()
        self.after = {}
        for kind in dict.fromkeys(fault.kind for fault in faults):
            for fault in faults:
                if fault.kind != kind or touched.intersection(fault.lines):
                    continue
                before = self._whole(fault.lines)
                what = self._way(fault)(fault)
                if what:
                    touched.update(fault.lines)
                    change = self._whole(fault.lines) - before
                    made.append(self._report(fault, what, change))
            if made:
                break
        kept: list[Line] = []
        for i, line in enumerate(self.lines):
            kept.extend(self.after.get(i, [line]))
            for part in self.after.get(i, ()):
                self.tries[part] = self.tries.get(line, 0) + 1
        self.lines = kept
        return made

    def _way(self, fault: Fault) -> Callable[[Fault], str]:
        tries = max(self.tries.get(self.lines[i], 0) for i in fault.lines)
        if tries > 2 * _PATIENCE:
            return self._remove_shorter
        if tries > _PATIENCE and fault.kind in _MOVED:
            return self._cut_out
        return self.ways[fault.kind]

    def _whole(self, indices: Sequence[int]) -> float:
        return sum(line.length for i in indices for line in self.after.get(i, [self.lines[i]]))

    def _report(self, fault: Fault, what: str, change: float) -> Repair:
        names = tuple(self.lines[i].name for i in fault.lines)
        if len(names) == 1 and fault.kind not in ("repeated vertex", "short segment", "hairpin",
                                                  "short fracture"):  # fmt: skip
            names = (*names, BODY)
        return Repair(fault.kind, names, fault.place, fault.size, what, change)

    def _shape(self, i: int) -> LineString:
        return self.search.shapes[self.lines[i]]

    def _other(self, fault: Fault) -> LineString:
        """What the first fracture of a fault is too near to."""
        if len(fault.lines) > 1:
            return self._shape(fault.lines[1])
        assert self.body is not None
        return self.body.exterior

    # Each of these repairs a fault and says in words what it did; nothing said, nothing done. ----

    def _clip(self, fault: Fault) -> str:
        return self._keep(fault.lines[0], self._shape(fault.lines[0]).intersection(self.body))

    def _take_out(self, fault: Fault) -> str:
        """Take out of the first fracture what runs along the other one."""
        flat = self._other(fault).buffer(self.limits.near, cap_style="flat")
        return self._keep(fault.lines[0], self._shape(fault.lines[0]).difference(flat))

    def _cut_out(self, fault: Fault) -> str:
        """Cut the place out of the shorter one, which leaves a gap of some distances."""
        i = self._shorter(fault)
        hole = Point(fault.place).buffer(2.0 * self.limits.near)
        return f"place cut out: {self._keep(i, self._shape(i).difference(hole))}"

    def _shorter(self, fault: Fault) -> int:
        return min(fault.lines, key=lambda k: self.lines[k].length)

    def _remove(self, fault: Fault) -> str:
        self.after[fault.lines[0]] = []
        return f"removed, {self.lines[fault.lines[0]].length:.6g} m long"

    def _remove_shorter(self, fault: Fault) -> str:
        i = self._shorter(fault)
        self.after[i] = []
        return (
            f"{self.lines[i].name} removed, {self.lines[i].length:.6g} m long:"
            f" {self.tries.get(self.lines[i], 0)} repairs there did not end"
        )

    def _drop_vertex(self, fault: Fault) -> str:
        """Leave out an inner vertex of a short segment, one that no other fracture meets first."""
        i, first = fault.lines[0], fault.vertex
        points = self.lines[i].points
        if fault.kind == "repeated vertex":
            first -= 1
        inner = [k for k in (first, first + 1) if 0 < k < len(points) - 1]
        if not inner:
            return self._remove(fault)
        vertex = min(inner, key=lambda k: self.search.is_met(self.lines[i], points[k]))
        self._set(i, np.delete(points, vertex, axis=0))
        return f"its vertex {vertex + 1} left out"

    def _split(self, fault: Fault) -> str:
        points = self.lines[fault.lines[0]].points
        k = fault.vertex
        return self._keep_all(fault.lines[0], [points[: k + 1], points[k:]])

    def _cut_stub(self, fault: Fault) -> str:
        """Let the first fracture end where it last crosses the other one."""
        i, is_start = fault.lines[0], fault.vertex == 0
        shape = self._shape(i)
        met = shapely.get_coordinates(shape.intersection(self._other(fault)))
        places = [float(shape.project(Point(place))) for place in met]
        along = min(places) if is_start else max(places)
        end = met[places.index(along)]
        self._set(i, self._until(i, along, end, is_start))
        return f"{fault.size:.6g} m behind the crossing cut off"

    def _until(self, i: int, along: float, end: Points, is_start: bool) -> Points:
        """Vertices of a line up to, or from, a place on it, without one right beside the place."""
        points = self.lines[i].points
        at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        kept = points[at > along] if is_start else points[at < along]
        return np.vstack([end, kept] if is_start else [kept, end])

    def _mend_end(self, fault: Fault) -> str:
        if self.ends == "gap" and len(fault.lines) > 1:
            return self._cut_back(fault)
        target, words = self._target(fault)
        points = self.lines[fault.lines[0]].points.copy()
        points[fault.vertex] = target
        self._set(fault.lines[0], points)
        way = float(np.hypot(*(target - np.array(fault.place))))
        return f"end moved by {way:.6g} m to {words}"

    def _cut_back(self, fault: Fault) -> str:
        i, is_start = fault.lines[0], fault.vertex == 0
        left = self._shape(i).difference(self._other(fault).buffer(1.01 * self.limits.near))
        if left.is_empty:
            return self._remove(fault)
        # Only the end goes, whatever else of the line meets the other one: the cut is at the first
        # place, seen from the end, that is far enough from it.
        shape = self._shape(i)
        ends = [c for piece in shapely.get_parts(left) for c in (piece.coords[0], piece.coords[-1])]
        places = [float(shape.project(Point(end))) for end in ends]
        along = min(places) if is_start else max(places)
        self._set(i, self._until(i, along, np.array(ends[places.index(along)]), is_start))
        whole = shape.length
        return f"end cut back by {whole - self._whole([i]):.6g} m, which leaves a gap"

    def _target(self, fault: Fault) -> tuple[Points, str]:
        """Where a point goes: the nearest vertex of the other line, or else its nearest place."""
        place = np.array(fault.place)
        other = self._other(fault)
        whose = self.lines[fault.lines[1]].name if len(fault.lines) > 1 else "the boundary"
        vertices = shapely.get_coordinates(other)
        gaps = np.hypot(*(vertices - place).T)
        if gaps.min() < self.limits.near:
            return vertices[int(gaps.argmin())], f"a vertex of {whose}"
        nearest = other.interpolate(other.project(Point(place)))
        return shapely.get_coordinates(nearest)[0], f"the nearest place of {whose}"

    def _move_vertex(self, fault: Fault) -> str:
        """Move an inner vertex onto the other fracture; away from the boundary it is left out."""
        i, k = fault.lines[0], fault.vertex
        points = self.lines[i].points.copy()
        if len(fault.lines) == 1:
            self._set(i, np.delete(points, k, axis=0))
            return f"its vertex {k + 1} left out"
        points[k], words = self._target(fault)
        self._set(i, points)
        return f"vertex {k + 1} moved to {words}"

    def _gather(self, fault: Fault) -> str:
        """Let two fractures cross a third one at one place."""
        one, other = fault.lines[1:]
        place = np.array(fault.place)
        for i in dict.fromkeys(fault.lines):
            self._set(i, self._through(i, place))
        where = ", ".join(place_text(fault.place, self.limits.near))
        if one == other:
            return f"both crossings made one at ({where})"
        return f"crossings gathered at ({where})"

    def _through(self, i: int, place: Points) -> Points:
        """Vertices of a line that goes through a place near to it."""
        points, shape = self.lines[i].points, self._shape(i)
        along = float(shape.project(Point(place)))
        at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        if along <= self.limits.near:
            return np.vstack([place, points[at > self.limits.near]])
        if along >= at[-1] - self.limits.near:
            return np.vstack([points[at < at[-1] - self.limits.near], place])
        before, after = at < along - self.limits.near, at > along + self.limits.near
        before[0] = after[-1] = True
        return np.vstack([points[before], place, points[after]])

    def _to_corner(self, fault: Fault) -> str:
        target, _ = self._target(fault)
        points = self.lines[fault.lines[0]].points.copy()
        points[fault.vertex] = target
        self._set(fault.lines[0], points)
        return f"end moved by {fault.size:.6g} m to the corner"

    # --------------------------------------------------------------------------------------------

    def _set(self, i: int, points: Points) -> None:
        gaps = np.hypot(*np.diff(points, axis=0).T)
        points = points[np.concatenate([[True], gaps > 0.0])]
        kept = [replace(self.lines[i], points=points)] if len(points) > 1 else []
        self.after[i] = kept

    def _keep(self, i: int, left: shapely.Geometry) -> str:
        """Keep what is left of a line, each piece as a fracture."""
        parts = list(left.geoms) if hasattr(left, "geoms") else [left]
        pieces = [p for p in parts if isinstance(p, LineString) and p.length > self.limits.same]
        return self._keep_all(i, [shapely.get_coordinates(piece) for piece in pieces])

    def _keep_all(self, i: int, pieces: Sequence[Points]) -> str:
        line = self.lines[i]
        if not pieces:
            self.after[i] = []
            return f"removed, {line.length:.6g} m long: nothing remains"
        if len(pieces) == 1:
            self.after[i] = [replace(line, points=pieces[0])]
            return f"shortened by {line.length - self._whole([i]):.6g} m"
        self.after[i] = [
            replace(line, name=self._new_name(line.name), points=points) for points in pieces
        ]
        names = ", ".join(piece.name for piece in self.after[i])
        self.names.discard(line.name)
        return f"parted into {names}; {line.length - self._whole([i]):.6g} m taken out"

    def _new_name(self, stem: str) -> str:
        number = 1
        while f"{stem[:60]}.{number}" in self.names:
            number += 1
        name = f"{stem[:60]}.{number}"
        self.names.add(name)
        return name
