"""Tables of TOML files as pydantic models: each key is declared once, with its kind."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationError,
    ValidationInfo,
)

from wingcrack.errors import CaseError
from wingcrack.figures import text_files

TIME_LIMIT_S = 3600.0  # of a run that gives no limit of its own


class Entry(BaseModel):
    """A table: every key is known and of the right kind, every number finite."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class ValueOfKeyError(ValueError):
    """What is wrong with a value; the sentence names its key."""


Kind = TypeVar("Kind", bound=Entry)
Table = dict[str, Any]
Text = Annotated[str, Field(min_length=1)]
Positive = Annotated[float, Field(gt=0.0)]


def is_number(value: Any) -> bool:
    """Whether a value is a finite number."""
    is_one = isinstance(value, int | float) and not isinstance(value, bool)
    return is_one and math.isfinite(value)


def as_number(value: Any, place: str) -> float:
    """Finite number as float, or an error that names the place."""
    if not is_number(value):
        raise CaseError(f"{place} must be a finite number, not {value!r}")
    return float(value)


def _list_of(what: str, is_one: Callable[[Any], bool], least: int = 0) -> BeforeValidator:
    def judge(value: Any, info: ValidationInfo) -> Any:
        if value is None:
            return None
        if not isinstance(value, list | tuple) or len(value) < least or not all(map(is_one, value)):
            raise ValueOfKeyError(f"'{info.field_name}' must be a list of {what}")
        return tuple(value)

    return BeforeValidator(judge)


def _numbers(value: Any, info: ValidationInfo) -> Any:
    if value is None:
        return None
    if not isinstance(value, list | tuple) or not value:
        raise ValueOfKeyError(f"'{info.field_name}' must be a list of numbers")
    try:
        return tuple(as_number(item, f"'{info.field_name}'") for item in value)
    except CaseError as reason:
        raise ValueOfKeyError(str(reason)) from None


Texts = Annotated[tuple[str, ...], _list_of("texts", lambda item: isinstance(item, str))]
Numbers = Annotated[tuple[float, ...], BeforeValidator(_numbers)]
Values = Annotated[tuple[Any, ...], _list_of("at least one value", lambda _: True, 1)]
Tables = Annotated[tuple[Any, ...], _list_of("tables", lambda item: isinstance(item, Mapping))]


def read_by(read: Callable[[Any], Any], *, names_key: bool = True) -> PlainValidator:
    """What a function makes of a value; its `CaseError`, which may name the key, is the error."""

    def judge(value: Any) -> Any:
        try:
            return read(value)
        except CaseError as reason:
            kind = ValueOfKeyError if names_key else ValueError
            raise kind(str(reason)) from None

    return PlainValidator(judge)


def choice(words: Iterable[str]) -> AfterValidator:
    """One of some words."""
    known = tuple(words)

    def judge(value: str | None, info: ValidationInfo) -> str | None:
        if value is None or value in known:
            return value
        there = ", ".join(known)
        raise ValueOfKeyError(f"'{value}' is no {info.field_name}; there are: {there}")

    return AfterValidator(judge)


def whole(least: int) -> BeforeValidator:
    """Whole number from a least one on."""

    def judge(value: Any, info: ValidationInfo) -> Any:
        if value is None or (type(value) is int and value >= least):
            return value
        raise ValueOfKeyError(f"'{info.field_name}' must be a whole number from {least} on")

    return BeforeValidator(judge)


def read_entry(kind: type[Kind], data: Any, place: str) -> Kind:
    """Table as a model; a `CaseError` names the place, the key and what would be right."""
    try:
        return kind.model_validate(data)
    except ValidationError as wrong:
        error = wrong.errors()[0]
        raise CaseError(_sentence(error, kind, place)) from None


def _sentence(error: Any, kind: type[Entry], place: str) -> str:
    name, value = error["type"], error["input"]
    parts = [str(part + 1 if isinstance(part, int) else part) for part in error["loc"]]
    reason = error.get("ctx", {}).get("error")
    if isinstance(reason, ValueOfKeyError):
        parts = parts[:-1]
    if reason is not None or not parts:
        said = str(reason) if reason is not None else "it must be a table"
        return f"{': '.join([place, *parts])}: {said}"
    where, key = ": ".join([place, *parts[:-1]]), parts[-1]
    if name == "missing":
        return f"{where}: '{key}' is missing"
    if name == "extra_forbidden":
        near = difflib.get_close_matches(key, kind.model_fields, n=1) if len(parts) == 1 else []
        return f"{where}: '{key}' is unknown" + (f"; did you mean '{near[0]}'?" if near else "")
    limits = error.get("ctx", {})
    wanted = {
        "greater_than": f"positive, not {value}",
        "less_than": f"less than {limits.get('lt')}, not {value}",
        "float_type": f"a finite number, not {value!r}",
        "finite_number": f"a finite number, not {value!r}",
        "bool_type": "true or false",
        "dict_type": "a table",
        "model_type": "a table",
        "tuple_type": "a list of tables",
        "too_short": "a table that is not empty",
    }
    return f"{where}: '{key}' must be {wanted.get(name, 'a text')}"


def read_toml(path: Path) -> Table:
    """Read a TOML file; a `CaseError` states what is wrong with it."""
    try:
        return text_files.read_toml(path)
    except FileNotFoundError:
        raise CaseError(f"{path.name} is missing") from None
    except (OSError, ValueError) as reason:
        raise CaseError(f"{path.name}: {reason}") from None


def as_tables(data: Any, kinds: Iterable[str], place: str) -> dict[str, Table]:
    """Tables by kind, empty where not given; no other kinds."""
    if not isinstance(data, Mapping):
        raise CaseError(f"'{place}' must be a table")
    for kind, table in data.items():
        if kind not in kinds:
            raise CaseError(f"{place}: '{kind}' is unknown; there are: {', '.join(kinds)}")
        if not isinstance(table, Mapping):
            raise CaseError(f"{place}: '{kind}' must be a table")
    return {kind: dict(data.get(kind, {})) for kind in kinds}
