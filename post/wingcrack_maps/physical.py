"""Fractures, body and regions from the physical groups of gmsh's files."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from shapely import unary_union
from shapely.geometry import LineString, MultiLineString, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import linemerge

from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Area, Line, Map, Points


@dataclass
class Groups:
    """Physical groups by name."""

    # edges of the curves of each group, (n, 2, 2): edge, end, coordinate. None has no length, and
    # none is there twice
    curves: dict[str, Points] = field(default_factory=dict)
    # what the surfaces of each group cover
    surfaces: dict[str, BaseGeometry] = field(default_factory=dict)


def map_of_groups(groups: Groups, path: str) -> Map:
    """Make a map of physical groups.

    Physical curves on the rim of all physical surfaces are sides of the body and left out with a
    note; the others are fractures. The outline of all physical surfaces is the body's, and each
    surface a region where there are several. Raises `SceneError` if there is none, or the surfaces
    are no one piece.
    """
    found = Map()
    rim = _add_areas(found, groups.surfaces, path)
    for name, edges in groups.curves.items():
        merged = linemerge(MultiLineString(list(edges)))
        lines = list(merged.geoms) if hasattr(merged, "geoms") else [merged]
        if rim is not None and all(
            rim.contains(line.interpolate(0.5, normalized=True)) for line in lines
        ):
            found.note("left out", f"physical curve '{name}' lies on the rim: a side, no fracture")
            continue
        for number, line in enumerate(lines, start=1):
            label = name if len(lines) == 1 else f"{name}.{number}"
            points = _without_straight(np.array(line.coords))
            found.lines.append(Line(label, points, {}, f"physical curve '{name}'"))
    if not (found.lines or found.areas):
        raise SceneError(
            f"{path}: it has no physical curves or surfaces; name them in gmsh, as"
            ' Physical Curve("f1") = {5};'
        )
    return found


def _add_areas(
    found: Map, surfaces: dict[str, BaseGeometry], path: str
) -> LineString | MultiLineString | None:
    """Add body and regions, and give the rim of the body."""
    if not surfaces:
        return None
    whole = unary_union(list(surfaces.values()))
    if whole.is_empty or not isinstance(whole, Polygon):
        raise SceneError(f"{path}: the physical surfaces must be one piece, which is the body")
    if whole.interiors:
        found.note("hole left out", "holes of the body are ignored")
    corners = _without_straight(np.array(whole.exterior.coords))[:-1]
    found.areas.append(Area("body", corners, "boundary", {}, "physical surfaces"))
    # of regions that overlap the later one counts: one within another comes after it
    by_size = sorted(surfaces.items(), key=lambda item: -item[1].envelope.area)
    for name, outline in by_size if len(surfaces) > 1 else ():
        for part in outline.geoms if hasattr(outline, "geoms") else (outline,):
            corners = _without_straight(np.array(part.exterior.coords))[:-1]
            source = f"physical surface '{name}'"
            found.areas.append(Area(name, corners, "region", {}, source))
    return whole.exterior.buffer(1e-9 * whole.length)


def _without_straight(points: Points) -> Points:
    """Leave out vertices on straight lines: nodes of the mesh that say nothing of the geometry."""
    is_closed = bool((points[0] == points[-1]).all())
    if is_closed:  # begin at a true corner
        ring = points[:-1]
        turn = _turns(np.roll(ring, 1, axis=0), ring, np.roll(ring, -1, axis=0))
        start = int(np.argmax(turn))
        points = np.vstack([np.roll(ring, -start, axis=0), ring[start]])
    turn = _turns(points[:-2], points[1:-1], points[2:])
    return np.asarray(points[np.concatenate([[True], turn > 1e-9, [True]])])


def _turns(before: Points, here: Points, after: Points) -> Points:
    """Sine of the angle by which a polyline turns [-]."""
    a, b = here - before, after - here
    sine = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return np.asarray(sine / (np.hypot(*a.T) * np.hypot(*b.T)))
