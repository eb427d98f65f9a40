"""Scenes to start from: whole, commented from the solver's table, done in seconds."""

from __future__ import annotations

import json
from pathlib import Path

import f90nml
import pytest

from map_calls import needs_solver
from wingcrack.command_line import main
from wingcrack.command_line.scene_commands import KINDS
from wingcrack.scenes.errors import SceneError
from wingcrack.scenes.namelist import Value, group_text
from wingcrack.scenes.new import KINDS as FOLDER
from wingcrack.scenes.new import annotated
from wingcrack.scenes.solver import call, check
from wingcrack.scenes.water import water


def test_every_kind_has_a_file_and_every_file_is_a_kind() -> None:
    assert {file.stem for file in FOLDER.glob("*.nml")} == set(KINDS)


@needs_solver
@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_is_good_and_runs(tmp_path: Path, kind: str) -> None:
    scene = tmp_path / "mine.nml"
    assert main(["new", kind, "--out", str(scene)]) == 0
    assert f90nml.read(scene)["scene"]["name"] == "mine"
    is_good, words = check(scene)
    assert is_good, words
    done = call("run", scene, "--out", tmp_path / "out", "--quiet")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    assert record["status"] == "finished"
    assert record["warnings"] == []
    assert record["cpu_s"] < 30.0


@needs_solver
@pytest.mark.parametrize("kind", KINDS)
def test_comments_change_nothing(tmp_path: Path, kind: str) -> None:
    """The commented scene is the file that it comes from, to another reader of namelists."""
    scene = tmp_path / f"{kind}.nml"
    assert main(["new", kind, "--out", str(scene)]) == 0
    assert f90nml.read(scene) == f90nml.read(FOLDER / f"{kind}.nml")
    assert "! [Pa] Young's modulus E" in scene.read_text()
    assert max(map(len, scene.read_text().splitlines())) <= 132


@needs_solver
def test_a_name_that_the_solver_does_not_know_is_refused() -> None:
    with pytest.raises(SceneError, match="knows no yung in &material"):
        annotated("&material\n  yung = 1.0\n/\n")
    with pytest.raises(SceneError, match="knows no group &rock"):
        annotated("&rock\n/\n")


@needs_solver
def test_water(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Values by which IAPWS lets programs be checked; the solver takes the scene."""
    pytest.importorskip("iapws", reason="iapws is not installed (requirements_water.txt)")
    capacity = water(80e6, 300.0, [300.0])["heat_capacity"]
    assert capacity == pytest.approx(4.01008987e6 / 0.971180894e-3 * 1e-3, rel=1e-5)
    assert water(2.15e6, 298.15)["viscosity"] == pytest.approx(889.7351e-6, rel=1e-4)
    scene = tmp_path / "heat.nml"
    assert main(["new", "heat", "--water", "423.15", "--out", str(scene)]) == 0
    is_good, words = check(scene)
    assert is_good, words
    fluid = f90nml.read(scene)["fluid"]
    assert fluid["table_temperature"] == pytest.approx([333.15 + 10 * k for k in range(11)])
    assert fluid["viscosity_at"][9] == fluid["viscosity"]
    assert f90nml.read(scene)["heat"]["temperature"] == 423.15
    refused = {"mechanics": "has no fluid", "heat": "is not liquid"}
    for kind, words in refused.items():
        out = str(tmp_path / "no.nml")
        assert main(["new", kind, "--water", "700", "--out", out]) == 2
        assert words in capsys.readouterr().err


def test_groups_read_back_as_they_were(tmp_path: Path) -> None:
    values: dict[str, Value] = {
        "name": "it's",
        "x": [0.1 * k for k in range(60)],
        "vtu": False,
        "steps": 3,
        "e": 1e-9,
    }
    (tmp_path / "g.nml").write_text(group_text("fracture", values))
    assert f90nml.read(tmp_path / "g.nml")["fracture"] == values
    assert max(map(len, (tmp_path / "g.nml").read_text().splitlines())) <= 100


def test_a_file_that_is_there_stays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "mine.nml"
    scene.write_text("mine")
    with pytest.raises(SystemExit) as ended:
        main(["new", "--out", str(scene)])
    assert ended.value.code == 2
    assert "--overwrite" in capsys.readouterr().err
    assert scene.read_text() == "mine"
