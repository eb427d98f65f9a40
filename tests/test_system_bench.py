"""The performance measurements: that they say what a run says of itself, and find a loss."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from system_scene import SOLVER, call

pytestmark = pytest.mark.usefixtures("program")

needs_valgrind = pytest.mark.skipif(
    shutil.which("valgrind") is None, reason="valgrind is not installed"
)


def test_a_measurement_as_table_and_json(tmp_path: Path) -> None:
    done = call(tmp_path, "bench", "b1", "quick_fluid", "--repeat", "2", "--out", "here")
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[1].split()[0] == "b1"
    assert lines[2].split()[0] == "quick_fluid"
    assert any(line.startswith("  quick_fluid: ") for line in lines)
    record = json.loads((tmp_path / "here" / "bench.json").read_text())
    assert set(record) == {"revision", "machine", "made_with", "measurements", "growth"}
    mechanics, fluid = record["measurements"]
    assert (mechanics["name"], fluid["name"]) == ("b1", "quick_fluid")
    for measured in (mechanics, fluid):
        typical = measured["typical"]
        assert len(measured["cpu_s"]) == 2
        assert min(measured["cpu_s"]) <= measured["median_s"] <= max(measured["cpu_s"])
        assert sum(typical["phases_s"].values()) == pytest.approx(typical["cpu_s"], rel=1e-9)
        assert min(typical["phases_s"].values()) >= 0.0
        assert measured["instructions"] is None
        assert typical["memory_mb"] > 1
    assert mechanics["typical"]["states"] == 1
    assert fluid["typical"]["states"] == 2
    assert mechanics["typical"]["phases_s"]["discretize"] == 0.0  # finite volumes are left out
    assert min(measured["typical"]["sizes"]["unknowns"] for measured in (mechanics, fluid)) > 1000
    assert fluid["cpu_per_growth_s"] is None


@needs_valgrind
def test_a_loss_of_instructions_is_found(tmp_path: Path) -> None:
    baseline = tmp_path / "baseline.json"
    options = (
        "quick_fractures",
        "--repeat",
        "1",
        "--baseline",
        str(baseline),
        "--out",
        str(tmp_path / "out"),
    )
    done = call(tmp_path, "bench", *options, "--store")
    if done.returncode == 1 and "not all could be counted" in done.stderr:
        pytest.skip(done.stdout.splitlines()[-1])
    assert done.returncode == 0, done.stderr
    stored = json.loads(baseline.read_text())
    assert stored["instructions"]["quick_fractures"] > 1e8
    # a program that had taken a fifth less; how much more is no loss: test_bench.py
    stored["instructions"]["quick_fractures"] = int(stored["instructions"]["quick_fractures"] / 1.2)
    baseline.write_text(json.dumps(stored))
    done = call(tmp_path, "bench", *options, "--instructions")
    assert done.returncode == 1
    assert "instructions are judged for quick_fractures" in done.stdout
    assert "a loss: quick_fractures takes 1.2" in done.stderr.splitlines()[-1]


def test_a_loss_against_another_program_is_found(tmp_path: Path) -> None:
    """Here the other program is this one, started with a wrapper that costs nothing or much."""
    for name, extra, status in (("same", "", 0), ("slow", "--solver", 1)):
        wrapper = tmp_path / name
        work = "for ((k = 0; k < 200000; ++k)); do :; done\n" if extra else ""
        wrapper.write_text(f'#!/bin/bash\n{work}exec "{SOLVER}" "$@"\n')
        wrapper.chmod(0o755)
        pair = ["--solver", str(wrapper), "--against", str(SOLVER)]
        done = call(tmp_path, "bench", "b1", "--repeat", "3", *pair)
        assert done.returncode == status, done.stdout + done.stderr
        (measured,) = json.loads((tmp_path / "out" / "bench" / "bench.json").read_text())[
            "measurements"
        ]
        assert len(measured["other_s"]) == 3
        assert (measured["cpu_ratio"] > 1.25) == (status == 1)
    assert "times the CPU time of the other program" in done.stderr.splitlines()[-1]


def test_a_run_that_fails_is_told(tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    broken.write_text("#!/bin/sh\necho 'wingcrack: it broke' >&2\nexit 1\n")
    broken.chmod(0o755)
    done = call(tmp_path, "bench", "b1", "--solver", str(broken))
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == "wingcrack bench: b1: it broke"
    assert not (tmp_path / "out").exists()
