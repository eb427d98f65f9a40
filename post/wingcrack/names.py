"""The table of names: what scenes can say, what files of a run hold, limits and checks."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

NAMES = Path(__file__).with_name("names.json")  # what `wingcrack-solver --describe json` prints


@cache
def table() -> dict[str, Any]:
    """Lists of rows: ``groups``, ``files``, ``words``, ``limits``, ``checks``; and ``version``."""
    found: dict[str, Any] = json.loads(NAMES.read_text(encoding="utf-8"))
    return found


@cache
def columns() -> dict[str, dict[str, dict[str, str]]]:
    """Rows of the columns, keys or fields of each file of a run, by their names."""
    return {
        file["name"]: {row["name"]: row for row in file["columns"]} for file in table()["files"]
    }


def error_column(file: str, column: str) -> str | None:
    """Name of the column of the same file with the estimated error of a column.

    `None` if no error is stated, or if it is in another file. The names of probes are kept.

    >>> error_column("history.csv", "max_slip_m")
    'max_slip_error_m'
    >>> error_column("probes.csv", "deep_p_pa")
    'deep_p_error_pa'
    """
    for name, row in columns().get(file, {}).items():
        stem, ending = "", name
        if name.startswith("NAME_"):
            ending = name.removeprefix("NAME")
            stem = column.removesuffix(ending)
        if not column.endswith(ending) or (not stem and column != name):
            continue
        found = row["error"].split(";")[0]
        if found.startswith("none: ") or " of " in found:
            return None
        return found.replace("NAME", stem, 1)
    return None
