"""Common scales of all figures of a run: the unit of lengths, and the limit of zero."""

from __future__ import annotations

import numpy as np

from wingcrack.figures.read import Run
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import METRE, Unit, length_unit

ROUND_OFF = 1.0e-9  # share of a run's largest value below which another one says nothing


def run_length_unit(run: Run) -> Unit:
    """Unit of places and lengths: that of the body's coordinates, the same in every figure."""
    if run.scene is None or run.scene.outline is None:
        return METRE
    return length_unit(run.scene.outline)


def jump_scale(run: Run) -> float:
    """Largest slip or opening of any fracture in the run [m]."""
    return _largest(run, "jump_n_m", "jump_t_m")


def traction_scale(run: Run) -> float:
    """Stress that tells tractions from round-off [Pa].

    The largest traction in the run, or the stress that goes with the largest jump, Young's modulus
    times jump over length, where fractures carry none.
    """
    largest = _largest(run, "traction_n_pa", "traction_t_pa")
    young = run.scene.young_pa if run.scene else None
    if young and run.history.has("fracture_length_m"):
        length = float(run.history.number("fracture_length_m").max())
        if length > 0.0:
            largest = max(largest, young * jump_scale(run) / length)
    return largest


def without_round_off(values: FloatArray, scale: float) -> FloatArray:
    """Values with zero for what is round-off compared with `scale` (same unit)."""
    return np.where(np.abs(values) <= ROUND_OFF * scale, 0.0, values)


def _largest(run: Run, *columns: str) -> float:
    if run.fractures is None or run.fractures.rows == 0:
        return 0.0
    values = np.abs(np.concatenate([run.fractures.number(name) for name in columns]))
    return float(np.nanmax(values))
