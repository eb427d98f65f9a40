"""Runs that end as a fracture end has grown as far as the scene wants: so far, and no farther."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from system_scene import GROWING, GROWING_BY_PARIS, TOP, numbers, record, rows, run

pytestmark = pytest.mark.usefixtures("program")

WINGS = (TOP / "inputs" / "paper_c" / "wing_crack.nml").read_text()
DISC = (TOP / "inputs" / "paper_b" / "disc_path_45.nml").read_text()
BEND = (TOP / "verification" / "length_control" / "bend.nml").read_text()


# With a fluid in equilibrium and by the law of advances; without one, with two tips and with one.
@pytest.mark.parametrize(
    ("text", "gain", "ends", "length"),
    [
        (WINGS, 0.02, 2, 0.1),
        (GROWING, 0.0137, 2, 0.1),
        (GROWING_BY_PARIS, 0.0061, 2, 0.1),
        (GROWING_BY_PARIS, 0.0137, 2, 0.1),
        (DISC, 0.00733, 2, 0.01),
        (BEND, 0.137, 1, 0.1),
    ],
)
def test_a_run_ends_at_the_gain_asked_for(
    text: str, gain: float, ends: int, length: float, tmp_path: Path
) -> None:
    out = run(tmp_path, re.sub(r"stop_gain = [0-9.]+", f"stop_gain = {gain}", text))
    reason = record(out)["reason"]
    assert isinstance(reason, str)
    assert reason.endswith("has gained stop_gain")
    reached = numbers(out / "history.csv", "fracture_length_m")[-1]
    # Equal wings may part within their errors, which are stated with a fluid.
    error = max(float(rows(out / "history.csv")[-1].get("fracture_length_error_m", 0.0)), 0.0)
    assert reached <= (length + ends * gain) * (1.0 + 1e-9)
    assert reached >= (length + ends * gain) * (1.0 - 1e-9) - error
    gained: dict[str, float] = {}
    for row in rows(out / "tips.csv"):
        gained[row["tip"]] = gained.get(row["tip"], 0.0) + float(row["advance_m"])
    assert max(gained.values()) == pytest.approx(gain, rel=1e-9)
    # Then the log says so, and the error of the length covers it.
    lead = max(gained.values()) - min(gained.values())
    if lead > 0.025 * gain:
        assert lead <= error
        said = [row["detail"] for row in rows(out / "events.csv") if row["kind"] == "bifurcation"]
        assert any("ahead of an equal one" in detail for detail in said)


def test_the_gain_is_found_in_time(tmp_path: Path) -> None:
    """Where growth is stable the tips are at their toughness there."""
    out = run(tmp_path, WINGS.replace("stop_gain = 0.25", "stop_gain = 0.02"))
    last = rows(out / "tips.csv")[-2:]
    assert [float(row["keq_pa_sqrtm"]) for row in last] == pytest.approx([0.7e6] * 2, rel=0.0051)
