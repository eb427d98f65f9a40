"""Times as one writes them: a number and its unit."""

from __future__ import annotations

import re

SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}

_TIME = re.compile(r"([0-9.]+(?:[eE][-+]?[0-9]+)?)\s*(s|min|h|d)?")


def parse_times(text: str) -> tuple[float, ...]:
    """Read a comma-separated list of times into seconds.

    >>> parse_times("90, 2min, 1.5h")
    (90.0, 120.0, 5400.0)

    Raises
    ------
    ValueError
        If an entry is no number with an optional unit s, min, h or d.
    """
    times = []
    for entry in text.split(","):
        match = _TIME.fullmatch(entry.strip())
        if match is None:
            raise ValueError(f"'{entry.strip()}' is no time (a number, then s, min, h or d)")
        times.append(float(match.group(1)) * SECONDS[match.group(2) or "s"])
    return tuple(times)
