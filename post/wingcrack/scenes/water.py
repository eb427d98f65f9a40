"""Water as the fluid of a scene, by the standards IAPWS-IF97 and, for its viscosity, IAPWS 2008."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import f90nml
import numpy as np

from wingcrack.errors import EnvironmentLacksError
from wingcrack.scenes.errors import SceneError
from wingcrack.scenes.namelist import Value, value_text

_STEP = 10.0  # of the temperatures in a table [K]


def water(
    pressure: float, temperature: float, table: Sequence[float] | None = None
) -> dict[str, Value]:
    """Entries of &fluid for liquid water at a pressure [Pa] and a temperature [K].

    With temperatures of a table also those that a scene with &heat takes.
    """
    state = _state(pressure, temperature)
    entries: dict[str, Value] = {
        "compressibility": _rounded(1e-6 * state.xkappa),  # of 1/MPa
        "viscosity": _rounded(state.mu),
    }
    if table is not None:
        entries["heat_capacity"] = _rounded(1e3 * state.rho * state.cp)
        entries["heat_expansion"] = _rounded(state.alfav)
        entries["table_temperature"] = list(table)
        entries["viscosity_at"] = [_rounded(_state(pressure, t).mu) for t in table]
    return entries


def _state(pressure: float, temperature: float) -> Any:
    try:
        library = import_module("iapws")
    except ImportError:
        raise EnvironmentLacksError(
            "iapws is missing: ./wingcrack new --water installs it (requirements_water.txt)"
        ) from None
    try:
        state = library.IAPWS97(T=temperature, P=1e-6 * pressure)
    except NotImplementedError:
        state = None
    if state is None or getattr(state, "region", 0) != 1:
        raise SceneError(
            f"at {temperature:g} K and {1e-6 * pressure:g} MPa water is not liquid: that takes"
            " 273.15 to 623.15 K, and a pressure above that of its vapour"
        )
    return state


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")


def with_water(text: str, temperature: float) -> str:
    """Give the scene of a text, whose groups have a line for each entry, water as its fluid.

    `temperature`: of the rock [K], also in &heat. Pressure is that of &initial.
    """
    groups = f90nml.reads(text)
    if "fluid" not in groups:
        raise SceneError("this kind of scene has no fluid, so --water has no meaning")
    table = None
    if "heat" in groups:
        text = re.sub(r"(?<=&heat\n  temperature = ).*", repr(temperature), text)
        wells = groups.get("injection", [])
        wells = wells if isinstance(wells, list) else [wells]
        known = np.ravel([well["temperature"] for well in wells if "temperature" in well])
        low, high = min([temperature, *known]), max([temperature, *known])
        count = int(np.ceil((high - low) / _STEP)) + 1
        table = [_rounded(t) for t in np.linspace(low, high, max(count, 2))]
    pressure = groups.get("initial", {}).get("pressure", 0.0)
    entries = {**groups["fluid"], **water(pressure, temperature, table)}
    block = "".join(f"  {name} = {value_text(value)}\n" for name, value in entries.items())
    return re.sub(r"(?<=&fluid\n).*?(?=^/$)", block, text, count=1, flags=re.S | re.M)
