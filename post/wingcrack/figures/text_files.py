"""JSON, TOML, CSV and namelists as values: the one place where a user's text is converted.

Errors of the libraries (another encoding, too deep, too large) become a `ValueError` here, whose
text is one sentence; a file that cannot be read is an `OSError`.
"""

from __future__ import annotations

import csv
import io
import json
import os
import re
import sys
import tomllib
from collections.abc import Iterable
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any, NoReturn

_DEEPEST = 100  # lists and tables within one another
_LARGEST = int(sys.float_info.max)
_DIGITS = len(str(_LARGEST))
_HALF = re.compile(r"\\u[dD][89a-fA-F]")  # perhaps half a character

_MANY = re.compile(r"(?<![\w.])[0-9]{7,}\*")

csv.field_size_limit(2**31 - 1)  # a geometry in a cell may be longer than csv's own 131,072 bytes


def is_file(path: Path) -> bool:
    """Whether a name of any length is that of a file."""
    try:
        return path.is_file()
    except OSError:  # it is too long
        return False


def read_text(path: Path) -> str:
    """Text of a file in UTF-8, with or without a byte-order mark."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as reason:
        line = reason.object.count(b"\n", 0, reason.start) + 1
        raise ValueError(f"it is not UTF-8 text (line {line}); save it as UTF-8") from None


def write_whole(path: Path, content: str | bytes) -> Path:
    """Write a file that appears whole: under another name first, which is then changed."""
    aside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        aside.write_bytes(content.encode() if isinstance(content, str) else content)
        return aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)


def read_json(path: Path) -> Any:
    """Value of a JSON file; see `json_value`."""
    return json_value(read_text(path))


def json_value(text: str) -> Any:
    """Value of a JSON text, all of whose numbers a float can hold."""
    try:
        found = json.loads(text, parse_int=_whole)
    except RecursionError:
        _refuse_depth()
    if _HALF.search(text):
        try:
            json.dumps(found, ensure_ascii=False).encode()
        except UnicodeEncodeError:
            raise ValueError("a text in it has half a character (\\ud800 to \\udfff)") from None
    return judged(found)


def read_toml(path: Path) -> dict[str, Any]:
    """Table of a TOML file, all of whose whole numbers a float can hold."""
    text = read_text(path)
    try:
        found = tomllib.loads(text)
    except RecursionError:
        _refuse_depth()
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:  # of `int`
        raise ValueError(f"a number in it has more than {_DIGITS} digits") from None
    judged(found)
    return found


def namelist_groups(text: str) -> Any:
    """Groups of a scene file by name, as f90nml gives them; those of one name are a list."""
    import f90nml

    if many := _MANY.search(text):  # each would be written out
        raise ValueError(f"{many[0]} in it repeats a value more often than 999,999 times")
    try:
        with redirect_stdout(io.StringIO()):  # it prints its tables where it does not understand
            return judged(f90nml.reads(text))
    except Exception as reason:  # the library raises many kinds, ValueError and AttributeError too
        raise ValueError(f"no file of namelist groups ({reason})") from None


def csv_rows(lines: Iterable[str], separator: str = ",") -> list[list[str]]:
    """Cells of each row, without the space around them."""
    reader = csv.reader(lines, delimiter=separator, skipinitialspace=True)
    return [[cell.strip() for cell in row] for row in reader]


def _whole(word: str) -> int:
    if len(word) > _DIGITS:
        raise ValueError(f"the number {word[:9]}... has {len(word)} digits, which is too large")
    return int(word)


def _refuse_depth() -> NoReturn:
    raise ValueError(f"lists or tables in it stand more than {_DEEPEST} deep within one another")


def judged(found: Any) -> Any:
    """Give back what is neither too deep nor too large for what comes after."""
    level = [found]
    for _ in range(_DEEPEST):
        if any(type(item) is int and abs(item) > _LARGEST for item in level):
            raise ValueError(f"a number in it is larger than {sys.float_info.max:.1e}")
        level = [
            inner
            for item in level
            if isinstance(item, dict | list)
            for inner in (item.values() if isinstance(item, dict) else item)
        ]
        if not level:
            return found
    _refuse_depth()
