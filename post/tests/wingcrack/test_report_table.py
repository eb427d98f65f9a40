"""The table of what each well did in each stage."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from wingcrack.figures import read_run
from wingcrack.figures.page import write_page
from wingcrack.figures.report import report_rows

_HEAD = (
    "time_s,well,stage,control,rate_m2_s,pressure_pa,injected_m2,injectivity_m2_s_pa,"
    "pressure_error_pa,injectivity_error_m2_s_pa\n"
)
# an injector in two stages with a shut-in, and a producer, in the order of the file
_ROWS = """\
0.0,a,0,shut,0.0,1e6,0.0,0.0,0.0,0.0
0.0,b,0,shut,0.0,1e6,0.0,0.0,0.0,0.0
10.0,a,1,rate,2e-6,5e6,2e-5,1e-12,1e4,1e-14
10.0,b,1,rate,-1e-6,9e5,-1e-5,1e-12,1e4,1e-14
20.0,a,1,limit,1e-6,4e6,3e-5,2e-12,2e4,1e-14
20.0,b,1,rate,-1e-6,8e5,-2e-5,1e-12,1e4,1e-14
30.0,a,2,rate,0.0,3e6,3e-5,0.0,3e4,-1.0
30.0,b,1,rate,-1e-6,7e5,-3e-5,1e-12,1e4,1e-14
"""


@pytest.fixture
def wells(own_run: Path) -> Path:
    """Add two wells to the synthetic run."""
    (own_run / "wells.csv").write_text(_HEAD + _ROWS)
    return own_run


def test_each_well_has_a_row_per_stage(wells: Path) -> None:
    rows = report_rows(read_run(wells))
    assert [(row["well"], row["stage"]) for row in rows] == [("a", 1), ("a", 2), ("b", 1)]
    first, shut_in, producer = rows
    assert (first["begin_s"], first["end_s"], first["controls"]) == (0.0, 20.0, "rate limit")
    assert first["highest_pressure_pa"] == 5e6
    assert first["highest_pressure_time_s"] == 10.0
    assert (first["pressure_at_begin_pa"], first["pressure_at_end_pa"]) == (1e6, 4e6)
    assert first["pressure_at_end_error_pa"] == 2e4
    assert first["injected_m2"] == pytest.approx(3e-5)
    assert first["produced_m2"] == 0.0
    assert (shut_in["begin_s"], shut_in["injected_m2"]) == (20.0, 0.0)
    assert shut_in["injectivity_error_m2_s_pa"] == ""  # none is stated
    assert producer["produced_m2"] == pytest.approx(3e-5)


def test_page_and_file_have_the_same_rows(wells: Path, tmp_path: Path) -> None:
    table, _, page = write_page(read_run(wells), tmp_path, ())
    with table.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["highest_pressure_pa"]) for row in rows] == [5e6, 3e6, 9e5]
    text = page.read_text(encoding="utf-8")
    assert text.count("<tr>") == 1 + len(rows)
    assert '<a href="report.csv">' in text
    assert "<td>2e-12</td>" in text  # the injectivity, in its unit
