"""Places that are one within the precision of a map get the same numbers: a joint stays a joint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.strtree import STRtree

from wingcrack_maps.features import Line, Points

_EXACT = 5e-14
"""The mesher takes places for one that differ by less: distance over the largest coordinate."""


def weld(lines: Sequence[Line], body: Polygon | None, same: float) -> tuple[list[Line], int, float]:
    """Move vertices that are one place onto each other, and let segments go through them.

    Returns
    -------
    list of Line, int, float
        The fractures, how many places were apart, and the largest distance [m].
    """
    rim = np.empty((0, 2)) if body is None else np.array(body.exterior.coords[:-1])
    points = np.vstack([rim, *(line.points for line in lines)])
    exact = _EXACT * float(np.abs(points).max())
    first = len(rim) + np.cumsum([0, *(len(line.points) for line in lines)])
    ends = np.concatenate([first[:-1], first[1:] - 1])
    moved = points[_representatives(points, same)]
    if body is not None:
        outline = body.exterior
        gap = shapely.distance(outline, shapely.points(moved[ends]))
        on_rim = ends[(gap > exact) & (gap <= same)]
        along = shapely.line_locate_point(outline, shapely.points(moved[on_rim]))
        moved[on_rim] = shapely.get_coordinates(shapely.line_interpolate_point(outline, along))
    apart = np.hypot(*(moved - points).T)
    moved[apart <= exact] = points[apart <= exact]
    gaps = list(apart[apart > exact])
    through = _passed(moved, first, same, exact, gaps)
    welded = []
    for line, start, stop in zip(lines, first, first[1:], strict=False):
        pieces = [moved[start:stop]]
        if any(k in through for k in range(start, stop - 1)):
            pieces = [np.vstack([moved[k], *through.get(k, ())]) for k in range(start, stop)]
        elif not (apart[start:stop] > exact).any():
            welded.append(line)
            continue
        welded.append(replace(line, points=np.vstack(pieces)))
    return welded, len(gaps), max(gaps, default=0.0)


def _representatives(points: Points, same: float) -> NDArray[np.int64]:
    """For each point the first one of those that are one place with it."""
    tree = STRtree(shapely.points(points))
    one, other = tree.query(tree.geometries, predicate="dwithin", distance=same)
    first = np.arange(len(points))
    while True:
        least = first.copy()
        np.minimum.at(least, one, first[other])
        if (least == first).all():
            return first
        first = least


def _passed(
    points: Points, first: NDArray[np.int64], same: float, exact: float, gaps: list[float]
) -> dict[int, Points]:
    """Vertices that segments pass nearer than the precision, by the segment's first vertex.

    Only of segments that pass one of them not exactly; what they miss by is added to `gaps`.
    """
    starts = np.setdiff1d(np.arange(first[0], first[-1]), first[1:] - 1)
    segments = np.stack([points[starts], points[starts + 1]], axis=1)
    places = np.unique(points[first[0] :], axis=0)
    tree = STRtree(shapely.linestrings(segments))
    place, segment = tree.query(shapely.points(places), predicate="dwithin", distance=same)
    to_ends = np.hypot(*(segments[segment] - places[place][:, None]).transpose(2, 0, 1))
    is_inner = (to_ends > same).all(axis=1)
    place, segment = place[is_inner], segment[is_inner]
    miss = shapely.distance(shapely.points(places[place]), tree.geometries[segment])
    gaps.extend(miss[miss > exact])
    found = {}
    for k in np.unique(segment[miss > exact]):
        passed = places[place[segment == k]]
        order = np.argsort(np.hypot(*(passed - segments[k, 0]).T))
        found[int(starts[k])] = passed[order]
    return found
