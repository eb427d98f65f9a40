"""Units of length, coordinate systems in degrees, and the origin."""

from __future__ import annotations

import re

import numpy as np

from wingcrack.runs.units import FARTHEST
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map, Points

_DIGITS = 2.0**-50
"""Of numbers in double precision, with room for a few operations on them."""

METRES = {"m": 1.0, "km": 1000.0, "ft": 0.3048, "cm": 0.01, "mm": 0.001}

# Projected systems among the numbers that the EPSG registry otherwise gives to geographic ones.
_PROJECTED = (range(4087, 4089), range(4217, 4218), range(4399, 4464), range(4484, 4490),
              range(4491, 4556), range(4559, 4560), range(4568, 4600), range(4647, 4648),
              range(4652, 4658), range(4766, 4801), range(4822, 4823), range(4826, 4827),
              range(4839, 4840), range(4855, 4881))  # fmt: skip


def refuse_degrees(path: str, system: str, content: Map) -> None:
    """Refuse a map in degrees with the system that it may be projected to."""
    zone = utm_zone(np.vstack(_all_points(content)))
    raise SceneError(
        f"{path}: its coordinate system {system} is in degrees of longitude and latitude, but"
        f" lengths are needed: --crs {zone} projects it (UTM, in metres), as --crs utm does"
    )


def utm_zone(places: Points) -> str:
    """The UTM zone of places in degrees, by its name in the EPSG registry.

    Examples
    --------
    >>> utm_zone(np.array([[5.3, 60.4]])), utm_zone(np.array([[-70.0, -33.0]]))
    ('EPSG:32631', 'EPSG:32719')
    """
    longitude, latitude = places.mean(axis=0)
    zone = int((longitude + 180.0) // 6.0) % 60 + 1
    return f"EPSG:{(32600 if latitude >= 0.0 else 32700) + zone}"


def in_degrees(system: str) -> bool:
    """Whether a coordinate system is a geographic one, as far as its name tells.

    Examples
    --------
    >>> in_degrees("urn:ogc:def:crs:OGC:1.3:CRS84"), in_degrees("EPSG:25832")
    (True, False)
    """
    if re.search(r"CRS:?8[34]|CRS:?27|WGS ?84$|^GEOG", system, re.IGNORECASE):
        return True
    code = re.search(r"EPSG.*?(\d+)$|^(?:SRID=)?(\d+)$", system, re.IGNORECASE)
    if code is None or len(code[0]) > 100:
        return False
    number = int(code[1] or code[2])
    return 4000 <= number < 5000 and not any(number in numbers for numbers in _PROJECTED)


def could_be_degrees(content: Map) -> bool:
    """Whether all numbers of a map could be longitudes and latitudes."""
    places = np.vstack(_all_points(content))
    return bool((np.abs(places[:, 0]) <= 180.0).all() and (np.abs(places[:, 1]) <= 90.0).all())


def scale(content: Map, unit: str, path: str) -> None:
    """Turn all coordinates into metres.

    Raises `SceneError` if one is farther from the origin than the earth is wide.
    """
    places = np.abs(np.vstack(_all_points(content)))
    content.precision = _DIGITS * float(places.max()) * METRES[unit]
    for item in content.features:
        item.points = item.points * METRES[unit]
        if np.abs(item.points).max() > FARTHEST:
            raise SceneError(
                f"{path}: {item.source} has a coordinate of {np.abs(item.points).max():.3g} m, but"
                f" none may be beyond {FARTHEST:.0e} m"
            )


def shift(content: Map, origin: str) -> None:
    """Make a place of the map the origin, and note which.

    `origin`: ``centre`` or ``corner`` of what the map covers, or ``X,Y`` in metres.
    """
    places = np.vstack(_all_points(content))
    low, high = places.min(axis=0), places.max(axis=0)
    if origin == "centre":
        place = np.round(0.5 * (low + high))
    elif origin == "corner":
        place = np.floor(low)
    else:
        place = np.array([float(word) for word in origin.split(",")])
    for item in content.features:
        item.points = item.points - place
    content.note(
        "shift", f"({place[0]:.10g}, {place[1]:.10g}) m of the map is the origin of the scene"
    )


def _all_points(content: Map) -> list[Points]:
    return [item.points for item in content.features]
