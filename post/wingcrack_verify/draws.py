"""Trials drawn at random: a Latin hypercube over ranges, of a fixed seed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from wingcrack.errors import CaseError
from wingcrack.sweeps.fields import Fields
from wingcrack.sweeps.sweep import Table, read_tables


def read_draw(data: Any, place: str) -> list[tuple[str, Table]]:
    """Tables of trials that a ``[[draw]]`` stands for, each with its place for errors.

    The names of its ``ranges`` are used in templates, as those of an ``over`` (`sweep`); `number`
    is that of the trial, from 1. So that each range is covered evenly however few the trials, it is
    cut into as many equal parts as there are trials, and each part is drawn from once (McKay,
    Beckman and Conover 1979). With `quick` that many of them are part of ``--quick``.
    """
    fields = Fields(data, place)
    count, seed = (_whole(fields, key) for key in ("count", "seed"))
    quick = _whole(fields, "quick") if fields.has("quick") else count
    if quick > count:
        raise CaseError(f"{place}: 'quick' must be at most 'count', {count}")
    ranges = fields.mapping("ranges")
    trial = fields.mapping("trial")
    fields.done()
    if not ranges:
        raise CaseError(f"{place}: 'ranges' is missing")
    random = np.random.default_rng(seed)
    points: Table = {"number": list(range(1, count + 1))}
    for name, entry in ranges.items():
        shares = (random.permutation(count) + random.random(count)) / count
        points[name] = _places(entry, shares.tolist(), f"{place}: ranges.{name}")
    whole = {**trial, "over": {"place": points}}
    tables = read_tables(Fields({"trial": [whole]}, place), "trial")
    return [
        (place, {"quick": number <= quick, **table})
        for number, (_, table) in enumerate(tables, start=1)
    ]


def _whole(fields: Fields, key: str) -> int:
    value = fields.number(key)
    if value != int(value) or value < 1:
        raise CaseError(f"{fields.place}: '{key}' must be a whole number from 1 on")
    return int(value)


def _places(data: Any, shares: list[float], place: str) -> list[Any]:
    """Values at shares of a range: of a list, or between two numbers."""
    fields = Fields(data, place)
    if fields.has("of"):
        values = fields.take("of")
        fields.done()
        if not isinstance(values, list) or not values:
            raise CaseError(f"{place}: 'of' must be a list of at least one value")
        return [values[int(share * len(values))] for share in shares]
    first, last = fields.number("from"), fields.number("to")
    by_decades = fields.flag("log")
    fields.done()
    if by_decades and not min(first, last) > 0.0:
        raise CaseError(f"{place}: 'log' needs numbers above 0")
    if by_decades:
        return [first * math.exp(share * math.log(last / first)) for share in shares]
    return [first + share * (last - first) for share in shares]
