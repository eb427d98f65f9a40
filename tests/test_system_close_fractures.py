"""Fractures that nearly touch each other, through the real program (docs/sweeps.md)."""

from __future__ import annotations

import json
from pathlib import Path

import close_sweeps
import pytest
from fluid_sweeps import SOLVER, call_solver
from system_scene import varied

from wingcrack_verify import recompute

pytestmark = pytest.mark.usefixtures("program")


def reason_of(folder: Path, text: str) -> str:
    """Why a scene's run has failed."""
    (folder / "scene.nml").write_text(text)
    verdict, reason, _ = call_solver(folder, SOLVER, 120.0)
    assert verdict is None
    assert json.loads((folder / "out" / "run.json").read_text())["status"] == "failed"
    return reason


# What the files alone must show; the judge's other measures are for bodies loaded by their sides.
MEASURES = (
    "tension of contact",
    "penetration",
    "shear above friction",
    "traction on open faces",
    "slip against friction",
    "mass balance",
    "fracture volume",
)


@pytest.mark.parametrize("number", [66, 160, 200])
def test_close_sets_have_an_initial_state(number: int, tmp_path: Path) -> None:
    """None was found. The states obey friction, and fluid is conserved."""
    text = close_sweeps.scene_text(number)
    assert "&output vtu = .false." in text
    text = text.replace("&output vtu = .false.", "&output interval = 1e-9")
    (tmp_path / "scene.nml").write_text(text)
    verdict, reason, _ = call_solver(tmp_path, SOLVER, 200.0)
    assert (verdict, reason) == (None, "")
    worst = recompute.judge(tmp_path / "out").worst
    assert max(worst[name] for name in MEASURES) < 1e-9


def test_a_close_set_goes_on_from_its_initial_state(tmp_path: Path) -> None:
    """No step of any length was found from there."""
    assert close_sweeps.sweep(tmp_path, [371]) == {"right": 1}


def test_close_sets_of_every_kind_run(tmp_path: Path) -> None:
    seeds = [1, 2, 3, 4, 5]
    assert close_sweeps.sweep(tmp_path, seeds) == {"right": len(seeds)}


def test_a_step_that_is_not_solved_names_fracture_and_place(tmp_path: Path) -> None:
    text = varied(
        ("rate = 5.0e-9", "rate = 1.0e-5"),
        ("step = 3600.0", "step = 3600.0, smallest_factor = 0.01"),
        ("intensities = .true.", "intensities = .false."),
        ("size_boundary = 0.25", "size_boundary = 0.25, newton_max = 1"),
    )
    reason = reason_of(tmp_path, text)
    assert "did not converge, on fracture 'f1' at (" in reason


def test_a_fracture_that_a_well_empties_says_so(tmp_path: Path) -> None:
    text = varied(
        ("rate = 5.0e-9", "rate = -1.0e-6"),
        ("&injection ", "&injection name = 'a', "),
        ("step = 3600.0", "step = 3600.0, smallest_factor = 0.01"),
        ("intensities = .true.", "intensities = .false."),
    )
    reason = reason_of(tmp_path, text)
    assert "fracture 'f1' has less fluid at (" in reason
    assert "than well 'a' extracts: give the well a pressure as its limit" in reason


def test_an_initial_state_not_found_names_the_way_out(tmp_path: Path) -> None:
    text = close_sweeps.scene_text(66)
    reason = reason_of(tmp_path, text.replace("&coarse ", "&coarse newton_max = 1, "))
    assert "no initial equilibrium was found" in reason
    assert ", on fracture 'f" in reason
    assert "use &initial fracture_pressure = 'undrained'" in reason
