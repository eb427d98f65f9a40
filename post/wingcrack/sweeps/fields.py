"""Strict reading of TOML tables: every key is known, of the right kind, and used."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.figures import text_files

TIME_LIMIT_S = 3600.0  # of a run that gives no limit of its own
REQUIRED: Any = object()


class Fields:
    """A TOML table whose keys are taken one by one; `done` refuses those left over."""

    def __init__(self, data: Any, place: str) -> None:
        if not isinstance(data, Mapping):
            raise CaseError(f"{place} must be a table")
        self.place = place
        self._left = dict(data)
        self._known: list[str] = []

    def has(self, key: str) -> bool:
        """Whether the key is given and not yet taken."""
        return key in self._left

    def take(self, key: str, default: Any = REQUIRED) -> Any:
        """Value of any kind."""
        self._known.append(key)
        if key not in self._left:
            if default is REQUIRED:
                raise CaseError(f"{self.place}: '{key}' is missing")
            return default
        return self._left.pop(key)

    def text(self, key: str, default: Any = REQUIRED) -> Any:
        """Text that is not empty."""
        return self._of_kind(key, default, str, "a text")

    def flag(self, key: str, default: bool = False) -> bool:
        """Truth value."""
        return bool(self._of_kind(key, default, bool, "true or false"))

    def number(self, key: str, default: Any = REQUIRED) -> Any:
        """Finite number, as float."""
        value = self.take(key, default)
        return value if value is default else as_number(value, f"{self.place}: '{key}'")

    def positive(self, key: str, default: Any = REQUIRED) -> Any:
        """Finite number above 0."""
        value = self.number(key, default)
        if value is not default and not value > 0.0:
            raise CaseError(f"{self.place}: '{key}' must be positive, not {value}")
        return value

    def choice(self, key: str, choices: Sequence[str], default: Any = REQUIRED) -> Any:
        """One of a fixed set of words."""
        value = self.text(key, default)
        if value is not default and value not in choices:
            raise CaseError(f"{self.place}: '{value}' is no {key}; there are: {', '.join(choices)}")
        return value

    def texts(self, key: str, default: Any = REQUIRED) -> Any:
        """List of texts, as a tuple."""
        value = self.take(key, default)
        if value is default:
            return value
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise CaseError(f"{self.place}: '{key}' must be a list of texts")
        return tuple(value)

    def numbers(self, key: str, default: Any = REQUIRED) -> Any:
        """List of finite numbers, as a tuple."""
        value = self.take(key, default)
        if value is default:
            return value
        if not isinstance(value, list) or not value:
            raise CaseError(f"{self.place}: '{key}' must be a list of numbers")
        return tuple(as_number(item, f"{self.place}: '{key}'") for item in value)

    def mapping(self, key: str) -> dict[str, Any]:
        """Table with free keys; empty if not given."""
        value = self.take(key, {})
        if not isinstance(value, Mapping):
            raise CaseError(f"{self.place}: '{key}' must be a table")
        return dict(value)

    def constants(self, key: str) -> dict[str, float]:
        """Table of names and numbers; empty if not given."""
        place = f"{self.place}: '{key}'"
        return {name: as_number(value, place) for name, value in self.mapping(key).items()}

    def tables(self, key: str) -> list[Any]:
        """List of tables; empty if not given."""
        value = self.take(key, [])
        if not isinstance(value, list):
            raise CaseError(f"{self.place}: '{key}' must be a list of tables")
        return value

    def done(self) -> None:
        """Refuse the keys that nobody took, and say what was perhaps meant."""
        for key in self._left:
            near = difflib.get_close_matches(key, self._known, n=1)
            hint = f"; did you mean '{near[0]}'?" if near else ""
            raise CaseError(f"{self.place}: '{key}' is unknown{hint}")

    def _of_kind(self, key: str, default: Any, kind: type, name: str) -> Any:
        value = self.take(key, default)
        if value is default:
            return value
        if not isinstance(value, kind) or value == "":
            raise CaseError(f"{self.place}: '{key}' must be {name}")
        return value


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file; a `CaseError` tells what is wrong with it."""
    try:
        return text_files.read_toml(path)
    except FileNotFoundError:
        raise CaseError(f"{path.name} is missing") from None
    except (OSError, ValueError) as reason:
        raise CaseError(f"{path.name}: {reason}") from None


def as_number(value: Any, place: str) -> float:
    """Finite number as float, or an error that tells the place."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise CaseError(f"{place} must be a finite number, not {value!r}")
    return float(value)
