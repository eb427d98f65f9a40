"""Paths of cracks: how far two polylines lie apart, and the parts of a network as rows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from wingcrack.errors import CaseError, RunError
from wingcrack.figures.growth import read_growth
from wingcrack.figures.table import Table
from wingcrack.figures.text_files import read_json
from wingcrack.sweeps.expressions import Array

NETWORK = "network.json"  # the file that is read as a table of vertices
COLUMNS = ("fracture", "name", "part", "vertex", "s_m", "x_m", "y_m")


def path_distance(first: Array, second: Array) -> float:
    """Largest distance between two paths, both ways, up to the arc length of the shorter one.

    Both begin at the same place of a crack, so each is cut off at an arc length from its first
    point. Of every point of one path the distance to the nearest place of the other counts (the
    Hausdorff distance of polylines, whose maximum is taken at vertices where the paths are nearly
    parallel; segments are halved until they are short compared with the distance found). Raises
    `CaseError` if a path has no length.

    `first` and `second` (n, 2), (m, 2): points of the polylines [m].
    """
    length = min(_length(first), _length(second))
    if not length > 0.0:
        raise CaseError("a path has no length")
    one, other = _cut(first, length), _cut(second, length)
    return max(_one_way(one, other), _one_way(other, one))


def network_table(path: Path) -> Table:
    """Vertices of network.json: for each fracture its part `initial`, and `start` and `end`.

    The wings `start` and `end` begin with the initial end of the fracture and lead outwards; `s_m`
    is the arc length from there. Of the initial part it is that from its first vertex. A wing that
    has not grown has no rows. Raises `CaseError` if the file is missing, or not what it should be.
    """
    try:
        content: Any = read_json(path)
        growths = read_growth(content)
    except FileNotFoundError:
        raise CaseError(f"{path.name}: the file is missing") from None
    except (ValueError, RunError) as reason:
        raise CaseError(f"{path.name}: {reason}") from None
    rows: list[tuple[str, ...]] = []
    for item in growths:
        parts = (("initial", item.initial), ("start", item.start), ("end", item.end))
        for part, points in parts:
            if part != "initial" and len(points) < 2:
                continue
            arc = np.concatenate(([0.0], np.cumsum(_steps(points))))
            rows += [
                (str(item.number), item.name, part, str(k), *map(repr, map(float, (s, *xy))))
                for k, (s, xy) in enumerate(zip(arc, points, strict=True), start=1)
            ]
    cells = dict(zip(COLUMNS, zip(*rows, strict=True), strict=True)) if rows else {}
    return Table(path, {name: cells.get(name, ()) for name in COLUMNS}, len(rows))


def _steps(points: Array) -> Array:
    return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))


def _length(points: Array) -> float:
    return float(_steps(points).sum())


def _cut(points: Array, length: float) -> Array:
    """Path up to an arc length, with points closer than a thousandth of it."""
    arc = np.concatenate(([0.0], np.cumsum(_steps(points))))
    wanted = np.union1d(arc[arc < length], np.linspace(0.0, length, 1001))
    return np.column_stack([np.interp(wanted, arc, points[:, axis]) for axis in (0, 1)])


def _one_way(points: Array, path: Array) -> float:
    """Largest distance of the points to the nearest place of the path."""
    start, edge = path[:-1], np.diff(path, axis=0)
    keep = np.sum(edge**2, axis=1) > 0.0
    start, edge = start[keep], edge[keep]
    largest = 0.0
    for point in points:
        share = np.sum((point - start) * edge, axis=1) / np.sum(edge**2, axis=1)
        foot = start + np.clip(share, 0.0, 1.0)[:, None] * edge
        largest = max(largest, float(np.min(np.linalg.norm(foot - point, axis=1))))
    return largest
