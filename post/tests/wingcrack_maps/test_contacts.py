"""What meets within the precision of a map's numbers meets in the scene, wherever its origin is."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely.geometry import box

from map_calls import feature, geojson, imported, needs_solver, rows
from wingcrack_maps.contacts import weld
from wingcrack_maps.features import Line

UTM = np.array([466010.0, 6691571.0])
SAME = 2.0**-50 * UTM[1]


def snapped_network(seed: int, offset: np.ndarray) -> list[np.ndarray]:
    """Polylines around a place; each ends on the first one, as far as numbers can say so."""
    numbers = random.Random(seed)
    lines = [offset + np.array([[-40.0, 1.3], [3.7, -2.1], [44.0, 0.7]])]
    for k in range(12):
        x, side = -36.0 + 6.1 * k, (-1.0) ** k
        free = np.array([x + numbers.uniform(0.0, 3.0), side * numbers.uniform(8.0, 20.0)])
        middle = np.array([x + numbers.uniform(0.0, 2.0), side * numbers.uniform(4.0, 6.0)])
        parent = shapely.LineString(lines[0])
        end = parent.interpolate(parent.project(shapely.Point(offset + np.array([x, 0.0]))))
        lines.append(np.array([offset + free, offset + middle, end.coords[0]]))
    return lines


def misses(lines: list[Line]) -> np.ndarray:
    """Distances of the ends of all lines but the first from the first one."""
    return np.array([
        shapely.LineString(lines[0].points).distance(shapely.Point(line.points[-1]))
        for line in lines[1:]
    ])  # fmt: skip


@pytest.mark.parametrize("seed", range(5))
def test_snapped_ends_meet_after_a_shift(seed: int) -> None:
    """Exact to the last digit of coordinates of some 40 m, after they were known to 1e-9 m."""
    lines = [Line(str(k), places - UTM) for k, places in enumerate(snapped_network(seed, UTM))]
    assert misses(lines).max() > 1e-11
    welded, number, largest = weld(lines, None, SAME)
    assert misses(welded).max() == 0.0
    assert number > 0
    assert 0.0 < largest <= SAME
    assert [line.name for line in welded] == [line.name for line in lines]
    for new, old in zip(welded, lines, strict=True):
        assert (
            shapely.LineString(new.points).hausdorff_distance(shapely.LineString(old.points))
            <= 2.0 * SAME
        )
    again, number, _ = weld(welded, None, SAME)
    assert number == 0
    assert again == welded


def test_vertices_and_ends_on_the_boundary() -> None:
    gap = 0.5 * SAME
    lines = [
        Line("a", np.array([[0.0, 0.0], [10.0 - gap, 3.0]])),
        Line("b", np.array([[gap, gap], [4.0, 9.0]])),
        Line("c", np.array([[-3.0, 2.0], [0.0, -gap], [5.0, -8.0]])),
    ]
    welded, number, _ = weld(lines, box(-10.0, -10.0, 10.0, 10.0), SAME)
    assert number == 3
    assert welded[0].points.tolist() == [[0.0, 0.0], [10.0, 3.0]]
    assert welded[1].points[0].tolist() == welded[2].points[1].tolist() == [0.0, 0.0]


def test_what_meets_exactly_or_is_apart_stays_as_it_is() -> None:
    lines = [Line(str(k), places) for k, places in enumerate(snapped_network(0, np.zeros(2)))]
    lines.append(Line("apart", np.array([[-40.0, 1.3 + 2.0 * SAME], [-50.0, 20.0]])))
    welded, number, _ = weld(lines, None, SAME)
    assert number == 0
    assert all(new is old for new, old in zip(welded, lines, strict=True))


@needs_solver
@pytest.mark.parametrize("repair", [(), ("--repair", "0.05")])
@pytest.mark.parametrize("origin", [(), ("--origin", "centre"), ("--origin", "466000,6691500.1")])
def test_a_map_is_accepted_wherever_its_origin_is(
    tmp_path: Path, origin: tuple[str, ...], repair: tuple[str, ...]
) -> None:
    lines = (feature(*places.tolist()) for places in snapped_network(1, UTM))
    path = geojson(tmp_path / "m.geojson", *lines)
    status, scene = imported(path, "--unit", "m", *origin, *repair)
    assert status == 0
    assert ("precision", "", "") in rows(scene, "noted") or not origin
