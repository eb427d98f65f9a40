"""The table's statistics and the figures' contents, beside numbers computed here."""

from __future__ import annotations

import csv
import statistics
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Rectangle
from pyarrow import parquet

from small_study import HEAD, LINES, ONSET, OVER, PRESSURE, SmallStudy, small_study
from wingcrack.errors import CaseError
from wingcrack.runner.task import Outcome
from wingcrack.studies import figures
from wingcrack.studies.plots import Plot
from wingcrack.studies.running import done_before, tasks_of
from wingcrack.studies.study import Study, read_study
from wingcrack.studies.table import StudyTable, make_table, write_csv, write_parquet
from wingcrack.sweeps.fields import read_entry

DRAW = """\
[draw]
count = 9
seed = 5
method = "random"
[draw.parameters]
"injection.rate" = { uniform = [1.0e-9, 3.0e-9] }
"""

BAND = LINES.replace('"lines"', '"band"').replace('"pressure"', '"band"')
BARS = '[[figure]]\nname = "bars"\nkind = "histogram"\nquantity = "pressure"\n'
OVER_RATE = (
    '[[figure]]\nname = "over"\nkind = "over"\nquantity = "pressure"\nover = "injection.rate"\n'
)


def ran(made: SmallStudy) -> tuple[Study, StudyTable]:
    """Run a study, and give it with its table."""
    assert made.call().returncode == 0
    study = read_study(made.file)
    outcomes = done_before(tasks_of(study, made.folder / "build", made.out))
    assert len(outcomes) == len(study.runs)
    return study, make_table(study, outcomes, made.out)


