"""Times as one writes them, and units of axes."""

from __future__ import annotations

import numpy as np
import pytest

from synthetic_run import HOUR
from wingcrack.figures.durations import parse_times
from wingcrack.figures.units import displacement_unit, time_unit, volume_unit


def test_times_in_all_units() -> None:
    assert parse_times("90, 2min,1.5h,1d, 1e3 s") == (90.0, 120.0, 5400.0, 86400.0, 1000.0)


@pytest.mark.parametrize("text", ["", "3 weeks", "1h,,2h", "-1h", "h", "1.2.3", ".", "1e999"])
def test_what_is_no_time_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is no time"):
        parse_times(text)


def test_units_keep_numbers_readable() -> None:
    assert time_unit(65.0 * HOUR).name == "h"
    assert time_unit(600.0).name == "min"
    assert time_unit(30.0).name == "s"
    assert displacement_unit(np.array([-2e-4, np.nan])).name == "mm"
    assert displacement_unit(np.array([4e-5])).name == "µm"
    assert displacement_unit(np.zeros(3)).name == "mm"
    assert volume_unit(1.0, np.array([7e-4])).name == "cm²"
    whole = volume_unit(30.0, np.array([7e-4]))
    assert whole.name == "l"
    assert float(whole.of(7e-4)) == pytest.approx(21.0)
    assert displacement_unit(np.array([2e-4])).of(2e-4) == pytest.approx(0.2, rel=1e-15)
