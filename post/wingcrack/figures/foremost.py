"""The order of many fractures: first those with a well, then those that grow, then long ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wingcrack.figures.growth import Growth
from wingcrack.figures.scene import Scene
from wingcrack.figures.table import FloatArray

MOST = 12  # fractures that are named on a map, or get a figure each


def foremost(growths: Sequence[Growth], scene: Scene | None) -> list[Growth]:
    """Give the fractures in their order of interest, at most `MOST` of them.

    First those that a well feeds, then those that have grown, and among equals the longest at the
    end of the run.
    """
    fed = {well.fracture for well in scene.wells} if scene else set()

    def rank(item: Growth) -> tuple[bool, bool, float]:
        grown = len(item.start) > 1 or len(item.end) > 1
        length = sum(_length(part) for part in (item.initial, item.start, item.end))
        return item.name not in fed, not grown, -length

    return sorted(growths, key=rank)[:MOST]


def _length(points: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
