"""Limits of a run and doubts about a scene, through the real program."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from system_scene import GROWING_BY_PARIS, SCENE, TOP, bare, call, changed, numbers, record, varied

pytestmark = pytest.mark.usefixtures("program")


def run(place: Path, text: str) -> tuple[int, str, str, list[str]]:
    """Run a scene: status, terminal, last line of stderr, warnings on record."""
    (place / "scene.nml").write_text(text)
    done = call(place, "run", "scene.nml", "--out", "out", "--no-plot")
    warnings = record(place / "out")["warnings"]
    assert isinstance(warnings, list)
    reason = done.stderr.splitlines()[-1] if done.stderr else ""
    return done.returncode, done.stdout, reason, warnings


def first_value(warning: str, quantity: str) -> float:
    """The value of a warning that begins with this quantity."""
    assert warning.startswith(quantity)
    return float(warning.removeprefix(quantity).split()[0])


def test_a_sound_run_has_no_warnings(tmp_path: Path) -> None:
    status, terminal, _, warnings = run(tmp_path, SCENE)
    assert (status, warnings) == (0, [])
    assert "warning" not in terminal


def test_a_bad_condition_is_warned_of(tmp_path: Path) -> None:
    """A rock like gravel: the rounding errors are large, and fluid gets lost."""
    changes = ("permeability = 5.0e-20", "permeability = 3.0e-10")
    status, terminal, _, warnings = run(tmp_path, varied(changes))
    assert status == 0
    seal, bound, mass = warnings
    assert seal.startswith("&injection: reach is ")
    assert 2.0e-6 < first_value(bound, "forward error bound ") < 1.0e-5
    assert " above 1e-06 at 3600 s; in 5 states, the worst " in bound
    assert mass.startswith("mass error ")
    assert "3 warnings:" in terminal
    assert terminal.count("warning") == 1
    assert bound in terminal
    log = (tmp_path / "out" / "run.log").read_text()
    assert log.count("warning: forward error bound") == 1
    assert log.count("warning: mass error") == 1


def test_growth_before_the_first_step_is_warned_of(tmp_path: Path) -> None:
    """Friction 0.2 bears less than the 5 MPa of shear under 15 MPa less the fluid's pressure."""
    changes = ("friction = 0.5", "friction = 0.2"), ("intensities = .true.", "enabled = .true.")
    _, _, _, warnings = run(tmp_path, varied(*changes, ("end = 18000.0", "end = 3600.0")))
    value = first_value(warnings[-1], "K_eq over K_IC in the initial state ")
    pressure = numbers(tmp_path / "out" / "history.csv", "well_pressure_pa")[0]
    k2 = (5e6 - 0.2 * (15e6 - pressure)) * math.sqrt(math.pi * 0.05)
    # maximum tangential stress; five cells along the fracture, in a body of twenty lengths
    assert value == pytest.approx(2 / math.sqrt(3) * k2 / 0.3e6, rel=0.1)


def test_a_bound_is_larger_than_the_error(tmp_path: Path) -> None:
    """A conductive rock in long steps: the pressure after five is right within five bounds."""
    base = changed(
        (TOP / "verification/stability/base.nml").read_text(),
        ("permeability = 5.0e-20", "permeability = 1.0e-12"),
        ("step = 3600.0", "step = 1.0e7"),
        ("end = 18000.0", "end = 5.0e7"),
        ("&injection\n  fracture = 'f1'\n  rate = 1.5e-8\n/\n", ""),
    )
    status, _, _, warnings = run(tmp_path, base)
    assert status == 0
    told = [warning for warning in warnings if warning.startswith("forward error bound ")]
    bound = first_value(told[0], "forward error bound ")
    assert 5.0e-5 < bound < 2.0e-4
    # the same body, sealed too, with k = 1e-20 m2, where the bound is 4e-12
    found = numbers(tmp_path / "out/fractures.csv", "pressure_pa")[-1]
    assert found == pytest.approx(6.902057e6, rel=5.0 * bound)


