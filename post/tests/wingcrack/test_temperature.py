"""Figure of temperatures: the fracture in which they differ most, its ends by time, the wells."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wingcrack.errors import AbsentError
from wingcrack.figures import read_run
from wingcrack.figures.temperature import temperature

_HEAD = "time_s,fracture,s_m,state,temperature_k\n"
_YEAR = 365.25 * 86400.0


@pytest.fixture
def cooled(own_run: Path) -> Path:
    """Give the synthetic run fractures of three cells: the second one is cooled from its start."""
    rows = [
        f"{3.0 * _YEAR * step},{fracture},{s},stick,{300.0 - fracture // 2 * step * (30.0 - s)}"
        for step in range(5)
        for fracture in (1, 2)
        for s in (5.0, 25.0, 15.0)
    ]
    (own_run / "fractures.csv").write_text(_HEAD + "\n".join(rows) + "\n")
    return own_run


def test_profiles_and_ends_of_the_fracture_that_cools(cooled: Path) -> None:
    along, by_time = temperature(read_run(cooled)).axes
    first, *_, last = along.get_lines()
    assert np.asarray(first.get_ydata()).tolist() == [300.0, 300.0, 300.0]
    assert np.asarray(last.get_xdata()).tolist() == [5.0, 15.0, 25.0]
    assert np.asarray(last.get_ydata()).tolist() == [200.0, 240.0, 280.0]
    assert last.get_label() == "12 years"
    start, end = by_time.get_lines()[:2]
    assert np.asarray(start.get_ydata()).tolist() == [300.0, 275.0, 250.0, 225.0, 200.0]
    assert np.asarray(end.get_ydata()).tolist() == [300.0, 295.0, 290.0, 285.0, 280.0]


def test_without_heat_there_is_none(wet_run: Path) -> None:
    with pytest.raises(AbsentError, match="the scene has no &heat"):
        temperature(read_run(wet_run))
