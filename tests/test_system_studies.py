"""Studies with the real solver: the table is that of the files; shipped studies are sound."""

from __future__ import annotations

import csv
import subprocess
from pathlib import Path

import pytest
from system_scene import SCENE, SOLVER, TOP

from small_study import call_here

STUDY = """\
title = "Slip by the rate of injection"
scene = "scene.nml"
set = { "time.end" = 7200.0 }

[over]
"injection.rate" = [2.5e-9, 5.0e-9]

[[quantity]]
name = "largest_k2"
unit = "MPa sqrt(m)"
file = "tips.csv"
column = "abs(k2_pa_sqrtm)/1e6"
take = "max"

[[quantity]]
name = "injected"
unit = "m2"
file = "history.csv"
column = "injected_m2"
take = "last"
"""


def study(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return call_here(["study", *map(str, arguments), "--build", str(SOLVER.parents[2])])


def rows_of(file: Path) -> list[dict[str, str]]:
    with file.open(newline="", encoding="utf-8") as text:
        return list(csv.DictReader(text))


def test_the_table_holds_what_the_files_of_the_runs_say(tmp_path: Path) -> None:
    (tmp_path / "scene.nml").write_text(SCENE)
    (tmp_path / "study.toml").write_text(STUDY)
    out = tmp_path / "out"
    done = study(tmp_path / "study.toml", "--out", out)
    assert (done.returncode, done.stderr) == (0, "")
    rows = rows_of(out / "table.csv")
    for row, rate in zip(rows, (2.5e-9, 5.0e-9), strict=True):
        # one hour of injection, until the end of the second hour
        assert float(row["injected_m2"]) == pytest.approx(rate * 3600.0, rel=1e-9)
        tips = rows_of(out / row["folder"] / "output" / "tips.csv")
        largest = max(abs(float(tip["k2_pa_sqrtm"])) for tip in tips)
        assert float(row["largest_k2_mpa_sqrtm"]) == pytest.approx(largest / 1e6, rel=1e-12)
    assert float(rows[0]["largest_k2_mpa_sqrtm"]) < float(rows[1]["largest_k2_mpa_sqrtm"])


@pytest.mark.parametrize(
    "file", sorted((TOP / "inputs" / "studies").glob("*.toml")), ids=lambda file: file.stem
)
@pytest.mark.parametrize("form", [[], ["--quick"]], ids=["whole", "quick"])
def test_every_scene_of_a_shipped_study_passes_the_check(
    tmp_path: Path, file: Path, form: list[str]
) -> None:
    done = study(file, "--check", "--out", tmp_path / "out", *form)
    assert (done.returncode, done.stderr) == (0, "")
    assert "all scenes are sound" in done.stdout


def test_an_entry_that_does_not_exist_is_refused_with_the_nearest(tmp_path: Path) -> None:
    (tmp_path / "scene.nml").write_text(SCENE)
    (tmp_path / "study.toml").write_text(STUDY.replace("injection.rate", "injection.rat"))
    done = study(tmp_path / "study.toml", "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "rate" in done.stderr.splitlines()[-1]
    assert not (tmp_path / "out").exists()
