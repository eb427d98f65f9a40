"""Cracks that grow with a fluid until they come to fractures, sides and each other."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from system_scene import TOP, changed, numbers, record, rows, run

pytestmark = pytest.mark.usefixtures("program")

TEE = (TOP / "verification/growth_joints/t.nml").read_text()
BAR = TEE[TEE.index("&fracture\n  name = 'bar'") : TEE.index("&side name = 'left'")]


def tee(*changes: tuple[str, str]) -> str:
    """Give the scene with pieces replaced."""
    return changed(TEE, ("time end = 84.0", "time end = 80.0"), *changes)


def joints(out: Path) -> list[dict[str, str]]:
    """Give the events in which something has been joined."""
    return [row for row in rows(out / "events.csv") if row["kind"] == "joint"]


@pytest.fixture(scope="module")
def joined(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the run of the scene as it is."""
    return run(tmp_path_factory.mktemp("joined"), tee())


def test_a_joint_lets_the_pressure_fall(joined: Path) -> None:
    """In the step of the joint; the tip that has joined is none any more, and no fluid is lost."""
    out = joined
    (joint,) = joints(out)
    assert (joint["fracture"], joint["detail"]) == ("1", "joins fracture bar")
    history = rows(out / "history.csv")
    at = [row["time_s"] for row in history].index(joint["time_s"])
    pressure = numbers(out / "history.csv", "well_pressure_pa")
    assert pressure[at] < pressure[at - 1] - 3.0e4
    assert [row["n_tips"] for row in history[at - 1 : at + 1]] == ["4", "3"]
    assert [row["n_intersections"] for row in history[at - 1 : at + 1]] == ["0", "1"]
    late = {row["tip"] for row in rows(out / "tips.csv") if float(row["time_s"]) > 79.0}
    assert late == {"1", "3", "4"}
    mass_error = record(out)["mass_error_relative"]
    assert isinstance(mass_error, float)
    assert mass_error < 1.0e-9
    network = json.loads((out / "network.json").read_text())
    assert [(j["kind"], j["fractures"]) for j in network["joints"]] == [("T", [1, 2])]
    assert sorted(tip["tip"] for tip in network["tips"]) == [1, 3, 4]
    run_json = (out / "run.json").read_text()
    assert "intersections: flow from fracture" in run_json
    assert "fractures do not meet" not in run_json


def test_the_law_of_advances_joins_too(tmp_path: Path) -> None:
    """At the end of a step, and the pressure falls in the short ones that follow."""
    out = run(
        tmp_path,
        tee(
            ("increment = 0.05", "increment = 0.05, law = 'paris', threshold = 0.5"),
            ("end = 80.0", "end = 75.0, step = 2.0"),
        ),
    )
    (joint,) = joints(out)
    assert joint["detail"] == "joins fracture bar"
    history = rows(out / "history.csv")
    at = [row["time_s"] for row in history].index(joint["time_s"])
    assert [row["n_tips"] for row in history[at : at + 2]] == ["4", "3"]
    pressure = numbers(out / "history.csv", "well_pressure_pa")
    assert pressure[at + 1] < pressure[at] - 5.0e4
    mass_error = record(out)["mass_error_relative"]
    assert isinstance(mass_error, float)
    assert mass_error < 1.0e-9


def test_ends_that_almost_touch_join_at_once(tmp_path: Path) -> None:
    """At K_IC, over 0.2 mm with cells of 100 mm; the run says beforehand that they will.

    K_I = s sqrt(pi a) of the stem alone, whatever lies beside it, as it is pressed along itself so
    much that the bars do not open ahead of its tips.
    """
    other = BAR.replace("'bar'", "'other'").replace("x = 0.8, 0.8", "x = -0.8, -0.8")
    out = run(
        tmp_path,
        tee(
            (BAR, BAR + other),
            ("x = -0.65, 0.65", "x = -0.7998, 0.7998"),
            ("x_traction = -4.0e6", "x_traction = -1.0e8"),
            ("size_fracture = 0.05", "size_fracture = 0.1"),
            ("increment = 0.05", "increment = 0.1"),
            ("end = 80.0", "end = 85.0"),
        ),
    )
    warnings = record(out)["warnings"]
    assert isinstance(warnings, list)
    for name in ("bar", "other"):
        assert any(f"&fracture 'stem' to '{name}': gap is 2.0e-4 m" in text for text in warnings)
    left, right = joints(out)
    assert {left["detail"], right["detail"]} == {"joins fracture bar", "joins fracture other"}
    onset = 1.0e6 / math.sqrt(math.pi * 0.7998)
    volume = 2.0 * math.pi * 0.7998**2 / 3.2e10 * onset
    time = volume * (1.0 + 4.0e-9 * (2.0e6 + onset)) / 1.0e-6
    # K to 0.5 %, the step to 0.5 % of the time, and the equilibrium to twice 0.5 % of K.
    assert float(left["time_s"]) == pytest.approx(time, rel=0.02)
    assert left["time_s"] == right["time_s"]
    history = rows(out / "history.csv")
    assert [history[0]["n_tips"], history[-1]["n_tips"]] == ["6", "4"]
    mass_error = record(out)["mass_error_relative"]
    assert isinstance(mass_error, float)
    assert mass_error < 1.0e-9


