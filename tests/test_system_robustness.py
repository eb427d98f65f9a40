"""Runs that end before their time: interrupted, failed, without a place to write to."""

from __future__ import annotations

import resource
import signal
import subprocess
import time
from pathlib import Path

import pytest
from system_scene import GROWING, TOP, call, numbers, record, rows, start

pytestmark = pytest.mark.usefixtures("program")

SOLVER = TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver"

# Two halves of a plate that nothing but contact holds together: pressed first, then drawn apart.
HALVES = """\
&domain x_min = 0.0, x_max = 1.0, y_min = -1.0, y_max = 1.0 /
&material young = 1.0e9, poisson = 0.25 /
&side name = 'bottom', y_displacement = 0.0 /
&restraint x = 0.0, y = -1.0, x_displacement = 0.0 /
&side name = 'top', y_traction = 1.0e6 /
&fracture name = 'cut', x = 0.0, 1.0, y = 0.0, 0.0, friction = 0.5 /
&load from = -3.0, to = 1.0, steps = 4 /
&fe size_fracture = 0.2, size_boundary = 0.5 /
"""


def test_a_failed_run_leaves_the_last_good_state(tmp_path: Path) -> None:
    (tmp_path / "halves.nml").write_text(HALVES)
    done = call(tmp_path, "run", "halves.nml", "--out", "out", "--quiet")
    out = tmp_path / "out"
    assert done.returncode == 1
    told = record(out)
    assert told["status"] == "failed"
    assert done.stderr.splitlines()[-1] == f"wingcrack: {told['reason']}"
    assert str(told["reason"]).startswith("after load factor 0: ")
    factors = numbers(out / "history.csv", "load_factor")
    assert factors[:2] == [-2.0, -1.0]
    assert 1.0 not in factors
    pressed = [row for row in rows(out / "fractures.csv") if float(row["load_factor"]) == -1.0]
    for row in pressed:
        assert float(row["traction_n_pa"]) == pytest.approx(-1.0e6, rel=1e-9)
    assert not list(out.rglob("*.part"))


def test_an_interrupted_load_programme_leaves_whole_files(tmp_path: Path) -> None:
    scene = HALVES.replace("to = 1.0, steps = 4", "to = -1.0, steps = 100000")
    (tmp_path / "halves.nml").write_text(scene + "&output vtu = .false. /\n")
    history = tmp_path / "out" / "history.csv"
    with start(tmp_path, "run", "halves.nml", "--out", "out", "--quiet") as process:
        deadline = time.monotonic() + 60
        while not (history.exists() and len(rows(history)) > 2):
            assert time.monotonic() < deadline
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    assert process.returncode == 130
    assert error.splitlines()[-1] == "wingcrack: interrupted; the last state is in out"
    out = tmp_path / "out"
    told = record(out)
    assert told["status"] == "stopped"
    factors = numbers(history, "load_factor")
    assert told["steps"] == len(factors) > 2
    assert numbers(out / "fractures.csv", "load_factor")[-1] == factors[-1]
    assert not list(out.rglob("*.part"))


@pytest.mark.parametrize("scene", [HALVES, GROWING], ids=["mechanics", "two levels"])
@pytest.mark.parametrize("limit", [1000, 6000])
def test_a_full_disk_is_told_and_leaves_no_half_file(
    scene: str, limit: int, tmp_path: Path
) -> None:
    """A limit on the size of files stands for the disk: too small for scene.nml, or for fields."""

    def limit_files() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    (tmp_path / "scene.nml").write_text(scene)
    done = subprocess.run(
        [SOLVER, "run", "scene.nml", "--out", "out", "--quiet"],
        cwd=tmp_path,
        preexec_fn=limit_files,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    (reason,) = done.stderr.splitlines()
    assert "scene.nml" in reason if limit == 1000 else "vtu" in reason
    out = tmp_path / "out"
    assert not list(out.rglob("*.part"))
    if limit == 1000:
        assert not [path for path in out.rglob("*") if path.is_file()]
    else:
        assert record(out)["status"] == "failed"
        assert f"wingcrack: {record(out)['reason']}" == reason
        assert (out / "scene.nml").read_text().rstrip().endswith("/")
        assert not list(out.rglob("*.vtu"))


@pytest.mark.parametrize("scene", [HALVES, GROWING], ids=["mechanics", "two levels"])
def test_a_place_that_cannot_be_written_is_named(scene: str, tmp_path: Path) -> None:
    (tmp_path / "scene.nml").write_text(scene)
    done = call(tmp_path, "run", "scene.nml", "--out", "/proc/out")
    assert done.returncode == 1
    assert "cannot make the directory /proc/out" in done.stderr.splitlines()[-1]
