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
