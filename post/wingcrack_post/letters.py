"""The letters of a page taken out of a font, without loading fontTools.

A TrueType font is a list of tables; `glyf` has the outlines one after the other, `loca` where each
begins (Apple, TrueType Reference Manual, chapter 6). Letters keep their numbers here: those that
are not used get no outline. fontTools, which finds new numbers for them, takes half a second to
load and to do so for the figures of a run.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from io import BytesIO
from pathlib import Path

import numpy as np
import numpy.typing as npt

# what a PDF reader needs of a font whose letters are known by number (ISO 32000-1, table 126)
_TABLES = (b"cvt ", b"fpgm", b"glyf", b"head", b"hhea", b"hmtx", b"loca", b"maxp", b"prep")
_ENTRY = struct.Struct(">4sIII")  # of the list: name, checksum, place, length
_HEAD = struct.Struct(">IHHHH")  # version, number of tables, and three numbers for searching
_LONG_PLACE = 50  # in `head`: whether `loca` has 32-bit numbers
_WORDS, _MORE, _SCALE, _TWO_SCALES, _MATRIX = 0x1, 0x20, 0x8, 0x40, 0x80  # flags of a part


class FontLetters:
    """A font with the outlines of some letters only.

    Parameters
    ----------
    file : Path
        A TrueType font.
    glyphs : iterable of int
        Numbers of the letters to keep; parts of composed letters are kept with them.

    Attributes
    ----------
    glyph_index_map : dict of int to int
        New number of each kept letter: its old one.
    """

    def __init__(self, file: Path, glyphs: Iterable[int]) -> None:
        self._tables = _tables(file.read_bytes())
        long = self._tables[b"head"][_LONG_PLACE : _LONG_PLACE + 2] != b"\0\0"
        places = np.frombuffer(self._tables[b"loca"], ">u4" if long else ">u2").astype(np.int64)
        self._places = places if long else 2 * places
        kept = self._with_parts({0, *glyphs})
        self.glyph_index_map = {number: number for number in sorted(kept)}
        outlines = [self._outline(k) if k in kept else b"" for k in range(len(places) - 1)]
        ends = np.cumsum([0, *(len(one) for one in outlines)])
        self._tables[b"glyf"] = b"".join(outlines)
        self._tables[b"loca"] = (
            ends.astype(">u4") if long else (ends // 2).astype(">u2")
        ).tobytes()

    def file(self) -> BytesIO:
        """Write the font."""
        found = [(name, self._tables[name]) for name in _TABLES if name in self._tables]
        power = len(found).bit_length() - 1
        search = 16 << power
        head = _HEAD.pack(0x00010000, len(found), search, power, 16 * len(found) - search)
        place = len(head) + _ENTRY.size * len(found)
        entries, bodies = [], []
        for name, table in found:
            body = table + bytes(-len(table) % 4)
            entries.append(_ENTRY.pack(name, _checksum(body), place, len(table)))
            bodies.append(body)
            place += len(body)
        return BytesIO(b"".join((head, *entries, *bodies)))

    def _outline(self, number: int) -> bytes:
        return self._tables[b"glyf"][self._places[number] : self._places[number + 1]]

    def _with_parts(self, wanted: set[int]) -> set[int]:
        kept: set[int] = set()
        while wanted:
            number = wanted.pop()
            kept.add(number)
            wanted |= set(_parts(self._outline(number))) - kept
        return kept


def _tables(font: bytes) -> dict[bytes, bytes]:
    count = _HEAD.unpack_from(font)[1]
    entries = (_ENTRY.unpack_from(font, _HEAD.size + _ENTRY.size * k) for k in range(count))
    return {name: font[place : place + length] for name, _, place, length in entries}


def _parts(outline: bytes) -> Iterable[int]:
    """Numbers of the letters that a composed one is made of."""
    if len(outline) < 2 or struct.unpack_from(">h", outline)[0] >= 0:
        return
    place, flags = 10, _MORE  # behind the box
    while flags & _MORE:
        flags, number = struct.unpack_from(">HH", outline, place)
        yield number
        place += 8 if flags & _WORDS else 6
        scales = {_SCALE: 2, _TWO_SCALES: 4, _MATRIX: 8}
        place += sum(size for flag, size in scales.items() if flags & flag)


def _checksum(body: bytes) -> int:
    words: npt.NDArray[np.uint32] = np.frombuffer(body, ">u4")
    return int(words.sum(dtype=np.uint64)) & 0xFFFFFFFF
