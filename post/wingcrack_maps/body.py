"""The body around a network: the map's own boundary, or a rectangle with a margin on all sides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from shapely.geometry import Polygon, box

from wingcrack.scenes.errors import SceneError
from wingcrack.scenes.namelist import Value
from wingcrack_maps.features import Area, Line, Map


def assign_roles(content: Map, polygons: str | None, path: str) -> None:
    """Let each polygon be boundary or region, by what the map or the call says.

    `polygons`: role of polygons of which the map says none: ``boundary`` or ``region``.
    """
    for area in content.areas:
        if not area.role and polygons is None:
            raise SceneError(
                f"{path}: {area.source} is a polygon and may be the body or a region: say which by"
                " a property (or column) kind, 'boundary' or 'region', or for all by --polygons"
            )
        area.role = area.role or str(polygons)
    outlines = [area for area in content.areas if area.role == "boundary"]
    if len(outlines) > 1:
        raise SceneError(
            f"{path}: {outlines[0].source} and {outlines[1].source} are both the boundary; the"
            " body has one"
        )
    for area in content.areas:
        if len(area.points) < 3:
            raise SceneError(f"{path}: {area.source}: the polygon has no area")
        if not Polygon(area.points).is_valid:
            raise SceneError(f"{path}: {area.source}: the polygon's outline crosses itself")


def boundary_of(content: Map) -> Area | None:
    """The polygon that is the body, if there is one."""
    return next((area for area in content.areas if area.role == "boundary"), None)


def rectangle_around(lines: Sequence[Line], margin: float | None) -> Polygon:
    """Rectangle around all fractures.

    `margin`: room on each side [m]; half the network's larger extent without it.
    """
    places = np.vstack([line.points for line in lines])
    low, high = places.min(axis=0), places.max(axis=0)
    room = 0.5 * float((high - low).max()) if margin is None else margin
    if margin is None:  # numbers that somebody might write
        grain = 10.0 ** np.floor(np.log10(room) - 0.7)
        low, high = np.floor((low - room) / grain) * grain, np.ceil((high + room) / grain) * grain
    else:
        low, high = low - room, high + room
    return box(float(low[0]), float(low[1]), float(high[0]), float(high[1]))


def domain_values(body: Polygon) -> dict[str, Value]:
    """Entries of &domain: a rectangle where the body is one."""
    x, y = (np.array(body.exterior.coords)[:-1]).T
    low_x, low_y, high_x, high_y = (float(number) for number in body.bounds)
    if len(x) == 4 and body.equals(box(low_x, low_y, high_x, high_y)):
        return {"x_min": low_x, "x_max": high_x, "y_min": low_y, "y_max": high_y}
    return {"shape": "polygon", "x": list(map(float, x)), "y": list(map(float, y))}
