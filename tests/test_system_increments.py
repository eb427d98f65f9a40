"""Every increment of growth is a written state: rows, fields, and the files that gather them."""

from __future__ import annotations

import json
import re
from itertools import pairwise
from pathlib import Path

import pytest
import pyvista
from system_scene import GROWING_BY_PARIS, TOP, call, changed, numbers, record, rows, run

pytestmark = pytest.mark.usefixtures("program")

INCREMENTS = 5
EDGE_CRACK = changed(
    (TOP / "inputs/paper_b/edge_mode1.nml").read_text(),
    ("poisson = 0.3", "poisson = 0.3, toughness = 1.0e6"),
    ("intensities = .true.", "enabled = .true., law = 'paris', increment = 0.02, stop_gain = 0.1"),
)


def files(collection: Path) -> list[tuple[float, Path]]:
    """Times and files of a collection, in its order."""
    found = re.findall(r'timestep="([^"]*)" part="0" file="([^"]*)"', collection.read_text())
    return [(float(time), collection.parent / file) for time, file in found]


def history_rows(collection: Path) -> list[int]:
    """Rows of history.csv of the files of a collection."""
    return [int(pyvista.read(file).field_data["history_row"][0]) for _, file in files(collection)]


def check_states(out: Path) -> None:
    """Hold the states of all files against history.csv."""
    history = rows(out / "history.csv")
    clock = "load_factor" if "load_factor" in history[0] else "time_s"
    for table in ("tips.csv", "fractures.csv"):
        for row in rows(out / table):
            assert row[clock] == history[int(row["history_row"]) - 1][clock]
    for name in ("matrix.pvd", "fractures.pvd"):
        times = [time for time, _ in files(out / name)]
        assert all(before < after for before, after in pairwise(times))
    numbers_of_rows = history_rows(out / "fractures.pvd")
    for (time, file), number in zip(files(out / "fractures.pvd"), numbers_of_rows, strict=True):
        fields = pyvista.read(file)
        assert float(fields.field_data["TimeValue"][0]) == float(history[number - 1][clock])
        assert time == pytest.approx(float(history[number - 1][clock]), rel=1e-12)
        length = fields.compute_cell_sizes().cell_data["Length"].sum()
        # with a fluid the wings of the body's mesh lag behind by less than a cell
        assert length == pytest.approx(float(history[number - 1]["fracture_length_m"]), rel=0.1)


def test_each_increment_without_a_fluid(tmp_path: Path) -> None:
    """The crack runs at one load: each state of it, and the one after the last increment."""
    out = run(tmp_path, EDGE_CRACK)
    check_states(out)
    lengths = numbers(out / "history.csv", "fracture_length_m")
    assert lengths == pytest.approx([0.5 + 0.02 * i for i in range(INCREMENTS + 1)], rel=1e-4)
    assert len(set(numbers(out / "history.csv", "load_factor"))) == 1
    for table in ("tips.csv", "fractures.csv"):
        assert sorted(set(numbers(out / table, "history_row"))) == [1, 2, 3, 4, 5, 6]
    assert numbers(out / "tips.csv", "advance_m")[-1] == 0.0
    assert history_rows(out / "matrix.pvd") == [1, 2, 3, 4, 5, 6]
    told = record(out)
    assert (told["increments"], told["warnings"]) == (INCREMENTS, [])
    assert json.loads((out / "network.json").read_text())["fractures"][0]["length_m"] == lengths[-1]


@pytest.mark.parametrize("most", [0, 2])
def test_fields_of_as_many_increments_as_the_scene_wants(tmp_path: Path, most: int) -> None:
    """Then rows go on, one warning says so unless none were wanted; the end has its fields."""
    out = run(tmp_path, f"{EDGE_CRACK}\n&output growth_states = {most} /\n")
    assert sorted(set(numbers(out / "fractures.csv", "history_row"))) == [1, 2, 3, 4, 5, 6]
    assert history_rows(out / "matrix.pvd") == [*range(1, most + 1), 6]
    words = "growth_states = 2 of &output is reached: VTU files of further increments of growth"
    assert record(out)["warnings"] == ([f"{words} are omitted"] if most else [])
    assert (out / "run.log").read_text().count("growth_states") == min(most, 1)


