"""Units of figures: SI from the files, scaled to readable numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wingcrack.figures.durations import SECONDS
from wingcrack.figures.table import FloatArray


@dataclass(frozen=True)
class Unit:
    """A unit and its size in SI."""

    name: str
    size: float

    def of(self, values: npt.ArrayLike) -> FloatArray:
        """Turn SI values into values in this unit."""
        return np.asarray(values, dtype=float) / self.size


METRE = Unit("m", 1.0)
MEGAPASCAL = Unit("MPa", 1e6)

_SMALL_LENGTHS = (METRE, Unit("mm", 1e-3), Unit("µm", 1e-6), Unit("nm", 1e-9), Unit("pm", 1e-12))
_STRESSES = (MEGAPASCAL, Unit("kPa", 1e3), Unit("Pa", 1.0))
_AREAS = (Unit("m²", 1.0), Unit("cm²", 1e-4), Unit("mm²", 1e-6))
_VOLUMES = (Unit("m³", 1.0), Unit("l", 1e-3), Unit("ml", 1e-6))
_RATES = (
    Unit("m²/s", 1.0),
    *(Unit(rf"$10^{{-{power}}}$ m²/s", 10.0**-power) for power in (3, 6, 9, 12)),
)
_YEAR = Unit("years", 365.25 * SECONDS["d"])
_TIMES = (_YEAR, *(Unit(name, SECONDS[name]) for name in ("h", "min", "s")))


def time_unit(end_s: float) -> Unit:
    """Years, hours, minutes or seconds: the largest unit of which the run has two."""
    return next((unit for unit in _TIMES if end_s >= 2.0 * unit.size), _TIMES[-1])


def length_unit(*values: npt.ArrayLike) -> Unit:
    """Unit of the axes of a map: metres; millimetres if no coordinate reaches half a metre."""
    largest = max(float(np.max(np.abs(np.asarray(value, dtype=float)))) for value in values)
    return METRE if largest >= 0.5 else _SMALL_LENGTHS[1]


def displacement_unit(*values: npt.ArrayLike) -> Unit:
    """Unit in which the largest displacement or opening is at least one tenth."""
    return _fitting(_SMALL_LENGTHS, values)


def stress_unit(*values: npt.ArrayLike) -> Unit:
    """Unit in which the largest stress is at least one tenth."""
    return _fitting(_STRESSES, values)


def rate_unit(*values: npt.ArrayLike) -> Unit:
    """Unit in which the largest rate is at least one tenth."""
    return _fitting(_RATES, values)


def intensity_unit(*values: npt.ArrayLike) -> Unit:
    """Unit in which the largest stress intensity is at least one tenth."""
    stress = _fitting(_STRESSES, values)
    return Unit(rf"{stress.name}$\,\sqrt{{\mathrm{{m}}}}$", stress.size)


def volume_unit(thickness_m: float, *values: npt.ArrayLike) -> Unit:
    """Unit for volumes per metre [m2]: of the whole thickness where that is not 1 m."""
    if thickness_m == 1.0:
        return _fitting(_AREAS, values)
    whole = tuple(thickness_m * np.asarray(value, dtype=float) for value in values)
    unit = _fitting(_VOLUMES, whole)
    return Unit(unit.name, unit.size / thickness_m)


def volume_label(unit: Unit) -> str:
    """Label of an axis of volumes."""
    return f"volume{' per thickness' if '²' in unit.name else ''} [{unit.name}]"


def _fitting(units: tuple[Unit, ...], values: tuple[npt.ArrayLike, ...]) -> Unit:
    finite = [np.abs(a[np.isfinite(a)]) for a in (np.asarray(v, dtype=float) for v in values)]
    largest = max((float(a.max()) for a in finite if a.size), default=0.0)
    if largest == 0.0:
        return MEGAPASCAL if MEGAPASCAL in units else units[1]
    return next((unit for unit in units if largest >= 0.1 * unit.size), units[-1])
