"""Maps from well-known text, one geometry a line; `SRID=25832;` may precede it."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
import shapely

from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.geometry import add_geometry
from wingcrack_maps.units import refuse_degrees

_DEEPEST = 100  # brackets within one another: GEOS ends the process at some thousand


def read_wkt(text: str, path: str) -> Map:
    """Read all lines that are neither empty nor comments (#)."""
    found = Map()
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            geometry = geometry_of(line.strip(), path, f"line {number}")
            add_geometry(found, geometry, {}, path, f"line {number}")
    return found


def geometry_of(text: str, path: str, source: str) -> shapely.Geometry:
    """Read one geometry."""
    head, separator, rest = text.partition(";")
    if separator and head.upper().startswith("SRID="):
        refuse_degrees(path, head)
        text = rest
    opened = accumulate((mark == "(") - (mark == ")") for mark in text if mark in "()")
    try:
        if "\0" in text or max(opened, default=0) > _DEEPEST:
            raise ValueError(f"it has a zero byte, or more than {_DEEPEST} brackets in one another")
        with np.errstate(all="ignore"):  # numbers that are too large are refused with the others
            return shapely.from_wkt(text)
    except (ValueError, shapely.errors.ShapelyError) as reason:
        raise SceneError(
            f"{path}: {source} is no well-known text such as LINESTRING (0 0, 1 2):"
            f" {' '.join(str(reason).split())}"
        ) from None
