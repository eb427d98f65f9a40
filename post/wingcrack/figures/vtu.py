"""VTU files of a run: XML with the position of each array in the raw bytes that follow.

Layout: VTK User's Guide, "VTK XML Formats", with one piece and raw appended arrays, each preceded
by its size in bytes as UInt64. VTK's own reader takes wrong sizes from a truncated file, and
ends the process for lack of memory (9.7, tried); and loading VTK takes a hundred times as long as
reading.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from wingcrack.errors import RunError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_TYPES = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4", "UInt8": "u1"}
_APPENDED = b"<AppendedData"
_SIZE_BYTES = 8  # of the UInt64 before an array


@dataclass(frozen=True)
class Grid:
    """An unstructured grid."""

    points: FloatArray  # (n, 3) nodes [m]
    connectivity: IntArray  # (k,) nodes of all cells one after another, from 0
    kinds: IntArray  # (m,) VTK's cell type of each cell
    # cell, point: data by name; the first axis is that of the cells or of the points
    cell: dict[str, FloatArray]
    point: dict[str, FloatArray]


def read_vtu(path: Path) -> Grid:
    """Read a file.

    Raises `RunError` if it is missing, cut off, or not as a run writes it.
    """
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise RunError(
            f"{path}: the file is missing, though its PVD collection names it."
        ) from None
    except OSError as reason:
        raise RunError(f"{path}: the file cannot be read ({reason}).") from None
    try:
        return _grid(content)
    except (ValueError, KeyError, AttributeError, ElementTree.ParseError) as reason:
        said = f"{reason} is missing" if isinstance(reason, KeyError) else str(reason)
        raise RunError(f"{path}: the file is damaged ({said}).") from None


def _grid(content: bytes) -> Grid:
    head, _, rest = content.partition(_APPENDED)
    if not rest:
        raise ValueError("it has no raw appended arrays")
    root = ElementTree.fromstring(head + b"/></VTKFile>")
    if root.get("header_type") != "UInt64" or b'encoding="raw"' not in rest[: rest.find(b">") + 1]:
        raise ValueError("its arrays are not raw, with their sizes as UInt64")
    order = {"LittleEndian": "<", "BigEndian": ">"}[root.attrib["byte_order"]]
    begin = len(head) + len(_APPENDED) + rest.index(b"_") + 1
    pieces = root.findall("UnstructuredGrid/Piece")
    if len(pieces) != 1:
        raise ValueError(f"it has {len(pieces)} pieces, one was expected")
    piece = pieces[0]

    def arrays(section: str) -> dict[str, npt.NDArray[Any]]:
        return {
            entry.attrib["Name"]: _array(entry, content, begin, order)
            for entry in piece.findall(f"{section}/DataArray")
        }

    def numbers(section: str, length: int) -> dict[str, FloatArray]:
        found = {name: np.asarray(a, dtype=np.float64) for name, a in arrays(section).items()}
        for name, values in found.items():
            if len(values) != length:
                raise ValueError(f"'{name}' has {len(values)} values for {length}")
        return found

    n_points, n_cells = (int(piece.attrib[f"NumberOf{what}"]) for what in ("Points", "Cells"))
    points, cells = arrays("Points")["Points"], arrays("Cells")
    connectivity = np.asarray(cells["connectivity"], dtype=np.int64)
    kinds = np.asarray(cells["types"], dtype=np.int64)
    if points.shape != (n_points, 3) or kinds.shape != (n_cells,):
        raise ValueError("its arrays do not fit to its number of points or cells")
    if connectivity.size and not 0 <= connectivity.min() <= connectivity.max() < n_points:
        raise ValueError("a cell has a node that is not there")
    return Grid(
        np.asarray(points, dtype=np.float64),
        connectivity,
        kinds,
        numbers("CellData", n_cells),
        numbers("PointData", n_points),
    )


def _array(entry: ElementTree.Element, content: bytes, begin: int, order: str) -> npt.NDArray[Any]:
    """Take an array out of the bytes; `begin` is where offsets count from."""
    name = entry.attrib["Name"]
    if entry.get("format") != "appended":
        raise ValueError(f"'{name}' is not appended")
    kind = np.dtype(order + _TYPES[entry.attrib["type"]])
    place = begin + int(entry.attrib["offset"])
    size = int.from_bytes(content[place : place + _SIZE_BYTES], "little" if order == "<" else "big")
    place += _SIZE_BYTES
    if place + size > len(content):
        raise ValueError(f"it ends within '{name}'")
    values = np.frombuffer(content, kind, size // kind.itemsize, place)
    components = int(entry.get("NumberOfComponents", "1"))
    return values if components == 1 else values.reshape(-1, components)
