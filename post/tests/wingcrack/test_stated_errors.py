"""Every published number has a stated error, or a reason why there is none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wingcrack
from wingcrack.names import columns, error_column
from wingcrack.runs.units import column_unit

TOP = Path(__file__).resolve().parents[3]
ROWS = [(file, name) for file, rows in columns().items() for name in rows]
NONE = "none: "
LEAST = 10  # characters of a reason


def stated(file: str, name: str) -> tuple[str, str, str]:
    """File and name of the error of a column, and the reason for runs without it."""
    text = columns()[file][name]["error"]
    where, _, rest = text.partition("; ")
    found, _, other = where.partition(" of ")
    return other or file, found, rest


@pytest.mark.parametrize(("file", "name"), ROWS)
def test_a_column_has_an_error_or_a_reason(file: str, name: str) -> None:
    text = columns()[file][name]["error"]
    if text.startswith(NONE):
        assert len(text) >= LEAST
        return
    where, found, rest = stated(file, name)
    row, of_error = columns()[file][name], columns()[where][found]
    assert of_error["error"] == "none: itself an error"
    if row["unit"] != of_error["unit"]:
        assert found in ("position_error_m", "angle_error_deg")  # of a direction
    written_alike = row["runs"] == of_error["runs"] or where != file
    # Where the value is written in more runs than its error, the reason follows.
    assert written_alike or NONE in f"{rest} " or "with a fluid" in row["runs"]


def test_every_error_is_that_of_a_quantity() -> None:
    named = {stated(file, name)[:2] for file, name in ROWS if "_error" not in name}
    of_their_own = {"mass_error_relative", "forward_error_bound", "energy_error_relative"}
    of_their_own.add("heat_error_relative")
    for file, name in ROWS:
        if "_error" in name and name not in of_their_own:
            assert (file, name) in named, (file, name)


def test_the_page_lists_them() -> None:
    page = (TOP / "docs/output.md").read_text(encoding="utf-8")
    for file, name in ROWS:
        text = columns()[file][name]["error"]
        (line, *_) = (
            row
            for row in page.split(f"## {file}\n")[1].split("\n## ")[0].splitlines()
            if row.startswith(f"| `{name}` |")
        )
        assert text.partition("; ")[0].partition(" of ")[0].removeprefix(NONE) in line


def test_the_column_of_an_error() -> None:
    assert error_column("history.csv", "max_slip_m") == "max_slip_error_m"
    assert error_column("history.csv", "n_slip") is None
    assert error_column("history.csv", "no_such_m") is None
    assert error_column("probes.csv", "a_b_ux_m") == "a_b_u_error_m"
    assert error_column("history.csv", "well_1_well_pressure_pa") is None  # in wells.csv
    assert column_unit("seismic_moment_error_nm") == "N m/m"


def test_a_run_gives_errors(tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text('{"scene": "s", "status": "finished"}')
    (tmp_path / "history.csv").write_text(
        "time_s,max_slip_m,well_pressure_pa,max_slip_error_m,well_pressure_error_pa\n"
        "0.0,0.0,1.0e6,0.0,-1.0\n1.0,2.0e-3,2.0e6,1.0e-4,5.0e4\n"
    )
    run = wingcrack.open(tmp_path)
    slip, pressure = run.error("max_slip_m"), run.error("well_pressure_pa")
    assert slip is not None
    assert pressure is not None
    np.testing.assert_array_equal(slip, [0.0, 1.0e-4])
    np.testing.assert_array_equal(pressure, [np.nan, 5.0e4])
    assert run.error("max_opening_m") is None  # of an older run
    axes = run.plot_history("max_slip_m")
    (band,) = axes.collections
    heights = np.asarray(band.get_paths()[0].vertices)[:, 1]
    assert np.ptp(heights[np.isfinite(heights)]) == pytest.approx(2.1, rel=1.0e-12)  # [mm]
