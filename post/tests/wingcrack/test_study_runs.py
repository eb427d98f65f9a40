"""What is run, what is not run again, and what survives when the call or a run does not."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest
from pyarrow import parquet

from small_study import DRAWN, HEAD, ONSET, OVER, PRESSURE, SOUND, SmallStudy, small_study, wait_for

SLOW = '[set]\n"scene.title" = "slow"\n'
HANG = HEAD + OVER + '[set]\n"scene.title" = "hang"\n'


@pytest.fixture
def study(tmp_path: Path) -> SmallStudy:
    return small_study(tmp_path)


def test_a_grid_gives_a_row_and_a_run_for_each_value(study: SmallStudy) -> None:
    study.write(DRAWN)
    done = study.call("--format", "png,pdf")
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(study.calls) == ["1e-09 plain", "2e-09 plain", "4e-09 plain"]
    rows = study.rows
    assert [float(row["injection_rate_m2_s"]) for row in rows] == [1e-9, 2e-9, 4e-9]
    assert [float(row["pressure_mpa"]) for row in rows] == pytest.approx([4.0, 8.0, 16.0])
    assert [row["onset_s"] for row in rows] == ["2.5"] * 3
    assert {row["status"] for row in rows} == {"finished"}
    for form in ("png", "pdf"):
        assert (study.out / "figures" / f"pressure.{form}").stat().st_size > 1000


def test_parquet_holds_the_same_table_with_units(study: SmallStudy) -> None:
    assert study.call().returncode == 0
    table = parquet.read_table(study.out / "table.parquet")
    rows = study.rows
    assert table.column_names == list(rows[0])
    assert table["pressure_mpa"].to_pylist() == [float(row["pressure_mpa"]) for row in rows]
    assert table["label"].to_pylist() == [row["label"] for row in rows]
    assert table.schema.field("pressure_mpa").metadata == {b"unit": b"MPa"}
    assert table.schema.field("injection_rate_m2_s").metadata == {b"unit": b"m2/s"}


def test_nothing_is_run_again(study: SmallStudy) -> None:
    assert study.call().returncode == 0
    first = (study.out / "table.csv").read_bytes()
    done = study.call()
    assert done.returncode == 0
    assert len(study.calls) == 3
    assert (study.out / "table.csv").read_bytes() == first
    record = json.loads((study.out / "study.json").read_text())
    assert (record["runs_of_this_call"], record["runs_done"]) == (0, 3)


def test_a_new_value_and_another_order_run_only_what_is_new(study: SmallStudy) -> None:
    assert study.call().returncode == 0
    study.write(SOUND.replace("[1.0e-9, 2.0e-9, 4.0e-9]", "[8.0e-9, 4.0e-9, 1.0e-9]"))
    assert study.call().returncode == 0
    assert study.calls[3:] == ["8e-09 plain"]
    assert [float(row["pressure_mpa"]) for row in study.rows] == pytest.approx([32.0, 16.0, 4.0])


def test_a_new_quantity_is_read_without_a_run(study: SmallStudy) -> None:
    assert study.call().returncode == 0
    study.write(SOUND + PRESSURE.replace('"pressure"', '"mean"').replace('"max"', '"mean"'))
    assert study.call().returncode == 0
    assert len(study.calls) == 3
    assert [float(row["mean_mpa"]) for row in study.rows] == pytest.approx([2.0, 4.0, 8.0])


def test_another_solver_runs_all(study: SmallStudy) -> None:
    assert study.call().returncode == 0
    solver = study.folder / "build" / "fortran" / "app" / "wingcrack-solver"
    solver.write_text(solver.read_text() + "# rebuilt\n")
    assert study.call().returncode == 0
    assert len(study.calls) == 6


def test_a_run_that_fails_does_not_end_the_others(study: SmallStudy) -> None:
    titles = '[over]\n"scene.title" = ["fail", "plain"]\n'
    study.write(HEAD + titles + PRESSURE)
    done = study.call()
    assert done.returncode == 1
    assert "1 of 2 runs failed" in done.stderr.splitlines()[-1]
    failed, sound = study.rows
    assert (failed["status"], failed["pressure_mpa"]) == ("failed", "")
    assert failed["reason"] == "wingcrack: the step is too small"
    assert sound["status"] == "finished"
    assert study.call().returncode == 1  # still, without another run
    assert len(study.calls) == 2


def test_a_run_that_takes_too_long_is_ended(study: SmallStudy) -> None:
    study.write(HANG.replace("[over]", "time_limit_s = 0.5\n[over]"))
    assert study.call().returncode == 1
    assert {row["status"] for row in study.rows} == {"crashed"}


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_leaves_the_table_of_what_is_done(
    study: SmallStudy, number: signal.Signals, status: int
) -> None:
    titles = '[over]\n"scene.title" = ["plain", "hang"]\n'
    study.write(HEAD + titles + PRESSURE)
    with study.start("--jobs", "1") as process:
        wait_for(lambda: len(study.calls) == 2)
        process.send_signal(number)
        _, said = process.communicate(timeout=60)
    assert process.returncode == status
    assert "interrupted with 1 runs to go" in said.splitlines()[-1]
    assert [row["status"] for row in study.rows] == ["finished", "not run"]
    assert json.loads((study.out / "study.json").read_text())["status"] == "stopped"


def test_killed_in_the_middle_it_goes_on_where_it_was(study: SmallStudy) -> None:
    study.write(SOUND.replace("[[quantity]]", SLOW + "[[quantity]]", 1))
    with study.start("--jobs", "1") as process:
        wait_for(lambda: any(study.out.glob("runs/*/outcome.json")))
        process.kill()
        process.communicate(timeout=60)
    before = study.calls
    assert 1 <= len(before) < 3
    done = study.call("--jobs", "1")
    assert done.returncode == 0
    assert study.calls.count("1e-09 slow") == 1
    assert [row["status"] for row in study.rows] == ["finished"] * 3


def test_runs_end_with_a_call_that_was_killed(study: SmallStudy) -> None:
    study.write(HANG)
    with study.start("--jobs", "2") as process:
        wait_for(lambda: len(study.calls) == 2)
        assert len(_running_in(study.out)) >= 2
        process.kill()
        process.communicate(timeout=60)
    solver = str(study.folder / "build")
    wait_for(lambda: not any(solver in words for words in _running_in(study.out)))


def _running_in(folder: Path) -> list[str]:
    """Words of the processes that run in a folder."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if str(folder) in str((process / "cwd").readlink()):
                found.append((process / "cmdline").read_text())
        except OSError:
            continue
    return found


