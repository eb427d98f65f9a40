"""Runs that are asked to end: at any moment they stop, with all files of the last good state."""

from __future__ import annotations

import signal
import subprocess
import time
from pathlib import Path

import pytest
from system_scene import SOLVER, TOP, numbers, record, start, varied

pytestmark = pytest.mark.usefixtures("program")

GROWING_WINGS = TOP / "inputs" / "paper_c" / "wing_crack.nml"
TABLES = ["events.csv", "fractures.csv", "history.csv", "network.json", "probes.csv", "tips.csv"]

# Meshed in seconds, and in minutes.
SIZES = "size_fracture = 0.02, size_boundary = 0.25"
FINE = varied((SIZES, "size_fracture = 0.012, size_boundary = 0.012"))
VERY_FINE = varied((SIZES, "size_fracture = 0.004, size_boundary = 0.004"))


def wait_for(path: Path, process: subprocess.Popen[str]) -> None:
    deadline = time.monotonic() + 60
    while not path.exists():
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.01)


# From right after the start of the solver, gmsh's and the mesh, over the first steps to growth; the
# two signals by turns, as the solver asks at the same places for both.
@pytest.mark.parametrize(
    ("seconds", "sent", "status"),
    [
        (seconds, *((signal.SIGTERM, 143), (signal.SIGINT, 130))[number % 2])
        for number, seconds in enumerate((0.0, 0.05, 0.1, 0.2, 0.4, 0.8, 2.0, 5.0))
    ],
)
def test_a_signal_ends_a_run_at_a_good_state(
    seconds: float, sent: signal.Signals, status: int, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    with start(tmp_path, "run", GROWING_WINGS, "--out", "out", "--quiet") as process:
        wait_for(out, process)
        time.sleep(seconds)
        process.send_signal(sent)
        begun = time.monotonic()
        _, error = process.communicate(timeout=60)
    assert time.monotonic() - begun < 20
    assert process.returncode == status
    assert error.splitlines()[-1] == "wingcrack: interrupted; the last state is in out"
    told = record(out)
    assert told["status"] == "stopped"
    assert [name for name in TABLES if not (out / name).exists()] == []
    times = numbers(out / "history.csv", "time_s")
    assert told["steps"] == max(len(times) - 1, 0)
    assert numbers(out / "fractures.csv", "time_s")[-1:] == times[-1:]
    assert not list(out.rglob("*.part"))


def test_a_signal_while_meshing_is_heeded(tmp_path: Path) -> None:
    (tmp_path / "fine.nml").write_text(FINE)
    out = tmp_path / "out"
    with start(tmp_path, "run", "fine.nml", "--out", "out", "--quiet") as process:
        wait_for(out, process)
        time.sleep(0.5)
        assert list(out.iterdir()) == []  # nothing is written before there is a mesh
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
    assert process.returncode == 143
    assert record(out)["status"] == "stopped"
    assert [name for name in TABLES if not (out / name).exists()] == []


@pytest.mark.parametrize("sent", [signal.SIGTERM, signal.SIGINT])
def test_a_second_signal_ends_at_once(sent: signal.Signals, tmp_path: Path) -> None:
    (tmp_path / "fine.nml").write_text(VERY_FINE)
    out = tmp_path / "out"
    with start(tmp_path, "run", "fine.nml", "--out", "out", "--quiet") as process:
        wait_for(out, process)
        process.send_signal(sent)
        time.sleep(1.0)
        assert process.poll() is None
        process.send_signal(sent)
        begun = time.monotonic()
        process.communicate(timeout=60)
    assert time.monotonic() - begun < 3
    assert process.returncode == 128 + sent
    assert list(out.iterdir()) == []


def test_the_same_wish_may_arrive_twice(tmp_path: Path) -> None:
    """A terminal's ctrl-C comes directly and through the launcher."""
    out = tmp_path / "out"
    command: list[str | Path] = [SOLVER, "run", GROWING_WINGS, "--out", "out", "--quiet"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        wait_for(out / "scene.nml", process)
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
    assert process.returncode == 130
    assert record(out)["status"] == "stopped"
