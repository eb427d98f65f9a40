"""A scene in other units of length, stress and time, and its results in the first ones.

Two scenes whose dimensionless groups are equal differ by such a change alone. Powers of 4 leave
every digit of a number and of its root as it was, so results must agree to rounding.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import f90nml

from wingcrack.figures.text_files import namelist_groups
from wingcrack.names import columns
from wingcrack.scenes.parameters import groups

# Exponents of length, stress and time.
DIMENSIONS: dict[str, tuple[float, float, float]] = {
    "-": (0.0, 0.0, 0.0),
    "degree": (0.0, 0.0, 0.0),
    "MB": (0.0, 0.0, 0.0),
    "m": (1.0, 0.0, 0.0),
    "m2": (2.0, 0.0, 0.0),
    "1/m": (-1.0, 0.0, 0.0),
    "s": (0.0, 0.0, 1.0),
    "m/s": (1.0, 0.0, -1.0),
    "m2/s": (2.0, 0.0, -1.0),
    "m2/s/Pa": (2.0, -1.0, -1.0),
    "m/s2": (1.0, 0.0, -2.0),
    "Pa": (0.0, 1.0, 0.0),
    "1/Pa": (0.0, -1.0, 0.0),
    "Pa/m": (-1.0, 1.0, 0.0),
    "N/m": (1.0, 1.0, 0.0),
    "J/m": (2.0, 1.0, 0.0),
    "J/m2": (1.0, 1.0, 0.0),
    "N m/m": (2.0, 1.0, 0.0),
    "N m": (3.0, 1.0, 0.0),
    "N m/s": (3.0, 1.0, -1.0),
    "Pa m^1/2": (0.5, 1.0, 0.0),
    "Pa s": (0.0, 1.0, 1.0),
    "Pa s/m": (-1.0, 1.0, 1.0),
    "Pa s/m2": (-2.0, 1.0, 1.0),
    "Pa s2/m4": (-4.0, 1.0, 2.0),
    "m2/Pa": (2.0, -1.0, 0.0),
    "kg/m3": (-2.0, 1.0, 2.0),
    "K": (0.0, 0.0, 0.0),
    "1/K": (0.0, 0.0, 0.0),
    "K/m": (-1.0, 0.0, 0.0),
    "J/m3/K": (0.0, 1.0, 0.0),
    "W/m/K": (2.0, 1.0, -1.0),
    "W/m": (2.0, 1.0, -1.0),
    "W/m2": (1.0, 1.0, -1.0),
}

# Defaults with a dimension, in groups that a scene with a fluid need not have.
DEFAULTS = {
    "growth": {"new_aperture": 1.0e-5},
    "output": {
        "stimulated_jump": 1.0e-6,
        "seismic_slip_rate": 1.0e-3,
        "out_of_plane_length": 1.0,
    },
}


@dataclass(frozen=True)
class Units:
    """What numbers of length, stress and time are multiplied by."""

    length: float = 1.0
    stress: float = 1.0
    time: float = 1.0

    def factor(self, unit: str) -> float:
        """What a number of a unit is multiplied by."""
        length, stress, time = DIMENSIONS[unit]
        return float(self.length**length * self.stress**stress * self.time**time)


def in_units(text: str, units: Units) -> str:
    """Text of a scene in other units."""
    scene = namelist_groups(text)
    for group, values in DEFAULTS.items() if "fluid" in scene else ():
        entry = scene.setdefault(group, f90nml.Namelist())
        for name, value in values.items():
            entry.setdefault(name, value)
    written = io.StringIO()
    for group, item in scene.items():
        for one in item if isinstance(item, list) else [item]:
            table = groups()[group].parameters
            new = {
                name: _times(value, units.factor(table[name].unit)) for name, value in one.items()
            }
            f90nml.Namelist({group: f90nml.Namelist(new)}).write(written)
    return written.getvalue()


def _times(value: Any, factor: float) -> Any:
    if isinstance(value, list):
        return [_times(one, factor) for one in value]
    return value * factor if isinstance(value, float) and factor != 1.0 else value


def table(path: Path, units: Units = Units()) -> list[dict[str, float]]:
    """Numbers of a table of a run in the units before the change, by rows."""
    known = columns()[path.name]
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return [
        {
            name: float(text) / units.factor(known[name]["unit"])
            for name, text in row.items()
            if name in known and _is_number(text)
        }
        for row in rows
    ]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def differences(
    one: list[dict[str, float]], other: list[dict[str, float]], skipped: tuple[str, ...] = ()
) -> Mapping[str, float]:
    """Largest difference of each column over its largest value; rows must be equally many."""
    assert len(one) == len(other), f"{len(one)} and {len(other)} rows"
    found: dict[str, float] = {}
    for name in one[0]:
        if name in skipped:
            continue
        size = max(abs(row[name]) for row in one if name in row)
        worst = max(abs(a[name] - b[name]) for a, b in zip(one, other, strict=True) if name in a)
        found[name] = worst / size if size > 0.0 else worst
    return found
