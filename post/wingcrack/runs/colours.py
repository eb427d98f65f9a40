"""How a field of the rock is coloured: its unit, label, scale and colours."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import Colormap, Normalize

from wingcrack.figures import style
from wingcrack.figures.fields import MatrixField
from wingcrack.figures.frames import extent, usual_range, value_scale
from wingcrack.figures.maps import signed_colours, stress_norm
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import MEGAPASCAL, Unit, displacement_unit
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


def colouring(states: Iterable[Fields], field: str) -> Colouring:
    """One scale for all states, which are read one by one.

    Stress is cut at what most of the body keeps to: at tips it has no bound.
    """
    whole = field.partition(".")[0]
    name = _NAMES.get(field, field.replace(".", ", "))
    unit, limits = Unit(NONE, 1.0), []
    for found in states:
        values, rock = values_of(found, field), rock_of(found)
        if whole == "stress":
            limits.append(usual_range(rock, values, extent([rock])))
        else:
            limits.append((float(np.nanmin(values)), float(np.nanmax(values))))
        unit = Unit(found.units.get(whole, NONE), 1.0)
    low, high = min(pair[0] for pair in limits), max(pair[1] for pair in limits)
    if whole == "stress":
        norm, unit = stress_norm(low, high)
        colours = signed_colours(float(norm.vmin or 0.0), float(norm.vmax or 0.0))
        return Colouring(unit, f"{name} [{unit.name}]", norm, colours)
    if unit.name == "Pa":
        unit = MEGAPASCAL
    elif unit.name == "m":
        unit = displacement_unit(np.array([low, high]))
    norm = value_scale([unit.of([low, high])])
    return Colouring(unit, f"{name} [{unit.name}]", norm, style.FIELD_COLOURS)
