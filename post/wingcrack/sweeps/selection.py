"""Selecting values from the CSV and JSON files of a run or a case."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Self, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from wingcrack.errors import CaseError, RunError
from wingcrack.figures.table import Table, read_table
from wingcrack.figures.text_files import read_json
from wingcrack.sweeps.expressions import FUNCTIONS, Array, evaluate, names_in
from wingcrack.sweeps.fields import (
    Entry,
    Text,
    Texts,
    as_number,
    choice,
    is_number,
    read_by,
    read_entry,
)
from wingcrack.sweeps.paths import NETWORK, network_table

T = TypeVar("T")
Mask = npt.NDArray[np.bool_]

TAKES: dict[str, Callable[[Array], float]] = {
    "first": lambda values: float(values[0]),
    "last": lambda values: float(values[-1]),
    "max": lambda values: float(np.max(values)),
    "min": lambda values: float(np.min(values)),
    "max_abs": lambda values: float(np.max(np.abs(values))),
    "span": lambda values: float(np.ptp(values)),
    "mean": lambda values: float(np.mean(values)),
    "sum": lambda values: float(np.sum(values)),
}

# A path into a JSON file; not the exponent of a number.
_KEY = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")

_OWN = {*FUNCTIONS, "pi"}  # names of arithmetic itself

CLOCKS = ("time_s", "load_factor")  # what stands for the time of a row
EQUAL = 1.0e-9  # relative difference up to which a number in a file is the one asked for


class Limits(Entry):
    """Both included; an open side is infinite."""

    min: float = -np.inf
    max: float = np.inf


Wanted: TypeAlias = Limits | float | str


def _condition(value: Any) -> Wanted:
    if isinstance(value, Mapping):
        return read_entry(Limits, value, "limits")
    return value if isinstance(value, str) else as_number(value, "it")


def _abscissa(value: Any) -> str | tuple[float, ...] | None:
    if isinstance(value, str) and value:
        return value
    if not isinstance(value, list) or not value or not all(map(is_number, value)):
        raise CaseError("'x' must be a text, or a list of finite numbers")
    return tuple(map(float, value))


Conditions: TypeAlias = dict[str, Annotated[Wanted, read_by(_condition, names_key=False)]]


class Selection(Entry):
    """What to read from a file; see docs/verification.md for each key."""

    file: Text
    column: Text | None = None
    columns: Texts = ()
    where: Conditions = Field(default_factory=dict)
    at: Conditions = Field(default_factory=dict)
    take: Annotated[str | None, choice(TAKES)] = None
    interpolate: dict[str, float] = Field(default_factory=dict)
    x: Annotated[str | tuple[float, ...] | None, read_by(_abscissa)] = None
    key: Text | None = None

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if self.key is not None:
            if self.model_fields_set & {*Selection.model_fields} - {"file", "key"}:
                raise ValueError("'key' excludes the other keys of a selection")
            return self
        several = bool(self.columns)
        if several == (self.column is not None):
            raise ValueError("either 'column' or 'columns' is needed")
        if len(self.interpolate) > 1:
            raise ValueError("'interpolate' takes one column")
        along = isinstance(self.x, str)
        if sum(map(bool, (self.at, self.take, self.interpolate, along))) > 1:
            raise ValueError("'at', 'take', 'interpolate' and 'x' exclude each other")
        if several and not self.at:
            raise ValueError("'columns' needs 'at': one row")
        if (along and several) or (self.x is not None and not along and not several):
            raise ValueError("'x' is a column, or of 'columns' a list of numbers")
        if isinstance(self.x, tuple) and len(self.x) != len(self.columns):
            raise ValueError(f"{len(self.x)} values of x for {len(self.columns)} columns")
        return self

    @property
    def all_columns(self) -> tuple[str, ...]:
        """The columns that are read."""
        return self.columns or ((self.column,) if self.column else ())

    @property
    def x_column(self) -> str | None:
        """The column of the abscissa."""
        return self.x if isinstance(self.x, str) else None

    @property
    def conditions(self) -> list[tuple[str, Wanted]]:
        """All that holds in the rows that are read."""
        return [*self.where.items(), *self.at.items()]


@dataclass(frozen=True)
class Values:
    """Selected values, all finite."""

    values: Array  # (n,) in the unit of the check; n = 1 unless it is a profile
    x: Array | None  # (n,) abscissa of a profile, increasing
    profile: bool  # whether there may be several values


def names_of(
    selection: Selection, is_column: Callable[[str], bool] = lambda name: False
) -> set[str]:
    """Names that a selection needs: columns or keys of its file, and constants in arithmetic.

    Those that `is_column` knows are left out, also where they could be taken for arithmetic.
    """
    if selection.key is not None:
        found = set(_KEY.findall(selection.key)) - _OWN
        return {name for name in found if not is_column(name)}
    x = [selection.x_column] if selection.x_column else []
    texts = [*selection.all_columns, *x, *selection.interpolate]
    found = {name for text in texts if not is_column(text) for name in names_in(text) - _OWN}
    found |= {name for name, _ in selection.conditions}
    return {name for name in found if not is_column(name)}


def select(
    selection: Selection, folder: Path, constants: Mapping[str, float], as_path: bool = False
) -> Values:
    """Read the selected values from a file in the folder.

    With `as_path`, a profile keeps the order of the file's rows: a curve that may turn back. Raises
    `CaseError` if the file, a column or the row is not there, or if a value is no finite number.
    """
    if selection.key is not None:
        return Values(np.array([_json_number(selection, folder)]), None, False)
    table = _table(folder / selection.file)
    kept = _rows(table, selection)
    if not kept.any():
        raise CaseError(f"{selection.file}: no row where {_spoken(selection)}")
    if selection.at and np.count_nonzero(kept) > 1:
        raise CaseError(
            f"{selection.file}: {np.count_nonzero(kept)} rows where {_spoken(selection)}, "
            "and 'at' wants one"
        )
    columns = [_column(table, name, kept, constants) for name in selection.all_columns]
    if isinstance(selection.x, tuple) or len(columns) > 1:
        x = np.array(selection.x) if selection.x else None
        return _ordered(np.concatenate(columns), x, selection)
    values = columns[0]
    if selection.take is not None:
        return Values(np.array([TAKES[selection.take](values)]), None, False)
    for name, wanted in selection.interpolate.items():
        profile = _ordered(values, _column(table, name, kept, constants), selection)
        return Values(interpolated(profile, np.array([wanted]), selection.file), None, False)
    if selection.at:
        return Values(values, None, False)
    if selection.x_column is None:
        return Values(values, None, True)
    x = _column(table, selection.x_column, kept, constants)
    return Values(values, x, True) if as_path else _ordered(values, x, selection)


def interpolated(profile: Values, x: Array, name: str) -> Array:
    """Linear interpolation of a profile, never beyond its ends.

    x: (m,) in the unit of the profile's abscissa.  Returns (m,) values.
    """
    if profile.x is None:
        raise CaseError(f"{name}: 'x' is needed to interpolate")
    slack = EQUAL * (profile.x[-1] - profile.x[0])
    if not (np.min(x) >= profile.x[0] - slack and np.max(x) <= profile.x[-1] + slack):
        raise CaseError(
            f"{name}: x from {np.min(x):g} to {np.max(x):g} is wanted, "
            f"and there is {profile.x[0]:g} to {profile.x[-1]:g}"
        )
    return np.interp(x, profile.x, profile.values)


def _ordered(values: Array, x: Array | None, selection: Selection) -> Values:
    if x is None:
        return Values(values, None, True)
    order = np.argsort(x, kind="stable")
    x = x[order]
    if np.any(np.diff(x) <= 0.0):
        raise CaseError(f"{selection.file}: a value of x stands twice; 'where' is too wide")
    return Values(values[order], x, True)


def _rows(table: Table, selection: Selection) -> Mask:
    kept = np.ones(table.rows, dtype=np.bool_)
    for column, wanted in selection.conditions:
        kept &= _matches(table, column, wanted)
    return kept


def _matches(table: Table, column: str, wanted: Wanted) -> Mask:
    if isinstance(wanted, str) and not (column in CLOCKS and wanted in ("first", "last")):
        return _guarded(lambda: np.asarray(table.text(column) == wanted, dtype=np.bool_))
    numbers = _numbers(table, column)
    if isinstance(wanted, Limits):
        return np.asarray((numbers >= wanted.min) & (numbers <= wanted.max), dtype=np.bool_)
    if isinstance(wanted, str):
        if table.rows == 0:
            raise CaseError(f"{table.path.name}: there is no row")
        wanted = float(np.min(numbers) if wanted == "first" else np.max(numbers))
    return np.asarray(np.abs(numbers - wanted) <= EQUAL * abs(wanted), dtype=np.bool_)


def _column(table: Table, text: str, kept: Mask, constants: Mapping[str, float]) -> Array:
    if table.has(text):
        values = _numbers(table, text)[kept]
    else:
        used = names_in(text) - set(constants) - _OWN
        columns: dict[str, Array | float] = dict(constants)
        columns |= {name: _numbers(table, name)[kept] for name in used}
        values = np.broadcast_to(evaluate(text, columns), (int(np.count_nonzero(kept)),))
    if not np.all(np.isfinite(values)):
        raise CaseError(f"{table.path.name}: '{text}' is NaN or infinite in a row that is used")
    return np.array(values, dtype=np.float64)


def _numbers(table: Table, name: str) -> Array:
    return _guarded(lambda: table.number(name))


def _json_number(selection: Selection, folder: Path) -> float:
    """Value of the key, or of the arithmetic that it is: names are paths into the file."""
    try:
        content: Any = read_json(folder / selection.file)
    except FileNotFoundError:
        raise CaseError(f"{selection.file}: the file is missing") from None
    except ValueError as reason:
        raise CaseError(f"{selection.file}: this is no JSON ({reason})") from None
    values: dict[str, float] = {}

    def named(path: re.Match[str]) -> str:
        if path.group() in _OWN:
            return path.group()
        name = path.group().replace(".", "__")
        values[name] = _json_value(content, path.group(), selection.file)
        return name

    key = str(selection.key)
    value = float(evaluate(_KEY.sub(named, key), values))
    return as_number(value, f"{selection.file}: '{key}'")


def _json_value(content: Any, path: str, file: str) -> float:
    name = f"{file}: '{path}'"
    try:
        for part in path.split("."):
            content = content[part]
    except (KeyError, TypeError):
        raise CaseError(f"{name} is missing") from None
    return as_number(content, name)


def _table(path: Path) -> Table:
    try:
        return _read(path, path.stat().st_mtime_ns)
    except FileNotFoundError:
        raise CaseError(f"{path.name}: the file is missing") from None


@lru_cache(maxsize=64)
def _read(path: Path, _changed: int) -> Table:
    if path.name == NETWORK:
        return network_table(path)
    table = _guarded(lambda: read_table(path))
    with path.open("rb") as file:
        file.seek(-1, 2)
        if file.read(1) != b"\n":
            raise CaseError(f"{path.name}: the last line is cut off")
    return table


def _guarded(action: Callable[[], T]) -> T:
    try:
        return action()
    except RunError as reason:
        message = str(reason)
        raise CaseError(message[message.rfind("/") + 1 :].rstrip(".")) from None


def _spoken(selection: Selection) -> str:
    parts = []
    for column, wanted in selection.conditions:
        if isinstance(wanted, Limits):
            parts.append(f"{wanted.min:g} <= {column} <= {wanted.max:g}")
        else:
            parts.append(f"{column} = {wanted}")
    return " and ".join(parts) or "there is any"
