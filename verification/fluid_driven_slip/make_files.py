"""Write the scene and the reference of this case.

The well must hold the pressure at x = 0 constant, but a scene gives rates: so the rate of each time
step is the volume that the exact solution takes up in it, V(t) = 2 a c_p dp sqrt(4 alpha t/pi).
"""

from __future__ import annotations

from math import erfc
from pathlib import Path

import numpy as np
from numpy.polynomial.legendre import leggauss

FRICTION = 0.5
NORMAL = 10.0e6  # sigma_0', compression [Pa]
SHEAR = 4.0e6  # tau_b [Pa]
OVERPRESSURE = 4.0e6  # dp [Pa]
APERTURE = 1.0e-5  # a [m]
COMPRESSIBILITY = 1.0e-7  # c_p [1/Pa]
REACH = 0.505  # sqrt(4 alpha t) at the end [m]
END = 1.0  # [s]
LAMBDA = 0.791607  # Viesca (2021) for T = 0.5
MODULUS = 40.0e9 / (1.0 - 0.2**2)  # E' [Pa]
STEPS = 40
HERE = Path(__file__).parent

complementary_error = np.vectorize(erfc, otypes=[float])


def write_scene() -> None:
    """Write fluid_driven_slip.nml from the head below and one injection per time step."""
    diffusivity = REACH**2 / (4.0 * END)
    viscosity = APERTURE**2 / (12.0 * diffusivity * COMPRESSIBILITY)
    head = f"""! Slip driven by fluid at constant pressure (Viesca 2021, T = 0.5). By make_files.py:
! one injection per time step, with the volume that the exact solution takes up.
&scene
  name = 'fluid_driven_slip'
  title = 'Self-similar slip driven by fluid'
/
&domain x_min = -20.0, x_max = 20.0, y_min = -20.0, y_max = 20.0 /
&material
  young = 40.0e9, poisson = 0.2, biot = 1.0e-6, porosity = 1.0e-6, permeability = 1.0e-30
/
&fluid compressibility = {COMPRESSIBILITY!r}, viscosity = {viscosity!r} /
&fracture
  name = 'f', x = -1.0, 1.0, y = 0.0, 0.0
  friction = {FRICTION!r}, aperture = {APERTURE!r}
/
! The bottom is held; s_xx = nu/(1 - nu) s_yy keeps it from straining the body beside it.
&side name = 'bottom', x_displacement = 0.0, y_displacement = 0.0 /
&side name = 'left', x_traction = {0.25 * NORMAL!r}, y_traction = {-SHEAR!r} /
&side name = 'right', x_traction = {-0.25 * NORMAL!r}, y_traction = {SHEAR!r} /
&side name = 'top', x_traction = {SHEAR!r}, y_traction = {-NORMAL!r} /
&time end = {END!r}, step = {END / STEPS!r} /
! An odd number of cells: the well is in the middle one.
&coarse size_fracture = 0.0247, size_boundary = 4.0 /
&output vtu = .false. /
"""
    times = np.linspace(0.0, END, STEPS + 1)
    volumes = (
        2.0 * APERTURE * COMPRESSIBILITY * OVERPRESSURE * np.sqrt(4.0 * diffusivity * times / np.pi)
    )
    rates = np.diff(volumes) / np.diff(times)
    wells = "".join(
        f"&injection fracture = 'f', rate = {rate:.9e}, x = 0.0, y = 0.0, "
        f"start = {start:.6g}, end = {end:.6g} /\n"
        for rate, start, end in zip(rates, times[:-1], times[1:], strict=True)
    )
    (HERE / "fluid_driven_slip.nml").write_text(head + wells)


def slip(x: np.ndarray) -> np.ndarray:
    """Slip of a crack of half-length b under the shear stress drop of the exact pressure [m].

    delta(x) = 4/(pi E') int_-b^b drop(s) ln|(b^2 - x s + sqrt((b^2-x^2)(b^2-s^2)))/(b (x - s))| ds
    (Muskhelishvili; Tada, Paris and Irwin), by Gauss and Legendre in s = x +- v^3, which removes
    the logarithm.
    """
    b = LAMBDA * REACH
    nodes, weights = leggauss(200)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    result = np.zeros_like(x)
    for i, here in enumerate(x):
        if abs(here) >= b:
            continue
        for side in (-1.0, 1.0):
            length = b - side * here
            s = here + side * length * nodes**3
            measure = 3.0 * length * nodes**2 * weights
            drop = SHEAR - FRICTION * (
                NORMAL - OVERPRESSURE * complementary_error(np.abs(s) / REACH)
            )
            root = np.sqrt(np.maximum(0.0, (b**2 - here**2) * (b**2 - s**2)))
            kernel = np.log(np.abs((b**2 - here * s + root) / (b * (here - s))))
            result[i] += np.sum(measure * drop * kernel)
    return 4.0 / (np.pi * MODULUS) * result


def main() -> None:
    """Write both files."""
    write_scene()
    x = np.linspace(-1.0, 1.0, 401)
    table = np.column_stack([x, slip(x), OVERPRESSURE * complementary_error(np.abs(x) / REACH)])
    np.savetxt(
        HERE / "reference.csv",
        table,
        delimiter=",",
        header="x_m,slip_m,pressure_pa",
        comments="",
        fmt="%.9e",
    )


if __name__ == "__main__":
    main()
