"""The wells in history.csv: the pressure of each, and the volumes injected and extracted."""

from __future__ import annotations

import numpy as np

from wingcrack.figures.read import Run
from wingcrack.figures.table import FloatArray, Table

_PRESSURE = "well_pressure_pa"


def pressure_columns(history: Table) -> dict[str, str]:
    """Give the column of each well's pressure by its name; of the only one by no name.

    A run without a fluid has none; one with a fluid and no well has that of none, which is 0.
    """
    if history.has(_PRESSURE):
        return {"": _PRESSURE}
    return {
        column.removesuffix(f"_{_PRESSURE}"): column
        for column in history.cells
        if column.endswith(f"_{_PRESSURE}")
    }


def well_pressures(history: Table) -> dict[str, FloatArray]:
    """Give the pressures of each well by its name [Pa], as `pressure_columns`."""
    return {name: history.number(column) for name, column in pressure_columns(history).items()}


def highest_pressures(history: Table) -> list[tuple[str, int, float]]:
    """Give name, row and pressure [Pa] of each well's highest pressure, the highest first."""
    found = []
    for name, pressure in well_pressures(history).items():
        row = int(np.nanargmax(pressure))
        found.append((name, row, float(pressure[row])))
    return sorted(found, key=lambda peak: -peak[2])


def injected_and_produced(history: Table) -> tuple[FloatArray, FloatArray]:
    """Give what wells have injected and what they have produced so far, both positive [m2].

    A run of an earlier version does not tell them apart: what it has is the difference.
    """
    net = history.number("injected_m2")
    produced = history.number("produced_m2") if history.has("produced_m2") else np.zeros_like(net)
    return net + produced, produced


def pumped_volumes(run: Run) -> tuple[float, float]:
    """Give what wells have taken in at their heads, and produced, until the end, positive [m2].

    The history has what has entered the body: less by what the wells store.
    """
    wells = run.wells
    if wells is None or not wells.has("rate_m2_s") or wells.rows == 0:
        injected, produced = injected_and_produced(run.history)
        return float(injected[-1]), float(produced[-1])
    names, time, rate = wells.text("well"), wells.moments(), wells.number("rate_m2_s")
    moved = [np.diff(time[names == name]) * rate[names == name][1:] for name in np.unique(names)]
    volumes = np.concatenate(moved)
    return float(volumes[volumes > 0.0].sum()), float(-volumes[volumes < 0.0].sum())
