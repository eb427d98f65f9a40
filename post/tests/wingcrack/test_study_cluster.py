"""Studies on a cluster: Dask's on this machine for real, others as far as they can be seen here."""

from __future__ import annotations

import importlib.util
import os
import signal
from pathlib import Path

import pytest

from small_study import HEAD, PRESSURE, SOUND, SmallStudy, small_study, wait_for

MANY = '[over]\n"injection.rate" = [1e-9, 2e-9, 3e-9, 4e-9, 5e-9, 6e-9, 7e-9, 8e-9]\n'
SLOW = '[set]\n"scene.title" = "slow"\n'


def test_a_killed_worker_does_not_cost_the_study(tmp_path: Path) -> None:
    study = small_study(tmp_path, HEAD + MANY + SLOW + PRESSURE)
    with study.start("--cluster", "local", "--jobs", "2") as process:
        wait_for(lambda: len(study.calls) >= 3)
        worker = _worker_of(study)
        os.kill(worker, signal.SIGKILL)
        said, error = process.communicate(timeout=120)
    assert (process.returncode, error) == (0, "")
    assert "[8/8]" in said
    rows = study.rows
    assert [row["status"] for row in rows] == ["finished"] * 8
    assert [float(row["pressure_mpa"]) for row in rows] == pytest.approx(list(range(4, 36, 4)))
    assert len(study.calls) <= 8 + 2  # only what the lost worker had is run again


def _worker_of(study: SmallStudy) -> int:
    """Process that started a run of the study which is going on."""
    found: list[int] = []

    def look() -> bool:
        for process in Path("/proc").glob("[0-9]*"):
            try:
                words = (process / "cmdline").read_text()
                if "wingcrack-solver\0run" in words and str(study.folder) in words:
                    status = (process / "status").read_text()
                    found.append(int(status.split("PPid:")[1].split()[0]))
            except OSError:
                continue
        return bool(found)

    wait_for(look)
    return found[0]


def test_a_cluster_goes_on_with_what_processes_have_run(tmp_path: Path) -> None:
    study = small_study(tmp_path)
    assert study.call().returncode == 0
    study.write(SOUND.replace("4.0e-9]", "4.0e-9, 5.0e-9]"))
    assert study.call("--cluster", "local", "--jobs", "1").returncode == 0
    assert study.calls[3:] == ["5e-09 plain"]


@pytest.mark.skipif(
    importlib.util.find_spec("dask_jobqueue") is not None, reason="dask_jobqueue is installed"
)
@pytest.mark.parametrize("kind", ["slurm", "pbs"])
def test_a_queue_takes_a_package_of_its_own(tmp_path: Path, kind: str) -> None:
    study = small_study(tmp_path, SOUND + f'[cluster]\nkind = "{kind}"\n')
    done = study.call()
    assert done.returncode == 3
    assert "takes the Python package dask-jobqueue" in done.stderr
    assert done.stderr.count("\n") == 1
    assert study.calls == []


def test_an_argument_that_the_class_does_not_know(tmp_path: Path) -> None:
    study = small_study(tmp_path, SOUND + '[cluster]\nkind = "local"\n[cluster.local]\nmoon = 1\n')
    done = study.call()
    assert done.returncode == 3
    assert "cannot be started" in done.stderr
    assert "moon" in done.stderr
    assert study.calls == []
