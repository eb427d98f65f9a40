"""Coordinate systems of maps, by PROJ."""

from __future__ import annotations

from typing import Any

import numpy as np

from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.needs import needed
from wingcrack_maps.units import refuse_degrees, utm_zone


def metres_of(system: str, path: str, content: Map) -> float:
    """Metres of the unit of a map's coordinate system.

    Raises `SceneError` if its unit is no length.
    """
    known = _system(system, path)
    if known.is_geographic:
        refuse_degrees(path, system, content)
    return float(known.axis_info[0].unit_conversion_factor) if known.axis_info else 1.0


def project(content: Map, system: str, wanted: str, path: str) -> None:
    """Project a map from its coordinate system to another one, in metres.

    `wanted`: its name, as ``EPSG:25832``, or ``utm`` for the zone of the map's middle.
    """
    pyproj = needed("pyproj")
    source = _system(system, path)
    places = np.vstack([item.points for item in content.features])
    if wanted.lower() == "utm":
        if not source.is_geographic:
            to_degrees = pyproj.Transformer.from_crs(source, "EPSG:4326", always_xy=True)
            places = np.stack(to_degrees.transform(*places.T), axis=1)
        wanted = utm_zone(places)
    target = _system(wanted, "--crs")
    if not target.is_projected or target.axis_info[0].unit_conversion_factor != 1.0:
        raise SceneError(f"--crs {wanted}: its unit is not the metre; utm takes the map's UTM zone")
    way = pyproj.Transformer.from_crs(source, target, always_xy=True)
    for item in content.features:
        item.points = np.stack(way.transform(*item.points.T), axis=1)
        if not np.isfinite(item.points).all():
            raise SceneError(f"{path}: {item.source} cannot be projected to {wanted}")
    content.note("coordinate system", f"projected from {system} to {wanted}")


def _system(name: str, path: str) -> Any:
    pyproj = needed("pyproj")
    try:
        return pyproj.CRS.from_user_input(name)
    except pyproj.exceptions.CRSError:
        raise SceneError(f"{path}: there is no coordinate system '{name}'") from None
