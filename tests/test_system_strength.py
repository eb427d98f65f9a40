"""Faces whose strength falls as they slip stick until that strength is reached."""

from __future__ import annotations

from pathlib import Path

import pytest
from system_scene import numbers, rows, run

pytestmark = pytest.mark.usefixtures("program")

# A closed crack of 20 m in rock that neither conducts nor gives way, so that its pressure rises by
# rate/(length aperture compressibility), and its tractions are those of the stress in situ.
CRACK = """\
&domain x_min = -150, x_max = 150, y_min = -150, y_max = 150 /
&material
  young = 30e9, poisson = 0.25, biot = 1e-6, porosity = 1e-6, permeability = 1e-30
  radiation_damping = 5e6
/
&fluid compressibility = 5e-10, viscosity = 1e-4 /
&fracture
  name = 'f', aperture = 2e-4
  x = -8.191520442889918, 8.191520442889918
  y = 5.735764363510462, -5.735764363510462
  friction = {friction}, friction_residual = {residual}, weakening_slip = 2e-3{bond}
/
&in_situ sxx = -50e6, syy = -30e6, sxy = 4e6 /
&initial pressure = 10e6 /
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&injection fracture = 'f', rate = {rate} /
&time end = {end} /
&coarse size_fracture = 2, size_boundary = 15 /
&output vtu = .false. /
"""
NORMAL, SHEAR = 32.821028083599682e6, 8.028845634556409e6  # of the stress in situ at -35 degrees
DAMPING = "\n  radiation_damping = 5e6"

# A joint across a block that is sheared at 1e-6 m/s.
SLIDER = """\
&domain x_min = 0, x_max = 4, y_min = -3, y_max = 3 /
&material
  young = 12e9, poisson = 0.15, biot = 1e-6, porosity = 1e-6, permeability = 1e-30
  radiation_damping = 4e6
/
&fluid compressibility = 1e-9, viscosity = 1e-3 /
&fracture
  name = 'j', x = 0, 4, y = 0, 0, aperture = 1e-4
  friction = 0.6, friction_residual = 0.25, weakening_slip = 2e-3
/
&in_situ sxx = -10e6, syy = -10e6 /
&initial pressure = 3e6 /
&side name = 'left', y_displacement = 0 /
&side name = 'right', y_displacement = 0 /
&side name = 'bottom', y_displacement = 0, x_displacement = 0 /
&side name = 'top', x_displacement = 0, 5.5545e-3, time = 0, 5554.5 /
&time end = 5554.5 /
&coarse size_fracture = 0.5, size_boundary = 1 /
&output vtu = .false. /
"""

# The shear on the fracture is `friction` times the pressure at a load factor of 0.48.
RISING = """\
&domain x_min = -60, x_max = 60, y_min = -60, y_max = 60 /
&material young = 25e9, poisson = 0.25 /
&fracture
  name = 'c', friction = 0.6, friction_residual = {residual}, weakening_slip = 1e-4
  x = -1.8793852415718169, 1.8793852415718169
  y = -0.6840402866513374, 0.6840402866513374
/
&in_situ sxx = -8e6, syy = -8e6 /
&side name = 'left', x_traction = 6427876.096865392, y_traction = -7660444.43118978 /
&side name = 'right', x_traction = -6427876.096865392, y_traction = 7660444.43118978 /
&side name = 'top', x_traction = 7660444.43118978, y_traction = 6427876.096865392 /
&side name = 'bottom', x_traction = -7660444.43118978, y_traction = -6427876.096865392 /
&restraint x = -60, y = -60, x_displacement = 0, y_displacement = 0 /
&restraint x = 60, y = -60, y_displacement = 0 /
&load to = 0.5, steps = 100 /
&fe size_fracture = 0.4, size_boundary = 12 /
&output vtu = .false. /
"""


def first_slip(history: Path, column: str) -> float:
    """Where faces slip for the first time."""
    pairs = zip(numbers(history, column), numbers(history, "max_slip_m"), strict=True)
    return next(value for value, slip in pairs if slip > 1e-12)


@pytest.mark.parametrize(
    ("friction", "residual", "cohesion", "rate"),
    [
        (0.65, 0.3, 0.0, 2e-7),  # slipped 15 % early
        (0.65, 0.3, 0.0, 2e-8),  # 15 %
        (0.65, 0.1, 0.0, 2e-7),  # 0.6 %
        (0.5, 0.4, 2e6, 2e-7),  # 18 %
        (0.5, 0.5, 4e6, 2e-7),  # 16 %
    ],
)
def test_crack_sticks_until_its_strength_is_reached(
    tmp_path: Path, friction: float, residual: float, cohesion: float, rate: float
) -> None:
    """Friction that weakens and bonds, beside a fluid: closed form of pressure and time."""
    onset = NORMAL - (SHEAR - cohesion) / friction
    time = (onset - 10e6) * 20.0 * 2e-4 * 5e-10 / rate
    bond = f", cohesion = {cohesion}" if cohesion > 0.0 else ""
    text = CRACK.format(friction=friction, residual=residual, bond=bond, rate=rate, end=1.5 * time)
    history = run(tmp_path, text) / "history.csv"
    assert first_slip(history, "time_s") == pytest.approx(time, rel=1e-4)
    assert first_slip(history, "well_pressure_pa") == pytest.approx(onset, rel=1e-4)


