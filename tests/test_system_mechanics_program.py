"""The program without the coarse level: what it links and refuses, what the other costs more."""

from __future__ import annotations

import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from callgrind_profile import profile
from system_scene import SCENE, SOLVER

from wingcrack_verify.bench.catalogue import read_benchmarks
from wingcrack_verify.bench.measure import write_scene

WITHOUT = SOLVER.with_name("wingcrack-mechanics")

pytestmark = [
    pytest.mark.usefixtures("program"),
    pytest.mark.skipif(
        not WITHOUT.exists(), reason="wingcrack-mechanics is not built; ./wingcrack test builds all"
    ),
]
needs_valgrind = pytest.mark.skipif(
    shutil.which("valgrind") is None, reason="valgrind is not installed"
)


def test_it_holds_nothing_of_the_fluid() -> None:
    names = shutil.which("nm")
    assert names is not None  # comes with the compiler
    for program, holds_fluid in ((WITHOUT, False), (SOLVER, True)):
        done = subprocess.run([names, program], capture_output=True, text=True, check=True)
        assert "__mechanics_simulation_MOD_" in done.stdout
        assert ("__coarse_" in done.stdout) == holds_fluid
        assert ("__twolevel_" in done.stdout) == holds_fluid


@pytest.mark.parametrize("command", ["check", "run"])
def test_it_refuses_a_fluid(command: str, tmp_path: Path) -> None:
    (tmp_path / "scene.nml").write_text(SCENE)
    done = subprocess.run(
        [WITHOUT, command, "scene.nml"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr == (
        "wingcrack: the scene has a fluid, and this program was built without the coarse level,"
        " which that takes\n"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["scene.nml"]


def test_what_is_wrong_with_a_scene_comes_first(tmp_path: Path) -> None:
    (tmp_path / "scene.nml").write_text(SCENE.replace("young = 40.0e9", "young = -1.0"))
    done = subprocess.run(
        [WITHOUT, "check", "scene.nml"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "young" in done.stderr


@needs_valgrind
def test_the_coarse_level_costs_mechanics_nothing(tmp_path: Path) -> None:
    """Instructions of whole runs: the same but for loading libraries and looking for free memory.

    Loading MUMPS' library takes half a percent; once, among all other tests, it was 1.5, and the
    same program alone took its half again.
    """
    known, _ = read_benchmarks()
    scene = write_scene(known["quick_growth"], tmp_path).read_text()
    with ThreadPoolExecutor(2) as pool:
        with_it, without = pool.map(
            lambda program: profile(scene, tmp_path / program.name, program), (SOLVER, WITHOUT)
        )
    assert without.total > 1e8
    assert with_it.total == pytest.approx(without.total, rel=0.02)
    work, work_without = (
        found.total - found.loading() - found.searching() for found in (with_it, without)
    )
    assert work == pytest.approx(work_without, rel=1e-3)
    assert not with_it.executed("coarse_", "twolevel_")
