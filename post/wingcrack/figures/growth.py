"""How a fracture network has grown: initial fractures, wings, and the time of each segment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from wingcrack.errors import RunError
from wingcrack.figures.scene import Scene
from wingcrack.figures.table import FloatArray
from wingcrack.figures.vtu import IntArray

_SAME = 1.0e-9  # relative difference of arc lengths that are equal


@dataclass(frozen=True)
class Growth:
    """A fracture, split into what was there and what has grown."""

    number: int  # of the fracture in the files
    name: str  # of the fracture in the scene
    initial: FloatArray  # (n, 2) vertices at the start of the run [m]
    # start, end: (m, 2) wings at the polyline's start and end: the fracture's initial end, then
    # outwards [m]
    start: FloatArray
    end: FloatArray
    # start_steps, end_steps: (m - 1,) step of the network, from 0, in which each segment of the
    # wings was there first
    start_steps: IntArray
    end_steps: IntArray


def read_growth(network: Mapping[str, Any]) -> list[Growth]:
    """Growth of each fracture from the contents of ``network.json``.

    Raises `RunError` if the network has no steps or lacks what a fracture needs.
    """
    try:
        steps = network["steps"]
        first = {item["fracture"]: item for item in steps[0]["fractures"]}
        return [_growth(item, first[item["fracture"]], steps) for item in network["fractures"]]
    except (LookupError, TypeError, ValueError, AttributeError, StopIteration) as reason:
        raise RunError(f"the network is damaged ({reason!r}).") from None


def moment_of(step: Mapping[str, Any]) -> float:
    """Time of a step of network.json [s], or in a mechanics-only run its load factor."""
    return float(step["load_factor"] if "load_factor" in step else step["time_s"])


def _growth(last: Mapping[str, Any], first: Mapping[str, Any], steps: Sequence[Any]) -> Growth:
    number = last["fracture"]
    initial, points = _points(first), _points(last)
    at_start, at_end = _wings(last, initial)
    counts = []
    for step in steps:
        item = next(one for one in step["fractures"] if one["fracture"] == number)
        counts.append(_wings(item, initial))
    return Growth(
        number=int(number),
        name=str(last.get("name") or f"fracture {number}"),
        initial=initial,
        start=points[: at_start + 1][::-1],
        end=points[len(points) - at_end - 1 :],
        start_steps=_steps([start for start, _ in counts], at_start),
        end_steps=_steps([end for _, end in counts], at_end),
    )


def _points(item: Mapping[str, Any]) -> FloatArray:
    points = np.column_stack((item["x_m"], item["y_m"])).astype(np.float64)
    if len(points) < 2 or not np.all(np.isfinite(points)):
        raise ValueError("a fracture needs two points")
    return points


def _wings(item: Mapping[str, Any], initial: FloatArray) -> tuple[int, int]:
    """How many vertices have been added at start and end."""
    points = _points(item)
    arc = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    before = int(np.argmin(np.abs(arc + float(item["s_start_m"]))))
    if not abs(arc[before] + float(item["s_start_m"])) <= _SAME * arc[-1]:
        raise ValueError("s_start_m is no vertex")
    return before, len(points) - len(initial) - before


def _steps(counts: Sequence[int], wanted: int) -> IntArray:
    """Step in which the k-th vertex was there for the first time."""
    return np.array(
        [next(step for step, count in enumerate(counts) if count > k) for k in range(wanted)],
        dtype=np.int64,
    )


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
