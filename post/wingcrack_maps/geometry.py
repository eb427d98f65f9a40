"""Features from geometries of shapely, for all formats that hand over such."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from shapely.geometry import LineString, MultiLineString, Polygon
from shapely.geometry.base import BaseGeometry

from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Area, Attributes, Line, Map, Points

NAMES = ("name", "label", "id", "fid")
ROLES = ("boundary", "region", "fracture", "well", "")
_FITTING = {"LineString": ("fracture", ""), "Polygon": ROLES[:3] + ROLES[4:], "Point": ROLES[3:]}
_WORDS = {"LineString": "line", "Polygon": "polygon", "Point": "point"}


def add_geometry(
    content: Map, geometry: BaseGeometry, attributes: Attributes, path: str, source: str
) -> None:
    """Add a geometry with all its parts; what is neither line nor polygon becomes a note.

    Raises `SceneError` if a coordinate is no number, or the role is unknown or does not fit.

    `attributes`: what the map says of it; ``kind`` is its role. `path` and `source`: file, and
    place in it.
    """
    role = _role(attributes, path, source)
    parts = list(_parts(_joined(geometry, content, source)))
    if not parts:
        content.note("empty", f"{source} has an empty geometry and gives nothing")
    for number, part in enumerate(parts, start=1):
        name = name_of(attributes)
        if name and len(parts) > 1:
            name = f"{name}.{number}"
        if part.has_z:
            content.note("height left out", f"{source}: heights are ignored")
        if role not in _FITTING.get(part.geom_type, ROLES):
            raise SceneError(
                f"{path}: {source} is a {_WORDS[part.geom_type]} but its kind is '{role}': it takes"
                f" a {'point' if role == 'well' else 'polygon'}"
            )
        if role == "well":
            well = Line(name, _points(part.coords, path, source), attributes, source)
            content.wells.append(well)
        elif isinstance(part, LineString):
            line = Line(name, _points(part.coords, path, source), attributes, source)
            content.lines.append(line)
        elif isinstance(part, Polygon):
            _add_polygon(content, part, Area(name, _no_points(), role, attributes), path, source)
        else:
            words = f"{source} is a {part.geom_type}; a point with the kind 'well' is a well"
            content.note("left out", words)


def _joined(geometry: BaseGeometry, content: Map, source: str) -> BaseGeometry:
    """Make one line of parts of a geometry that go on where others end."""
    if not isinstance(geometry, MultiLineString):
        return geometry
    joined = shapely.line_merge(geometry)
    fewer = len(geometry.geoms) - shapely.get_num_geometries(joined)
    if fewer > 0:
        content.note("joined", f"{source}: {fewer + 1} parts go on where others end: one fracture"
                     if fewer + 1 == len(geometry.geoms) else
                     f"{source}: parts go on where others end, {fewer} fewer")  # fmt: skip
    return joined


def _add_polygon(content: Map, part: Polygon, area: Area, path: str, source: str) -> None:
    ring = _points(part.exterior.coords, path, source)
    if area.role == "fracture":
        content.lines.append(Line(area.name, ring, area.attributes, source))
        content.note("closed line", f"{source}: the outline of the polygon is a closed fracture")
        return
    if part.interiors:
        content.note("hole left out", f"{source}: holes of the polygon are ignored")
    area.points, area.source = ring[:-1], source
    content.areas.append(area)


def name_of(attributes: Attributes) -> str:
    """Name of a feature by its attributes, or nothing."""
    by_word = {word.lower(): value for word, value in attributes.items()}
    for word in NAMES:
        if by_word.get(word) not in (None, ""):
            return str(by_word[word])
    return ""


def is_well(attributes: Attributes) -> bool:
    """Whether the kind of a feature is a well."""
    return any(
        word.lower() == "kind" and str(value).strip().lower() == "well"
        for word, value in attributes.items()
    )


def _role(attributes: Attributes, path: str, source: str) -> str:
    for word in list(attributes):
        if word.lower() == "kind":
            role = str(attributes.pop(word) or "").strip().lower()
            if role and role not in ROLES:
                raise SceneError(
                    f"{path}: {source} has the kind '{role}', but it must be one of"
                    f" {', '.join(ROLES[:-1])}"
                )
            return role
    return ""


def _parts(geometry: BaseGeometry) -> Iterator[BaseGeometry]:
    if geometry.is_empty:
        return
    if hasattr(geometry, "geoms"):
        for part in geometry.geoms:
            yield from _parts(part)
    else:
        yield geometry


def _points(coordinates: object, path: str, source: str) -> Points:
    points = np.asarray(coordinates, dtype=float)[:, :2]
    if not np.isfinite(points).all():
        raise SceneError(f"{path}: {source} has a coordinate that is no finite number")
    return points


def _no_points() -> Points:
    return np.empty((0, 2))
