"""Entries that take missing values from another one: ``like = "NAME"``."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.figures import text_files
from wingcrack.sweeps.fields import Table

SHARED = "like.toml"  # beside the cases: entries that several of them are like

# Key that names an entry, by kind.
NAMED_BY = {"run": "name", "sweep": "name", "check": "quantity", "figure": "title", "trial": "name"}
_OWN = ("like", "known_gap", "default")  # said of one entry, never of those that are like it


class Likes:
    """Entries of a file, or of a part of it, by kind and name; then those of the `outer` ones."""

    def __init__(self, data: Mapping[str, Any], file: str, outer: Likes | None = None) -> None:
        self._entries = {kind: _tables(data.get(kind)) for kind in NAMED_BY}
        self._files: list[str] = (
            [file] if outer is None else list(dict.fromkeys([file, *outer._files]))
        )
        self._outer = outer

    def complete(self, entry: Mapping[str, Any], kind: str, place: str) -> Table:
        """Entry with what it does not say itself, tables joined item by item.

        Raises `CaseError` if it is like one that is not there, or there twice, or, in the end, like
        itself.
        """
        return self._whole(entry, kind, f"{self._files[0]}: {place}: like", [])

    def _whole(self, entry: Mapping[str, Any], kind: str, place: str, chain: list[Any]) -> Table:
        if "like" not in entry:
            return dict(entry)
        name = entry["like"]
        if not isinstance(name, str):
            raise CaseError(f"{place} must be a text, the {NAMED_BY[kind]} of another {kind}")
        scope, found = self._find(entry, kind, name, place)
        if any(found is passed for passed in chain):
            raise CaseError(f"{place}: the {kind} '{name}' is, in the end, like itself")
        whole = scope._whole(found, kind, place, [*chain, entry])
        others = {key: value for key, value in whole.items() if key not in _OWN}
        return joined(others, {key: value for key, value in entry.items() if key != "like"})

    def _find(
        self, entry: Mapping[str, Any], kind: str, name: str, place: str
    ) -> tuple[Likes, Mapping[str, Any]]:
        """The entry of that name, which is another one, nearest first; and where it is from."""
        scope: Likes | None = self
        while scope is not None:
            entries = [item for item in scope._entries[kind] if item is not entry]
            found = [item for item in entries if item.get(NAMED_BY[kind]) == name]
            if len(found) > 1:
                raise CaseError(f"{place}: {len(found)} entries are a {kind} '{name}'")
            if found:
                return scope, found[0]
            scope = scope._outer
        near = difflib.get_close_matches(name, self._names(kind), n=1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise CaseError(f"{place}: no other {kind} '{name}' is in {' or '.join(self._files)}{hint}")

    def _names(self, kind: str) -> list[str]:
        names = [item.get(NAMED_BY[kind]) for item in self._entries[kind]]
        own = [name for name in names if isinstance(name, str)]
        return own if self._outer is None else [*own, *self._outer._names(kind)]


def shared_likes(top: Path) -> Likes:
    """Entries of ``like.toml`` in a folder of cases; none where there is no such file.

    Raises `CaseError` if it is no TOML file, or has anything else than entries with a name.
    """
    try:
        data = text_files.read_toml(top / SHARED)
    except FileNotFoundError:
        return Likes({}, SHARED)
    except (OSError, ValueError) as reason:
        raise CaseError(f"{SHARED}: {reason}") from None
    for kind, entries in data.items():
        if kind not in NAMED_BY:
            raise CaseError(f"{SHARED}: '{kind}' is unknown; there are: {', '.join(NAMED_BY)}")
        for number, entry in enumerate(_tables(entries), start=1):
            if not isinstance(entry.get(NAMED_BY[kind]), str):
                raise CaseError(f"{SHARED}: {kind} {number}: '{NAMED_BY[kind]}' must be a text")
    return Likes(data, SHARED)


def joined(first: Mapping[str, Any], second: Mapping[str, Any]) -> Table:
    """Keys of both; what the second gives goes before, and tables are joined item by item."""
    both = {**first, **second}
    for name in first.keys() & second.keys():
        if isinstance(first[name], Mapping) and isinstance(second[name], Mapping):
            both[name] = {**first[name], **second[name]}
    return both


def _tables(entries: Any) -> list[Mapping[str, Any]]:
    """Those of a list that are tables; what else stands there is for its reader to refuse."""
    if not isinstance(entries, list):
        return []
    return [item for item in entries if isinstance(item, Mapping)]
