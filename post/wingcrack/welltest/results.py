"""Results of the analysis of shut-ins, as a table: a row per well and shut-in."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wingcrack.errors import RunError
from wingcrack.figures.scene import read_groups
from wingcrack.figures.text_files import read_text
from wingcrack.welltest.record import Record
from wingcrack.welltest.shut_in import (
    FallOff,
    Line,
    closures,
    fall_offs,
    instantaneous_pressure,
    lines,
    picks,
)

Cell = float | int | str | None


@dataclass(frozen=True)
class Rock:
    """What slopes need to become properties; None where it is not known."""

    viscosity: float | None = None  # of the fluid [Pa s]
    storage: float | None = None  # of the rock at uniaxial strain [1/Pa]


def rock_of_scene(path: Path) -> Rock:
    """Give viscosity and storage of `&fluid` and `&material` of a run's scene.nml.

    S = phi c_p + (alpha - phi)/K_dr + alpha^2/(lambda + 2 G); the second term times 1 - alpha for
    the storage of textbooks. Raises `RunError` if the file is missing or has no such values.
    """
    try:
        groups = dict(reversed(read_groups(read_text(path))))
        fluid, rock = groups["fluid"], groups["material"]
        young, poisson, biot, porosity = (
            float(rock[name][0]) for name in ("young", "poisson", "biot", "porosity")
        )
        uniaxial = young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        grains = (biot - porosity) * 3.0 * (1.0 - 2.0 * poisson) / young
        if rock["storage"][0].strip("'\"") == "textbook":
            grains *= 1.0 - biot
        compressibility = float(fluid["compressibility"][0])
        return Rock(
            viscosity=float(fluid["viscosity"][0]),
            storage=porosity * compressibility + grains + biot**2 / uniaxial,
        )
    except (OSError, KeyError, ValueError) as reason:
        raise RunError(f"{path}: the scene of a run was expected ({reason}).") from None


def evaluate(records: Iterable[Record], rock: Rock) -> list[tuple[FallOff, dict[str, Cell]]]:
    """Evaluate all shut-ins: each with its row, as docs/howto_wells.md describes the columns."""
    return [(fall, _row(fall, rock)) for record in records for fall in fall_offs(record)]


def _row(fall: FallOff, rock: Rock) -> dict[str, Cell]:
    pressure, error = instantaneous_pressure(fall)
    row: dict[str, Cell] = {
        "well": fall.well,
        "shut_in": fall.number,
        "start_s": fall.start,
        "injection_s": fall.injection,
        "rate": fall.rate,
        "volume": fall.volume,
        "pressure_before_pa": fall.pressure_before,
        "isip_pa": pressure,
        "isip_error_pa": error,
    }
    found = {line.regime: line for line in lines(fall)}
    for regime in ("linear", "radial"):
        line = found.get(regime)
        row[f"{regime}_begin_s"] = line.begin if line else None
        row[f"{regime}_end_s"] = line.end if line else None
        row[f"{regime}_slope"] = line.slope if line else None
        row[f"{regime}_slope_error"] = line.slope_error if line else None
        row[f"{regime}_reservoir_pa"] = line.pressure if line else None
        row[f"{regime}_reservoir_error_pa"] = line.pressure_error if line else None
    row |= _properties(fall, found, rock)
    picked = {pick.method: pick for pick in (*picks(fall), *closures(fall))}
    for method in ("tangent", "compliance", "root", "first cell", "last cell"):
        pick, name = picked.get(method), method.replace(" ", "_")
        row[f"closure_{name}_s"] = pick.since if pick else None
        row[f"closure_{name}_pa"] = pick.pressure if pick else None
    return row


def _properties(fall: FallOff, found: dict[str, Line], rock: Rock) -> dict[str, Cell]:
    """Properties from the slopes, with errors in proportion to those of the slopes.

    linear: p = p_0 + 2 q/(sqrt(pi) F) X with F = A sqrt(k S/mu), A the area of all faces per
    thickness; radial: p = p_0 + q mu/(4 pi k h) X.
    """
    leakoff = root = transmissivity = conductivity = None
    linear, radial = found.get("linear"), found.get("radial")
    if linear:
        leakoff = 2.0 * fall.rate / (np.sqrt(np.pi) * linear.slope)
        if rock.viscosity and rock.storage:
            root = leakoff * np.sqrt(rock.viscosity / rock.storage)
    if radial:
        transmissivity = fall.rate / (4.0 * np.pi * radial.slope)
        if rock.viscosity:
            conductivity = transmissivity * rock.viscosity
    row: dict[str, Cell] = {}
    for name, value, line in (
        ("area_leakoff", leakoff, linear),
        ("area_root_k", root, linear),
        ("transmissivity", transmissivity, radial),
        ("k_h", conductivity, radial),
    ):
        row[name] = None if value is None else float(value)
        share = line.slope_error / abs(line.slope) if line else 0.0
        row[f"{name}_error"] = None if value is None else float(share * value)
    return row
