"""Runs go on from a checkpoint as if they had not been interrupted, bit for bit, or are refused."""

from __future__ import annotations

import json
import re
import resource
import shutil
import signal
import struct
import subprocess
import time
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from restarts import EVERY_STATE, FINE, assert_same, contents, finished, solver
from system_scene import GROWING, GROWING_BY_PARIS, SCENE, SOLVER, TOP, with_heat

import wingcrack
from wingcrack.runner.task import run_task
from wingcrack.runs.checkpoint import read_checkpoint
from wingcrack.studies.running import tasks_of
from wingcrack.studies.study import read_study

pytestmark = pytest.mark.usefixtures("program")

MECHANICS = (TOP / "inputs" / "paper_b" / "disc_path_30.nml").read_text()
MECHANICS = re.sub(r"&scene.*?\n/\n", "", MECHANICS, flags=re.DOTALL)
SCENES = {
    "steps": FINE,
    "heat": with_heat(GROWING).replace(
        "&fluid", "&fluid table_temperature = 50.0, 150.0, viscosity_at = 3e-4, 1e-4,"
    ),
    "growth": GROWING,
    "paris": GROWING_BY_PARIS,
    "mechanics": MECHANICS,
    "sparse": FINE.replace("size_boundary = 0.25", "size_boundary = 0.25, condensation = 'sparse'"),
}


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Give the folder of a run of a scene from start to end."""
    top = tmp_path_factory.mktemp("unbroken")

    def folder(name: str) -> Path:
        if not (top / name).exists():
            (top / f"{name}.nml").write_text(SCENES[name] + EVERY_STATE)
            done = solver("run", top / f"{name}.nml", "--out", top / name, "--quiet")
            assert done.returncode == 0, done.stderr
        return top / name

    return folder


@pytest.mark.parametrize(
    ("name", "share", "sent"),
    [
        *((name, 0.5, signal.SIGTERM) for name in SCENES),
        *((name, 0.7, signal.SIGKILL) for name in ("steps", "growth", "mechanics")),
        *((name, 0.0, signal.SIGTERM) for name in ("steps", "growth", "mechanics")),
    ],
)
def test_a_run_goes_on_as_if_it_had_not_been_ended(
    name: str, share: float, sent: signal.Signals, unbroken: Callable[[str], Path], tmp_path: Path
) -> None:
    whole = unbroken(name)
    wall = json.loads((whole / "run.json").read_text())["wall_s"]
    (tmp_path / "scene.nml").write_text(SCENES[name] + EVERY_STATE)
    out = tmp_path / "out"
    words = [str(SOLVER), "run", str(tmp_path / "scene.nml"), "--out", str(out), "--quiet"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while not (out / "checkpoint.bin").exists():
            assert time.monotonic() < deadline
            time.sleep(0.005)
        time.sleep(share * wall)
        process.send_signal(sent)
        begun = time.monotonic()
        process.communicate(timeout=60)
    assert time.monotonic() - begun < 2.0
    assert process.returncode in {0, 128 + sent, -sent}
    done = solver("run", "--restart", out, "--quiet")
    assert done.returncode == 0, done.stderr
    assert_same(out, whole)
    assert "restart from the state at" in (out / "run.log").read_text()


def damaged(path: Path, place: int) -> None:
    data = bytearray(path.read_bytes())
    data[place] ^= 1
    path.write_bytes(data)


@pytest.fixture
def ended(unbroken: Callable[[str], Path], tmp_path: Path) -> Path:
    """Folder of a run that has ended, with two checkpoints."""
    return Path(shutil.copytree(unbroken("steps"), tmp_path / "run"))


def test_another_folder_gets_all_files_and_the_first_one_keeps_its_own(
    ended: Path, tmp_path: Path
) -> None:
    before = {path: path.read_bytes() for path in ended.rglob("*") if path.is_file()}
    (ended / "checkpoint.bin").rename(ended / "checkpoint_old.bin")
    done = solver("run", "--restart", ended, "--out", tmp_path / "other", "--quiet")
    assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "other", ended)
    (ended / "checkpoint_old.bin").rename(ended / "checkpoint.bin")
    assert all(path.read_bytes() == before[path] for path in before if path.exists())


@pytest.mark.parametrize("place", [0, 18, 30, 200, 5000, -1])
def test_of_a_damaged_checkpoint_the_one_before_is_used(place: int, ended: Path) -> None:
    expected = contents(ended)
    damaged(ended / "checkpoint.bin", place)
    done = solver("run", "--restart", ended, "--quiet")
    assert done.returncode == 0, done.stderr
    assert contents(ended) == expected
    log = (ended / "run.log").read_text()
    assert re.search(r"warning: \S+/checkpoint.bin is .*checkpoint_old.bin is used", log)


def test_without_a_good_checkpoint_nothing_changes(ended: Path) -> None:
    for name in ("checkpoint.bin", "checkpoint_old.bin"):
        (ended / name).write_bytes((ended / name).read_bytes()[:-1])
    expected = contents(ended)
    done = solver("run", "--restart", ended, "--quiet")
    assert done.returncode == 2
    assert done.stderr.count("is damaged") == 2
    assert contents(ended) == expected


def test_a_checkpoint_of_another_version_is_refused(ended: Path) -> None:
    (ended / "checkpoint_old.bin").unlink()
    path = ended / "checkpoint.bin"
    body = path.read_bytes()[32:]
    version = wingcrack.__version__.encode()
    body = body.replace(version, b"9" * len(version), 1)
    path.write_bytes(b"wingcrack state\n" + struct.pack("<qq", len(body), zlib.crc32(body)) + body)
    done = solver("run", "--restart", ended, "--quiet")
    assert done.returncode == 2
    assert f"is of version {'9' * len(version)} of the program" in done.stderr


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("friction = 0.5", "friction = 0.4", "friction of &fracture from 0.5"),
        ("permeability = 5.0e-20", "permeability = 6.0e-20", "permeability_xx of &material"),
        ("size_boundary = 0.25", "size_boundary = 0.26", "size_boundary of &coarse"),
        ("&probe name = 'corner', x = 2.0, y = 2.0 /", "", "number of groups"),
        ("end = 18000.0", "end = 3000.0", "after the end at 3000 s"),
    ],
)
def test_other_changes_are_refused_by_name(
    old: str, new: str, words: str, ended: Path, tmp_path: Path
) -> None:
    assert old in FINE
    (tmp_path / "other.nml").write_text(FINE.replace(old, new) + EVERY_STATE)
    done = solver("run", tmp_path / "other.nml", "--restart", ended, "--quiet")
    assert done.returncode == 2, done.stderr
    assert words in done.stderr


def test_a_later_end_and_another_stage_continue_a_run(ended: Path, tmp_path: Path) -> None:
    later = FINE.replace("end = 18000.0", "end = 21600.0").replace("end = 14400.0", "end = 20000.0")
    (tmp_path / "later.nml").write_text(later + EVERY_STATE)
    done = solver(
        "run", tmp_path / "later.nml", "--restart", ended, "--out", tmp_path / "later", "--quiet"
    )
    assert done.returncode == 0, done.stderr
    times = [
        float(line.split(",")[0])
        for line in (tmp_path / "later" / "history.csv").read_text().splitlines()[1:]
    ]
    assert times[-1] == 21600.0
    assert times == sorted(set(times))
    run = wingcrack.open(ended)
    longer = run.continue_with(tmp_path / "longer", end=19800.0)
    assert longer.status == "finished"
    assert longer.history["time_s"].iloc[-1] == 19800.0


def test_growth_begins_at_a_restart_without_intensities_so_far(
    unbroken: Callable[[str], Path], tmp_path: Path
) -> None:
    """Windows begin there, and know slip on their faces from there on."""
    off = "enabled = .true., stop_gain = 0.015"
    whole = unbroken("growth")
    base = finished(
        tmp_path, "base", GROWING.replace(off, "").replace("end = 7200.0", "end = 3600.0")
    )
    later = finished(tmp_path, "later", GROWING, "--restart", base)
    ends = [pd.read_csv(folder / "history.csv").iloc[-1] for folder in (whole, later)]
    assert ends[0]["fracture_length_m"] == pytest.approx(ends[1]["fracture_length_m"], rel=1e-6)
    assert ends[0]["time_s"] == pytest.approx(ends[1]["time_s"], rel=0.02)


def test_growth_without_a_fluid_cannot_be_switched(
    unbroken: Callable[[str], Path], tmp_path: Path
) -> None:
    other = MECHANICS.replace("enabled = .true.", "enabled = .false.")
    assert other != MECHANICS
    (tmp_path / "other.nml").write_text(other + EVERY_STATE)
    origin = unbroken("mechanics")
    words = ("run", tmp_path / "other.nml", "--restart", origin, "--out", tmp_path / "out")
    run = solver(*words)
    assert run.returncode == 2
    assert "cannot switch growth on or off: the scene has no fluid" in run.stderr
    assert not list((tmp_path / "out").iterdir())


def test_runs_without_checkpoints_have_nothing_to_go_on_from(tmp_path: Path) -> None:
    (tmp_path / "scene.nml").write_text(SCENE + "\n&output checkpoint = 0.0 /\n")
    done = solver("run", tmp_path / "scene.nml", "--out", tmp_path / "out", "--quiet")
    assert done.returncode == 0
    assert not list((tmp_path / "out").glob("checkpoint*"))
    done = solver("run", "--restart", tmp_path / "out")
    assert done.returncode == 2
    assert "has no checkpoint" in done.stderr


def test_without_space_for_checkpoints_a_run_goes_on(
    unbroken: Callable[[str], Path], tmp_path: Path
) -> None:
    whole = unbroken("steps")
    most = (whole / "checkpoint.bin").stat().st_size - 1
    (tmp_path / "scene.nml").write_text(SCENES["steps"] + EVERY_STATE)
    done = subprocess.run(
        [SOLVER, "run", "scene.nml", "--out", "out", "--quiet"],
        cwd=tmp_path,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert (
        "no checkpoint: cannot write out/checkpoint_new.bin"
        in (tmp_path / "out" / "run.log").read_text()
    )
    assert_same(tmp_path / "out", whole)
    assert not list((tmp_path / "out").glob("*.part"))


def test_a_checkpoint_is_read_in_python(ended: Path) -> None:
    state = read_checkpoint(ended / "checkpoint.bin")
    run = wingcrack.open(ended)
    assert state["about/time"] == 18000.0
    assert state["about/scene"] == (ended / "scene.nml").read_text()
    assert state["texts/text"] == (ended / "history.csv").read_text()
    last = run.fractures[run.fractures.time_s == 18000.0]
    assert np.array_equal(state["now/coarse/pressure"], last.pressure_pa.to_numpy())
    assert state["now/coarse/jump"].shape == (2, 2, len(last))
    assert state["simulation/steps"] == run.record["steps"]
    damaged(ended / "checkpoint.bin", 100)
    with pytest.raises(wingcrack.RunError, match="is damaged"):
        read_checkpoint(ended / "checkpoint.bin")


def test_forks_of_a_state_are_as_runs_from_the_start(ended: Path, tmp_path: Path) -> None:
    """Two schedules from one history, one of them as a study."""
    run = wingcrack.open(ended)
    state = run.at(7200.0)
    assert state.directory == ended / "states" / "7200"
    written = (state.directory / "run.json").stat().st_mtime_ns
    for end in (9000.0, 16200.0):
        (tmp_path / "whole.nml").write_text(
            FINE.replace("end = 14400.0", f"end = {end}") + EVERY_STATE
        )
        whole = tmp_path / f"whole_{end}"
        assert solver("run", tmp_path / "whole.nml", "--out", whole, "--quiet").returncode == 0
        run.at(7200.0).fork(tmp_path / f"fork_{end}", {"injection.1.end": end})
        assert_same(tmp_path / f"fork_{end}", whole)
    assert (state.directory / "run.json").stat().st_mtime_ns == written
    assert run.at(18000.0).directory == ended
    (tmp_path / "study.toml").write_text(
        f"title = 'Shut-in'\nfrom = '{ended}'\nat = 7200.0\n"
        "over = { 'injection.1.end' = [9000.0, 16200.0] }\n"
        "[[quantity]]\nname = 'last'\nunit = 'Pa'\nfile = 'history.csv'\n"
        "column = 'well_pressure_pa'\ntake = 'last'\n"
    )
    study = read_study(tmp_path / "study.toml")
    tasks = tasks_of(study, SOLVER.parents[2], tmp_path / "study")
    assert [run_task(task).status for task in tasks.values()] == ["finished"] * 2
    for task, end in zip(tasks.values(), (9000.0, 16200.0), strict=True):
        one = (task.folder / "output" / "history.csv").read_bytes()
        assert one == (tmp_path / f"fork_{end}" / "history.csv").read_bytes()
