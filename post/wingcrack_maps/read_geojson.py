"""Maps from GeoJSON (RFC 7946)."""

from __future__ import annotations

import json
import math
from typing import Any

import shapely
from shapely.geometry import shape

from wingcrack.figures.text_files import json_value
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.geometry import add_geometry

_DEPTHS = {"Point": 0, "MultiPoint": 1, "LineString": 1, "MultiLineString": 2, "Polygon": 2,
           "MultiPolygon": 3}  # fmt: skip


def read_geojson(text: str, path: str) -> Map:
    """Read a FeatureCollection, a Feature or a bare geometry, in its own unit."""
    try:
        content = json_value(text)
    except ValueError as reason:
        raise SceneError(f"{path}: not a JSON file: {reason}") from None
    if not isinstance(content, dict) or "type" not in content:
        raise SceneError(f'{path}: no GeoJSON, which is an object with a "type"')
    found = Map(system=_system(content))
    for number, feature in enumerate(_features(content, path), start=1):
        _add(found, feature, path, f"feature {number}")
    return found


def _system(content: dict[str, Any]) -> str:
    entry = content.get("crs")
    if not entry:
        return ""
    named = entry.get("properties", {}) if isinstance(entry, dict) else {}
    return str(named.get("name") or named.get("code") or entry)


def _features(content: dict[str, Any], path: str) -> list[Any]:
    if content["type"] == "FeatureCollection":
        features = content.get("features")
        if not isinstance(features, list):
            raise SceneError(f'{path}: the FeatureCollection has no list "features"')
        return features
    return [content]


def _add(found: Map, feature: Any, path: str, source: str) -> None:
    if not isinstance(feature, dict):
        raise SceneError(f"{path}: {source} is no object with a geometry")
    geometry: Any = feature
    attributes: Any = {}
    if feature.get("type") == "Feature":
        geometry = feature.get("geometry")
        attributes = feature.get("properties") or {}
        if not isinstance(attributes, dict):
            raise SceneError(f"{path}: {source}: its properties are no object of names and values")
        attributes = dict(attributes)
        if feature.get("id") is not None and "id" not in attributes:
            attributes["id"] = feature["id"]
    if geometry is None:
        found.note("empty", f"{source} has no geometry and gives nothing")
        return
    try:
        _judge(geometry)
        made = shape(geometry)
    except (ValueError, shapely.errors.ShapelyError) as reason:
        raise SceneError(f"{path}: {source} has no geometry that can be read: {reason}") from None
    add_geometry(found, made, attributes, path, source)


def _judge(geometry: Any) -> None:
    """Refuse what is no geometry: shapely takes much for one, and fails in many ways."""
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind == "GeometryCollection":
        parts = geometry.get("geometries")
        if not isinstance(parts, list):
            raise ValueError('the GeometryCollection has no list "geometries"')
        for part in parts:
            _judge(part)
    elif isinstance(kind, str) and kind in _DEPTHS:
        _judge_places(geometry.get("coordinates"), _DEPTHS[kind], kind)
    else:
        known = ", ".join((*_DEPTHS, "GeometryCollection"))
        raise ValueError(f"its type {json.dumps(kind)[:40]} is none of {known}")


def _judge_places(given: Any, depth: int, kind: str) -> None:
    """Judge places [x, y] or [x, y, height] that stand so many lists deep."""
    if not isinstance(given, list):
        raise ValueError(f"{json.dumps(given)[:40]} in the {kind} must be a list")
    if depth == 1 and len({len(item) for item in given if isinstance(item, list)}) > 1:
        raise ValueError(f"some places of the {kind} have a height and others have none")
    for item in given:
        if depth:
            _judge_places(item, depth - 1, kind)
        elif isinstance(item, bool | str | list | dict | None) or not math.isfinite(item):
            raise ValueError(f"the place {json.dumps(given)[:60]} must hold finite numbers only")