def test_slip_without_damping_is_a_jump(tmp_path: Path) -> None:
    """To the next state that is stable: the stress drop is that to the residual friction."""
    time = (NORMAL - SHEAR / 0.65 - 10e6) * 20.0 * 2e-4 * 5e-10 / 2e-7
    text = CRACK.format(friction=0.65, residual=0.3, bond="", rate=2e-7, end=1.1 * time)
    assert DAMPING in text
    out = run(tmp_path, text.replace(DAMPING, ""))
    assert first_slip(out / "history.csv", "time_s") == pytest.approx(time, rel=1e-4)
    (event, *_) = rows(out / "slip_events.csv")
    assert (event["kind"], event["ended_by"]) == ("seismic", "speed")
    drop = SHEAR * (1.0 - 0.3 / 0.65)  # the fluid's pressure hardly changes
    assert float(event["stress_drop_pa"]) == pytest.approx(drop, rel=0.04)


def test_slider(tmp_path: Path) -> None:
    """Values of the ordinary differential equation of a block with damping."""
    out = run(tmp_path, SLIDER)
    assert first_slip(out / "history.csv", "time_s") == pytest.approx(4830.0, rel=1e-3)
    (event,) = [row for row in rows(out / "slip_events.csv") if row["kind"] == "seismic"]
    assert float(event["mean_slip_m"]) == pytest.approx(2.80e-3, rel=5e-3)
    assert float(event["stress_drop_pa"]) == pytest.approx(2.44e6, rel=5e-3)


@pytest.mark.parametrize("residual", [0.3, 0.6])
def test_shear_that_equals_the_strength(tmp_path: Path, residual: float) -> None:
    """Without a fluid: nothing has slipped at a load factor of 0.48, and all has at 0.485."""
    out = run(tmp_path, RISING.format(residual=residual))
    history = dict(
        zip(
            numbers(out / "history.csv", "load_factor"),
            numbers(out / "history.csv", "max_slip_m"),
            strict=True,
        )
    )
    assert history[0.48] < 1e-12
    assert history[0.485] > 1e-6


# Fractures of 0.107 m next to each other, 0.094 mm apart; friction is below 1.
CLOSE = """\
&domain x_min = 0.0, x_max = 1.0, y_min = 0.0, y_max = 1.0 /
&material young = 40e9, poisson = 0.2, biot = 0.8, porosity = 0.01, permeability = 5e-20 /
&fluid compressibility = 4e-10, viscosity = 1e-4 /
{fractures}
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&side name = 'right', x_traction = -20e6 /
&side name = 'top', y_traction = -10e6 /
&injection fracture = 'f0', rate = 1e-7 /
&initial fracture_pressure = 'equilibrated' /
&time end = 20.0, step = 10.0 /
&coarse size_fracture = 0.03, size_boundary = 0.15 /
&output vtu = .false. /
"""


def test_fractures_that_nearly_touch(tmp_path: Path) -> None:
    """Newton's iteration cycles; contact by pivoting leads to the initial state."""
    from_x, to_x, dx = 0.5201800613237769, 0.5932278134911787, -6.89942278729e-5
    from_y, to_y, dy = 0.39766369407205854, 0.47589321316011163, 6.44241881759e-5
    fractures = "\n".join(
        f"&fracture name = 'f{i}', friction = 0.5, dilation_deg = 1, aperture = 1e-4"
        f"  x = {from_x + i * dx}, {to_x + i * dx}, y = {from_y + i * dy}, {to_y + i * dy} /"
        for i in range(4)
    )
    history = run(tmp_path, CLOSE.format(fractures=fractures)) / "history.csv"
    assert max(numbers(history, "mass_error_relative")) < 1e-9
    assert numbers(history, "time_s")[-1] == 20.0


def test_friction_follows_the_path_of_slip(tmp_path: Path) -> None:
    """Slip that is stable: step after step friction has lost what the whole slip takes from it."""
    text = SLIDER.replace("weakening_slip = 2e-3", "weakening_slip = 2e-2")
    out = run(tmp_path, text.replace("\n  radiation_damping = 4e6", ""))
    last = [row for row in rows(out / "fractures.csv") if float(row["time_s"]) == 5554.5]
    assert last
    for row in last:
        slip = abs(float(row["jump_t_m"]))
        assert slip > 1e-4
        shear, normal = float(row["traction_t_pa"]), float(row["traction_n_pa"])
        assert abs(shear / normal) == pytest.approx(0.6 - 0.35 * slip / 2e-2, rel=1e-6)
