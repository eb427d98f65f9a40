"""Distance of paths against values found by hand, and the rows of a network."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from small_case import small_case
from wingcrack.errors import CaseError
from wingcrack.sweeps.expressions import Array
from wingcrack.sweeps.paths import network_table, path_distance
from wingcrack_verify.judge import ERROR, PASSED


def path(*points: tuple[float, float]) -> Array:
    return np.array(points)


def arc(radius: float, until: float, pieces: int) -> Array:
    angle = np.linspace(0.0, until, pieces + 1)
    return np.column_stack((radius * np.sin(angle), radius * (1.0 - np.cos(angle))))


def test_parallel_lines() -> None:
    one = path((0.0, 0.0), (1.0, 0.0), (4.0, 0.0))
    other = path((0.0, 0.3), (2.5, 0.3), (4.0, 0.3))
    assert path_distance(one, other) == pytest.approx(0.3, rel=1.0e-12)
    assert path_distance(one, one) == 0.0


def test_the_longer_path_is_cut_off() -> None:
    short = path((0.0, 0.0), (1.0, 0.0))
    long = path((0.0, 0.0), (1.0, 0.0), (1.0, 5.0))
    assert path_distance(short, long) == pytest.approx(0.0, abs=1.0e-12)
    assert path_distance(long, short) == pytest.approx(0.0, abs=1.0e-12)


def test_a_detour_counts_from_either_path() -> None:
    straight = path((0.0, 0.0), (4.0, 0.0))
    detour = path((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (3.0, 1.0))
    assert path_distance(straight, detour) == pytest.approx(math.hypot(1.0, 1.0), rel=1.0e-12)
    assert path_distance(detour, straight) == path_distance(straight, detour)


def test_a_curve_and_its_chords() -> None:
    # sagitta of a chord of 0.25 rad, from both paths cut at the chords' length (a little shorter)
    sagitta = 1.0 - math.cos(0.125)
    found = path_distance(arc(1.0, 1.0, 4), arc(1.0, 1.0, 4000))
    assert found == pytest.approx(sagitta, rel=1.0e-3)


def test_repeated_points_do_no_harm() -> None:
    one = path((0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (1.0, 0.0))
    other = path((0.0, 0.1), (1.0, 0.1), (1.0, 0.1))
    assert path_distance(one, other) == pytest.approx(0.1, rel=1.0e-12)


def test_a_point_is_no_path() -> None:
    with pytest.raises(CaseError, match="no length"):
        path_distance(path((0.0, 0.0), (0.0, 0.0)), path((0.0, 0.0), (1.0, 0.0)))


def network(x: list[float], s_start: float) -> dict[str, object]:
    fracture = {
        "fracture": 1,
        "name": "flaw",
        "s_start_m": s_start,
        "x_m": x,
        "y_m": [0.5] * len(x),
    }
    return {"time_s": 0.25 * len(x), "fractures": [fracture]}


def write_network(place: Path, last: dict[str, object]) -> Path:
    steps = [network([0.0, 1.0], 0.0), network([-0.5, 0.0, 1.0, 1.5], -0.5), last]
    content = {"fractures": last["fractures"], "steps": steps, "joints": []}
    (place / "network.json").write_text(json.dumps(content))
    return place / "network.json"


def test_a_network_is_split_into_initial_part_and_wings(tmp_path: Path) -> None:
    file = write_network(tmp_path, network([-1.0, -0.5, 0.0, 1.0, 1.5], -1.0))
    table = network_table(file)
    rows = list(zip(table.text("part"), table.number("x_m"), table.number("s_m"), strict=True))
    assert rows == [
        ("initial", 0.0, 0.0),
        ("initial", 1.0, 1.0),
        ("start", 0.0, 0.0),
        ("start", -0.5, 0.5),
        ("start", -1.0, 1.0),
        ("end", 1.0, 0.0),
        ("end", 1.5, 0.5),
    ]
    assert set(table.text("name")) == {"flaw"}
    assert set(table.number("y_m")) == {0.5}


@pytest.mark.parametrize("s_start", [-0.7, float("nan")])
def test_a_damaged_network_is_refused(tmp_path: Path, s_start: float) -> None:
    file = write_network(tmp_path, network([-1.0, -0.5, 0.0, 1.0, 1.5], s_start))
    with pytest.raises(CaseError, match=r"network\.json"):
        network_table(file)


def test_a_missing_network_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="missing"):
        network_table(tmp_path / "network.json")


def test_paths_of_networks_are_compared(tmp_path: Path) -> None:
    case = small_case(tmp_path, "path")
    wing = 'file = "network.json", column = "y_m", x = "x_m", where = { part = "start" }'
    case.toml = case.toml.replace(
        '{ file = "profile.csv", column = "p_pa", x = "x_m" }', f"{{ {wing} }}"
    )
    mirrored = wing.replace("start", "end").replace('"x_m"', '"1 - x_m"')
    case.toml = case.toml.replace(
        '{ file = "reference.csv", column = "p_pa", x = "x_m" }',
        f"{{ {mirrored} }}".replace("file =", "run_file ="),
    ).replace("order = { expected = 2.0, within = 0.1 }\n", "runs = ['fine']\n")
    last = network([-1.0, -0.5, 0.0, 1.0, 1.5, 2.0], -1.0)
    write_network(case.results / "fine", last)
    assert case.judge().verdict == PASSED


def test_a_path_needs_a_scale(tmp_path: Path) -> None:
    case = small_case(tmp_path, "path")
    case.toml = case.toml.replace("scale = 1.0\n", "")
    assert case.judge().verdict == ERROR


def test_a_path_is_compared_with_a_path(tmp_path: Path) -> None:
    case = small_case(tmp_path, "path")
    case.toml = case.toml.replace('{ file = "reference.csv", column = "p_pa", x = "x_m" }', "1.0")
    report = case.judge()
    assert report.verdict == ERROR
    assert "takes a selection with 'x'" in report.broken
