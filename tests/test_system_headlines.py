"""Headline numbers of runs with an injector and a producer, wherever they are stated.

What terminal, history, summary, story, page, report, studies and Python state is compared with
numbers of wells.csv and slip_events.csv, added up here.
"""

from __future__ import annotations

import csv
import html
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from system_scene import TOP, call, changed, rows, run

import wingcrack
from wingcrack.closing import closing_lines
from wingcrack.figures import read_run
from wingcrack.figures.facts import gather_facts
from wingcrack.figures.report import report_rows
from wingcrack.figures.story import _facts
from wingcrack.studies.quantities import Quantity, measure

pytestmark = pytest.mark.usefixtures("program")

FIELD = changed(
    (TOP / "inputs" / "examples" / "field.nml").read_text(),
    ("end = 259200.0", "end = 50000.0"),
    ("'field_injector.csv'", f"'{TOP}/inputs/examples/field_injector.csv'"),
    ("size_fracture = 2.0", "size_fracture = 5.0"),
    ("size_boundary = 16.0", "size_boundary = 40.0"),
)
BODY = """\
&domain x_min = -50, x_max = 50, y_min = -50, y_max = 50 /
&material young = 30e9, poisson = 0.25, biot = 0.7, porosity = 0.02, permeability = 1e-16 /
&fluid compressibility = 4.5e-10, viscosity = 3e-4 /
&in_situ sxx = -40e6, syy = -25e6 /
&initial pressure = 12e6 /
&side name = 'left', x_displacement = 0, pressure = 12e6 /
&side name = 'right', pressure = 12e6 /
&side name = 'bottom', y_displacement = 0 /
&fracture name = 'in', x = -12, 2, y = -6, 4, friction = 0.6, dilation_deg = 3, aperture = 2e-4 /
&fracture name = 'out', x = 4, 16, y = 0, 9, friction = 0.6, dilation_deg = 3, aperture = 2e-4 /
&coarse size_fracture = 2.0, size_boundary = 16 /
&output vtu = .false., seismic_slip_rate = 1e-8, stimulated_jump = 1e-7 /
"""
# The producer comes first, a thickness, flow-back of the injector, whose peak is early.
DOUBLET = """\
&scene thickness = 30 /
&injection name = 'p', fracture = 'out', rate_l_s = -0.15 /
&injection name = 'i', fracture = 'in', time_min = 0, 30, 45, 60, rate_l_s = 1.0, 0.3, 0, -0.3 /
&time end_min = 80 /
"""
# A well in the rock produces; storage and losses of the injector, and limits of both.
LIMITED = """\
&injection name = 'rock', x = 25, y = 20, radius = 0.05, rate = -1e-5, pressure = 8e6, start = 600 /
&injection name = 'frac', fracture = 'in', x = -5, y = -1, rate = 5e-5, pressure = 22e6, end = 2400,
  storage = 1e-9, friction = 1e10 /
&time end = 4000 /
"""
SCENES = {"field": FIELD, "doublet": BODY + DOUBLET, "limited": BODY + LIMITED}


@dataclass(frozen=True)
class Truth:
    """Numbers of wells.csv by well, in SI units, and of slip_events.csv."""

    time: np.ndarray
    pressure: dict[str, np.ndarray]
    injected: dict[str, float]
    produced: dict[str, float]
    magnitudes: list[float]  # of seismic events
    slow: list[float]  # moments of aseismic slip


def truth(out: Path) -> Truth:
    table = rows(out / "wells.csv")
    names = list(dict.fromkeys(row["well"] for row in table))
    of = {name: [row for row in table if row["well"] == name] for name in names}
    time = np.array([float(row["time_s"]) for row in of[names[0]]])
    moved = {
        name: np.diff(time) * np.array([float(row["rate_m2_s"]) for row in of[name]])[1:]
        for name in names
    }
    slips = rows(out / "slip_events.csv")
    return Truth(
        time,
        {name: np.array([float(row["pressure_pa"]) for row in of[name]]) for name in names},
        {name: float(volume[volume > 0].sum()) for name, volume in moved.items()},
        {name: float(-volume[volume < 0].sum()) for name, volume in moved.items()},
        [float(row["magnitude"]) for row in slips if row["kind"] == "seismic"],
        [float(row["moment_nm"]) for row in slips if row["kind"] != "seismic"],
    )


