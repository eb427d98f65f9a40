"""Write the scenes and the references of this case, two for each stress parameter T.

The well holds the pressure at x = 0 constant. In one scene it is told so, and the program chooses
its steps; in the other the rate of each time step is the volume that the exact solution takes up in
it, V(t) = 2 a c_p dp sqrt(4 alpha t/pi).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import erfc
from pathlib import Path

import numpy as np
from numpy.polynomial.legendre import leggauss

FRICTION = 0.5
NORMAL = 10.0e6  # sigma_0', compression [Pa]
OVERPRESSURE = 4.0e6  # dp [Pa]
APERTURE = 1.0e-5  # a [m]
COMPRESSIBILITY = 1.0e-7  # c_p [1/Pa]
END = 1.0  # [s]
MODULUS = 40.0e9 / (1.0 - 0.2**2)  # E' [Pa]
STEPS = 40
HERE = Path(__file__).parent


@dataclass(frozen=True)
class Case:
    """A stress parameter, and how far the fluid gets."""

    name: str
    parameter: float  # T of Viesca (2021)
    share: float  # lambda for it
    reach: float  # sqrt(4 alpha t) at the end [m]

    @property
    def shear(self) -> float:
        """Shear stress tau_b before [Pa]."""
        return FRICTION * (NORMAL - self.parameter * OVERPRESSURE)


# T near 0: slip outruns the fluid; near 1 it lags behind. The fracture ends at 1 m.
CASES = (
    Case("fluid_driven_slip", 0.5, 0.791607, 0.505),
    Case("slip_lags", 0.8, 0.283377, 0.8),
    Case("slip_outruns", 0.2, 1.912514, 0.4),
)

complementary_error = np.vectorize(erfc, otypes=[float])


def write_scenes(case: Case) -> None:
    """Write the scenes from the head below: with one injection per time step, at a pressure."""
    diffusivity = case.reach**2 / (4.0 * END)
    title = f"T = {case.parameter!r}"
    viscosity = APERTURE**2 / (12.0 * diffusivity * COMPRESSIBILITY)
    head = f"""! Slip driven by fluid at constant pressure (Viesca 2021, {title}). By make_files.py:
! one injection per time step, with the volume that the exact solution takes up.
&scene
  name = '{case.name}'
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
&side name = 'left', x_traction = {0.25 * NORMAL!r}, y_traction = {-case.shear!r} /
&side name = 'right', x_traction = {-0.25 * NORMAL!r}, y_traction = {case.shear!r} /
&side name = 'top', x_traction = {case.shear!r}, y_traction = {-NORMAL!r} /
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
    (HERE / f"{case.name}.nml").write_text(head + wells)
    head = head.replace(
        "! one injection per time step, with the volume that the exact solution takes up.",
        "! above what the load makes of alpha = 1e-6, 2250 Pa.",
    )
    head = head.replace(f"name = '{case.name}'", f"name = '{case.name}_at_pressure'")
    head = head.replace(f", step = {END / STEPS!r}", "")
    well = f"&injection fracture = 'f', pressure = {OVERPRESSURE + 2250.0!r}, x = 0.0, y = 0.0 /\n"
    (HERE / f"{case.name}_at_pressure.nml").write_text(head + well)


def slip(case: Case, x: np.ndarray) -> np.ndarray:
    """Slip of a crack of half-length b under the shear stress drop of the exact pressure [m].

    delta(x) = 4/(pi E') int_-b^b drop(s) ln|(b^2 - x s + sqrt((b^2-x^2)(b^2-s^2)))/(b (x - s))| ds
    (Muskhelishvili; Tada, Paris and Irwin), by Gauss and Legendre in s = x +- v^3, which removes
    the logarithm.
    """
    b = case.share * case.reach
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
            drop = case.shear - FRICTION * (
                NORMAL - OVERPRESSURE * complementary_error(np.abs(s) / case.reach)
            )
            root = np.sqrt(np.maximum(0.0, (b**2 - here**2) * (b**2 - s**2)))
            kernel = np.log(np.abs((b**2 - here * s + root) / (b * length * nodes**3)))
            result[i] += np.sum(measure * drop * kernel)
    return 4.0 / (np.pi * MODULUS) * result


def write_reference(case: Case) -> None:
    """Write slip and pressure along the fracture at the end."""
    x = np.linspace(-1.0, 1.0, 401)
    pressure = OVERPRESSURE * complementary_error(np.abs(x) / case.reach)
    np.savetxt(
        HERE / ("reference.csv" if case is CASES[0] else f"{case.name}.csv"),
        np.column_stack([x, slip(case, x), pressure]),
        delimiter=",",
        header="x_m,slip_m,pressure_pa",
        comments="",
        fmt="%.9e",
    )


def main() -> None:
    """Write all files."""
    for case in CASES:
        write_scenes(case)
        write_reference(case)


if __name__ == "__main__":
    main()
