"""What is run again, and what is not."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from small_case import SmallCase, small_case
from wingcrack_verify.judge import FAILED, PASSED

ALL = ["coarse", "fine", "middle"]


@pytest.fixture
def case(tmp_path: Path) -> SmallCase:
    made = small_case(tmp_path, "absolute")
    assert made.judge().verdict == PASSED
    assert sorted(made.calls) == ALL
    return made


def test_an_unchanged_case_is_not_run_again(case: SmallCase) -> None:
    assert case.judge().verdict == PASSED
    assert len(case.calls) == 3


def test_a_changed_check_is_judged_anew_without_a_run(case: SmallCase) -> None:
    case.toml = case.toml.replace("reference = 2.0", "reference = 3.0")
    assert case.judge().verdict == FAILED
    assert len(case.calls) == 3


def test_a_changed_reference_file_is_read_anew(tmp_path: Path) -> None:
    case = small_case(tmp_path, "relative")
    assert case.judge().verdict == PASSED
    case.edit("reference.csv", "1.0,2.0", "1.0,3.0")
    assert case.judge().verdict == FAILED


def test_a_changed_value_runs_that_run_only(case: SmallCase) -> None:
    case.toml = case.toml.replace('"scene.name" = "fine"', '"scene.name" = "fine", "a.b" = 1')
    case.judge()
    assert case.calls[3:] == ["fine"]


def test_a_changed_scene_file_runs_all(case: SmallCase) -> None:
    case.edit("scene.nml", "'none'", "'none', title = 'new'")
    case.judge()
    assert sorted(case.calls[3:]) == ALL


def test_a_changed_solver_runs_all(case: SmallCase) -> None:
    case.write_solver("# another build\n")
    case.judge()
    assert sorted(case.calls[3:]) == ALL


def test_a_run_that_was_killed_is_run_again(tmp_path: Path) -> None:
    case = small_case(tmp_path, "absolute")
    case.ends_with("fine", "kill -KILL $$")
    assert case.judge().verdict == FAILED
    case.ends_with("fine", "true")
    assert case.judge().verdict == PASSED
    assert sorted(case.calls) == [*ALL[:2], "fine", "middle"]


def test_a_failure_of_its_own_is_kept(tmp_path: Path) -> None:
    case = small_case(tmp_path, "absolute")
    case.ends_with("fine", "echo reason >&2; exit 1")
    assert case.judge().verdict == FAILED
    report = case.judge()
    assert report.verdict == FAILED
    assert "reason" in report.checks[0].reasons[0]
    assert sorted(case.calls) == ALL


def test_an_interrupted_call_goes_on_where_it_stopped(tmp_path: Path) -> None:
    case = small_case(tmp_path, "absolute")
    (case.case / "check.toml").write_text(case.toml)
    case.ends_with("fine", f"touch {tmp_path}/started; exec sleep 60")
    command = [sys.executable, "-m", "wingcrack", "verify", "--jobs", "1"]
    for name, folder in (("cases", "verification"), ("build", "build"), ("cache", "cache")):
        command += [f"--{name}", str(tmp_path / folder)]
    command += ["--report", str(tmp_path / "report")]
    packages = {"PYTHONPATH": str(Path(__file__).parents[2])}
    with subprocess.Popen(command, env=os.environ | packages, preexec_fn=heed_interrupts) as call:
        deadline = time.monotonic() + 60.0
        while not (tmp_path / "started").exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        call.send_signal(signal.SIGINT)
        assert call.wait(timeout=30.0) == 130
    assert not (tmp_path / "report").exists()
    case.ends_with("fine", "true")
    assert case.judge().verdict == PASSED
    assert case.calls == ["coarse", "middle", "fine", "fine"]


def heed_interrupts() -> None:
    """Undo an ignored SIGINT, which the call would inherit."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
