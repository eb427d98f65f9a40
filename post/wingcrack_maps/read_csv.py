"""Maps from CSV tables: a segment a row, a vertex a row, or well-known text in a column."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
import shapely
from shapely.geometry import LineString, Point

from wingcrack.figures.text_files import csv_rows
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Attributes, Line, Map
from wingcrack_maps.geometry import add_geometry, is_well, name_of
from wingcrack_maps.units import in_degrees

_DEEPEST = 100  # brackets within one another: GEOS ends the process at some thousand


def read_wkt(text: str, path: str) -> Map:
    """Read all lines that are neither empty nor comments (#)."""
    found = Map()
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            geometry = geometry_of(line.strip(), path, f"line {number}")
            add_geometry(found, geometry, {}, path, f"line {number}")
    return found


def geometry_of(text: str, path: str, source: str) -> shapely.Geometry:
    """Read one geometry."""
    head, separator, rest = text.partition(";")
    if separator and head.upper().startswith("SRID="):
        if in_degrees(head):
            raise SceneError(
                f"{path}: its coordinate system {head} is in degrees of longitude and latitude,"
                " but lengths are needed: project the map first, to UTM for instance"
            )
        text = rest
    opened = accumulate((mark == "(") - (mark == ")") for mark in text if mark in "()")
    try:
        if "\0" in text or max(opened, default=0) > _DEEPEST:
            raise ValueError(f"it has a zero byte, or more than {_DEEPEST} brackets in one another")
        with np.errstate(all="ignore"):  # numbers that are too large are refused with the others
            return shapely.from_wkt(text)
    except (ValueError, shapely.errors.ShapelyError) as reason:
        raise SceneError(
            f"{path}: {source} is no well-known text such as LINESTRING (0 0, 1 2):"
            f" {' '.join(str(reason).split())}"
        ) from None


_GEOMETRY = ("wkt", "geometry", "geom", "the_geom")
_SEGMENT = ("x1", "y1", "x2", "y2")
# names that other programs give to the columns
_ALIASES = {
    **dict(zip(("x_1", "y_1", "x_2", "y_2"), _SEGMENT, strict=True)),
    **dict(zip(("start_x", "start_y", "end_x", "end_y"), _SEGMENT, strict=True)),
    "pt_x": "x",
    "pt_y": "y",
    "fid": "id",
}
# tables without a row of names, by the number of columns
_BARE = {3: ("id", "x", "y"), 4: _SEGMENT, 5: ("id", *_SEGMENT)}
_LAYOUTS = (
    "x1, y1, x2, y2 (a straight fracture a row), name, x, y (a vertex a row) or wkt (a geometry"
    " a row)"
)


def read_csv(text: str, path: str) -> Map:
    """Read a table whose first row names the columns.

    Columns are parted by commas, semicolons or tabs, whichever the first row has; where it is not
    commas, numbers may have a decimal comma. The names may be in a comment (#), or missing where
    all columns are numbers.
    """
    rows: list[tuple[int, str]] = []
    comment = ""
    for number, line in enumerate(text.splitlines(), start=1):
        if line.lstrip().startswith("#"):
            comment = comment if rows else line.lstrip("# \t")
        elif line.strip():
            rows.append((number, line))
    if not rows:
        raise SceneError(f"{path}: the table is empty; it must have a row of column names")
    separator = next((mark for mark in "\t;" if mark in rows[0][1]), ",")
    header = csv_rows([rows[0][1]], separator)[0]
    found = Map()
    if all(isinstance(_plain(word, separator), float) for word in header):
        named = csv_rows([comment], separator)[0] if comment else []
        if len(named) != len(header):
            named = list(_BARE.get(len(header), ()))
            found.note("no column names", f"the columns are taken as {', '.join(named)}")
        if named:
            header, rows = named, [rows[0], *rows]
    repeated = {word for word in header if word and header.count(word) > 1}
    if repeated:
        raise SceneError(f"{path}: the column '{sorted(repeated)[0]}' is given twice")
    column = {_ALIASES.get(word.lower(), word.lower()): k for k, word in enumerate(header)}
    table = _Table(path, column, header, separator, found)
    for number, line in rows[1:]:
        table.add(number, csv_rows([line], separator)[0])
    return table.finish()


class _Table:
    """What the rows so far have given."""

    def __init__(
        self, path: str, column: dict[str, int], header: list[str], mark: str, found: Map
    ) -> None:
        self.path, self.column, self.header, self.mark = path, column, header, mark
        self.found = found
        self.vertices: dict[str, list[tuple[float, float]]] = {}
        self.first: dict[str, tuple[Attributes, str]] = {}
        self.last = ""
        self.geometry = next((word for word in _GEOMETRY if word in column), "")
        self.segment = _SEGMENT if all(word in column for word in _SEGMENT) else ()
        self.name = next((w for w in ("name", "fracture", "label", "id") if w in column), "")
        is_vertices = self.name and {"x", "y"} <= column.keys()
        if not (self.geometry or self.segment or is_vertices):
            raise SceneError(
                f"{path}: the columns {', '.join(header)} hold no fractures; there must be"
                f" {_LAYOUTS}"
            )

    def add(self, number: int, cells: list[str]) -> None:
        """Add a row."""
        source = f"row {number}"
        if len(cells) != len(self.header):
            raise SceneError(
                f"{self.path}:{number}: the row has {len(cells)} values but must have"
                f" {len(self.header)}, one per column"
            )
        used = {self.geometry, *self.segment} - {""} or {"x", "y"}
        attributes: Attributes = {
            word: _plain(cells[k], self.mark)
            for k, word in enumerate(self.header)
            if word and _ALIASES.get(word.lower(), word.lower()) not in used and cells[k] != ""
        }
        if self.geometry:
            made = geometry_of(cells[self.column[self.geometry]], self.path, source)
            add_geometry(self.found, made, attributes, self.path, source)
        elif self.segment:
            x_1, y_1, x_2, y_2 = (self._number(cells, word, number) for word in self.segment)
            made = LineString([(x_1, y_1), (x_2, y_2)])
            add_geometry(self.found, made, attributes, self.path, source)
        else:
            self._add_vertex(cells, attributes, number)

    def _add_vertex(self, cells: list[str], attributes: Attributes, number: int) -> None:
        name = cells[self.column[self.name]]
        if not name:
            raise SceneError(f"{self.path}:{number}: the row has no {self.name}")
        if name in self.vertices and name != self.last:
            raise SceneError(
                f"{self.path}:{number}: '{name}' goes on after '{self.last}', but the vertices of"
                " a fracture must follow each other"
            )
        attributes.setdefault("name", name)
        if name in self.first and attributes != self.first[name][0]:
            self.found.note(
                "attribute left out",
                f"row {number}: other attributes than in the first row of '{name}' do not count",
            )
        self.first.setdefault(name, (attributes, f"row {number}"))
        place = (self._number(cells, "x", number), self._number(cells, "y", number))
        self.vertices.setdefault(name, []).append(place)
        self.last = name

    def finish(self) -> Map:
        """Give the map, once all rows are added."""
        for name, places in self.vertices.items():
            attributes, source = self.first[name]
            if len(places) == 1 and is_well(attributes):
                add_geometry(self.found, Point(places[0]), attributes, self.path, source)
                continue
            if len(places) < 2:
                raise SceneError(
                    f"{self.path}: {source}: '{name}' has one vertex, but it takes two"
                )
            label = name_of(attributes) or name
            self.found.lines.append(Line(label, np.array(places), attributes, source))
        return self.found

    def _number(self, cells: list[str], word: str, number: int) -> float:
        text = cells[self.column[word]]
        value = _plain(text, self.mark)
        if isinstance(value, float) and np.isfinite(value):
            return value
        raise SceneError(f"{self.path}:{number}: {word} is '{text}' but must be a number")


def _plain(text: str, separator: str) -> float | str:
    """Give a number if the cell is one."""
    decimal = text.replace(",", ".") if separator != "," and text.count(",") == 1 else text
    if "_" in decimal:  # Python's own way of grouping digits is nobody's table
        return text
    try:
        return float(decimal)
    except ValueError:
        return text
