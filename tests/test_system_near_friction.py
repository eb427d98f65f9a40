"""Stated errors of a fracture that sticks, near its friction limit and far from it."""

import math
from pathlib import Path

import pytest
from system_scene import numbers, run

SCENE = """\
&scene name = 'near' /
&domain x_min = -20.0, x_max = 20.0, y_min = -20.0, y_max = 20.0 /
&material young = 20.0e9, poisson = 0.2, biot = 0.8, porosity = 0.05, permeability = 1e-17 /
&fluid compressibility = 4.0e-10, viscosity = 0.001 /
&fracture name = 'f1', x = -1.0, 1.0, y = -1.0, 1.0, friction = {friction}, aperture = 0.0002 /
&in_situ sxx = -20.0e6, syy = -12.0e6 /
&initial pressure = 5.0e6 /
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&injection fracture = 'f1', pressure = 6.0e6 /
&time end = 100.0 /
&coarse size_fracture = 0.28, size_boundary = 4.0 /
&output vtu = .false. /
"""
#: Shear traction over what presses the faces together, at the fluid's 6 MPa.
RATIO = 4e6 / (16e6 - 6e6)


@pytest.mark.parametrize("more", [1.002, 1.5])
def test_faces_that_stick_near_their_limit_may_slip(more: float, tmp_path: Path) -> None:
    """Whether they slip there depends on the mesh; far from it, it does not.

    With as much less friction the slip would be 4 a/E' times what shear exceeds friction by.
    """
    out = run(tmp_path, SCENE.format(friction=more * RATIO))
    slip = numbers(out / "history.csv", "max_slip_m")[-1]
    error = numbers(out / "history.csv", "max_slip_error_m")[-1]
    missing = (more - 1.0) * 4e6
    other_way = 4.0 * math.sqrt(2.0) / (20e9 / 0.96) * missing
    assert slip <= error
    if more < 1.1:
        assert 0.0 < error < 100.0 * other_way
    else:
        assert slip <= 0.0
        assert error <= 0.0
