"""Choice of times, and units of axes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from synthetic_run import GROWTH_STEP, HOUR, LAST_WING, STEPS, times, wing_length
from wingcrack_post import read_run
from wingcrack_post.durations import parse_times
from wingcrack_post.times import growth_start, select_times
from wingcrack_post.units import area_unit, displacement_unit, time_unit


def test_times_in_all_units() -> None:
    assert parse_times("90, 2min,1.5h,1d, 1e3 s") == (90.0, 120.0, 5400.0, 86400.0, 1000.0)


@pytest.mark.parametrize("text", ["", "3 weeks", "1h,,2h", "-1h", "h"])
def test_what_is_no_time_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is no time"):
        parse_times(text)


def test_wanted_times_give_the_nearest_written_ones_once(wet_run: Path) -> None:
    run = read_run(wet_run)
    wanted = (31.0 * HOUR, 9.0 * HOUR, 11.0 * HOUR, 1e9)
    assert select_times(run, times(), 3, wanted) == [10.0 * HOUR, 30.0 * HOUR, 65.0 * HOUR]


def test_default_times_hold_start_growth_and_end(wet_run: Path) -> None:
    run = read_run(wet_run)
    start = times()[GROWTH_STEP]
    assert growth_start(run) == start
    chosen = select_times(run, times(), 6)
    assert chosen[0] == times()[0]
    assert chosen[1] == start
    assert chosen[-1] == times()[-1]
    # between them: the first written times that reach equally spaced lengths
    first = wing_length(GROWTH_STEP)
    wings = first + (LAST_WING - first) * np.array([0.25, 0.5, 0.75])
    steps = [next(s for s in range(STEPS) if wing_length(s) >= wing) for wing in wings]
    assert chosen[2:-1] == [float(times()[step]) for step in steps]


def test_without_growth_times_are_equally_spaced(own_run: Path) -> None:
    history = own_run / "history.csv"
    lines = history.read_text(encoding="utf-8").splitlines()
    history.write_text("\n".join(lines[: GROWTH_STEP + 1]) + "\n", encoding="utf-8")
    run = read_run(own_run)
    assert growth_start(run) is None
    written = times()[:GROWTH_STEP]
    assert select_times(run, written, 3) == [float(t) for t in written[[0, 2, 4]]]


def test_units_keep_numbers_readable() -> None:
    assert time_unit(65.0 * HOUR).name == "h"
    assert time_unit(600.0).name == "min"
    assert time_unit(30.0).name == "s"
    assert displacement_unit(np.array([-2e-4, np.nan])).name == "mm"
    assert displacement_unit(np.array([4e-5])).name == "µm"
    assert displacement_unit(np.zeros(3)).name == "mm"
    assert area_unit(np.array([7e-4])).name == "cm²"
    assert displacement_unit(np.array([2e-4])).of(2e-4) == pytest.approx(0.2, rel=1e-15)
