"""Maps from gmsh's meshes: MSH 2 and 4.1, as text or binary, by the format's definition.

gmsh itself is not used: it executes a file `MESH.msh.opt` next to a mesh, and scripts within one.
"""

from __future__ import annotations

import re
from collections import defaultdict
from itertools import islice
from pathlib import Path
from typing import Any, NoReturn, TypeAlias

import numpy as np
from numpy.typing import NDArray
from shapely import coverage_union_all, polygons
from shapely.errors import ShapelyError

from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.physical import Groups, map_of_groups

Numbers: TypeAlias = NDArray[np.int64]

# Of each type of element of a curve or a surface: its dimension, its nodes, its corners. Corners
# come first.
_ELEMENTS = {1: (1, 2, 2), 8: (1, 3, 2), 26: (1, 4, 2), 27: (1, 5, 2), 28: (1, 6, 2),
             2: (2, 3, 3), 9: (2, 6, 3), 20: (2, 9, 3), 21: (2, 10, 3), 22: (2, 12, 3),
             23: (2, 15, 3), 24: (2, 15, 3), 25: (2, 21, 3), 3: (2, 4, 4), 10: (2, 9, 4),
             16: (2, 8, 4), 36: (2, 16, 4), 37: (2, 25, 4), 38: (2, 36, 4),
             15: (0, 1, 1)}  # fmt: skip
_SKIPPED = ("Comments", "Periodic", "Parametrizations", "NodeData", "ElementData",
            "ElementNodeData", "InterpolationScheme")  # fmt: skip
_FORMAT = re.compile(
    rb"\s*\$MeshFormat[ \t]*\r?\n\s*(\S+)\s+([01])\s+(\d+)[ \t]*\r?\n(....)?\s*\$EndMeshFormat",
    re.DOTALL,
)
_SHORT = "it ends too early"


def read_msh(path: Path) -> Map:
    """Read the physical groups of a mesh.

    Raises `SceneError`: with the line of what is not as the format says.
    """
    try:
        return map_of_groups(_Mesh(path.read_bytes(), str(path)).groups(), str(path))
    except OSError as reason:
        raise SceneError(f"{path}: it cannot be read: {reason.strerror}") from None


class _Section:
    """The numbers of a section, taken one after another."""

    def __init__(self, path: str, data: bytes, place: int, end: int, binary: bool) -> None:
        self.path, self.data, self.place, self.end = path, data, place, end
        self.binary = binary
        self.words: list[bytes] = [] if binary else data[place:end].split()
        self.taken = 0

    def whole(self, count: int, form: str = "i4") -> Numbers:
        """Give whole numbers, in binary files of a form such as ``i4`` or ``u8``."""
        return np.asarray(self._take(count, form), dtype=np.int64)

    def places(self, count: int) -> NDArray[np.float64]:
        """Give coordinates and the like."""
        return np.asarray(self._take(count, "f8"), dtype=np.float64)

    def text_line(self) -> int:
        """Give a whole number that stands on a line of its own in binary files too."""
        if not self.binary:
            return int(self.whole(1)[0])
        stop = self.data.find(b"\n", self.place, self.end)
        word, self.place = self.data[self.place : stop], stop + 1
        return int(self._numbers([word], "i8")[0]) if stop >= 0 else self.refuse(_SHORT)

    def nodes(self, count: int) -> tuple[Numbers, NDArray[np.float64]]:
        """Give numbers and places of nodes that stand by turns."""
        if self.binary:
            both = self._take(count, "i4, 3f8")
            return both["f0"].astype(np.int64), both["f1"]
        words = self._words(4 * count)
        tags = [word for k, word in enumerate(words) if k % 4 == 0]
        places = [word for k, word in enumerate(words) if k % 4 > 0]
        return self._numbers(tags, "i8"), self._numbers(places, "f8").reshape(-1, 3)

    def done(self) -> None:
        """Refuse what is left over."""
        left = self.data[self.place : self.end].strip() if self.binary else self.words[self.taken :]
        if left:
            self.refuse("it has more numbers than it says")

    def _take(self, count: int, form: str) -> NDArray[Any]:
        if not self.binary:
            return self._numbers(self._words(count), "f8" if form == "f8" else "i8")
        kind = np.dtype(form).newbyteorder("<")
        if not 0 <= count * kind.itemsize <= self.end - self.place:
            self.refuse(_SHORT)
        found = np.frombuffer(self.data, kind, count, self.place)
        self.place += count * kind.itemsize
        return found

    def _words(self, count: int) -> list[bytes]:
        if not 0 <= count <= len(self.words) - self.taken:
            self.refuse(_SHORT)
        self.taken += count
        return self.words[self.taken - count : self.taken]

    def _numbers(self, words: list[bytes], form: str) -> NDArray[Any]:
        convert = float if form == "f8" else int
        try:
            if any(b"_" in word for word in words):  # Python's own way of grouping digits
                raise ValueError
            return np.array([convert(word) for word in words], dtype=form)
        except (ValueError, OverflowError):
            return self.refuse("there is something else than the numbers that should be there")

    def refuse(self, why: str) -> NoReturn:
        """Refuse it, with the line that was reached."""
        place = self.place
        if not self.binary:
            found = re.finditer(rb"\S+", self.data[place : self.end])
            word = next(islice(found, max(self.taken - 1, 0), None), None)
            place += word.start() if word else 0
        _refuse(self.path, self.data, place, why)


