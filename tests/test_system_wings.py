"""Wings that nothing parts grow alike, at any rate of the well, through the real program."""

from __future__ import annotations

from pathlib import Path

import pytest
from system_scene import TOP, call, rows

pytestmark = pytest.mark.usefixtures("program")


def test_wings_of_a_fast_well_gain_alike(tmp_path: Path) -> None:
    """Scene C2 with 20 times its rate: whether one wing runs ahead is neutral, and stays open."""
    text = (TOP / "inputs/paper_c/wing_crack.nml").read_text()
    for old, new in (("rate = 5.0e-9", "rate = 1.0e-7"), ("stop_gain = 0.25", "stop_gain = 0.06")):
        assert old in text, old
        text = text.replace(old, new)
    (tmp_path / "scene.nml").write_text(text)
    done = call(tmp_path, "run", "scene.nml", "--out", "out", "--no-plot")
    assert done.returncode == 0, done.stderr
    gain = {"1": 0.0, "2": 0.0}
    for row in rows(tmp_path / "out/tips.csv"):
        gain[row["tip"]] += float(row["advance_m"])
    assert max(gain.values()) >= 0.06
    assert gain["1"] == pytest.approx(gain["2"], rel=0.02)
