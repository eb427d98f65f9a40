"""What a run says of its own errors, in a line."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import wingcrack

_KEPT = 1.0e-3  # tips with less than this share of the largest K_eq are at rest


def describe_errors(run: wingcrack.Run) -> str:
    """Give the run's own estimates: of K, of length and pressure, of the fluid's balance."""
    said = [*_of_intensities(run), *_of_history(run)]
    energy = run.record.get("energy_error_relative")
    if energy is not None:
        said.append(f"energy norm {percent(float(energy))}")
    return ", ".join(said) or "none: no stress intensity factors"


def _of_intensities(run: wingcrack.Run) -> Iterator[str]:
    try:
        tips = run.tips
    except wingcrack.AbsentError:
        return
    size = np.hypot(tips["k1_pa_sqrtm"], tips["k2_pa_sqrtm"])
    error = np.hypot(tips["k1_error_pa_sqrtm"], tips["k2_error_pa_sqrtm"])
    loaded = size > _KEPT * size.max() if size.size else np.zeros(0, dtype=bool)
    if not loaded.any():
        return
    growing = loaded & (tips["advance_m"] > 0.0)
    if growing.any():
        yield f"K {percent(float((error / size)[growing].max()))} where tips grow"
    else:
        last = loaded & (tips["history_row"] == tips["history_row"][loaded].max())
        yield f"K {percent(float((error / size)[last].max()))} at the end"


def _of_history(run: wingcrack.Run) -> Iterator[str]:
    last = run.history.iloc[-1]
    length = last.get("fracture_length_error_m", -1.0)
    if length > 0.0:
        yield f"length {1e3 * length:.2g} mm of {last['fracture_length_m']:.3g} m"
    pressure = last.get("well_pressure_error_pa", -1.0)
    if pressure > 0.0:
        said = f"well pressure {1e-3 * pressure:.2g} kPa"
        # of several wells it is the error of their mean
        yield (
            f"{said} of {1e-6 * whole:.3g} MPa" if (whole := last.get("well_pressure_pa")) else said
        )
    if "mass_error_relative" in last:
        yield f"fluid {run.record['mass_error_relative']:.0e}"


def percent(share: float) -> str:
    """A share in per cent with two digits, and what is too small to matter as less than 0.01 %."""
    return "below 0.01 %" if share < 1.0e-4 else f"{100.0 * share:.2g} %"
