"""Units of measured records, and the map of their columns."""

from __future__ import annotations

import re

_QUANTITIES = ("time", "rate", "pressure")
_BARREL = 0.158987294928  # [m3]
UNITS: dict[str, dict[str, float]] = {  # to SI, by quantity
    "time": {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0},
    "pressure": {"Pa": 1.0, "kPa": 1.0e3, "MPa": 1.0e6, "bar": 1.0e5, "psi": 6894.757293168},
    "rate": {
        "m2/s": 1.0,
        "m3/s": 1.0,
        "l/s": 1.0e-3,
        "l/min": 1.0e-3 / 60.0,
        "m3/h": 1.0 / 3600.0,
        "bbl/min": _BARREL / 60.0,
        "bpm": _BARREL / 60.0,
    },
}


def read_columns(text: str) -> dict[str, tuple[str, str]]:
    """Read a map of columns, 'HEADER=QUANTITY [UNIT], ...': header and unit of each quantity.

    Raises `ValueError` with the reason.

    >>> read_columns("injectionRate=rate [bpm], pressure=pressure [psi], time=time [s]")["rate"]
    ('injectionRate', 'bpm')
    """
    found: dict[str, tuple[str, str]] = {}
    for part in text.split(","):
        match = re.fullmatch(r"\s*(.+?)\s*=\s*(\w+)\s*\[\s*(.+?)\s*\]\s*", part)
        if match is None:
            raise ValueError(f"'{part.strip()}' is not of the form HEADER=QUANTITY [UNIT]")
        header, quantity, unit = match.groups()
        if quantity not in _QUANTITIES:
            raise ValueError(f"'{quantity}' is none of {', '.join(_QUANTITIES)}")
        known = {name.lower(): name for name in UNITS[quantity]}
        if unit.lower() not in known:
            raise ValueError(f"'{unit}' is none of {', '.join(UNITS[quantity])}")
        found[quantity] = (header, known[unit.lower()])
    missing = [quantity for quantity in _QUANTITIES if quantity not in found]
    if missing:
        raise ValueError(f"no column is named for {', '.join(missing)}")
    return found
