"""Wings that nothing parts grow alike, at any rate of the well, through the real program."""

from __future__ import annotations

from pathlib import Path

import pytest
from system_scene import TOP, changed, rows, run

pytestmark = pytest.mark.usefixtures("program")


@pytest.mark.parametrize(
    ("rate", "stop_gain", "more"),
    [("1.0e-7", 0.04, ""), ("1.0e-6", 0.02, ", increment = 0.0025")],
    ids=["20 times the rate", "200 times, finer increments"],
)
def test_wings_of_a_fast_well_gain_alike(
    tmp_path: Path, rate: str, stop_gain: float, more: str
) -> None:
    """Scene C2 with faster wells: whether one wing runs ahead is neutral, and stays open."""
    text = changed(
        (TOP / "inputs/paper_c/wing_crack.nml").read_text(),
        ("rate = 5.0e-9", f"rate = {rate}"),
        ("stop_gain = 0.25", f"stop_gain = {stop_gain}{more}"),
    )
    run(tmp_path, text)
    gain = {"1": 0.0, "2": 0.0}
    for row in rows(tmp_path / "out/tips.csv"):
        gain[row["tip"]] += float(row["advance_m"])
    assert max(gain.values()) == pytest.approx(stop_gain, rel=1e-9)
    assert gain["1"] == pytest.approx(gain["2"], rel=0.02)
