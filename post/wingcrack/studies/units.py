"""Units of parameters, and names of columns that carry them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

NONE = "-"  # the unit of a number that has none

_GROUP = re.compile(r"## &(\w+)")
_ROW = re.compile(r"\| `(\w+)` \| [^|]* \| ([^|]*) \|")


@lru_cache(maxsize=4)
def units_of_input(page: Path) -> Mapping[str, str]:
    """Unit of each ``group.name``, from the page that the program writes of its input."""
    units, group = {}, ""
    for line in page.read_text(encoding="utf-8").splitlines():
        if heading := _GROUP.match(line):
            group = heading[1]
        elif row := _ROW.match(line):
            units[f"{group}.{row[1]}"] = row[2].strip()
    return units


def unit_of_path(path: str, page: Path) -> str | None:
    """Unit of a namelist entry by its path; None if the page does not know it."""
    group, *_, name = path.lower().split(".")
    return units_of_input(page).get(f"{group}.{name}")


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
