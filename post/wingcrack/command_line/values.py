"""Readers of the values of options: each gives a value, or says in a ValueError why not."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from wingcrack.runs.units import FARTHEST

_WIDEST = 20.0  # SIGMA
_LENGTHS = {"constant": (1, 1), "power": (3, 3), "lognormal": (2, 4), "exponential": (1, 3)}
_ANGLES = {"uniform": (0, 2), "constant": (1, 1), "vonmises": (2, 2)}


def whole(least: int, most: int | None = None) -> Callable[[str], int]:
    """Whole numbers within bounds."""

    def read(text: str) -> int:
        number = int(text) if text.isascii() and text.isdecimal() else -1
        if number < least or (most is not None and number > most):
            bounds = f"from {least} on" if most is None else f"from {least} to {most}"
            raise ValueError(f"'{text}' is no whole number {bounds}")
        return number

    return read


def each_of(names: Sequence[str]) -> Callable[[str], tuple[str, ...]]:
    """Names out of several, with commas."""

    def read(text: str) -> tuple[str, ...]:
        chosen = tuple(part.strip() for part in text.split(","))
        for part in chosen:
            if part not in names:
                raise ValueError(f"'{part}' is none of {', '.join(names)}")
        return chosen

    return read


def place(text: str) -> str:
    """A file or folder as it is given."""
    return text


def absolute(text: str) -> Path:
    """A place that stays the same for programs that run in folders of their own."""
    return Path(text).resolve()


def number(text: str) -> float:
    """A finite number."""
    try:
        found = float(text)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise ValueError(f"'{text}' is no number")
    return found


def positive(text: str) -> float:
    """A number above 0."""
    found = number(text)
    if found <= 0.0:
        raise ValueError(f"'{text}' must be greater than 0")
    return found


def length(text: str) -> float:
    """A length [m]."""
    found = positive(text)
    if found > FARTHEST:
        raise ValueError(f"'{text}' must be at most {FARTHEST:.0e} m")
    return found


def angle(text: str) -> float:
    """The least angle between fractures [degrees]."""
    found = number(text)
    if not 3.0 <= found <= 45.0:
        raise ValueError(f"'{text}' must be from 3 to 45 degrees")
    return found


def origin(text: str) -> str:
    """Where a map's (0, 0) is."""
    if text not in ("centre", "corner"):
        _places(text, 2, "X,Y, centre or corner")
    return text


def box(text: str) -> tuple[float, ...]:
    """Corners of a rectangle [m]."""
    x0, y0, x1, y1 = _places(text, 4, "X0,Y0,X1,Y1")
    if min(x1 - x0, y1 - y0) < 1.0 / FARTHEST:
        raise ValueError(f"'{text}' must be X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1")
    return x0, y0, x1, y1


def _places(text: str, count: int, what: str) -> tuple[float, ...]:
    """So many coordinates [m]."""
    words = text.split(",")
    numbers = tuple(map(number, words)) if len(words) == count else (math.inf,)
    if max(map(abs, numbers)) > FARTHEST:
        raise ValueError(f"'{text}' must be {what}, none beyond {FARTHEST:.0e} m")
    return numbers


def density(text: str) -> tuple[str, float]:
    """How many fractures: per area, or their length per area."""
    name, mark, value = text.partition("=")
    if not mark or name not in ("p20", "p21"):
        raise ValueError(f"'{text}' must be p20=N or p21=L")
    return name, positive(value)


def lengths(text: str) -> tuple[str, tuple[float, ...]]:
    """A law of lengths [m]."""
    name, numbers = _law(text, _LENGTHS)
    judged = numbers[1:] if name == "power" else (*numbers[:1], *numbers[-2:])
    if name == "exponential" and len(numbers) == 3:
        judged = (numbers[0], numbers[2])  # its least length may be 0
    if name == "lognormal" and len(numbers) == 2:
        judged = numbers
    if min(judged) <= 0.0 or (name == "lognormal" and numbers[1] <= 0.0):
        raise ValueError(f"'{text}': lengths must be greater than 0")
    if name == "lognormal" and numbers[1] > _WIDEST:
        raise ValueError(f"'{text}': SIGMA must be at most {_WIDEST:g}")
    if max(judged) > FARTHEST:
        raise ValueError(f"'{text}': lengths must be at most {FARTHEST:.0e} m")
    if len(numbers) > 2 and not 0.0 <= numbers[-2] < numbers[-1]:
        raise ValueError(f"'{text}': MIN must be less than MAX")
    return name, numbers


def orientations(text: str) -> tuple[str, tuple[float, ...]]:
    """A law of orientations [degrees]."""
    name, numbers = _law(text, _ANGLES)
    if name == "vonmises" and numbers[1] < 0.0:
        raise ValueError(f"'{text}': KAPPA must not be negative")
    if len(numbers) == 2 and name == "uniform" and not numbers[0] < numbers[1]:
        raise ValueError(f"'{text}': FROM must be less than TO")
    return name, numbers


def _law(text: str, known: dict[str, tuple[int, int]]) -> tuple[str, tuple[float, ...]]:
    """Name and numbers of a law."""
    name, mark, rest = text.partition(":")
    if name not in known:
        raise ValueError(f"'{text}' is none of {', '.join(known)}")
    numbers = tuple(number(word) for word in rest.split(",")) if mark else ()
    least, most = known[name]
    if not least <= len(numbers) <= most or (most - least == 2 and len(numbers) == least + 1):
        raise ValueError(f"'{text}' has {len(numbers)} numbers after its name")
    return name, numbers
