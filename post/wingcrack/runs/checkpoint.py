"""Checkpoints of runs as arrays (docs/output.md, Checkpoints)."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from wingcrack.errors import RunError

_MAGIC = b"wingcrack state\n"
_HEAD = 32
_TYPES = {"r8": "<f8", "i4": "<i4", "i8": "<i8", "l4": "<i4", "b1": "u1", "c1": "S1"}


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
    groups: list[str] = []
    place = 0
    while place < len(body):
        name, kind, shape, place = _head(body, place)
        if kind == "g0":
            if name:
                groups.append(name)
            else:
                groups.pop()
            continue
        key = "/".join([*groups, name])
        number = 2
        while key in values:
            key = "/".join([*groups, f"{name} {number}"])
            number += 1
        values[key], place = _values(body, place, kind, shape)
    return values


def _head(body: bytes, place: int) -> tuple[str, str, tuple[int, ...] | None, int]:
    """Name, kind and shape of an entry (None: not allocated), and where its values begin."""
    (length,) = struct.unpack_from("<i", body, place)
    place += 4
    name = body[place : place + length].decode()
    kind = body[place + length : place + length + 2].decode()
    place += length + 2
    (rank,) = struct.unpack_from("<i", body, place)
    place += 4
    if rank < 0:
        return name, kind, None, place
    return name, kind, struct.unpack_from(f"<{rank}q", body, place), place + 8 * rank


def _values(body: bytes, place: int, kind: str, shape: tuple[int, ...] | None) -> tuple[Any, int]:
    """Values of an entry, and where they end."""
    if kind == "n8":
        return struct.unpack_from("<q", body, place)[0], place + 8
    if shape is None:
        return None, place
    count = int(np.prod(shape, dtype=np.int64))
    found = np.frombuffer(body, _TYPES[kind], count, place)
    place += found.nbytes
    if kind == "c1":
        return found.tobytes().decode(errors="replace"), place
    if kind == "l4":
        found = found != 0
    return (found.reshape(shape, order="F") if shape else found[0]), place
