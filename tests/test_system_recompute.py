"""What judges the trials of growth and joints from their files finds what is wrong in them."""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from system_scene import SOLVER, TOP

from wingcrack.sweeps.scene import scene_text
from wingcrack_verify import recompute, recompute_files, recompute_growth
from wingcrack_verify.stability import ALL_FIELDS

pytestmark = pytest.mark.usefixtures("program")


@pytest.fixture(scope="module")
def files(program: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The base of the trials: a joint from the start, growth, a joint by growth."""
    folder = tmp_path_factory.mktemp("recompute")
    base = TOP / "verification" / "stability_joints" / "base.nml"
    (folder / "scene.nml").write_text(scene_text(base, ALL_FIELDS, ()))
    subprocess.run([SOLVER, "run", "scene.nml", "--out", "out", "--quiet"], cwd=folder, check=True)
    return folder / "out"


@pytest.fixture
def out(files: Path, tmp_path: Path) -> Path:
    """A copy, to be spoilt."""
    return Path(shutil.copytree(files, tmp_path / "out"))


def wrong(out: Path) -> list[str]:
    """What is found, by what reads only tables first: fields take long."""
    return recompute_growth.judge_growth(out).wrong or recompute.judge(out).wrong


def test_a_run_with_growth_and_joints_is_right(out: Path) -> None:
    assert wrong(out) == []
    network = json.loads((out / "network.json").read_text())
    assert [joint["time_s"] > 0.0 for joint in network["joints"]] == [False, True]


def spoil_table(out: Path, table: str, column: str, row: int, change: Callable[[str], Any]) -> None:
    """Change a value of a table."""
    rows = list(csv.reader((out / table).read_text().splitlines()))
    place = rows[0].index(column)
    rows[row][place] = str(change(rows[row][place]))
    with (out / table).open("w", newline="") as file:
        csv.writer(file).writerows(rows)


@pytest.mark.parametrize(
    ("table", "column", "row", "change", "found"),
    [
        ("tips.csv", "keq_pa_sqrtm", -2, lambda x: 1.1e6, "is not called unstable"),
        ("tips.csv", "k1_pa_sqrtm", -2, lambda x: "NaN", "k1_pa_sqrtm of tips.csv is no number"),
        ("tips.csv", "k1_error_pa_sqrtm", 9, lambda x: -1.0, "k1_error_pa_sqrtm is not stated"),
        ("history.csv", "well_pressure_error_pa", -1, lambda x: -1, "_error_pa is not stated"),
        ("history.csv", "fracture_length_m", -1, lambda x: 1.1, "fracture_length_m of history.csv"),
        ("history.csv", "fracture_length_m", -1, lambda x: 1.3, "history.csv ends with 1.3 m"),
        ("fractures.csv", "pressure_pa", -1, lambda x: -1.0e5, "pressure below that of vapour"),
        ("fractures.csv", "void_m", -1, lambda x: 1.0e-5, "void under pressure"),
    ],
)
def test_a_spoilt_table_is_found(
    table: str, column: str, row: int, change: Callable[[str], Any], found: str, out: Path
) -> None:
    spoil_table(out, table, column, row, change)
    faults = wrong(out)
    assert any(found in fault for fault in faults), faults


@pytest.mark.parametrize(
    ("column", "found"),
    [("prefilled_m2", "remeshed mass balance"), ("leakoff_m2", "remeshed leak-off")],
)
def test_a_spoilt_balance_on_a_new_mesh_is_found(column: str, found: str, out: Path) -> None:
    states = recompute_files.read_run(out).states
    (row, *_) = [
        row
        for row in range(2, len(states) + 1)
        if not recompute.same_mesh(states[row - 2], states[row - 1])
    ]
    spoil_table(out, "history.csv", column, row, lambda x: float(x) + 1.0e-8)
    faults = wrong(out)
    assert any(found in fault for fault in faults), faults


def spoil_json(out: Path, name: str, change: Callable[[Any], None]) -> None:
    """Change a file of JSON."""
    record = json.loads((out / name).read_text())
    change(record)
    (out / name).write_text(json.dumps(record))


def _crossing(network: Any) -> None:
    """The first fracture ends beyond the third one."""
    network["fractures"][0]["x_m"][-1] += 0.01


def _shorter(network: Any) -> None:
    fracture = network["steps"][-1]["fractures"][0]
    fracture["x_m"].pop()
    fracture["y_m"].pop()


@pytest.mark.parametrize(
    ("name", "change", "found"),
    [
        ("network.json", _crossing, "without a joint"),
        ("network.json", _shorter, "m shorter at"),
        ("network.json", lambda it: it["joints"][1].update(x_m=0.26), "joint away from its"),
        ("run.json", lambda it: it.update(reason="K is NaN", status="failed"), "is no cause"),
        ("run.json", lambda it: it.update(keq_over_kic=0.9), "keq_over_kic 0.9 is 1.0"),
    ],
)
def test_a_spoilt_record_is_found(
    name: str, change: Callable[[Any], None], found: str, out: Path
) -> None:
    spoil_json(out, name, change)
    faults = wrong(out)
    assert any(found in fault for fault in faults), faults