def test_two_calls_do_not_share_a_folder(study: SmallStudy) -> None:
    study.write(HANG)
    with study.start() as process:
        wait_for(lambda: bool(study.calls))
        other = study.call()
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
    assert other.returncode == 2
    assert "another study is running in" in other.stderr


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (SOUND.replace("injection.rate", "injection.rote"), "rote is unknown; did you mean rate?"),
        (
            HEAD + '[over]\n"scene.title" = ["plain", "refuse"]\n',
            "run 2 (scene.title = refuse): rate 1e-09 is too much",
        ),
        (  # of several scenes that one process checks
            HEAD + '[over]\n"scene.title" = ["plain", "slow", "hang", "fail", "refuse", "quiet"]\n',
            "run 5 (scene.title = refuse): rate 1e-09 is too much",
        ),
        (SOUND.replace("injection.rate", "fracture.f2.x"), "there is no item 'f2'"),
        (SOUND.replace('"scene.nml"', '"none.nml"'), "there is no scene file"),
        ("", "'title' is missing"),
        ("title = ", "study.toml: "),
    ],
)
def test_what_is_wrong_is_refused_before_anything_runs(
    study: SmallStudy, text: str, reason: str
) -> None:
    study.write(text)
    done = study.call()
    assert done.returncode == 2
    assert reason in done.stderr
    assert done.stderr.count("\n") == 1
    assert not study.out.exists()
    assert study.calls == []


