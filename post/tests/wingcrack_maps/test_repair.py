"""Each fault is found where it is, left alone unless asked, and repaired as it says."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import numpy as np
import pytest
from shapely.geometry import LineString, Point, box

from wingcrack_maps.faults import Limits, Search, find_faults
from wingcrack_maps.features import Line
from wingcrack_maps.repair import repair

LIMITS = Limits(0.1, 5.0, 1e-8)
Places = Sequence[tuple[float, float]]

CASES: dict[str, list[Places]] = {
    "short segment": [[(0, 0), (5, 0), (5.05, 0.02), (9, 1)]],
    "repeated vertex": [[(0, 0), (5, 0), (5, 0), (9, 1)]],
    "hairpin": [[(0, 0), (5, 0), (2, 0.1)]],
    "short fracture": [[(0, 0), (5, 0)], [(8, 8), (8.05, 8)]],
    "duplicate": [[(0, 0), (5, 0)], [(5, 0.01), (0, 0.01)]],
    "overlap": [[(0, 0), (5, 0)], [(4, 0), (8, 0)]],
    "end past": [[(0, 0), (5, 0)], [(2, 3), (2, -0.05)]],
    "near end": [[(0, 0), (5, 0)], [(2, 3), (2, 0.05)]],
    "near vertex": [[(0, 0), (5, 0)], [(0, 3), (2, 0.05), (4, 3)]],
    "near crossings": [[(0, 0), (5, 0)], [(2, -2), (2, 2)], [(1.05, -1), (3.05, 1)]],
}


def lines_of(places: Sequence[Places]) -> list[Line]:
    return [Line(f"f{k}", np.array(p, dtype=float)) for k, p in enumerate(places, start=1)]


@pytest.mark.parametrize("kind", CASES)
def test_a_fault_is_found_and_repaired(kind: str) -> None:
    lines = lines_of(CASES[kind])
    assert kind in [fault.kind for fault in find_faults(lines, None, LIMITS)]
    repaired, done = repair(lines, None, LIMITS, "join")
    assert kind in [one.kind for one in done]
    assert find_faults(repaired, None, LIMITS) == []
    assert sum(one.length_change for one in done) == pytest.approx(
        sum(line.length for line in repaired) - sum(line.length for line in lines), abs=1e-9
    )


def test_a_near_end_is_joined_or_cut_back() -> None:
    lines = lines_of(CASES["near end"])
    joined, _ = repair(lines, None, LIMITS, "join")
    assert joined[1].points[-1].tolist() == [2.0, 0.0]
    apart, _ = repair(lines, None, LIMITS, "gap")
    assert apart[1].points[-1].tolist() == pytest.approx([2.0, 0.101])


@pytest.mark.parametrize("is_start", [True, False])
@pytest.mark.parametrize(
    ("other", "line"),
    [
        ([(0, 0), (5, 0), (5, 6), (0, 6)], [(2, -3), (2, 5.95)]),  # crosses it elsewhere
        ([(0, 0), (5, 0), (5, 3), (0, 3), (0, 6), (5, 6)], [(2, -3), (2, 5.95)]),  # and twice
        ([(0, 0), (5, 0), (5, 6), (0, 6)], [(2, 0), (2, 5.95)]),  # is joined to it
        ([(0, 0), (5, 0), (5, 6), (0, 6)], [(1, 3), (3, 3), (3, 1), (2, 1), (2, 5.95)]),  # itself
        ([(4, 6), (0, 6)], [(4, 3), (2.5, 5), (2, 5.95)]),  # arrives askew
    ],
)
def test_nothing_but_the_end_is_cut_back(other: Places, line: Places, is_start: bool) -> None:
    """The last segment rises towards y = 6 and is cut 1.01 distances below it."""
    line = line[::-1] if is_start else line
    repaired, done = repair(lines_of([other, line]), None, LIMITS, "gap")
    (foot, top) = (line[1], line[0]) if is_start else line[-2:]
    y = 6 - 1.01 * LIMITS.near
    end = (foot[0] + (top[0] - foot[0]) * (y - foot[1]) / (top[1] - foot[1]), y)
    wanted = [end, *line[1:]] if is_start else [*line[:-1], end]
    assert repaired[1].points.ravel().tolist() == pytest.approx(np.ravel(wanted).tolist())
    assert [one.kind for one in done] == ["near end"]
    assert done[0].length_change == pytest.approx(-math.dist(end, top))


def test_of_an_overlap_the_rest_goes_on_from_the_other_fracture() -> None:
    repaired, _ = repair(lines_of(CASES["overlap"]), None, LIMITS, "join")
    assert [line.points.tolist() for line in repaired] == [[[0, 0], [5, 0]], [[5, 0], [8, 0]]]


def test_a_flat_crossing_is_parted_and_both_parts_are_named() -> None:
    lines = lines_of([[(-9, 0), (9, 0)], [(-8, -0.2), (8, 0.2)]])
    repaired, done = repair(lines, None, LIMITS, "join")
    assert [line.name for line in repaired] == ["f1", "f2.1", "f2.2"]
    assert "parted into f2.1, f2.2" in done[0].what
    assert find_faults(repaired, None, LIMITS) == []


def test_sound_networks_are_left_as_they_are() -> None:
    sound = lines_of([[(0, 0), (5, 0)], [(2, -2), (2, 2)], [(5, 0), (7, 3)], [(3, 0), (3, -3)]])
    assert find_faults(sound, box(-9, -9, 9, 9), LIMITS) == []
    assert repair(sound, box(-9, -9, 9, 9), LIMITS, "join") == (sound, [])


def test_a_line_that_crosses_itself_is_told_and_kept() -> None:
    lines = lines_of([[(0, 0), (4, 0), (4, 2), (2, 2), (2, -2)]])
    assert [fault.kind for fault in find_faults(lines, None, LIMITS)] == ["self-crossing"]
    assert find_faults(lines, None, LIMITS)[0].place == (2.0, 0.0)
    assert repair(lines, None, LIMITS, "join") == (lines, [])


@pytest.mark.parametrize(
    ("places", "kind"),
    [
        ([(0, 0), (20, 0)], "outside"),
        ([(0, 0), (9.95, 0)], "near end"),
        ([(-9, 9.97), (5, 9.97)], "overlap"),
        ([(0, 0), (10, 5), (0, 8)], "inner vertex"),
        ([(0, 0), (10, 9.95)], "near corner"),
    ],
)
def test_faults_at_the_boundary(places: Places, kind: str) -> None:
    body = box(-10, -10, 10, 10)
    lines = lines_of([places, [(-5, -5), (-2, -6)]])
    assert kind in [fault.kind for fault in find_faults(lines, body, LIMITS)]
    repaired, _ = repair(lines, body, LIMITS, "join")
    assert find_faults(repaired, body, LIMITS) == []
    assert all(body.buffer(1e-9).contains(LineString(line.points)) for line in repaired)


@pytest.mark.parametrize("way", [1, -1])
def test_what_leaves_the_body_is_found_at_its_end(way: int) -> None:
    lines = lines_of([[(-18, 0), (17, 0)][::way], [(0, 5), (0, 14)][::way]])
    first, second = find_faults(lines, box(-10, -10, 10, 10), LIMITS)
    assert {first.kind, second.kind} == {"outside"}
    assert first.place in {(-18.0, 0.0), (17.0, 0.0)}
    assert first.size == pytest.approx(8.0 + 7.0, abs=1e-6)
    assert second.size == pytest.approx(4.0, abs=1e-6)
    assert second.place[1] == pytest.approx(10.0 if way == 1 else 14.0, abs=1e-6)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("ends", ["join", "gap"])
def test_careless_networks_are_repaired_whatever_they_are(seed: int, ends: str) -> None:
    """Random walks on a coarse grid with noise: all faults at once, and nothing may be left."""
    numbers = random.Random(seed)
    lines = []
    for k in range(30):
        x, y = float(numbers.randrange(12)), float(numbers.randrange(12))
        places = []
        angle = math.radians(45.0 * numbers.randrange(8))
        for _ in range(numbers.randrange(2, 5)):
            places.append((x + numbers.gauss(0.0, 0.03), y + numbers.gauss(0.0, 0.03)))
            angle += math.radians(numbers.choice((0.0, 0.0, 45.0, -45.0)))
            step = numbers.choice((2.0, 3.0))
            x, y = x + step * math.cos(angle), y + step * math.sin(angle)
        lines.append(Line(f"f{k}", np.array(places)))
    repaired, done = repair(lines, None, LIMITS, ends)
    left = [f for f in find_faults(repaired, None, LIMITS) if f.kind != "self-crossing"]
    assert left == []
    assert done
    # no place of what is left is new: each is within a few distances of the old map
    old = [LineString(line.points) for line in lines]
    for line in repaired:
        for place in line.points:
            assert min(Point(place).distance(shape) for shape in old) < 5 * LIMITS.near


def test_a_crossing_at_a_small_angle_is_no_duplicate() -> None:
    """Two lines of 100 m that cross at 1.26 degrees, all within the distance of 2.5 m."""
    lines = lines_of([[(0, 0), (100, 0)], [(0, -1), (100, 1.2)]])
    limits = Limits(2.5, 5.0, 1e-8)
    [fault] = find_faults(lines, None, limits)
    assert fault.kind == "flat crossing"
    assert fault.size == pytest.approx(math.degrees(math.atan2(2.2, 100.0)))
    assert fault.place == pytest.approx((100.0 / 2.2, 0.0))
    assert find_faults(repair(lines, None, limits, "join")[0], None, limits) == []


def test_a_short_flat_meeting_is_found() -> None:
    """The first segment runs on the other fracture over less than the distance."""
    lines = lines_of([[(0, 0), (9, 0)], [(4, 0), (4.12, 0), (6, 4)]])
    assert [fault.kind for fault in find_faults(lines, None, LIMITS)] == ["overlap"]
    assert find_faults(repair(lines, None, LIMITS, "join")[0], None, LIMITS) == []


@pytest.mark.parametrize("seed", range(3))
def test_changed_networks_are_examined_as_new_ones(seed: int) -> None:
    """After any changes the search that goes on finds what a new one finds."""
    numbers = np.random.default_rng(seed)
    lines = lines_of([numbers.uniform(0.0, 9.0, (3, 2)).tolist() for _ in range(40)])
    search = Search(box(0.0, 0.0, 9.0, 9.0), LIMITS)
    for _ in range(6):
        assert search.faults(lines) == find_faults(lines, search.body, LIMITS)
        kept = [line for line in lines if numbers.random() < 0.8]
        moved = Line("new", numbers.uniform(0.0, 9.0, (3, 2)))
        lines = [*kept[:9], moved, *kept[9:]]
