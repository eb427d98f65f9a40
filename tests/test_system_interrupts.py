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
NETWORK = TOP / "inputs" / "paper_d" / "network.nml"
THIRTY = TOP / "verification" / "random_networks" / "network_30_7.nml"
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
        for number, seconds in enumerate((0.0, 0.05, 0.2, 0.8, 2.0, 4.0))
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
        time.sleep(1.5)
        assert process.poll() is None
        process.send_signal(sent)
        begun = time.monotonic()
        process.communicate(timeout=60)
    assert time.monotonic() - begun < 3
    assert process.returncode == 128 + sent
    assert list(out.iterdir()) == []


@pytest.mark.parametrize("rows_before", [0, 5])
def test_the_same_wish_may_arrive_twice(rows_before: int, tmp_path: Path) -> None:
    """A terminal's ctrl-C comes directly and through the launcher, at the start and later on."""
    out = tmp_path / "out"
    command: list[str | Path] = [SOLVER, "run", GROWING_WINGS, "--out", "out", "--quiet"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        wait_for(out / "scene.nml", process)
        history = out / "history.csv"
        if rows_before:
            wait_for(history, process)
        while rows_before and len(history.read_text().splitlines()) <= rows_before:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
    assert process.returncode == 130
    assert record(out)["status"] == "stopped"


def test_a_time_limit_ends_a_run_at_a_good_state(tmp_path: Path) -> None:
    """`timeout` signals the launcher and the whole group, which the launcher hands on."""
    command: list[str | Path] = [
        "timeout",
        "6",
        TOP / "wingcrack",
        "run",
        NETWORK,
        "--out",
        "out",
        "--quiet",
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 124
    assert "wingcrack: interrupted; the last state is in out" in done.stderr
    assert record(tmp_path / "out")["status"] == "stopped"


def test_a_signal_within_a_step_is_heeded(tmp_path: Path) -> None:
    """Steps of thirty fractures take 10 s and more at the start, a piece of work in them one."""
    out = tmp_path / "out"
    with start(tmp_path, "run", THIRTY, "--out", "out", "--quiet") as process:
        wait_for(out / "scene.nml", process)
        time.sleep(4.0)
        process.send_signal(signal.SIGTERM)
        begun = time.monotonic()
        process.communicate(timeout=120)
    assert time.monotonic() - begun < 5
    assert process.returncode == 143
    told = record(out)
    assert told["status"] == "stopped"
    assert told["steps"] == max(len(numbers(out / "history.csv", "time_s")) - 1, 0)