def test_a_stub_is_a_tip_of_its_own(tmp_path: Path) -> None:
    """The stem goes 1 mm past the bar: it is warned of, and runs to the end."""
    out = run(tmp_path, tee(("x = -0.65, 0.65", "x = -0.65, 0.801")))
    warnings = record(out)["warnings"]
    assert isinstance(warnings, list)
    assert any("&fracture 'stem' past 'bar': stub is 0.001 m" in text for text in warnings)
    assert rows(out / "history.csv")[-1]["n_intersections"] == "1"


def test_many_cells_make_no_difference(joined: Path, tmp_path: Path) -> None:
    """Growth and a joint on the sparse equations of many fracture cells, beside the full ones.

    States agree to 1e-9; where the tries of a step end, within 0.5 % of K_IC, is not as certain.
    """
    sparse = ("size_fracture = 0.05", "condensation = 'sparse', size_fracture = 0.05")
    ways = (joined, run(tmp_path, tee(sparse)))
    times = [joints(out)[0]["time_s"] for out in ways]
    assert float(times[0]) == pytest.approx(float(times[1]), rel=1.0e-3)
    for column in ("well_pressure_pa", "fracture_length_m"):
        full, other = (numbers(out / "history.csv", column)[-1] for out in ways)
        assert full == pytest.approx(other, rel=1.0e-3)


def test_nothing_is_joined_from_afar(tmp_path: Path) -> None:
    """A crack goes on past the end of a fracture that it does not touch, 2 mm beside it."""
    out = run(tmp_path, tee(("y = -0.31, 0.29", "y = 0.002, 0.6")))
    assert joints(out) == []
    assert max(float(row["x_m"]) for row in rows(out / "tips.csv") if row["tip"] == "2") > 0.8


def test_two_joints_in_one_step(tmp_path: Path) -> None:
    """A crack between two fractures, whose tips are alike, joins both at once."""
    other = BAR.replace("'bar'", "'other'").replace("x = 0.8, 0.8", "x = -0.8, -0.8")
    out = run(tmp_path, tee((BAR, BAR + other)))
    left, right = joints(out)
    assert left["time_s"] == right["time_s"]
    assert {left["detail"], right["detail"]} == {"joins fracture bar", "joins fracture other"}


def test_cracks_meet(tmp_path: Path) -> None:
    """Two wells, two cracks one after the other: they become one."""
    other = (
        BAR.replace("'bar'", "'other'")
        .replace("aperture = 1.0e-3", "aperture = 1.0e-6")
        .replace("x = 0.8, 0.8", "x = 0.8, 2.1")
        .replace("y = -0.31, 0.29", "y = 0.0, 0.0")
        .replace("friction = 9.0", "friction = 0.5")
    )
    well = "&injection fracture = 'stem', rate = 1.0e-6 /\n"
    out = run(tmp_path, tee((BAR, other), (well, well + well.replace("stem", "other"))))
    assert len(joints(out)) >= 1
    network = json.loads((out / "network.json").read_text())
    assert [(j["kind"], j["fractures"]) for j in network["joints"]] == [("V", [1, 2])]
    assert sorted(tip["tip"] for tip in network["tips"]) == [1, 4]


def test_a_crossing_grows(tmp_path: Path) -> None:
    """Fractures that meet at the start may grow: the one that crosses the stem stays as it is."""
    upright = BAR.replace("'bar'", "'upright'").replace("x = 0.8, 0.8", "x = 0.0, 0.0")
    out = run(tmp_path, tee((BAR, BAR + upright), ("end = 80.0", "end = 95.0")))
    network = json.loads((out / "network.json").read_text())
    assert sorted(j["kind"] for j in network["joints"]) == ["T", "X"]


def test_a_hook_joins_itself(tmp_path: Path) -> None:
    """A fracture from the left side turns back; pulled at, it comes to where it has been."""
    out = run(
        tmp_path,
        tee(
            (BAR, ""),
            ("x_min = -12.0", "x_min = -0.5"),
            ("x_max = 12.0, y_min = -12.0, y_max = 12.0", "x_max = 6.0, y_min = -6.0, y_max = 6.0"),
            ("x = -0.65, 0.65", "x = -0.5, 0.5, 0.6, 0.3, 0.05, 0.03"),
            ("y = 0.0, 0.0", "y = 0.0, 0.0, 0.35, 0.6, 0.4, 0.16"),
            ("'left', x_displacement = 0.0", "'left', x_traction = -2.0e6"),
            ("'right', x_traction = -4.0e6", "'right', x_displacement = 0.0"),
            ("end = 80.0", "end = 20.0"),
        ),
    )
    (joint,) = joints(out)
    assert joint["detail"] == "joins its own fracture"
    assert float(joint["y_m"]) == pytest.approx(0.0, abs=1e-12)
    assert rows(out / "history.csv")[-1]["n_tips"] == "0"
    mass_error = record(out)["mass_error_relative"]
    assert isinstance(mass_error, float)
    assert mass_error < 1.0e-9
