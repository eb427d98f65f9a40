"""Groups of a scene file as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

Value: TypeAlias = str | bool | int | float | Sequence[float]

_WIDTH = 100


def value_text(value: Value) -> str:
    """Write a value so that it reads back as it is.

    Examples
    --------
    >>> value_text("it's"), value_text(True), value_text([1.0, 2.5e-3])
    ("'it''s'", '.true.', '1.0, 0.0025')
    """
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(float(value))
    return ", ".join(repr(float(number)) for number in value)


def group_text(name: str, values: Mapping[str, Value]) -> str:
    """Write one group, on one line if it fits, else with a line for each name.

    Examples
    --------
    >>> print(group_text("time", {"end": 60.0, "step": 1.0}), end="")
    &time end = 60.0, step = 1.0 /
    """
    entries = [f"{key} = {value_text(value)}" for key, value in values.items()]
    line = f"&{name} {', '.join(entries)} /\n"
    if len(line) <= _WIDTH:
        return line
    lines = [piece for entry in entries for piece in _wrapped(f"  {entry}")]
    return "\n".join([f"&{name}", *lines, "/", ""])


def _wrapped(entry: str) -> list[str]:
    """Break a long list of numbers after commas; texts, which may hold commas, stay whole."""
    if len(entry) <= _WIDTH or "'" in entry:
        return [entry]
    lines, line = [], ""
    for piece in entry.split(", "):
        if line and len(line) + len(piece) + 3 > _WIDTH:
            lines.append(f"{line},")
            line = f"      {piece}"
        else:
            line = f"{line}, {piece}" if line else piece
    return [*lines, line]
