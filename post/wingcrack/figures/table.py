"""CSV tables of a run: named columns with the unit in the name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from wingcrack.errors import RunError
from wingcrack.figures.text_files import csv_rows, read_text

FloatArray = npt.NDArray[np.float64]
TextArray = npt.NDArray[np.str_]
BoolArray = npt.NDArray[np.bool_]
Shared = TypeVar("Shared", bound=npt.NDArray[Any])


@dataclass(frozen=True)
class Table:
    """A CSV file by columns."""

    path: Path  # the file, for error messages
    cells: dict[str, Sequence[str]]  # the text of every column, in the order of the rows
    rows: int  # number of rows below the header
    _texts: dict[str, TextArray] = field(default_factory=dict, init=False, repr=False)
    _numbers: dict[str, FloatArray] = field(default_factory=dict, init=False, repr=False)

    def has(self, *names: str) -> bool:
        """Whether all the named columns are there."""
        return all(name in self.cells for name in names)

    def text(self, name: str) -> TextArray:
        """Column as text, not to be changed; a missing one is a `RunError` that names it."""
        if name not in self.cells:
            raise RunError(
                f"{self.path}: the column '{name}' is missing (there are: {', '.join(self.cells)})."
            )
        if name not in self._texts:
            self._texts[name] = _shared(np.asarray(self.cells[name], dtype=np.str_))
        return self._texts[name]

    def moments(self) -> FloatArray:
        """Time of each row [s], or in a mechanics-only run its load factor."""
        return self.number("load_factor" if self.has("load_factor") else "time_s")

    def number(self, name: str) -> FloatArray:
        """Column as numbers in the unit of its name, not to be changed; an empty cell is nan."""
        if name in self._numbers:
            return self._numbers[name]
        text = self.text(name)
        try:
            numbers = np.where(text == "", "nan", text).astype(np.float64)
            return self._numbers.setdefault(name, _shared(numbers))
        except ValueError:
            for row, value in enumerate(text):
                _check_number(self.path, name, row, str(value))
            raise


def _shared(values: Shared) -> Shared:
    """Values that all readers have in common: read from their text once."""
    values.setflags(write=False)
    return values


def _check_number(path: Path, name: str, row: int, value: str) -> None:
    try:
        float(value or "nan")
    except ValueError:
        # the header is line 1, so row 0 stands on line 2
        raise RunError(f"{path}, line {row + 2}: '{value}' in column '{name}' is no number.") from (
            None
        )


def read_table(path: Path) -> Table:
    """Read a CSV file with one header line.

    A last line that is cut off (no line end, too few values) belongs to a run that is still being
    written and is left out. Raises `RunError` if the file is missing, not text, without header, or
    if a line has the wrong number of values.
    """
    try:
        content = read_text(path)
    except FileNotFoundError:
        raise RunError(f"{path}: the file is missing.") from None
    except (OSError, ValueError) as reason:
        raise RunError(f"{path}: the file cannot be read ({reason}).") from None
    lines = csv_rows(StringIO(content, newline=""))
    if not lines or not lines[0]:
        raise RunError(f"{path}: the file is empty, a header line was expected.")
    names, values = lines[0], lines[1:]
    if len(set(names)) != len(names):
        raise RunError(f"{path}: a column name stands twice in the header.")
    if values and len(values[-1]) < len(names) and not content.endswith("\n"):
        values.pop()
    for row, cells in enumerate(values):
        if len(cells) != len(names):
            raise RunError(
                f"{path}, line {row + 2}: {len(cells)} values where the header has {len(names)}."
            )
    columns = list(zip(*values, strict=True)) if values else [()] * len(names)
    return Table(path, dict(zip(names, columns, strict=True)), len(values))
