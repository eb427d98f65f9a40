"""Units of parameters, and names of columns that carry them."""

from __future__ import annotations

import re
from typing import Any

from wingcrack.runs.parameter_table import parameters

NONE = "-"  # the unit of a number that has none


def unit_of_path(path: str) -> str | None:
    """Unit of a namelist entry by its path; None if no scene has it."""
    group, *_, name = path.lower().split(".")
    found = parameters().get(f"{group}.{name}")
    return found.unit if found else None


def column_name(name: str, unit: str) -> str:
    """Name of a column, as in the files of a run: ``injection_rate_m2_s``."""
    words = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    ending = re.sub(r"[^a-z0-9]+", "_", unit.lower().replace("sqrt(m)", "sqrtm")).strip("_")
    return f"{words}_{ending}" if ending and not words.endswith(f"_{ending}") else words


def axis_label(name: str, unit: str) -> str:
    """Name of an axis of a figure."""
    said = name.replace("_", " ").replace(".", ": ")
    return said if unit == NONE else f"{said} [{pretty_unit(unit)}]"


def pretty_unit(unit: str) -> str:
    """Unit in a figure: m2/s with its exponent raised."""
    return re.sub(r"(?<=[A-Za-z])(-?\d+)", r"$^{\1}$", unit)


def pretty_number(value: Any) -> str:
    """Value in a figure: four digits, powers of ten as such."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return spoken(value)
    mantissa, _, exponent = f"{value:.4g}".partition("e")
    if not exponent:
        return mantissa
    factor = "" if mantissa == "1" else rf"{mantissa}\times"
    return rf"${factor}10^{{{int(exponent)}}}$"


def spoken(value: Any) -> str:
    """Value in a label: short, and the same for the same value."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        short = f"{value:g}"
        return short if float(short) == value else repr(value)
    if isinstance(value, list | tuple):
        return " ".join(spoken(item) for item in value)
    return str(value)
