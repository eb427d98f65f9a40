"""Figures that are up to date: drawn from the same files, by the same program, in the same way.

A record next to the figures has fingerprints of the data of each figure, and of the pictures
themselves. A figure is drawn again if any part of its fingerprint differs, or if its record or
pictures have changed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from wingcrack.figures.text_files import json_value, read_json, write_whole

RECORD = ".drawn.json"
_LARGEST = 2**28  # [byte] of fields that are read to see whether they changed
_LIBRARIES = ("matplotlib", "numpy")
# What run.json says of the machine and of how long it took: figures do not get it (`read_run`).
MEASURED = ("timers_s", "cpu_s", "wall_s", "peak_memory_mb")


class Drawn:
    """The record of a run's figures.

    `folder`: where the figures are.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / RECORD
        self._entries: dict[str, dict[str, Any]] = {}
        try:
            entries = read_json(self._path)
        except (OSError, ValueError):
            return
        if isinstance(entries, dict):
            self._entries = entries

    def find(self, name: str, fingerprint: str) -> tuple[list[Path], str] | None:
        """Give the files of a figure, or why it was left out, if all is as it was left."""
        entry = self._entries.get(name)
        try:
            if entry is None or not fingerprint or entry["fingerprint"] != fingerprint:
                return None
            files = {self._path.parent / file: state for file, state in entry["files"].items()}
            if any(_state(file) != state for file, state in files.items()):
                return None
            return list(files), str(entry["reason"])
        except (KeyError, TypeError, AttributeError, OSError):
            return None

    def has(self, name: str) -> bool:
        """Whether files of a figure were written."""
        entry = self._entries.get(name)
        return isinstance(entry, dict) and bool(entry.get("files"))

    def note(self, name: str, fingerprint: str, files: Sequence[Path], reason: str) -> None:
        """Remember what became of a figure."""
        self._entries[name] = {
            "fingerprint": fingerprint,
            "files": {file.name: _state(file) for file in files},
            "reason": reason,
        }
        self._write()

    def forget(self, name: str) -> set[Path]:
        """Say that a figure is about to be drawn: whoever interrupts that leaves no false word.

        Gives the files that it had.
        """
        entry = self._entries.pop(name, None)
        if entry is None:
            return set()
        self._write()
        files = entry.get("files") if isinstance(entry, dict) else None
        return {self._path.parent / file for file in files} if isinstance(files, dict) else set()

    def _write(self) -> None:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(self._path, json.dumps(self._entries, indent=1) + "\n")


def fingerprint_of(parts: Iterable[bytes | str]) -> str:
    """One short text for all parts; another part, or another order, gives another one."""
    digest = hashlib.blake2b(digest_size=20)
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()


def tables_of(directory: Path) -> str:
    """Fingerprint of a run's tables, its record without measures, and its lists of fields."""
    parts: list[bytes | str] = []
    for path in sorted(directory.iterdir()):
        if path.suffix not in (".csv", ".json", ".nml", ".pvd") or not path.is_file():
            continue
        content = path.read_bytes()
        if path.name == "run.json":
            content = _without_measures(content)
        parts += [path.name, content]
    return fingerprint_of(parts)


def fields_of(files: Iterable[Path]) -> str:
    """Fingerprint of VTU files; empty, which no record fits, where reading them takes too long."""
    parts: list[bytes | str] = []
    room = _LARGEST
    try:
        for path in files:
            room -= path.stat().st_size
            if room < 0:
                return ""
            parts += [str(path), path.read_bytes()]
    except OSError:
        return ""
    return fingerprint_of(parts)


@cache
def program() -> str:
    """Fingerprint of this package and of the libraries that draw."""
    parts: list[bytes | str] = [f"{name} {version(name)}" for name in _LIBRARIES]
    for path in sorted(Path(__file__).parent.glob("*.py")):
        parts += [path.name, path.read_bytes()]
    return fingerprint_of(parts)


def _without_measures(content: bytes) -> bytes:
    try:
        record = json_value(content.decode())
        kept = {name: value for name, value in record.items() if name not in MEASURED}
    except (ValueError, AttributeError):
        return content
    return json.dumps(kept, sort_keys=True).encode()


def _state(file: Path) -> list[int]:
    found = file.stat()
    return [found.st_size, found.st_mtime_ns]
