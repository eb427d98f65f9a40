"""Runs on two ranks: the same results as on one, and no rank that stays behind."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from system_scene import SOLVER, TOP, call, numbers, record, start, varied

pytestmark = pytest.mark.usefixtures("program")

needs_mpi = pytest.mark.skipif(
    shutil.which("mpiexec.openmpi") is None,
    reason="MPI is not installed, and nothing but --ranks needs it",
)

# Some 14,000 cells, which is enough to be shared.
SHARED = varied(
    ("size_fracture = 0.02, size_boundary = 0.25", "size_fracture = 0.01, size_boundary = 0.031"),
    ("end = 18000.0", "end = 7200.0"),
    ("intensities = .true.", "intensities = .false."),
)


def ranks_of(scene: Path) -> list[int]:
    """Processes of the program for ranks that were started for a scene."""
    found = []
    for folder in Path("/proc").iterdir():
        if not folder.name.isdecimal():
            continue
        try:
            words = (folder / "cmdline").read_bytes().decode().split("\0")
        except OSError:
            continue
        if words[0].endswith("/wingcrack-ranks") and str(scene) in words:
            found.append(int(folder.name))
    return sorted(found)


def assert_none_stays(scene: Path) -> None:
    deadline = time.monotonic() + 20
    while ranks_of(scene):
        assert time.monotonic() < deadline, "ranks have stayed behind"
        time.sleep(0.05)


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    file = tmp_path / "shared.nml"
    file.write_text(SHARED)
    return file


def begin(scene: Path) -> subprocess.Popen[str]:
    """Start a run on two ranks, and wait until it has begun and has written a state."""
    options = ("--out", "out", "--quiet", "--no-plot", "--ranks", "2")
    process = start(scene.parent, "run", scene, *options)
    deadline = time.monotonic() + 300  # the first call builds the program
    while not (scene.parent / "out" / "scene.nml").exists():
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.02)
    return process


def test_the_program_for_one_process_knows_nothing_of_mpi() -> None:
    done = subprocess.run(["ldd", SOLVER], capture_output=True, text=True, check=True)
    assert "libdmumps_seq" in done.stdout
    assert "libmpi.so" not in done.stdout
    assert "libscalapack" not in done.stdout


def test_a_scene_without_a_fluid_is_refused(tmp_path: Path) -> None:
    scene = TOP / "inputs" / "paper_b" / "edge_mode1.nml"
    done = call(tmp_path, "run", scene, "--ranks", "2")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        f"wingcrack: ranks share the matrices of a body with a fluid, and {scene} has none:"
        " omit --ranks\n"
    )
    assert list(tmp_path.iterdir()) == []


@needs_mpi
def test_two_ranks_give_what_one_gives(scene: Path) -> None:
    options = ("--quiet", "--no-plot")
    alone = call(scene.parent, "run", scene, "--out", "alone", *options)
    assert (alone.returncode, alone.stdout, alone.stderr) == (0, "", "")
    with begin(scene) as process:
        out, _ = process.communicate(timeout=300)
    assert (process.returncode, out) == (0, "")
    assert_none_stays(scene)
    one, two = scene.parent / "alone", scene.parent / "out"
    assert record(two)["status"] == "finished"
    assert float(str(record(two)["mass_error_relative"])) < 1e-12
    for column in ("well_pressure_pa", "fracture_volume_m2", "leakoff_m2", "max_slip_m"):
        expected = numbers(one / "history.csv", column)
        assert numbers(two / "history.csv", column) == pytest.approx(expected, rel=1e-10)


@needs_mpi
@pytest.mark.parametrize(("sent", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_ranks_at_a_good_state(
    sent: signal.Signals, status: int, scene: Path
) -> None:
    scene.write_text(SHARED.replace("end = 7200.0", "end = 3.6e6").replace("14400.0", "2.0e6"))
    with begin(scene) as process:
        process.send_signal(sent)
        _, error = process.communicate(timeout=60)
    assert process.returncode == status
    assert error.splitlines()[-1] == "wingcrack: interrupted; the last state is in out"
    assert record(scene.parent / "out")["status"] == "stopped"
    assert_none_stays(scene)


@needs_mpi
@pytest.mark.parametrize("which", [0, 1])
def test_a_rank_that_is_killed_takes_the_others_along(which: int, scene: Path) -> None:
    with begin(scene) as process:
        os.kill(ranks_of(scene)[which], signal.SIGKILL)
        _, error = process.communicate(timeout=60)
    assert process.returncode == 128 + signal.SIGKILL
    assert "signal 9 has ended a rank" in error.splitlines()[-1]
    assert_none_stays(scene)


@needs_mpi
def test_a_failed_run_ends_its_ranks(scene: Path) -> None:
    """The reason is the last line on stderr, as with one process."""
    with begin(scene) as process:
        process.communicate(timeout=300)
    scene.write_text(SHARED.replace("young = 40.0e9", "young = -1.0"))
    ranks = SOLVER.with_name("wingcrack-ranks")
    environment = {
        **os.environ,
        "OPENBLAS_NUM_THREADS": "1",
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    }
    done = subprocess.run(
        ["mpiexec.openmpi", "--quiet", "--oversubscribe", "-n", "2", ranks, "run", scene],
        cwd=scene.parent,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 2
    assert "young" in done.stderr.splitlines()[-1]
    assert_none_stays(scene)