def test_statistics_are_those_of_the_table(tmp_path: Path) -> None:
    made = small_study(tmp_path, "quantiles = [0.25, 0.5]\n" + HEAD + DRAW + PRESSURE + BAND + BARS)
    assert made.call().returncode == 0
    values = sorted(float(row["pressure_mpa"]) for row in made.rows)
    rates = sorted(4e9 * float(row["injection_rate_m2_s"]) for row in made.rows)
    assert values == pytest.approx(rates)
    with (made.out / "statistics.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["quantity"], row["runs"], row["absent"]) == ("pressure_mpa", "9", "0")
    assert float(row["mean"]) == pytest.approx(statistics.mean(values))
    assert float(row["standard_deviation"]) == pytest.approx(statistics.stdev(values))
    # of nine values in order the third and the fifth are these quantiles
    assert (float(row["q25"]), float(row["q50"])) == pytest.approx((values[2], values[4]))
    assert (float(row["min"]), float(row["max"])) == pytest.approx((values[0], values[-1]))
    for name in ("band", "bars"):
        assert (made.out / "figures" / f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_what_is_absent_is_counted_and_not_averaged(tmp_path: Path) -> None:
    titles = '[over]\n"scene.title" = ["plain", "quiet"]\n'
    text = "quantiles = [0.5]\n" + HEAD + titles + ONSET + "may_be_absent = true\n"
    made = small_study(tmp_path, text)
    assert made.call().returncode == 0
    with (made.out / "statistics.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["runs"], row["absent"], row["q50"]) == ("1", "1", "2.5")
    assert row["standard_deviation"] == ""


def test_lines_are_those_of_the_files(tmp_path: Path) -> None:
    made = small_study(tmp_path, HEAD + OVER + PRESSURE + LINES)
    study, table = ran(made)
    curves, missing = figures._curves(study, study.plots[0], table, made.out)
    assert missing == []
    figure = figures._lines(study, study.plots[0], curves)
    (axes,) = figure.axes
    for line, rate in zip(axes.get_lines(), (1e-9, 2e-9, 4e-9), strict=True):
        assert np.asarray(line.get_xdata()).tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
        assert np.asarray(line.get_ydata()).tolist() == pytest.approx(
            [1e15 * rate * t for t in range(5)]
        )
    assert len({line.get_color() for line in axes.get_lines()}) == 3
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[1] == r"rate $2\times10^{-9}$ m$^{2}$/s"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "pressure [Pa]")


def test_a_band_has_the_median_of_all_lines(tmp_path: Path) -> None:
    made = small_study(tmp_path, "quantiles = [0.0, 0.5, 1.0]\n" + HEAD + OVER + PRESSURE + BAND)
    study, table = ran(made)
    curves, _ = figures._curves(study, study.plots[0], table, made.out)
    (axes,) = figures._band(study, study.plots[0], curves).axes
    (median,) = axes.get_lines()
    times = np.asarray(median.get_xdata()).tolist()
    assert (times[0], times[-1]) == (0.0, 4.0)
    assert np.asarray(median.get_ydata()).tolist() == pytest.approx(
        [1e15 * 2e-9 * time for time in times]
    )


def test_a_quantity_over_a_parameter(tmp_path: Path) -> None:
    made = small_study(tmp_path, HEAD + OVER.replace("1.0e-9, 2.0e-9", "2.0e-9, 1.0e-9") + PRESSURE)
    made.write(made.file.read_text() + OVER_RATE)
    study, table = ran(made)
    (axes,) = figures._over(study, study.plots[0], table).axes
    (line,) = axes.get_lines()
    assert np.asarray(line.get_xdata()).tolist() == [
        1e-9,
        2e-9,
        4e-9,
    ]  # in order, though run in another
    assert np.asarray(line.get_ydata()).tolist() == pytest.approx([4.0, 8.0, 16.0])
    assert axes.get_xlabel() == "injection: rate [m$^{2}$/s]"


def test_a_histogram_counts_every_run(tmp_path: Path) -> None:
    made = small_study(tmp_path, HEAD + DRAW + PRESSURE + BARS)
    study, table = ran(made)
    (axes,) = figures._bars(study, study.plots[0], table).axes
    assert sum(bar.get_height() for bar in axes.patches if isinstance(bar, Rectangle)) == 9
    middle = statistics.median(float(row["pressure_mpa"]) for row in made.rows)
    assert np.asarray(axes.get_lines()[1].get_xdata())[0] == pytest.approx(middle)


def test_more_lines_than_colours_and_dashes_differ_all_the_same(tmp_path: Path) -> None:
    rates = ", ".join(f"{k}e-9" for k in range(1, 13))
    made = small_study(tmp_path, HEAD + f'[over]\n"injection.rate" = [{rates}]\n' + LINES)
    study, table = ran(made)
    curves, _ = figures._curves(study, study.plots[0], table, made.out)
    (axes,) = figures._lines(study, study.plots[0], curves).axes
    looks = {(line.get_color(), line.get_linestyle()) for line in axes.get_lines()}
    assert len(looks) == 12


def test_a_figure_without_any_run_says_so(tmp_path: Path) -> None:
    made = small_study(tmp_path, HEAD + OVER + '[set]\n"scene.title" = "fail"\n' + LINES)
    done = made.call()
    assert done.returncode == 1
    assert "figure 'pressure': there is nothing to draw: no run has finished" in done.stdout


def test_cells_of_all_kinds(tmp_path: Path) -> None:
    rows = (
        {"run": 1, "flag": True, "x": [0.5, 1.0], "n": 3, "label": 'a "b",\nc', "mixed": 1.0},
        {"run": 2, "flag": None, "x": [0.0], "n": None, "label": "断层", "mixed": "two"},
    )
    table = StudyTable(tuple(rows[0]), {}, rows)
    write_csv(table, tmp_path / "table.csv")
    write_parquet(table, tmp_path / "table.csv", tmp_path / "table.parquet")
    with (tmp_path / "table.csv").open(newline="", encoding="utf-8") as file:
        cells = list(csv.DictReader(file))
    assert cells[0]["x"] == "0.5 1"
    assert cells[0]["label"] == 'a "b",\nc'
    found = parquet.read_table(tmp_path / "table.parquet").to_pylist()
    assert found[0] == {
        **rows[0],
        "x": "0.5 1",
        "mixed": "1.0",
    }
    assert (found[1]["flag"], found[1]["n"], found[1]["label"]) == (None, None, "断层")
    assert sorted(item.name for item in tmp_path.iterdir()) == ["table.csv", "table.parquet"]


def test_a_run_that_no_worker_could_run_is_a_row(tmp_path: Path) -> None:
    study = read_study(small_study(tmp_path, HEAD + OVER + PRESSURE).file)
    lost = Outcome(str(tmp_path / "runs" / "a"), "crashed", "no worker ran it", 0.0, 0.0)
    table = make_table(study, {1: lost}, tmp_path)
    assert [row["status"] for row in table.rows] == ["crashed", "not run", "not run"]
    assert table.rows[0]["folder"] == "runs/a"


@pytest.mark.parametrize("key", ["x_log", "y_log"])
def test_axes_can_be_logarithmic(tmp_path: Path, key: str) -> None:
    plot = read_entry(
        Plot, {"name": "a", "kind": "over", "quantity": "p", "over": "q", key: True}, "figure 1"
    )
    _, axes = figures._empty(plot)
    assert {"x_log": axes.get_xscale(), "y_log": axes.get_yscale()}[key] == "log"


def test_quantities_are_not_for_lines() -> None:
    with pytest.raises(CaseError, match="'quantity' is unknown"):
        read_entry(
            Plot,
            {
                "name": "a",
                "kind": "lines",
                "file": "history.csv",
                "x": "time_s",
                "column": "dt_s",
                "x_label": "t",
                "y_label": "dt",
                "quantity": "p",
            },
            "figure 1",
        )