@pytest.fixture(scope="module", params=SCENES)
def done(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a run with its figures."""
    folder = tmp_path_factory.mktemp(request.param)
    out = run(folder, SCENES[request.param])
    drawn = call(folder, "plot", "out", "--only", "summary")
    assert drawn.returncode == 0, drawn.stderr
    return out


def test_units_are_those_of_the_thickness(done: Path) -> None:
    """A body of 30 m has volumes in m3 or litres, one without a thickness per metre of it."""
    is_thick = "thickness = 30.0" in (done / "scene.nml").read_text()
    line = next(line for line in gather_facts(read_run(done)).results if "injected" in line)
    assert ("²" in line) != is_thick


def test_terminal(done: Path) -> None:
    """The last lines have each well: net volume, pressures at the end and at most."""
    exact = truth(done)
    lines = closing_lines(done)
    thickness = 30.0 if "thickness = 30.0" in (done / "scene.nml").read_text() else 1.0
    for name, pressure in exact.pressure.items():
        line = next(line for line in lines if line.startswith(f"{name}: "))
        net = exact.injected[name] - exact.produced[name]
        unit = "m2" if thickness == 1.0 else "m3"
        what = "injected" if net >= 0.0 else "produced"
        stated = shown(line, rf"{what} ([\d.e+-]+) {unit},")
        assert stated == pytest.approx(abs(net) * thickness, rel=6e-3)
        assert shown(line, r"([\d.]+) MPa at the end") * 1e6 == pytest.approx(
            pressure[-1], rel=6e-3
        )
        assert shown(line, r"at most ([\d.]+) MPa") * 1e6 == pytest.approx(pressure.max(), rel=6e-3)


def test_table_of_the_page(done: Path) -> None:
    """The table of wells by stage on the page, cell by cell, against report.csv."""
    page = (done / "figures" / "index.html").read_text()
    table = re.search(r"<table><tr>(.*?)</tr>(.*?)</table>", page)
    assert table, page[:500]
    heads = re.findall(r"<th>(.*?)</th>", table[1])
    volume = "m³" if "thickness = 30.0" in (done / "scene.nml").read_text() else "m²"
    columns = {
        "from [s]": ("begin_s", 1.0), "to [s]": ("end_s", 1.0),
        "pressure at first [MPa]": ("pressure_at_begin_pa", 1e6),
        "at last [MPa]": ("pressure_at_end_pa", 1e6), "highest [MPa]": ("highest_pressure_pa", 1e6),
        f"injected [{volume}]": ("injected_m2", 30.0 if volume == "m³" else 1.0),
        f"produced [{volume}]": ("produced_m2", 30.0 if volume == "m³" else 1.0),
    }  # fmt: skip
    with (done / "figures" / "report.csv").open(newline="") as file:
        written = list(csv.DictReader(file))
    lines = re.findall(r"<tr>(.*?)</tr>", table[2])
    assert len(lines) == len(written)
    for line, row in zip(lines, written, strict=True):
        cells = dict(zip(heads, re.findall(r"<td>(.*?)</td>", line), strict=True))
        assert (cells["well"], cells["stage"]) == (row["well"], row["stage"])
        for head, (column, size) in columns.items():
            factor = size if volume in head else 1.0 / size
            expected = pytest.approx(float(row[column]) * factor, rel=6e-4)
            assert float(cells[head]) == expected, head


def shown(words: str, pattern: str) -> float:
    """Give the number in words that match."""
    found = re.search(pattern, words)
    assert found, (pattern, words)
    return float(found[1])


UNITS = {"m²": 1.0, "cm²": 1e-4, "mm²": 1e-6, "m³": 1 / 30, "l": 1e-3 / 30, "ml": 1e-6 / 30}
"""Those of volumes are over the only thickness here."""


def area(words: str, what: str) -> float:
    found = re.search(what + r":? ([\d.e+-]+) (\S+?)[,<\n]", words + "\n")
    assert found, (what, words)
    return float(found[1]) * UNITS[found[2]]


def agree(words: str, exact: Truth) -> None:
    """Peaks, volumes and slip in a text, to the digits that are printed."""
    assert area(words, "injected") == pytest.approx(sum(exact.injected.values()), rel=6e-3)
    assert area(words, "produced") == pytest.approx(sum(exact.produced.values()), rel=6e-3)
    if exact.magnitudes:
        assert shown(words, r"(\d+) seismic") == len(exact.magnitudes)
        largest = shown(words, r"largest \$?M_w\$? = \$?(-?[\d.]+)")
        assert largest == pytest.approx(max(exact.magnitudes), abs=6e-3)
    else:
        assert "seismic event" not in words.replace("aseismic", "")
    if exact.slow:
        assert shown(words, r"(\d+) aseismic") == len(exact.slow)
        assert shown(words, r"moment ([\d.e+]+) N m") == pytest.approx(sum(exact.slow), rel=6e-2)


def test_summary_and_page(done: Path) -> None:
    exact = truth(done)
    results = gather_facts(read_run(done)).results
    page = html.unescape((done / "figures" / "index.html").read_text())
    for text in ("\n".join(results), page):
        agree(text, exact)
        for name, pressure in exact.pressure.items():
            peak = shown(text, rf"highest pressure of {name}: ([\d.]+) MPa")
            assert peak * 1e6 == pytest.approx(pressure.max(), rel=6e-4)


def test_story(done: Path) -> None:
    exact = truth(done)
    words = "\n".join(_facts(read_run(done), []))
    agree(words, exact)
    for name, pressure in exact.pressure.items():
        assert shown(words, rf"{name}: peak(?: pressure)? ([\d.]+) MPa") * 1e6 == pytest.approx(
            pressure.max(), abs=6e3
        )


def test_progress(done: Path) -> None:
    """Each line of run.log, if the run is long enough for one, has the pressures at its time."""
    exact = truth(done)
    found = re.findall(r"t ([\d.e+]+) s .*well ([\d., ]+) MPa", (done / "run.log").read_text())
    for moment, pressures in found:
        at = int(np.argmin(np.abs(exact.time - float(moment))))
        stated = [float(pressure) for pressure in pressures.split(",")]
        expected = [pressure[at] / 1e6 for pressure in exact.pressure.values()]
        assert stated == pytest.approx(expected, rel=6e-4)


def test_history_and_python(done: Path) -> None:
    exact = truth(done)
    history, opened = rows(done / "history.csv"), wingcrack.open(done)
    for name, pressure in exact.pressure.items():
        column = f"{name}_well_pressure_pa"
        assert np.array([float(row[column]) for row in history]) == pytest.approx(pressure)
        assert opened.history[column].to_numpy() == pytest.approx(pressure)
        own = opened.wells[opened.wells.well == name]
        assert own.pressure_pa.max() == pressure.max()
    # what has entered the body: without what the wells have stored, or stored less
    table = rows(done / "wells.csv")
    names = len(exact.pressure)
    flowed = sum(
        (float(row["time_s"]) - float(table[k - names]["time_s"])) * float(row["flow_m2_s"])
        for k, row in enumerate(table)
        if k >= names
    )
    assert float(history[-1]["injected_m2"]) == pytest.approx(flowed, rel=1e-9)
    kinds = opened.slip_events.kind
    assert (kinds == "seismic").sum() == len(exact.magnitudes)


def test_report(done: Path) -> None:
    """Stages of a well: the highest of their peaks, the sum of their volumes."""
    exact = truth(done)
    with (done / "figures" / "report.csv").open(newline="") as file:
        written = list(csv.DictReader(file))
    computed = report_rows(read_run(done))
    assert len(written) == len(computed)
    for name, pressure in exact.pressure.items():
        own = [row for row in written if row["well"] == name]
        # the state before the first stage is in none
        assert max(float(row["highest_pressure_pa"]) for row in own) <= pressure.max()
        assert max(float(row["highest_pressure_pa"]) for row in own) >= pressure[1:].max()
        assert float(own[-1]["pressure_at_end_pa"]) == pressure[-1]
        for key, volume in (("injected_m2", exact.injected), ("produced_m2", exact.produced)):
            assert sum(float(row[key]) for row in own) == pytest.approx(volume[name], abs=1e-15)
    # slip that ends before the wells begin, or at the initial state, is in no stage
    seismic = {(row["begin_s"], row["end_s"]): int(row["seismic_events"]) for row in written}
    assert max(seismic.values(), default=0) <= len(exact.magnitudes)


def test_studies(done: Path) -> None:
    exact = truth(done)
    for name, pressure in exact.pressure.items():
        peak = Quantity(
            name="peak",
            unit="MPa",
            file="history.csv",
            column=f"{name}_well_pressure_pa/1e6",
            take="max",
        )
        value, reason = measure(peak, done, {})
        assert value is not None, reason
        assert value * 1e6 == pytest.approx(pressure.max(), rel=1e-12)
        net = Quantity(
            name="net", unit="m2", file="wells.csv", column="injected_m2", take="last",
            where={"well": name},
        )  # fmt: skip
        value, reason = measure(net, done, {})
        assert value is not None, reason
        expected = exact.injected[name] - exact.produced[name]
        assert value == pytest.approx(expected, rel=1e-9, abs=1e-15)
