"""Growth by jumps: the events, and the lengths near them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from system_scene import call, record, rows

pytestmark = pytest.mark.usefixtures("program")

# One tip grows; the other end is in tough rock.
ONE_TIP = """\
&domain x_min = 0.0, x_max = 6.0, y_min = 0.0, y_max = 6.0 /
&material
  young = 40.0e9, poisson = 0.2, biot = 0.8, porosity = 0.01, permeability = 5.0e-20
  toughness = 1.0e6
/
&fluid compressibility = 4.4e-10, viscosity = 1.0e-4 /
&region
  name = 'tough', toughness = 20.0e6
  x = 3.19, 6.0, 6.0, 3.19
  y = 0.0, 0.0, 6.0, 6.0
/
&fracture
  name = 'c', friction = 0.5, aperture = 1.0e-3
  x = 2.8, 3.2
  y = 3.0, 3.0
/
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&side name = 'top', y_traction = -10.0e6 /
&injection fracture = 'c', rate = 1.0e-7 /
&initial fracture_pressure = 'equilibrated' /
&time end = 320.0 /
&coarse size_fracture = 0.02, size_boundary = 0.5 /
&fine window = 0.1, size_ratio = 0.5 /
&growth enabled = .true., new_aperture = 1.0e-5, stop_gain = 0.15 /
&output vtu = .false. /
"""


def test_a_jump_is_reported_with_its_length(tmp_path: Path) -> None:
    """The events, run.json and the last lines agree with the lengths of history.csv."""
    (tmp_path / "one.nml").write_text(ONE_TIP)
    done = call(tmp_path, "run", "one.nml", "--out", "out", "--no-plot")
    out = tmp_path / "out"
    jumps = [row for row in rows(out / "events.csv") if row["kind"] == "growth_jump"]
    assert jumps
    history = rows(out / "history.csv")
    times = [float(row["time_s"]) for row in history]
    lengths = [float(row["fracture_length_m"]) for row in history]
    errors = [float(row["fracture_length_error_m"]) for row in history]
    longest = 0.0
    for jump in jumps:
        found = re.match(
            r"grows by ([\d.E+-]+) m at once; well pressure (\d+) Pa before, (\d+) Pa after",
            jump["detail"],
        )
        assert found, jump["detail"]
        at = times.index(float(jump["time_s"]))
        assert float(found[1]) == pytest.approx(lengths[at] - lengths[at - 1], rel=1e-3)
        assert float(found[2]) > float(found[3])  # the crack takes up the fluid
        assert errors[at] >= float(found[1])
        longest = max(longest, float(found[1]))
    ended = record(out)
    assert ended["growth_jumps"] == len(jumps)
    assert ended["longest_growth_jump_m"] == pytest.approx(longest, rel=1e-3)
    assert f"grows by {len(jumps)} jump" in done.stderr + done.stdout


def test_the_length_after_a_jump_with_any_tolerance(tmp_path: Path) -> None:
    """In leaking rock growth is smooth in long steps and jumps in short ones; errors cover that."""
    text = ONE_TIP.replace("stop_gain = 0.15", "stop_gain = 0.3")
    # Steps of .2 s with cells of 20 and 10 mm, and a tolerance of 3e-4: .5005 to .508 m.
    fine, known_within = 0.504, 0.004
    for tolerance in ("0.01", "0.003"):
        end = f"end = 195.0, tolerance = {tolerance}"
        (tmp_path / "one.nml").write_text(text.replace("end = 320.0", end))
        call(tmp_path, "run", "one.nml", "--out", tolerance, "--no-plot")
        last = rows(tmp_path / tolerance / "history.csv")[-1]
        error = float(last["fracture_length_error_m"])
        assert error < 0.2
        assert abs(float(last["fracture_length_m"]) - fine) <= error + known_within
