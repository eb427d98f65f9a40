"""The last lines of a run on the terminal."""

from __future__ import annotations

from pathlib import Path

from wingcrack.closing import closing_lines, pressure_text, time_text

WELLS = """\
time_s,well,pressure_pa,injected_m2
0.0,a,6.9e6,0.0
0.0,b,6.9e6,0.0
170.0,a,11.68e6,1.0e-5
170.0,b,5.0e6,-2.0e-5
3.6e4,a,10.4e6,1.8e-4
3.6e4,b,0.91e6,-3.0e-5
"""


def test_each_well_and_events_by_kind(tmp_path: Path) -> None:
    (tmp_path / "wells.csv").write_text(WELLS)
    (tmp_path / "events.csv").write_text(
        "time_s,kind\n1,slip_onset\n2,remesh\n3,growth\n3,growth\n"
    )
    assert closing_lines(tmp_path) == [
        "a: injected 0.00018 m2, 10.4 MPa at the end, at most 11.7 MPa at 170 s",
        "b: produced 3e-05 m2, 0.91 MPa at the end, at most 6.9 MPa at 0 s",
        "events: 1 fracture slips, 2 increments of tips",
    ]


def test_nothing_is_said_of_what_is_not_there(tmp_path: Path) -> None:
    assert closing_lines(tmp_path) == []


def test_numbers_have_units_that_read_well() -> None:
    assert [pressure_text(value) for value in (0.0, 250.0, 25.0e3, 0.31e6, -2.0e6)] == [
        "0 Pa",
        "0.25 kPa",
        "25 kPa",
        "0.31 MPa",
        "-2 MPa",
    ]
    assert [time_text(value) for value in (0.5, 599.0, 750.0, 1.0e5)] == [
        "0.5 s",
        "599 s",
        "12.5 min",
        "27.8 h",
    ]
