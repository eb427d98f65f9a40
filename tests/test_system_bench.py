"""The performance measurements: that they say what a run says of itself."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from system_scene import TOP, call

pytestmark = pytest.mark.usefixtures("program")


def test_a_measurement_as_table_and_json(tmp_path: Path) -> None:
    done = call(tmp_path, "bench", "b1", "c1", "--repeat", "1", "--out", "here")
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["b1", "c1"]
    table = {line[:26].strip(): line[26:].split() for line in lines[1:]}
    record = json.loads((tmp_path / "here" / "bench.json").read_text())
    assert set(record) == {"revision", "machine", "measurements"}
    mechanics, fluid = record["measurements"]
    assert (mechanics["name"], fluid["name"]) == ("b1", "c1")
    for measured in (mechanics, fluid):
        phases = measured["phases_s"]
        assert sum(phases.values()) == pytest.approx(measured["cpu_s"], rel=1e-9)
        assert min(phases.values()) >= 0.0
        assert measured["instructions"] is None
        assert measured["memory_mb"] > 1
    assert mechanics["states"] == 1
    assert fluid["states"] == 21
    assert mechanics["phases_s"]["discretize"] == 0.0  # finite volumes are left out
    assert mechanics["unknowns"] < fluid["unknowns"]
    assert table["accepted states"] == ["1", "21"]
    assert table["unknowns"] == [str(mechanics["unknowns"]), str(fluid["unknowns"])]
    assert table["CPU per propagation [s]"] == ["-", "-"]


def test_the_listed_scenes_are_there() -> None:
    table = (TOP / "tools" / "benchmarks.txt").read_text().splitlines()
    entries = [line.split("|") for line in table if line and not line.startswith("#")]
    assert [entry[0].strip() for entry in entries] == ["c1", "n1", "c2", "b1", "b4", "b6"]
    for _, scene, title in entries:
        assert (TOP / scene.strip()).exists()
        assert title.strip()


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
def test_instructions_are_counted_or_the_reason_is_told(tmp_path: Path) -> None:
    done = call(tmp_path, "bench", "b1", "--repeat", "1", "--instructions")
    assert done.returncode == 0, done.stderr
    (measured,) = json.loads((tmp_path / "out" / "bench" / "bench.json").read_text())[
        "measurements"
    ]
    if measured["instructions"] is None:
        assert f"b1: no instructions: {measured['why_not_counted']}" in done.stdout
        assert measured["why_not_counted"]
    else:
        assert measured["instructions"] > 1e6
        assert "instructions [1e6]" in done.stdout


def test_a_wrong_number_of_runs_is_refused(tmp_path: Path) -> None:
    done = call(tmp_path, "bench", "b1", "--repeat", "0")
    assert done.returncode == 2
    assert "'0' is no whole number from 1" in done.stderr.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []
