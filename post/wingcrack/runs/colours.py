"""How a field of the rock is coloured: its unit, label, scale and colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import Colormap, Normalize

from wingcrack.figures import style
from wingcrack.figures.fields import MatrixField
from wingcrack.figures.frames import extent, usual_limit, value_scale
from wingcrack.figures.maps import MEAN_COLOURS
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import MEGAPASCAL, Unit, displacement_unit, stress_unit
from wingcrack.runs.fields import Fields
from wingcrack.runs.units import NONE

MEAN = "stress.mean"
_NAMES = {MEAN: "mean in-plane stress", "pressure": "pore pressure"}


@dataclass(frozen=True)
class Colouring:
    """Colours for values in a unit that reads well."""

    unit: Unit
    label: str
    norm: Normalize
    colours: Colormap | str


def rock_of(found: Fields) -> MatrixField:
    """The rock of a state as the drawing code takes it."""
    return MatrixField(found.points, found.triangles, dict(found.rock))


def default_field(found: Fields) -> str:
    """Pressure, without a fluid the mean stress."""
    return "pressure" if "pressure" in found.rock else MEAN


def values_of(found: Fields, field: str) -> FloatArray:
    """Values of the cells [SI]; ``stress.mean`` is the mean of the normal stresses in the plane.

    Raises `AbsentError` if the state has no such field.
    """
    if field == MEAN:
        return np.asarray(0.5 * (found.of_rock("stress.xx") + found.of_rock("stress.yy")))
    return found.of_rock(field)


def colouring(states: Sequence[Fields], field: str) -> Colouring:
    """One scale for all states; stress is cut at what most of the body keeps to.

    At tips stress has no bound.
    """
    values = [values_of(found, field) for found in states]
    whole = field.partition(".")[0]
    name = _NAMES.get(field, field.replace(".", ", "))
    if whole == "stress":
        rocks = [rock_of(found) for found in states]
        limit = max(
            usual_limit(rock, one, extent([rock])) for rock, one in zip(rocks, values, strict=True)
        )
        limit = limit or 1.0
        unit = stress_unit(limit)
        top = float(unit.of(limit))
        return Colouring(unit, f"{name} [{unit.name}]", Normalize(-top, top), MEAN_COLOURS)
    unit = Unit(states[0].units.get(whole, NONE), 1.0)
    if unit.name == "Pa":
        unit = MEGAPASCAL
    elif unit.name == "m":
        unit = displacement_unit(*values)
    norm = value_scale([unit.of(one) for one in values])
    return Colouring(unit, f"{name} [{unit.name}]", norm, style.FIELD_COLOURS)