def test_what_no_rock_has_stops_the_run(tmp_path: Path) -> None:
    """Fluid enough to part the body: that state is not accepted, the one before is on disk."""
    changes = ("rate = 5.0e-9", "rate = 1.0e-2")
    status, _, reason, warnings = run(tmp_path, varied(changes))
    out = tmp_path / "out"
    assert status == 1
    told = record(out)
    assert told["status"] == "failed"
    assert reason == f"wingcrack: {told['reason']}"
    assert reason.startswith("wingcrack: after 3600 s: a limit of the run is exceeded: ")
    assert "pressure over Young's modulus" in reason
    assert any(warning.startswith("aperture over the body's size") for warning in warnings)
    times = numbers(out / "history.csv", "time_s")
    assert times[-1] == 3600.0
    assert told["steps"] == 1
    assert numbers(out / "fractures.csv", "time_s")[-1] == 3600.0
    assert max(numbers(out / "fractures.csv", "aperture_m")) < 1.1e-3


def test_growth_that_lags_behind_is_warned_of(tmp_path: Path) -> None:
    """With the thesis' law a step of an hour is too long: K_eq stays above K_IC after growth."""
    status, _, _, warnings = run(
        tmp_path, GROWING_BY_PARIS.replace("rate = 5.0e-9", "rate = 5.0e-8")
    )
    assert status == 0
    assert any(warning.startswith("K_eq over K_IC after growth ") for warning in warnings)


def test_fluid_that_stays_where_it_is_loses_nothing(tmp_path: Path) -> None:
    """Without fractures and flow, rounding is no error of mass."""
    scene = TOP / "verification" / "undrained_square" / "scene.nml"
    status, _, _, warnings = run(tmp_path, scene.read_text())
    assert (status, warnings) == (0, [])


def test_soft_rock_without_fluid_is_warned_of(tmp_path: Path) -> None:
    """A strain of 4 %: the result is that of the linear equations, and the run says so."""
    text = (TOP / "inputs" / "paper_b" / "edge_mode1.nml").read_text()
    status, _, _, warnings = run(tmp_path, text.replace("young = 70.0e9", "young = 150.0e6"))
    assert status == 0
    jump, strain = warnings
    assert jump.startswith("jump over its fracture cell's length 2.1")
    assert strain.startswith("strain of the body 0.040")


def test_check_tells_what_is_doubted(tmp_path: Path) -> None:
    text = varied(
        ("young = 40.0e9", "young = 40.0"),
        ("friction = 0.5", "friction = 1.6"),
        ("permeability = 5.0e-20", "permeability = 0.05"),
        ("start = 3600.0, end = 14400.0", "start = 36000.0, end = 72000.0"),
    )
    (tmp_path / "scene.nml").write_text(text)
    done = bare(tmp_path, "check", "scene.nml")
    assert done.returncode == 0
    listed = done.stdout.split("5 warnings:\n")[1].splitlines()
    assert listed == [
        "  &material: young is 40.0 Pa: rock has 1e9 to 1e11 Pa",
        "  &material: permeability is 0.05 m2: rock has 1e-22 to 1e-11 m2, "
        "and a millidarcy is 1e-15 m2",
        "  &fracture 'f1': friction is 1.6: rock has 0.3 to 1",
        "  &injection: reach is 13420.0 m: the body is sealed and its pressure changes with the "
        "volume of the wells; give sides a pressure, or inflow = 0 if they are sealed",
        "  &injection: start is 36000.0 s: the well is never active",
    ]


@pytest.mark.parametrize("scene", sorted((TOP / "inputs").rglob("*.nml")), ids=lambda p: p.stem)
def test_nothing_in_the_shipped_scenes_is_doubted(scene: Path, tmp_path: Path) -> None:
    done = bare(tmp_path, "check", scene)
    assert done.returncode == 0
    assert "warning" not in done.stdout
