"""Tables that stand for several: ``over``, its templates, and ``[defaults]`` of a file.

This module converts tables into tables; the keys are defined in `case`.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Mapping, Sequence, Set
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.sweeps.expressions import FUNCTIONS, evaluate, names_in
from wingcrack.sweeps.fields import Table, as_tables
from wingcrack.sweeps.likes import Likes, joined
from wingcrack.sweeps.selection import Selection

# Names of a point that are keys of a line of a figure are given to it; others are for templates.
_LINE_KEYS = {*Selection.model_fields, "label", "run", "points"}

# A name, or arithmetic of names, in braces; perhaps with a format, as in Python.
_PLACEHOLDER = re.compile(r"\{([^{}:]+)(?::([^{}]*))?\}")


class Defaults:
    """Keys of ``[defaults.KIND]``, and then of those around it; `done` refuses what nobody needs.

    Runs and sweeps have theirs in ``[defaults.run]``.
    """

    def __init__(self, data: Any, kinds: Sequence[str], outer: Defaults | None = None) -> None:
        self._tables = as_tables(data, kinds, "defaults")
        self._left = {kind: set(table) for kind, table in self._tables.items()}
        self._outer = outer

    def complete(self, data: Mapping[str, Any], kind: str) -> Table:
        """Table with what it does not give itself, tables joined item by item."""
        kept = "run" if kind == "sweep" else kind
        defaults = self._tables.get(kept, {})
        whole = joined(defaults, data)
        needed = {name for name in defaults if name not in data or whole[name] != data[name]}
        self._left.get(kept, set()).difference_update(needed)
        return whole if self._outer is None else self._outer.complete(whole, kind)

    def done(self) -> None:
        """Refuse a default that every table overrides, or that no table is there for."""
        for kind, names in self._left.items():
            for name in sorted(names):
                raise CaseError(f"defaults.{kind}: no {kind} needs '{name}'")


def read_tables(
    data: Any,
    kind: str,
    keys: Set[str],
    defaults: Defaults | None = None,
    likes: Likes | None = None,
) -> list[tuple[str, Table]]:
    """All tables of a kind, expanded, each with its place for errors.

    Raises `CaseError` as `_expand`; if a run has an ``over``, or a sweep has none; and if one is
    like another that is not there.
    """
    found = []
    for index, item in enumerate(data, start=1):
        place = f"{kind} {index}"
        whole = item if likes is None else likes.complete(item, kind, place)
        if kind in ("run", "sweep") and (kind == "sweep") != ("over" in whole):
            raise CaseError(f"{place}: a [[sweep]] needs 'over', and a [[run]] has none")
        whole = whole if defaults is None else defaults.complete(whole, kind)
        found += [(place, table) for table in _expand(whole, place, keys)]
    return found


def _expand(
    data: Mapping[str, Any], place: str, keys: Set[str], outer: _Filler | None = None
) -> list[Table]:
    """Tables that a table stands for: one per point of its ``over``, or itself without it.

    Raises `CaseError` if ``over`` gives nothing, or a name twice, or one that nobody uses, or if a
    template wants what the point does not have.

    `data`: with templates: texts with names of the point in braces. `place`: where it stands, for
    errors. `keys`: names of a point that become keys of the tables. `outer`: that of the table that
    this one stands in: its names can be used too.
    """
    template = {name: value for name, value in data.items() if name != "over"}
    points = grid_points(data["over"], f"{place}: over") if "over" in data else [{}]
    names = dict.fromkeys(itertools.chain.from_iterable(points))
    around = {} if outer is None else outer.point
    used: set[str] = set() if outer is None else outer.used
    for name in names:
        if name in around:
            raise CaseError(f"{place}: over: '{name}' is given around it already")
    found = []
    for point in points:
        given = {name: value for name, value in point.items() if name in keys}
        filler = _Filler({**around, **point}, used, place)
        found.append(filler.filled(joined(template, given)))
    for name in names:
        if name not in keys and name not in used:
            raise CaseError(f"{place}: over: nothing uses '{name}'")
    return found


def filled(
    table: Mapping[str, Any], point: Mapping[str, Any], place: str
) -> tuple[Table, set[str]]:
    """Table with the values of a point in its templates, and the names that these used.

    Raises `CaseError` if a template wants what the point does not have.
    """
    used: set[str] = set()
    return _Filler(dict(point), used, place).filled(table), used


def grid_points(over: Any, place: str, most: float = math.inf) -> list[Table]:
    """All combinations of the axes; the last axis changes first.

    Raises `CaseError` if an axis gives nothing, or two give the same name, or there would be more
    than `most`.
    """
    if not isinstance(over, Mapping) or not over:
        raise CaseError(f"{place} must be a table of lists")
    axes = [_axis(name, values, f"{place}.{name}") for name, values in over.items()]
    if (count := math.prod(map(len, axes))) > most:
        raise CaseError(f"{place}: {count} runs are more than {most}")
    return [_united(parts, place) for parts in itertools.product(*axes)]


def _axis(name: str, values: Any, place: str) -> list[Table]:
    """Places along an axis: of a list of values or tables, or of a table of lists."""
    if isinstance(values, Mapping):
        columns = {column: _list(given, f"{place}.{column}") for column, given in values.items()}
        lengths = {column: len(given) for column, given in columns.items()}
        if len(set(lengths.values())) != 1:
            told = ", ".join(f"{column} has {length}" for column, length in lengths.items())
            raise CaseError(f"{place}: the lists must be equally long ({told or 'there is none'})")
        return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    items = _list(values, place)
    return [dict(item) if isinstance(item, Mapping) else {name: item} for item in items]


def _list(values: Any, place: str) -> list[Any]:
    if not isinstance(values, list) or not values:
        raise CaseError(f"{place} must be a list of at least one value")
    return values


def _united(parts: tuple[Table, ...], place: str) -> Table:
    """One point of places on all axes; no name may be given twice."""
    point: Table = {}
    for part in parts:
        for name, value in part.items():
            known = point.get(name)
            if name not in point:
                point[name] = value
            elif isinstance(known, Mapping) and isinstance(value, Mapping):
                point[name] = _united((dict(known), dict(value)), f"{place}: {name}")
            else:
                raise CaseError(f"{place}: two axes give '{name}'")
    return point


class _Filler:
    """Puts the values of one point into templates, and notes which names were used."""

    def __init__(self, point: Mapping[str, Any], used: set[str], place: str) -> None:
        self.point = point
        self.used = used
        self.place = place
        self.numbers = {name: float(value) for name, value in point.items() if _is_number(value)}

    def filled(self, table: Mapping[str, Any]) -> Table:
        """Table with all its texts filled in, in lists and tables of it too."""
        return {name: self._value(value) for name, value in table.items()}

    def _value(self, value: Any) -> Any:
        if isinstance(value, str):
            return self._text(value)
        if isinstance(value, Mapping):
            return self.filled(value)
        if isinstance(value, list):
            filled: list[Any] = []
            for item in value:
                if isinstance(item, Mapping) and "over" in item:
                    filled += _expand(item, f"{self.place}: a line", _LINE_KEYS, self)
                else:
                    filled.append(self._value(item))
            return filled
        return value

    def _text(self, text: str) -> Any:
        """Text with its placeholders filled in; a placeholder alone keeps the kind of its value."""
        if any(brace in _PLACEHOLDER.sub("", text) for brace in "{}"):
            raise CaseError(f"{self.place}: a brace in '{text}' has no partner, or nothing in it")
        alone = _PLACEHOLDER.fullmatch(text)
        if alone and alone.group(2) is None:
            return self._named(alone.group(1))
        return _PLACEHOLDER.sub(lambda found: self._written(found.group(1), found.group(2)), text)

    def _named(self, expression: str) -> Any:
        """Value of a name, or of arithmetic with names."""
        name = expression.strip()
        if name in self.point:
            self.used.add(name)
            return self.point[name]
        try:
            for used in names_in(expression) - FUNCTIONS.keys() - {"pi"}:
                self.used.add(used)
                if used not in self.point:
                    there = f"there are: {', '.join(self.point) or 'none'}"
                    raise CaseError(f"'{used}' in '{{{expression}}}' is no name here ({there})")
                if used not in self.numbers:
                    raise CaseError(f"'{used}' in '{{{expression}}}' is no number")
            value = float(evaluate(expression, self.numbers))
        except CaseError as reason:
            raise CaseError(f"{self.place}: {reason}") from None
        if not math.isfinite(value):
            raise CaseError(f"{self.place}: '{expression}' is {value}")
        return value

    def _written(self, expression: str, form: str | None) -> str:
        value = self._named(expression)
        if not isinstance(value, str) and not _is_number(value):
            raise CaseError(f"{self.place}: '{expression}' is no text and no number")
        try:
            if re.search(r"\d{4}", form or ""):  # of so many characters
                raise ValueError
            return format(value, form or "")
        except ValueError:
            raise CaseError(f"{self.place}: '{form}' is no format for '{expression}'") from None


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
