"""A sample of the mutated scene files and of the sweeps with a fluid (docs/sweeps.md)."""

from __future__ import annotations

import csv
import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import fluid_sweeps
import heat_sweeps
import mutated_scenes
import pytest
import well_sweeps
from system_scene import SOLVER, TOP, bare

from wingcrack_verify import recompute

pytestmark = pytest.mark.usefixtures("program")

RUNS = 300  # of the design that the numbers below belong to
SLIPS = 35
STICKS_AND_SLIPS = 29


@pytest.fixture(scope="module")
def mutations(program: None) -> None:
    """The programs that mutate scene files and checkpoints are built."""
    programs = ["mutated_scenes", "mutated_checkpoints"]
    subprocess.run(
        ["cmake", "--build", "--preset", "release", "--target", *programs],
        cwd=TOP,
        check=True,
        capture_output=True,
    )


@pytest.mark.usefixtures("mutations")
def test_mutated_files_are_described_or_refused() -> None:
    tally = mutated_scenes.check_by_program(1001, 150, mutated_scenes.SCENES)
    assert tally.faults == []
    assert tally.counts["status 0"] > 20
    assert tally.counts["status 2"] > 50


@pytest.mark.usefixtures("mutations")
def test_runs_of_mutated_files_end_as_they_must() -> None:
    tally = mutated_scenes.run_short(1, 40, mutated_scenes.SCENES)
    assert tally.faults == []
    assert tally.counts["status 0"] > 5
    assert tally.counts["status 2"] > 10


@pytest.mark.usefixtures("mutations")
def test_no_mutated_checkpoint_ends_the_program() -> None:
    names = ("onset", "crossing", "lauwerier", "load_cycle", "stress_case2")
    scenes = [path for path in mutated_scenes.SCENES if path.stem in names]
    tally = mutated_scenes.load_checkpoints(1, 200, scenes)
    assert tally.faults == []
    assert tally.counts["refused"] > 30
    assert tally.counts["go on"] > 5


@pytest.mark.parametrize(
    ("number", "word"),
    [(4, "right"), (STICKS_AND_SLIPS, "right"), (SLIPS, "right"), (25, "warned"), (74, "stopped")],
)
def test_a_sweep_is_right_or_says_what_is_not(number: int, word: str, tmp_path: Path) -> None:
    tally = fluid_sweeps.sweep(tmp_path, RUNS, [number])
    assert tally == {word: 1}


def test_wells_of_every_kind_run(tmp_path: Path) -> None:
    """Seven that hung or did not converge, and one of each kind."""
    seeds = [4, 7, 14, 34, 36, 45, 49, 1, 2, 3, 5, 8, 9]
    assert well_sweeps.sweep(tmp_path, seeds) == {"right": len(seeds)}


def test_heat_of_every_kind_is_right(tmp_path: Path) -> None:
    """Stiff scenes, of which 3, 20 and 46 showed rounding as an error of their balance."""
    seeds = [3, 4, 11, 20, 25, 42, 46]
    assert heat_sweeps.sweep(tmp_path, seeds) == {"right": len(seeds)}


def test_a_neck_before_an_outlet_is_warned_of(tmp_path: Path) -> None:
    """Fluid opens a fracture and leaves it through a closed cell: 33 MPa, with finer cells 104."""
    scene = tmp_path / "neck.nml"
    scene.write_text(
        re.sub(r"&time end = [0-9.]+", "&time end = 60.0", heat_sweeps.scene_text(723))
    )
    command = [str(SOLVER), "run", str(scene), "--out", str(tmp_path / "out"), "--quiet"]
    subprocess.run(command, check=True, capture_output=True)
    warnings = json.loads((tmp_path / "out" / "run.json").read_text())["warnings"]
    assert any("error of a well's pressure over its rise" in warning for warning in warnings)


@pytest.fixture(scope="module")
def sweep_files(program: None, tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], Path]:
    """Runs of sweeps, each made once."""
    made: dict[int, Path] = {}

    def files(number: int) -> Path:
        if number not in made:
            made[number] = tmp_path_factory.mktemp(f"sweep_{number}")
            fluid_sweeps.sweep(made[number], RUNS, [number])
        return made[number] / f"sweep_{number:03d}" / "out"

    return files


