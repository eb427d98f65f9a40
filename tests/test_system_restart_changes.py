"""A run that goes on with other wells, another end or other growth is as if it had begun so."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from restarts import EVERY_STATE, FINE, assert_same, finished, solver
from system_scene import GROWING, varied

import wingcrack

pytestmark = pytest.mark.usefixtures("program")


def test_another_stage_and_end_are_as_if_they_had_been_there_from_the_start(
    tmp_path: Path,
) -> None:
    whole = FINE.replace("end = 14400.0", "end = 16200.0") + EVERY_STATE
    (tmp_path / "whole.nml").write_text(whole)
    (tmp_path / "base.nml").write_text(FINE.replace("end = 18000.0", "end = 7200.0") + EVERY_STATE)
    for words in (
        ("run", tmp_path / "whole.nml", "--out", tmp_path / "whole"),
        ("run", tmp_path / "base.nml", "--out", tmp_path / "base"),
        *[
            ("run", tmp_path / "whole.nml", "--restart", tmp_path / "base", "--out", tmp_path / out)
            for out in ("fork_1", "fork_2")
        ],
    ):
        done = solver(*words, "--quiet")
        assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "fork_1", tmp_path / "whole")
    assert_same(tmp_path / "fork_2", tmp_path / "whole")


def test_another_end_is_as_if_it_had_been_there_from_the_start(tmp_path: Path) -> None:
    """With a tolerance and growth: the continued run keeps the first step of its start.

    No step before the last one is tried that reaches the end, as one after 3600 s would up to
    7200 s.
    """
    scene = GROWING.replace("end = 7200.0, step = 3600.0", "end = 9000.0") + EVERY_STATE
    (tmp_path / "base.nml").write_text(scene)
    base, longer = tmp_path / "base", tmp_path / "longer"
    assert solver("run", tmp_path / "base.nml", "--out", base, "--quiet").returncode == 0
    # The last step was shortened to reach the end.
    (base / "checkpoint_old.bin").rename(base / "checkpoint.bin")
    for words in (
        ("--restart", base, "--end", "9800.0", "--out", longer),
        (longer / "scene.nml", "--out", tmp_path / "whole"),
    ):
        done = solver("run", *words, "--quiet")
        assert done.returncode == 0, done.stderr
    assert wingcrack.open(longer).scene["time.first"] == pytest.approx(9000.0e-7)
    assert_same(longer, tmp_path / "whole")


def test_a_well_that_comes_later_is_as_if_it_had_been_there_from_the_start(tmp_path: Path) -> None:
    well = "&injection name = 'second', x = 0.7, y = 0.7, rate = 4.0e-9, start = {} /\n"
    whole = FINE + well.format("9000.0, end = 12000.0") + EVERY_STATE
    (tmp_path / "whole.nml").write_text(whole)
    base = FINE.replace("end = 18000.0", "end = 7200.0") + well.format("1.0e9") + EVERY_STATE
    (tmp_path / "base.nml").write_text(base)
    for words in (
        ("run", tmp_path / "whole.nml", "--out", tmp_path / "whole"),
        ("run", tmp_path / "base.nml", "--out", tmp_path / "base"),
        (
            *("run", tmp_path / "whole.nml", "--restart", tmp_path / "base"),
            *("--out", tmp_path / "later"),
        ),
    ):
        done = solver(*words, "--quiet")
        assert done.returncode == 0, done.stderr
    assert_same(tmp_path / "later", tmp_path / "whole")


def columns_apart(first: Path, second: Path, table: str, after: float, rounding: float) -> set[str]:
    """Columns of the rows after a time that differ by more than rounding, or that one lacks."""
    one, other = (pd.read_csv(folder / table) for folder in (first, second))
    one, other = (frame[frame["time_s"] > after].reset_index(drop=True) for frame in (one, other))
    assert len(one) == len(other) > 0
    apart = set(one.columns) ^ set(other.columns)
    for name in set(one.columns) & set(other.columns):
        if pd.api.types.is_numeric_dtype(one[name]):
            scale = max(one[name].abs().max(), np.finfo(float).tiny)
            if not ((one[name] - other[name]).abs() <= rounding * scale).all():
                apart.add(name)
        elif list(one[name]) != list(other[name]):
            apart.add(name)
    return apart


WELLS = {
    "rock": "x = 0.7, y = 0.7, rate = 4.0e-9",
    "pressure": "fracture = 'f1', pressure = 9.0e6, friction = 1.0e14",
    "entry": "fracture = 'f1', entry_loss = 1.0e24, rate = 1.0e-9",
    "limit": "x = 1.3, y = 0.6, pressure = 2.0e6, rate = -1.0e-9, radius = 4.0e-4",
}
# One that is at work before another one of its kind is added.
IN_ROCK = "&injection name = 'rock', x = 0.7, y = 0.7, pressure = 9.0e6, radius = 4.0e-4 /\n"


@pytest.mark.parametrize("kind", list(WELLS))
def test_a_well_added_at_a_restart_is_as_if_it_had_been_there_from_the_start(
    kind: str, tmp_path: Path
) -> None:
    """Apart from what counts from its first state: injectivity and stated errors."""
    added = f"&injection name = 'second', {WELLS[kind]}, start = 9000.0, end = 12000.0 /\n"
    scene = FINE + IN_ROCK * (kind == "limit")
    whole = finished(tmp_path, "whole", scene + added)
    base = finished(tmp_path, "base", scene.replace("end = 18000.0", "end = 7200.0"))
    later = finished(tmp_path, "later", scene + added, "--restart", base)
    assert "well second added" in (later / "run.log").read_text()
    for table in ("history.csv", "wells.csv", "fractures.csv", "probes.csv"):
        # The columns of a single well are kept, and are empty from here on.
        single = {"well_pressure_pa", "injectivity_m2_s_pa", "injectivity_error_m2_s_pa"}
        apart = columns_apart(whole, later, table, 7200.0, 1e-9)
        assert {name for name in apart - single if "error" not in name} == set(), table
    rows = pd.read_csv(later / "history.csv")
    if kind != "limit":
        assert rows["well_pressure_pa"].notna().sum() == (rows["time_s"] <= 7200.0).sum()
    assert rows["second_well_pressure_pa"].notna().sum() == (rows["time_s"] > 7200.0).sum()
    again = solver("run", "--restart", later, "--end", "18600.0", "--out", tmp_path / "again")
    assert again.returncode == 0, again.stderr
    assert (
        (tmp_path / "again" / "history.csv")
        .read_text()
        .startswith((later / "history.csv").read_text())
    )


def test_a_well_left_out_at_a_restart_is_closed(tmp_path: Path) -> None:
    base = finished(tmp_path, "base", FINE.replace("end = 18000.0", "end = 7200.0"))
    whole = finished(tmp_path, "whole", FINE.replace("end = 14400.0", "end = 7200.0"))
    later = finished(tmp_path, "later", re.sub(r"&injection.*?/\n", "", FINE), "--restart", base)
    assert "well well_1 closed" in (later / "run.log").read_text()
    for table in ("history.csv", "wells.csv", "fractures.csv", "probes.csv"):
        assert (later / table).read_bytes() == (whole / table).read_bytes(), table


# Steps with a tolerance, which growth needs; with this toughness nothing grows.
TOUGH = varied(
    ("toughness = 0.3e6", "toughness = 3.0e6"),
    ("step = 3600.0", "step = 600.0, tolerance = 0.01, first = 0.002"),
)
SWITCHED = TOUGH.replace("intensities = .true.", "enabled = .true.")


@pytest.mark.parametrize(("before", "after"), [(TOUGH, SWITCHED), (SWITCHED, TOUGH)])
def test_growth_switched_at_a_restart_is_as_if_it_had_been_so_from_the_start(
    before: str, after: str, tmp_path: Path
) -> None:
    whole = finished(tmp_path, "whole", after)
    base = finished(tmp_path, "base", before.replace("end = 18000.0", "end = 7200.0"))
    # The last step was shortened to reach the end.
    (base / "checkpoint_old.bin").rename(base / "checkpoint.bin")
    later = finished(tmp_path, "later", after, "--restart", base)
    since = pd.read_csv(base / "history.csv")["time_s"].iloc[-2]
    only_with_growth = {"dimensionless_toughness", "dimensionless_leakoff"}
    only_with_growth |= {"apparent_toughness_pa_sqrtm"}
    for table in ("history.csv", "tips.csv", "wells.csv", "fractures.csv", "probes.csv"):
        assert columns_apart(whole, later, table, since, 1e-10) <= only_with_growth, table


def test_growth_ends_at_a_restart_and_begins_again(tmp_path: Path) -> None:
    growing = GROWING.replace("stop_gain = 0.015", "stop_gain = 0.5")
    base = finished(tmp_path, "base", growing.replace("end = 7200.0", "end = 5400.0"))
    off = growing.replace("enabled = .true.", "enabled = .false.")
    held = finished(tmp_path, "held", off, "--restart", base)
    rows = pd.read_csv(held / "history.csv")
    rows = rows[rows["time_s"] >= 5400.0]
    assert len(rows) > 2
    assert rows["fracture_length_m"].nunique() == 1
    assert rows["fracture_length_m"].iloc[-1] > 0.12
    assert rows["well_pressure_pa"].is_monotonic_increasing
    assert rows["mass_error_relative"].abs().max() < 1e-9
    # A restart within this part is exact.
    (held / "checkpoint_old.bin").rename(held / "checkpoint.bin")
    shutil.copytree(held, tmp_path / "again")
    run = solver("run", "--restart", tmp_path / "again", "--quiet")
    assert run.returncode == 0, run.stderr
    assert_same(tmp_path / "again", held)
    again = finished(
        tmp_path, "on", growing.replace("end = 7200.0", "end = 7500.0"), "--restart", held
    )
    assert pd.read_csv(again / "history.csv")["fracture_length_m"].iloc[-1] > 0.14


def test_a_change_of_wells_ended_before_its_first_checkpoint_goes_on(tmp_path: Path) -> None:
    """The folder then has the new scene.nml, and the checkpoint of the scene before."""
    added = f"&injection name = 'second', {WELLS['rock']}, start = 9000.0, end = 12000.0 /\n"
    base = finished(tmp_path, "base", FINE.replace("end = 18000.0", "end = 7200.0"))
    later = finished(tmp_path, "later", FINE + added, "--restart", base)
    (base / "scene.nml").write_text((later / "scene.nml").read_text())
    assert solver("run", "--restart", base, "--quiet").returncode == 0
    assert_same(base, later)
