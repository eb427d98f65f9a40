"""Checkpoints of runs as arrays (docs/output.md, Checkpoints)."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from wingcrack.errors import RunError

_MAGIC = b"wingcrack state\n"
_HEAD = 32
_TYPES = {
    "r8": "<f8",
    "i4": "<i4",
    "i8": "<i8",
    "n8": "<i8",
    "l4": "<i4",
    "b1": "u1",
    "c1": "S1",
}
_SIZES = {kind: np.dtype(name).itemsize for kind, name in _TYPES.items()} | {"g0": 0}


def read_checkpoint(path: str | Path) -> dict[str, Any]:
    """Give the values of a checkpoint by their names, with the groups that contain them.

    Arrays have the shape that they have in the program, with indices from 0; texts are strings.
    Of several entries with one name, as of several windows, the later ones have a number added.

    Raises
    ------
    RunError
        If it is no checkpoint, or a damaged one.

    Examples
    --------
    >>> state = read_checkpoint("out/wings/checkpoint.bin")  # doctest: +SKIP
    >>> state["now/coarse/pressure"]  # doctest: +SKIP
    """
    data = Path(path).read_bytes()
    if data[: len(_MAGIC)] != _MAGIC:
        raise RunError(f"{path} is no checkpoint")
    size, checksum = struct.unpack_from("<qq", data, len(_MAGIC)) if len(data) >= _HEAD else (-1, 0)
    body = data[_HEAD:]
    if len(body) != size or zlib.crc32(body) != checksum:
        raise RunError(f"{path} is damaged")
    values: dict[str, Any] = {}
    for entry in entry_places(body):
        if entry.kind == "g0":
            continue
        key, number = entry.name, 2
        while key in values:
            key = f"{entry.name} {number}"
            number += 1
        values[key] = _values(body, entry)
    return values


class EntryPlace(NamedTuple):
    """Where an entry lies in a checkpoint; `shape` is None if it is not allocated."""

    name: str
    kind: str
    shape: tuple[int, ...] | None
    rank: int
    values: int
    end: int


def entry_places(body: bytes) -> Iterator[EntryPlace]:
    """Give all entries in their order, with the groups that contain them in their names."""
    groups: list[str] = []
    place = 0
    while place < len(body):
        name, kind, shape, rank, place = _head(body, place)
        if kind == "g0" and not name:
            groups.pop()
        size = 0 if shape is None else math.prod(shape) * _SIZES[kind]
        yield EntryPlace("/".join([*groups, name]), kind, shape, rank, place, place + size)
        if kind == "g0" and name:
            groups.append(name)
        place += size


def _head(body: bytes, place: int) -> tuple[str, str, tuple[int, ...] | None, int, int]:
    """Name, kind and shape of an entry (None: not allocated), where rank and values begin."""
    (length,) = struct.unpack_from("<i", body, place)
    place += 4
    name = body[place : place + length].decode()
    kind = body[place + length : place + length + 2].decode()
    at = place + length + 2
    (rank,) = struct.unpack_from("<i", body, at)
    if rank < 0:
        return name, kind, None, at, at + 4
    return name, kind, struct.unpack_from(f"<{rank}q", body, at + 4), at, at + 4 + 8 * rank


def _values(body: bytes, entry: EntryPlace) -> Any:
    """Values of an entry."""
    if entry.shape is None:
        return None
    found = np.frombuffer(body[entry.values : entry.end], _TYPES[entry.kind])
    if entry.kind == "c1":
        return found.tobytes().decode(errors="replace")
    if entry.kind == "l4":
        found = found != 0
    return found.reshape(entry.shape, order="F") if entry.shape else found[0]
