"""What a run came to, for the last lines on the terminal: each well, events by kind."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

_EVENTS = {  # the kinds that tell what happened, in words for one and for several
    "slip_onset": ("fracture slips", "fractures slip"),
    "opening": ("opens", "open"),
    "growth": ("increment of a tip", "increments of tips"),
    "joint": ("joint", "joints"),
    "growth_jump": ("jump", "jumps"),
    "growth_uncertain": ("uncertain growth", "uncertain growths"),
}
_PRESSURES = ((1.0e6, "MPa"), (1.0e3, "kPa"), (1.0, "Pa"))
_TIMES = ((3600.0, "h"), (60.0, "min"))


def closing_lines(directory: Path) -> list[str]:
    """Give a line for each well, and one for all events; none of what is not there."""
    wells: dict[str, list[Mapping[str, str]]] = {}
    for row in _rows(directory / "wells.csv"):
        wells.setdefault(row["well"], []).append(row)
    thickness = _thickness(directory / "scene.nml")
    lines = [_well_line(name, rows, thickness) for name, rows in wells.items()]
    counts = Counter(row["kind"] for row in _rows(directory / "events.csv"))
    events = [
        f"{counts[kind]} {words[counts[kind] > 1]}"
        for kind, words in _EVENTS.items()
        if counts[kind]
    ]
    return [*lines, *(["events: " + ", ".join(events)] if events else [])]


def _rows(path: Path) -> Iterator[Mapping[str, str]]:
    if path.is_file():
        with path.open(newline="", encoding="utf-8") as file:
            yield from csv.DictReader(file)


def _thickness(scene: Path) -> float:
    """Thickness of the body [m], which the scene of every run has as a line."""
    text = scene.read_text(encoding="utf-8") if scene.is_file() else ""
    found = re.search(r"^  thickness = (\S+)", text, flags=re.MULTILINE)
    return float(found[1]) if found else 1.0


def _well_line(name: str, rows: list[Mapping[str, str]], thickness: float) -> str:
    highest = max(rows, key=lambda row: float(row["pressure_pa"]))
    last = rows[-1]
    volume = float(last["injected_m2"])
    what = "injected" if volume >= 0.0 else "produced"
    size = f"{abs(volume):.3g} m2" if thickness == 1.0 else f"{abs(volume) * thickness:.3g} m3"
    return (
        f"{name}: {what} {size}, {pressure_text(last['pressure_pa'])} at the end,"
        f" at most {pressure_text(highest['pressure_pa'])} at {time_text(highest['time_s'])}"
    )


def pressure_text(value: str | float, digits: int = 3) -> str:
    """A pressure as 0.91 MPa.

    >>> pressure_text(911234.0)
    '0.911 MPa'
    """
    number = float(value)
    size, unit = next(
        ((size, unit) for size, unit in _PRESSURES if abs(number) >= 0.1 * size), _PRESSURES[-1]
    )
    return f"{number / size:.{digits}g} {unit}"


def time_text(value: str | float) -> str:
    """A time as 170 s, 12.5 min or 27 h.

    >>> [time_text(170.0), time_text(97200.0)]
    ['170 s', '27 h']
    """
    number = float(value)
    size, unit = next(((s, u) for s, u in _TIMES if number >= 10.0 * s), (1.0, "s"))
    return f"{number / size:.3g} {unit}"