def spoil(
    out: Path, table: str, column: str, change: Callable[[float], float], always: bool = False
) -> None:
    """Change a column of a table in the last state, or in all of them."""
    rows = list(csv.reader((out / table).read_text().splitlines()))
    place = rows[0].index(column)
    for row in rows[1:]:
        if always or row[0] == rows[-1][0]:
            row[place] = repr(change(float(row[place])))
    (out / table).write_text("\n".join(",".join(row) for row in rows) + "\n")


@pytest.mark.parametrize(
    ("number", "table", "column", "change", "found"),
    [
        (SLIPS, "fractures.csv", "traction_t_pa", lambda x: 1.001 * x, "shear above friction"),
        (SLIPS, "fractures.csv", "traction_n_pa", lambda x: -x, "tension of contact"),
        (SLIPS, "fractures.csv", "pressure_pa", lambda x: 1.01 * x, "mass balance"),
        (SLIPS, "fractures.csv", "aperture_m", lambda x: 1.001 * x, "fracture volume"),
        (SLIPS, "history.csv", "leakoff_m2", lambda x: 1.001 * x, "leak-off"),
        (SLIPS, "history.csv", "n_slip", lambda x: x - 1.0, "n_slip is not"),
        (STICKS_AND_SLIPS, "fractures.csv", "jump_n_m", lambda x: x - 1e-9, "penetration"),
        (STICKS_AND_SLIPS, "fractures.csv", "jump_t_m", lambda x: x + 1e-6, "cells that stick"),
        (4, "fractures.csv", "traction_n_pa", lambda x: x - 1e3, "traction on open faces"),
        (4, "fractures.csv", "jump_n_m", lambda x: 0.99 * x, "aperture"),
    ],
)
def test_the_checker_finds_what_is_wrong(
    number: int,
    table: str,
    column: str,
    change: Callable[[float], float],
    found: str,
    sweep_files: Callable[[int], Path],
) -> None:
    out = sweep_files(number)
    assert recompute.judge(out).wrong == []
    text = (out / table).read_text()
    spoil(out, table, column, change)
    wrong = recompute.judge(out).wrong
    (out / table).write_text(text)
    assert any(found in fault for fault in wrong), wrong


def test_the_checker_knows_which_way_friction_acts(sweep_files: Callable[[int], Path]) -> None:
    out = sweep_files(SLIPS)
    text = (out / "fractures.csv").read_text()
    spoil(out, "fractures.csv", "traction_t_pa", lambda x: -x, always=True)
    wrong = recompute.judge(out).wrong
    (out / "fractures.csv").write_text(text)
    assert wrong
    assert all(fault.startswith("slip against friction") for fault in wrong)


def test_the_checker_misses_a_warning(sweep_files: Callable[[int], Path]) -> None:
    out = sweep_files(25)
    assert recompute.judge(out).wrong == []
    record = json.loads((out / "run.json").read_text())
    record["warnings"] = []
    (out / "run.json").write_text(json.dumps(record))
    (fault,) = recompute.judge(out).wrong
    assert fault.startswith("no warning of pressure over Young's modulus")


def test_a_disc_in_the_wrong_unit_is_judged_at_once(tmp_path: Path) -> None:
    """Millimetres for metres: the rim had a corner per cell, each compared with each."""
    text = (TOP / "inputs" / "paper_b" / "disc_path_45.nml").read_text()
    scene = tmp_path / "disc.nml"
    scene.write_text(text.replace("radius = 0.042", "radius = 420.0"))
    done = mutated_scenes.call(tmp_path, 10.0, "check", scene.name)
    assert done.returncode in (0, 2)


def test_the_largest_number_is_refused(tmp_path: Path) -> None:
    """It means `unlimited`, so scene.nml left the toughness out, which growth needs."""
    text = (TOP / "inputs" / "paper_c" / "wing_crack.nml").read_text()
    scene = tmp_path / "scene.nml"
    scene.write_text(text.replace("toughness = 0.7e6", "toughness = 1.7976931348623157e308"))
    done = bare(tmp_path, "check", scene.name)
    assert done.returncode == 2
    assert "scene.nml:29: &material: toughness is 1.7976931348623157e308" in done.stderr
