"""Times as one writes them: a number and its unit."""

from __future__ import annotations

import math
import re
from numbers import Real

from wingcrack.errors import RunError

SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}

_TIME = re.compile(r"((?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)\s*(s|min|h|d)?", re.ASCII)


def parse_times(text: str) -> tuple[float, ...]:
    """Read a comma-separated list of times into seconds.

    Raises `ValueError` if an entry is no number with an optional unit s, min, h or d.

    >>> parse_times("90, 2min, 1.5h")
    (90.0, 120.0, 5400.0)
    """
    times = []
    for entry in text.split(","):
        match = _TIME.fullmatch(entry.strip())
        time = float(match[1]) * SECONDS[match[2] or "s"] if match else math.inf
        if not math.isfinite(time):
            raise ValueError(f"'{entry.strip()}' is no time (a number, then s, min, h or d)")
        times.append(time)
    return tuple(times)


def moment_of(given: object) -> float:
    """Give a time [s], or a load factor [-], that a program asks for.

    Raises `RunError` if it is no finite number.
    """
    if not isinstance(given, Real) or not math.isfinite(given):
        raise RunError(f"{given!r} is no time: a number is needed, of seconds or a load factor")
    return float(given)
