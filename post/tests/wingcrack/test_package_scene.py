"""Scenes in Python, with a stand-in for the solver."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wingcrack

TOP = Path(__file__).resolve().parents[3]
ONSET = TOP / "inputs" / "paper_c" / "onset.nml"

# It is told what to do by words in the scene.
SOLVER = """\
#!/bin/sh
if grep -q -i 'bad' "$2"; then echo "$2:3: what is bad" >&2; exit 2; fi
if [ "$1" = check ]; then cat "$2"; exit; fi
mkdir -p "$4" && cp "$2" "$4/scene.nml" && echo "$5 $OMP_NUM_THREADS" >"$4/words"
if grep -q -i 'fails' "$2"; then echo 'first' >&2; echo 'no convergence' >&2; exit 1; fi
"""


@pytest.fixture(autouse=True)
def _stand_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "solver"
    program.write_text(SOLVER, encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("WINGCRACK_SOLVER", str(program))


def scene(tmp_path: Path, text: str) -> wingcrack.Scene:
    path = tmp_path / "mine.nml"
    path.write_text(text, encoding="utf-8")
    return wingcrack.Scene.read(path)


def test_parameters_are_told_in_words() -> None:
    assert len(wingcrack.parameters()) > 150
    exponent = wingcrack.parameters()["fluid.viscosity_exponent"]
    assert exponent.default == "required with the viscosity_law 'exponential'"
    assert exponent.allowed == "at least -1.0e-6 and at most 1.0e-6"
    assert wingcrack.parameters()["region.permeability_xy"].default == "none: 0"
    assert wingcrack.parameters()["fracture.slip"].meaning.endswith("; only without &fluid")
    friction = wingcrack.parameters()["fracture.friction"]
    assert (friction.kind, friction.repeated) == ("number", True)
    assert wingcrack.parameters()["material.young"].unit == "Pa"


def test_values_are_read_changed_and_written(tmp_path: Path) -> None:
    made = wingcrack.Scene.read(ONSET)
    name = made["fracture.1.name"]
    made[f"fracture.{name}.friction"] = np.float64(0.4)
    made["fracture.x"] = np.array([0.9, 1.1])
    made["growth.enabled"] = False
    title = made["scene.title"] = "it's / a ! test: ü"
    again = made.text()
    for line in ("friction = 0.4", "x = 0.9, 1.1", "enabled = .false."):
        assert line in again
    assert wingcrack.Scene.read(made.write(tmp_path / "again.nml"))["scene.title"] == title
    del made["fracture.friction"]
    assert "fracture.friction" not in made
    assert "fracture.aperture" in made


@pytest.mark.parametrize("path", sorted((TOP / "inputs").glob("*/*.nml")), ids=lambda p: p.stem)
def test_shipped_scenes_are_the_same_when_written_and_read(path: Path, tmp_path: Path) -> None:
    first = wingcrack.Scene.read(path)
    second = wingcrack.Scene.read(first.write(tmp_path / path.name))
    assert list(first) == list(second) != []
    for address in first:
        if not address.endswith(".schedule"):
            assert first[address] == second[address], address


@pytest.mark.parametrize(
    ("address", "value", "message"),
    [
        ("material.yuong", 1e9, "&material has no name 'yuong'; did you mean 'young'?"),
        ("materials.young", 1e9, "no group &materials; did you mean 'material'?"),
        ("young", 1e9, "'young' must be group.name or group.item.name"),
        ("fracture.f9.friction", 0.4, "there is no item 'f9' of &fracture; there are a, b"),
        ("fracture.3.friction", 0.4, "there is no item '3'"),
        (f"fracture.{'9' * 5000}.friction", 0.4, "there is no item '999"),
        ("fracture.friction", 0.4, "there are 2 such groups; say which"),
        ("fracture.a.friction", "high", "fracture.friction takes a number"),
        ("fracture.a.friction", True, "not True"),
        ("fracture.a.friction", [0.4], "takes one number, not a list"),
        ("fracture.a.friction", float("inf"), "a finite number, not inf"),
        ("fracture.a.x", [], "at least one value"),
        ("fracture.a.name", 3, "takes a text"),
        ("growth.enabled", 1, "takes a logical"),
        ("coarse.newton_max", 2.5, "takes a whole number"),
    ],
)
def test_wrong_addresses_and_values_are_refused(
    tmp_path: Path, address: str, value: object, message: str
) -> None:
    two = scene(tmp_path, "&fracture name = 'a' /\n&fracture name = 'b', x = 0, 1 /\n")
    before = two.text()
    with pytest.raises(wingcrack.SceneError) as caught:
        two[address] = value
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert two.text() == before


def test_items_come_and_go(tmp_path: Path) -> None:
    made = wingcrack.Scene(tmp_path / "new.nml")
    made["material.young"] = 40e9
    made.add("probe", name="near", x=1, y=1.0)
    made.add("probe", name="p.2", x=2.0, y=1.0)
    made["probe.p.2.x"] = 3.0
    assert made["probe.2.x"] == 3.0
    made.remove("probe", "near")
    assert made["probe.name"] == "p.2"
    with pytest.raises(wingcrack.SceneError, match="may be given once"):
        made.add("material", young=1.0)
    with pytest.raises(wingcrack.SceneError, match="no group &fluid"):
        made.remove("fluid")


def test_what_is_no_scene(tmp_path: Path) -> None:
    with pytest.raises(wingcrack.SceneError, match="cannot be read"):
        wingcrack.Scene.read(tmp_path / "no.nml")
    (tmp_path / "empty.nml").touch()
    with pytest.raises(wingcrack.SceneError, match="has no groups"):
        wingcrack.Scene.read(tmp_path / "empty.nml")
    (tmp_path / "bytes.nml").write_bytes(b"\xff\xfe")
    with pytest.raises(wingcrack.SceneError, match="cannot be read"):
        wingcrack.Scene.read(tmp_path / "bytes.nml")


def test_check_gives_the_solvers_words(tmp_path: Path) -> None:
    assert "young = 1.0" in scene(tmp_path, "&material young = 1.0 /").check()
    bad = scene(tmp_path, "&scene title = 'bad' /")
    with pytest.raises(wingcrack.SceneError) as caught:
        bad.check()
    assert str(caught.value) == f"{tmp_path / 'mine.nml'}:3: what is bad"


def test_tables_are_found_from_anywhere(tmp_path: Path) -> None:
    made = scene(tmp_path, "&injection schedule = 'rates.csv' /")
    assert f"schedule = '{tmp_path / 'rates.csv'}'" in made.check()
    assert made["injection.schedule"] == "rates.csv"


def test_a_run_and_how_it_can_end(tmp_path: Path) -> None:
    good = scene(tmp_path, "&scene name = 'good' /")
    run = good.run(tmp_path / "out", threads=2)
    assert (run.name, (tmp_path / "out" / "words").read_text()) == ("good", "--quiet 2\n")
    with pytest.raises(wingcrack.SceneError, match="what is bad"):
        scene(tmp_path, "&scene name = 'bad' /").run(tmp_path / "bad_out")
    assert not (tmp_path / "bad_out").exists()
    failing = scene(tmp_path, "&scene name = 'fails' /")
    with pytest.raises(wingcrack.RunFailedError, match=r"^no convergence$") as caught:
        failing.run(tmp_path / "failed")
    assert (caught.value.status, caught.value.directory) == (1, tmp_path / "failed")
    with pytest.raises(wingcrack.SceneError, match="threads must be at least 1"):
        good.run(tmp_path / "none", threads=0)


def test_without_a_solver(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WINGCRACK_SOLVER", str(tmp_path / "gone"))
    with pytest.raises(wingcrack.EnvironmentLacksError, match="there is no solver"):
        scene(tmp_path, "&scene name = 'a' /").check()
