"""Seismic events: b of drawn magnitudes within its error, none of few, the figure, the points."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from wingcrack.errors import AbsentError
from wingcrack.figures import read_run
from wingcrack.figures.page import write_page
from wingcrack.figures.seismicity import BIN, frequency, seismicity

_HEAD = "event,time_s,end_s,fracture,x_m,y_m,moment_nm,magnitude,kind,ended_by\n"


def drawn(b: float, count: int, least: float, seed: int) -> np.ndarray:
    """Draw magnitudes above `least` by inversion."""
    shares = np.random.default_rng(seed).random(count)
    return least - np.log10(1.0 - shares) / b


@pytest.mark.parametrize("b", [0.7, 1.0, 1.8])
def test_b_of_drawn_magnitudes(b: float) -> None:
    """200 catalogues of 400: mean and scatter of b are those of theory, and the stated error."""
    found = [frequency(drawn(b, 400, -1.0 - 0.5 * BIN, seed)) for seed in range(200)]
    values = np.array([each.b for each in found])
    errors = np.array([each.error for each in found])
    # error budget: the scatter of the mean, 1/sqrt(200 times 250 events); the bias 1/n of the
    # estimate, and that of the bins, (b BIN ln 10)^2/12
    bias = 1 / 200 + (b * BIN * np.log(10)) ** 2 / 12
    assert abs(values.mean() / b - 1) < bias + 3 / np.sqrt(200 * 200)
    assert np.mean(np.abs(values - b) < 1.96 * errors) == pytest.approx(0.95, abs=0.05)
    assert all(each.completeness >= -1.0 for each in found)


def test_missing_small_events_do_not_change_b() -> None:
    """Of the events below a magnitude only some are in the catalogue."""
    all_of = drawn(1.0, 20_000, -2.0, 1)
    seen = np.random.default_rng(2).random(all_of.size) < np.minimum(
        1.0, 10 ** (3 * (all_of + 1.0))
    )
    found = frequency(all_of[seen])
    assert found.completeness > -1.05
    assert abs(found.b - 1.0) < 3 * found.error


def test_few_events_have_no_b() -> None:
    assert "there is no seismic event" in frequency(np.array([])).words()
    found = frequency(drawn(1.0, 30, 0.0, 3))
    assert np.isnan(found.b)
    assert "of 30 events" in found.words()
    assert "fewer than 50" in found.words()


@pytest.fixture
def shaken(own_run: Path) -> Path:
    """Give the synthetic run events: 400 seismic ones and a slow one."""
    magnitudes = drawn(1.0, 400, -1.0, 4)
    rows = [
        f"{k + 1},{600.0 * k},{600.0 * k + 1.0},1,{1 + 1e-3 * k},1.0,"
        f"{10 ** (1.5 * m + 9.1)},{m},{'seismic' if k else 'aseismic'},stick"
        for k, m in enumerate(magnitudes)
    ]
    (own_run / "slip_events.csv").write_text(_HEAD + "\n".join(rows) + "\n")
    return own_run


def test_the_figure_and_the_points(shaken: Path) -> None:
    run = read_run(shaken)
    counts, times, places, _ = seismicity(run).axes
    assert "b = " in counts.get_title(loc="left") + counts.get_title()
    assert np.size(times.lines[0].get_xdata()) == 399  # the slow one has no magnitude
    assert np.shape(places.collections[0].get_offsets())[0] == 399
    files = write_page(run, shaken / "figures", [])
    (points,) = [file for file in files if file.suffix == ".vtp"]
    piece = ElementTree.parse(points).getroot()[0][0]
    assert piece.attrib["NumberOfPoints"] == "400"
    data = {item.attrib.get("Name"): item.text or "" for item in piece.iter("DataArray")}
    assert data["magnitude"].split()[0] == "nan"
    assert data["seismic"].split()[:2] == ["0", "1"]
    assert float(data["time_s"].split()[2]) == 1200.0


def test_slow_slip_has_no_figure(shaken: Path) -> None:
    path = shaken / "slip_events.csv"
    path.write_text(path.read_text().replace(",seismic,", ",aseismic,"))
    with pytest.raises(AbsentError, match="fast enough"):
        seismicity(read_run(shaken))
