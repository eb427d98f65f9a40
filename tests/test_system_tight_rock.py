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
#: K of an open tip that is drained, however little around it, over that of undrained rock [-]:
#: F^(3/4), F = (1 - nu_u)/(1 - nu) (verification/sudden_pressure).
DRAINED_TIP = 0.863**0.75
#: Diffusivity over permeability [1/s], and K of a layer of fluid pressure over its pressure and the
#: fourth root of c t, (1 + F)/2 sqrt(2)/Gamma(5/4) eta [-].
DIFFUSIVITY = 6.179e13
LAYER = 0.9315 * math.sqrt(2.0) / math.gamma(1.25) * 0.3


def of_layers(time: list[float], pressure: list[float], permeability: float) -> float:
    """K of the layers on the faces, whose pressure has changed in steps [Pa m^1/2]."""
    changes = zip(time[1:], pressure[1:], pressure[:-1], strict=True)
    c = DIFFUSIVITY * permeability
    return -LAYER * sum((p - q) * math.sqrt(math.sqrt(c * (time[-1] - t))) for t, p, q in changes)


@pytest.mark.parametrize(("pressure", "permeability"), [(3e6, 1e-19), (3e6, 1e-25), (9.9e6, 1e-25)])
def test_the_rocks_pressure_does_not_close_the_fracture(
    pressure: float, permeability: float, tmp_path: Path
) -> None:
    """The layers are thinner than a fiftieth of a cell: K is that of the tip less that of layers.

    The budget is the stated error, at most 12 % of K: 5 cells per half-length, steps, and what the
    rock's undrained pressure changes at the faces.
    """
    out = run(tmp_path, SCENE.format(p=pressure, k=permeability))
    fluid = numbers(out / "history.csv", "well_pressure_pa")
    undrained = (fluid[-1] - 10e6) * math.sqrt(math.pi * 50)
    exact = DRAINED_TIP * undrained + of_layers(
        numbers(out / "history.csv", "time_s"), fluid, permeability
    )
    k = numbers(out / "tips.csv", "k1_pa_sqrtm")[-2:]
    error = numbers(out / "tips.csv", "k1_error_pa_sqrtm")[-2:]
    for value, known_to in zip(k, error, strict=True):
        assert value == pytest.approx(exact, abs=known_to)
        assert known_to < 0.12 * exact
    assert k[0] == pytest.approx(k[1], rel=0.01)
