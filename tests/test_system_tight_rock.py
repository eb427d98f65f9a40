"""K of a fracture whose fluid and rock differ in pressure, in very tight rock."""

import math
from pathlib import Path

import pytest
from system_scene import numbers, run

SCENE = """\
&scene name = 'tight' /
&domain x_min = -1000.0, x_max = 1000.0, y_min = -1000.0, y_max = 1000.0 /
&material young = 40.0e9, poisson = 0.2, biot = 0.8, porosity = 0.01, permeability = {k},
  toughness = 1.0e6 /
&fluid compressibility = 4.0e-10, viscosity = 0.0003 /
&fracture name = 'f1', x = -50.0, 50.0, y = 0.0, 0.0, friction = 0.6, aperture = 0.0002 /
&in_situ sxx = -20.0e6, syy = -10.0e6 /
&initial pressure = {p} /
&side name = 'left', x_displacement = 0.0, pressure = {p} /
&side name = 'right', pressure = {p} /
&side name = 'bottom', y_displacement = 0.0 /
&injection fracture = 'f1', rate = 1.0e-4 /
&time end = 800.0 /
&coarse size_fracture = 5.0, size_boundary = 100.0 /
&fine window = 500.0 /
&growth enabled = .false., intensities = .true. /
&output vtu = .false. /
"""
#: What a tip that is drained, however little around it, makes of the undrained K.
DRAINED_TIP = 0.863  # (1 - nu_u)/(1 - nu) [-]


@pytest.mark.parametrize(("pressure", "permeability"), [(3e6, 1e-19), (3e6, 1e-25), (9.9e6, 1e-25)])
def test_the_rocks_pressure_does_not_close_the_fracture(
    pressure: float, permeability: float, tmp_path: Path
) -> None:
    out = run(tmp_path, SCENE.format(p=pressure, k=permeability))
    fluid = numbers(out / "history.csv", "well_pressure_pa")[-1]
    undrained = (fluid - 10e6) * math.sqrt(math.pi * 50)
    k = numbers(out / "tips.csv", "k1_pa_sqrtm")[-2:]
    error = numbers(out / "tips.csv", "k1_error_pa_sqrtm")[-2:]
    for value, known_to in zip(k, error, strict=True):
        assert 0.97 * DRAINED_TIP * undrained < value < 1.03 * undrained
        assert value - known_to < DRAINED_TIP * undrained
        assert undrained < value + known_to
    assert k[0] == pytest.approx(k[1], rel=0.01)