def test_each_increment_with_a_fluid(tmp_path: Path) -> None:
    """The first state on each mesh that has followed growth is there, whatever the interval."""
    out = run(tmp_path, f"{GROWING_BY_PARIS}\n&output interval = 1.0e6 /\n")
    check_states(out)
    moments = numbers(out / "history.csv", "time_s")
    remeshed = {float(r["time_s"]) for r in rows(out / "events.csv") if r["kind"] == "remesh"}
    assert remeshed
    after = {min(time for time in moments if time > moment) for moment in remeshed}
    written = {moments[row - 1] for row in history_rows(out / "matrix.pvd")}
    assert written == {moments[0], moments[-1]} | after
    assert written == set(numbers(out / "fractures.csv", "time_s"))


def test_a_falling_load_has_all_its_states(tmp_path: Path) -> None:
    """ParaView wants rising times: the collection has the states in the order of the load."""
    scene = (TOP / "inputs/paper_b/edge_mode1.nml").read_text()
    out = run(tmp_path, f"{scene}\n&load from = 3.0, to = 1.0, steps = 4 /\n")
    assert numbers(out / "history.csv", "load_factor") == [2.5, 2.0, 1.5, 1.0]
    check_states(out)
    assert [time for time, _ in files(out / "matrix.pvd")] == [1.0, 1.5, 2.0, 2.5]
    assert history_rows(out / "matrix.pvd") == [4, 3, 2, 1]


def test_tips_that_join_keep_their_numbers(tmp_path: Path) -> None:
    """Wings of a slipping fracture end on its neighbours: gaps in network.json as in tips.csv."""
    scene = changed(
        (TOP / "inputs/paper_a/imposed_slip.nml").read_text(),
        ("size_fracture = 0.0125", "size_fracture = 0.02"),
        ("increment = 0.02", "increment = 0.05"),
        ("to = 0.26, steps = 13", "to = 0.22"),
    )
    out = run(tmp_path, scene)
    network = json.loads((out / "network.json").read_text())
    last = max(int(row["history_row"]) for row in rows(out / "tips.csv"))
    places = {
        int(row["tip"]): (int(row["fracture"]), float(row["x_m"]), float(row["y_m"]))
        for row in rows(out / "tips.csv")
        if int(row["history_row"]) == last and float(row["advance_m"]) == 0.0
    }
    told = {t["tip"]: (t["fracture"], t["x_m"], t["y_m"]) for t in network["tips"]}
    assert told == places
    first = {tip["tip"] for tip in network["steps"][0]["tips"]}
    assert set(told) < first
    assert set(told) != set(range(1, len(told) + 1))
    assert [joint["kind"] for joint in network["joints"]] == ["T", "T"]
    joints = {
        event["detail"]: (float(event["x_m"]), float(event["y_m"]))
        for event in rows(out / "events.csv")
        if event["kind"] == "joint"
    }
    above, below = joints["joins fracture above"], joints["joins fracture below"]
    assert (above[1], below[1]) == pytest.approx((0.4, -0.4), abs=1e-12)
    assert above[0] == pytest.approx(-below[0], abs=5e-3)
    assert numbers(out / "history.csv", "n_intersections")[-1] == 2
    assert numbers(out / "history.csv", "n_tips")[-1] == 4


def test_warnings_stand_once_on_the_terminal(tmp_path: Path) -> None:
    (tmp_path / "scene.nml").write_text(f"{EDGE_CRACK}\n&output growth_states = 2 /\n")
    done = call(tmp_path, "run", "scene.nml", "--no-plot")
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("warning") == 1
    assert done.stdout.count("growth_states") == 1