def _refuse(path: str, data: bytes, place: int, why: str) -> NoReturn:
    line = data.count(b"\n", 0, place) + 1
    raise SceneError(f"{path}:{line}: the mesh cannot be read: {why}")


class _Mesh:
    """What the sections so far have given; tags are gmsh's numbers."""

    def __init__(self, data: bytes, path: str) -> None:
        self.data, self.path = data, path
        self.names: dict[tuple[int, int], str] = {}
        self.physical: dict[tuple[int, int], Numbers] = {}  # of entities, by dimension and tag
        self.tags: Numbers = np.empty(0, dtype=np.int64)
        self.places = np.empty((0, 3))
        # corners of elements by the dimension and tag of their physical group
        self.elements: dict[tuple[int, int], list[Numbers]] = defaultdict(list)
        place = self._format()
        while found := re.compile(rb"\s*\$(\w+)[ \t]*\r?\n").match(data, place):
            word = found[1].decode()
            end = data.find(b"$End" + found[1], found.end())
            if end < 0:
                _refuse(path, data, found.end() - 1, f"${word} has no $End{word}")
            self._section(word, found.end(), end)
            place = end + len(b"$End" + found[1])
        if data[place:].strip():
            _refuse(path, data, place + 1, "there must be a section, which begins with $")

    def _format(self) -> int:
        """Read the first section; give the place behind it."""
        found = _FORMAT.match(self.data)
        if found is None:
            raise SceneError(f"{self.path}:1: no mesh of gmsh, which begins with $MeshFormat")
        version, self.binary = found[1].decode("utf-8", "replace"), found[2] == b"1"
        self.is_old = version.startswith("2")
        if not (self.is_old or version == "4.1") or found[3] != b"8":
            _refuse(
                self.path, self.data, found.start(1), f"its format {version} is not read, but 2.2"
                " and 4.1 are: let gmsh convert it, by gmsh -save -format msh41"
            )  # fmt: skip
        if self.binary and found[4] != b"\x01\0\0\0":
            _refuse(self.path, self.data, found.start(4), "its numbers are of another byte order")
        return found.end()

    def _section(self, word: str, place: int, end: int) -> None:
        read = {"Entities": self._entities, "Nodes": self._nodes, "Elements": self._blocks}
        if self.is_old:
            read = {"Nodes": self._old_nodes, "Elements": self._old_elements}
        if word == "PhysicalNames":
            self._physical_names(place, end)
        elif word in read:
            section = _Section(self.path, self.data, place, end, self.binary)
            read[word](section)
            section.done()
        elif word not in _SKIPPED:
            _refuse(self.path, self.data, place - 1, f"a section ${word} is not read")

    def _physical_names(self, place: int, end: int) -> None:
        lines = self.data[place:end].decode("utf-8", "replace").splitlines()
        for line in filter(str.strip, lines[1:]):
            found = re.fullmatch(r'\s*([0-3])\s+([0-9]{1,9})\s+"([^"]*)"\s*', line)
            if found is None:
                _refuse(self.path, self.data, place, f"'{line[:40]}' names no physical group")
            self.names[int(found[1]), int(found[2])] = found[3]

    def _entities(self, section: _Section) -> None:
        for dimension, count in enumerate(section.whole(4, "u8").tolist()):
            for _ in _times(section, count):
                tag = int(section.whole(1)[0])
                section.places(3 if dimension == 0 else 6)
                groups = section.whole(int(section.whole(1, "u8")[0]))
                self.physical[dimension, tag] = np.abs(groups)
                if dimension > 0:
                    section.whole(int(section.whole(1, "u8")[0]))

    def _nodes(self, section: _Section) -> None:
        blocks = int(section.whole(4, "u8")[0])
        tags, places = [self.tags], [self.places]
        for _ in _times(section, blocks):
            dimension, _, parametric = section.whole(3).tolist()
            count = int(section.whole(1, "u8")[0])
            width = 3 + (dimension if parametric else 0)
            tags.append(section.whole(count, "u8"))
            places.append(section.places(count * width).reshape(count, width)[:, :3])
        self._keep_nodes(section, np.concatenate(tags), np.concatenate(places))

    def _old_nodes(self, section: _Section) -> None:
        self._keep_nodes(section, *section.nodes(section.text_line()))

    def _keep_nodes(self, section: _Section, tags: Numbers, places: NDArray[np.float64]) -> None:
        order = np.argsort(tags, kind="stable")
        self.tags, self.places = tags[order], places[order]
        if not np.isfinite(places).all():
            section.refuse("a coordinate is no finite number")
        if (np.diff(self.tags) == 0).any():
            section.refuse("two nodes have the same number")

    def _blocks(self, section: _Section) -> None:
        for _ in _times(section, int(section.whole(4, "u8")[0])):
            dimension, entity, kind = section.whole(3).tolist()
            nodes, corners = self._kind(section, kind, dimension)
            count = int(section.whole(1, "u8")[0])
            rows = section.whole(count * (1 + nodes), "u8").reshape(count, 1 + nodes)
            for group in self.physical.get((dimension, entity), ()):
                self.elements[dimension, int(group)].append(rows[:, 1 : 1 + corners])

    def _old_elements(self, section: _Section) -> None:
        left = section.text_line()
        while left > 0:
            number, kind, tags = section.whole(3).tolist()
            count = 1
            if self.binary:  # elements of one kind together, after their number
                kind, count = number, kind
            nodes, corners = self._kind(section, kind)
            head = int(self.binary)
            width = head + tags + nodes
            if tags < 0 or count < 1:
                section.refuse("an element has less than nothing")
            rows = section.whole(count * width).reshape(count, width)
            groups = rows[:, head] if tags else np.zeros(count, dtype=np.int64)
            for group in np.unique(groups):
                chosen = rows[groups == group, head + tags : head + tags + corners]
                self.elements[_ELEMENTS[kind][0], int(group)].append(chosen)
            left -= count

    def _kind(self, section: _Section, kind: int, dimension: int | None = None) -> tuple[int, int]:
        """Nodes and corners of a type of element."""
        own, nodes, corners = _ELEMENTS.get(kind, (-1, 0, 0))
        if own < 0 or dimension not in (None, own):
            section.refuse(f"elements of type {kind} are not read here: it takes a plane mesh")
        return nodes, corners

    def groups(self) -> Groups:
        """Give the physical groups by their names."""
        found = Groups()
        for dimension, group in sorted(self.elements):
            if dimension == 0 or group == 0:
                continue
            name = self.names.get((dimension, group)) or str(group)
            if name in (found.curves if dimension == 1 else found.surfaces):
                raise SceneError(f"{self.path}: two physical groups are called '{name}'")
            parts = self.elements[dimension, group]
            if dimension == 1:
                found.curves[name] = self._edges(np.concatenate(parts), name)
                continue
            cells = [polygons(self._points(part)) for part in parts]
            try:
                found.surfaces[name] = coverage_union_all(np.concatenate(cells))
            except ShapelyError as reason:
                raise SceneError(f"{self.path}: surface '{name}' is no mesh: {reason}") from None
        return found

    def _edges(self, ends: Numbers, name: str) -> NDArray[np.float64]:
        _, first = np.unique(np.sort(ends, axis=1), axis=0, return_index=True)
        edges = self._points(ends[np.sort(first)])
        if (edges[:, 0] == edges[:, 1]).all(axis=1).any():
            raise SceneError(f"{self.path}: an edge of curve '{name}' has no length")
        return edges

    def _points(self, tags: Numbers) -> NDArray[np.float64]:
        """Places of nodes in the plane, by their numbers."""
        index = np.minimum(np.searchsorted(self.tags, tags), max(self.tags.size - 1, 0))
        lacking = tags[self.tags[index] != tags] if self.tags.size else tags.ravel()
        if lacking.size:
            raise SceneError(f"{self.path}: an element has a node {lacking[0]}, which is not there")
        return np.asarray(self.places[index, :2])


def _times(section: _Section, count: int) -> range:
    """So many parts of a section, each of which takes numbers from it."""
    if not 0 <= count <= section.end:
        section.refuse(_SHORT)
    return range(count)