def test_check_writes_nothing(study: SmallStudy) -> None:
    done = study.call("--check")
    assert done.returncode == 0
    assert not study.out.exists()
    assert study.calls == []


def test_what_is_absent_is_told_unless_it_may_be(study: SmallStudy) -> None:
    titles = '[over]\n"scene.title" = ["plain", "quiet"]\n'
    study.write(HEAD + titles + ONSET)
    assert study.call().returncode == 0
    assert study.rows[1]["onset_s"] == ""
    assert study.rows[1]["reason"] == "onset: events.csv: no row where kind = growth"
    study.write(HEAD + titles + ONSET + "may_be_absent = true\n")
    assert study.call().returncode == 0
    assert (study.rows[1]["onset_s"], study.rows[1]["reason"]) == ("", "")


def test_a_wrong_column_is_refused_even_if_absence_is_allowed(study: SmallStudy) -> None:
    study.write(HEAD + OVER + ONSET.replace('"time_s"', '"time_h"') + "may_be_absent = true\n")
    done = study.call()
    assert done.returncode == 2
    assert "events.csv has no column 'time_h'" in done.stderr
    assert study.calls == []


def test_without_a_solver_the_environment_is_at_fault(study: SmallStudy) -> None:
    (study.folder / "build" / "fortran" / "app" / "wingcrack-solver").unlink()
    done = study.call()
    assert done.returncode == 3
    assert "not built" in done.stderr


def test_results_that_cannot_be_written(study: SmallStudy) -> None:
    done = study.call("--out", "/proc/here")
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1


def test_quick_takes_the_short_form_and_keeps_the_long_one(study: SmallStudy) -> None:
    study.write(SOUND + '[quick]\nover = { "injection.rate" = [3.0e-9] }\n')
    assert study.call("--quick").returncode == 0
    assert study.calls == ["3e-09 plain"]
    study.write(SOUND)
    done = study.call("--quick")
    assert done.returncode == 2
    assert "there is no [quick]" in done.stderr


def test_a_column_that_the_first_run_lacks_ends_the_study(study: SmallStudy) -> None:
    """It is one of a run's columns, but not of this run's: the others are not run."""
    study.write(SOUND.replace("well_pressure_pa", "max_slip_m"))
    done = study.call("--jobs", "1")
    assert done.returncode == 1
    assert "history.csv of the run has no max_slip_m; ended with " in done.stderr.splitlines()[-1]
    assert len(study.calls) < 3
    assert study.call("--jobs", "1").returncode == 1  # of what is there already, too
    assert len(study.calls) < 3


def test_a_file_that_may_be_absent_is_no_fault(study: SmallStudy) -> None:
    absent = PRESSURE.replace("history.csv", "slip_events.csv").replace(
        "well_pressure_pa", "time_s"
    )
    study.write(HEAD + OVER + ONSET + absent + "may_be_absent = true\n")
    done = study.call()
    assert (done.returncode, done.stderr) == (0, "")
    assert {(row["pressure_mpa"], row["reason"]) for row in study.rows} == {("", "")}


def test_a_quantity_of_no_run_is_told_by_the_status(study: SmallStudy) -> None:
    study.write(SOUND.replace('"growth"', '"growht"'))
    done = study.call()
    assert done.returncode == 1
    assert "'onset' could be read of no run" in done.stderr.splitlines()[-1]
    assert len(study.calls) == 3


def test_a_link_that_leads_out_of_the_run_is_not_followed(study: SmallStudy) -> None:
    assert study.call().returncode == 0
    secret = study.folder / "secret.csv"
    secret.write_text("time_s,well_pressure_pa\n0,12345678\n")
    for history in study.out.glob("runs/*/output/history.csv"):
        history.unlink()
        history.symlink_to(secret)
    done = study.call()
    assert done.returncode == 1
    assert "history.csv: it is not in the folder of the run" in done.stderr.splitlines()[-1]
    assert "12.345678" not in (study.out / "table.csv").read_text()
