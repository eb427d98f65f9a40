"""Runs that end before their time: interrupted, failed, without a place to write to."""

from __future__ import annotations

import resource
import signal
import subprocess
import time
from pathlib import Path

import pytest
from system_scene import (
    GROWING,
    GROWING_BY_PARIS,
    SCENE,
    SOLVER,
    TOP,
    bare,
    call,
    numbers,
    record,
    rows,
    start,
)

pytestmark = pytest.mark.usefixtures("program")

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
        left = {path.name for path in out.rglob("*") if path.is_file()}
        assert left <= {"run.log", "run.json"}
        assert "run.json" not in left or record(out)["status"] == "failed"
    else:
        assert record(out)["status"] == "failed"
        assert f"wingcrack: {record(out)['reason']}" == reason
        assert (out / "scene.nml").read_text().rstrip().endswith("/")
        assert not list(out.rglob("*.vtu"))


def test_a_run_with_a_table_that_is_not_whole_has_failed(tmp_path: Path) -> None:
    """The limit lets all files pass but fractures.csv, whose last rows come at the very end."""
    (tmp_path / "scene.nml").write_text(GROWING_BY_PARIS + "&output vtu = .false. /\n")
    done = subprocess.run(
        [SOLVER, "run", "scene.nml", "--out", "out", "--quiet"],
        cwd=tmp_path,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (5600, 5600)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    out = tmp_path / "out"
    told = record(out)
    assert told["status"] == "failed"
    assert str(told["reason"]).startswith("cannot write out/fractures.csv: ")
    assert done.stderr == f"wingcrack: {told['reason']}\n"
    assert told["steps"] == len(rows(out / "history.csv")) - 1
    assert not (out / "fractures.csv").exists()
    assert not list(out.rglob("*.part"))
    assert rows(out / "tips.csv")
    assert rows(out / "events.csv")


# Two levels on some 450 cells need little; the body of 30,000 cells does not fit in any of these.
@pytest.mark.parametrize(
    ("scene", "kilobytes"),
    [
        *(("small", size) for size in (150000, 250000, 360000)),
        *(("large", size) for size in (150000, 250000, 360000, 450000)),
    ],
)
def test_too_little_memory_is_told(scene: str, kilobytes: int, tmp_path: Path) -> None:
    text = SCENE if scene == "small" else SCENE.replace("boundary = 0.25", "boundary = 0.02")
    (tmp_path / "scene.nml").write_text(text)

    def limit_memory() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (kilobytes * 1024, kilobytes * 1024))

    done = subprocess.run(
        [TOP / "wingcrack", "run", "scene.nml", "--out", "out", "--quiet", "--no-plot"],
        cwd=tmp_path,
        preexec_fn=limit_memory,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if scene == "small" and kilobytes > 300000 and done.returncode == 0:
        return
    assert done.returncode == 1
    assert "not enough memory" in done.stderr.splitlines()[-1]


@pytest.mark.parametrize("scene", [HALVES, GROWING], ids=["mechanics", "two levels"])
def test_a_place_that_cannot_be_written_is_named(scene: str, tmp_path: Path) -> None:
    (tmp_path / "scene.nml").write_text(scene)
    done = call(tmp_path, "run", "scene.nml", "--out", "/proc/out")
    assert done.returncode == 1
    assert "cannot make the directory /proc/out" in done.stderr.splitlines()[-1]


def test_a_disk_that_becomes_full_leaves_the_record(tmp_path: Path) -> None:
    """On a real disk, of 400 kB: room for some states and no more."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("only root mounts a disk")
    try:
        (tmp_path / "scene.nml").write_text((TOP / "inputs/paper_c/onset.nml").read_text())
        done = bare(tmp_path, "run", "scene.nml", "--out", "disk/out", "--quiet")
        out = disk / "out"
        told = record(out)
        assert (done.returncode, told["status"]) == (1, "failed")
        assert done.stderr == f"wingcrack: {told['reason']}\n"
        assert "No space left on device" in done.stderr
        assert len(list((out / "vtu").glob("matrix_*.vtu"))) > 1
        assert len(rows(out / "history.csv")) > 1
        assert not list(out.rglob("*.part"))
    finally:
        subprocess.run(["umount", str(disk)], check=True)


@pytest.mark.parametrize("what", ["folder", "files", "other folder"])
def test_a_run_whose_files_are_taken_away_has_failed(what: str, tmp_path: Path) -> None:
    scene = HALVES.replace("to = 1.0, steps = 4", "to = -1.0, steps = 2000")
    (tmp_path / "scene.nml").write_text(scene + "&output vtu = .false. /\n")
    out = tmp_path / "out"
    with subprocess.Popen(
        [SOLVER, "run", "scene.nml", "--out", "out", "--quiet"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        deadline = time.monotonic() + 60
        while not (out / "run.json.part").exists():
            assert time.monotonic() < deadline
            time.sleep(0.01)
        if what == "files":
            (out / "scene.nml").unlink()
        else:
            out.rename(tmp_path / "gone")
        if what == "other folder":
            out.mkdir()
        _, error = process.communicate(timeout=60)
    assert process.returncode == 1
    words = {
        "folder": "cannot write out/",
        "files": "out/scene.nml was removed during the run",
        "other folder": "the folder out was removed or replaced during the run",
    }
    assert words[what] in error
    if what != "folder":
        assert record(out)["status"] == "failed"
