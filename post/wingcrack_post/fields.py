"""Fields from the VTU files of a run, as plain arrays."""

from __future__ import annotations

import logging
import re
import warnings
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from wingcrack_post.errors import EnvironmentLacksError, RunError
from wingcrack_post.table import FloatArray

IntArray = npt.NDArray[np.int64]

_ROW = re.compile(rb'Name="history_row"[^>]*>(\d+)<')
_HEAD = 1000  # bytes of a VTU file that hold its row
_LINE, _TRIANGLE, _QUADRATIC_TRIANGLE = 3, 5, 22  # VTK cell types


@dataclass(frozen=True)
class Snapshot:
    """One written VTU file, with the row of history.csv (from 0) where the file says it."""

    time_s: float
    path: Path
    row: int | None = None


@dataclass(frozen=True)
class MatrixField:
    """Rock at one time.

    Attributes
    ----------
    points : (n, 2) array
        Nodes [m].
    triangles : (m, 3) array
        Nodes of each cell, from 0.
    cell : dict of str to array
        Cell data by name, first axis of length m.
    """

    points: FloatArray
    triangles: IntArray
    cell: dict[str, FloatArray]


@dataclass(frozen=True)
class FractureField:
    """Fractures at one time.

    Attributes
    ----------
    segments : (m, 2, 2) array
        Both ends of each fracture cell [m].
    state : (m,) array
        0 stick, 1 slip, 2 open.
    """

    segments: FloatArray
    state: IntArray


def read_series(path: Path) -> tuple[Snapshot, ...]:
    """List the files of a PVD collection as written; nothing where there is no such file."""
    if not path.exists():
        return ()
    try:
        entries = ElementTree.parse(path).iter("DataSet")
        found = [
            (float(entry.attrib["timestep"]), path.parent / entry.attrib["file"])
            for entry in entries
        ]
    except (ElementTree.ParseError, KeyError, ValueError) as reason:
        raise RunError(f"{path}: the file is no valid PVD collection ({reason}).") from None
    states = [Snapshot(time, file, _history_row(file)) for time, file in found]
    # a falling load stands in the order of its factor
    rows = [state.row for state in states if state.row is not None]
    if len(rows) == len(states):
        states.sort(key=lambda state: state.row or 0)
    return tuple(states)


def _history_row(path: Path) -> int | None:
    """Row of history.csv with the same state, from the text at the head of a VTU file."""
    try:
        with path.open("rb") as file:
            found = _ROW.search(file.read(_HEAD))
    except OSError:
        return None  # who needs the fields will say what is wrong
    return int(found[1]) - 1 if found else None


def nearest(series: Sequence[Snapshot], time_s: float) -> Snapshot:
    """Give the snapshot written closest to a time."""
    return min(series, key=lambda snapshot: abs(snapshot.time_s - time_s))


def read_matrix(path: Path) -> MatrixField:
    """Read a file of the matrix series: triangles, of six-node ones the corners."""
    return matrix_field(read_grid(path), path)


def matrix_field(mesh: Any, path: Path) -> MatrixField:
    """Take the rock out of a pyvista mesh; `path` is for error messages."""
    if mesh.n_cells > 0 and mesh.celltypes[0] == _QUADRATIC_TRIANGLE:
        triangles = _cells(mesh, path, _QUADRATIC_TRIANGLE, 6, "six-node triangles")[:, :3]
    else:
        triangles = _cells(mesh, path, _TRIANGLE, 3, "triangles")
    cell = {name: np.asarray(array, dtype=float) for name, array in mesh.cell_data.items()}
    return MatrixField(np.asarray(mesh.points, dtype=float)[:, :2], triangles, cell)


def read_fractures(path: Path) -> FractureField:
    """Read a file of the fracture series, which holds lines only."""
    return fracture_field(read_grid(path), path)


def fracture_field(mesh: Any, path: Path) -> FractureField:
    """Take the fractures out of a pyvista mesh; `path` is for error messages."""
    points = np.asarray(mesh.points, dtype=float)[:, :2]
    if mesh.n_cells == 0:
        return FractureField(np.empty((0, 2, 2)), np.empty(0, dtype=np.int64))
    lines = _cells(mesh, path, _LINE, 2, "lines")
    return FractureField(points[lines], cell_values(mesh, path, "state").astype(np.int64))


def cell_values(mesh: Any, path: Path, name: str) -> FloatArray:
    """Take cell data from a pyvista mesh; `path` is for error messages."""
    if name not in mesh.cell_data:
        raise RunError(f"{path}: the cell data '{name}' is missing.")
    return np.asarray(mesh.cell_data[name], dtype=float)


def load_pyvista() -> Any:
    """Import pyvista late: it takes longer than all the rest together."""
    try:
        import pyvista
    except ImportError as reason:
        raise EnvironmentLacksError(f"pyvista cannot be used here ({reason})") from None
    return pyvista


def read_grid(path: Path) -> Any:
    """Read a VTU file with pyvista."""
    if not path.is_file():
        raise RunError(f"{path}: the file is missing, though its PVD collection names it.")
    pyvista = load_pyvista()
    level = logging.root.manager.disable
    logging.disable(logging.ERROR)  # else a damaged file brings pages of VTK's own errors
    try:
        with pyvista.vtk_verbosity("off"), warnings.catch_warnings():
            # VTK gives an empty mesh for a damaged file, pyvista warns about it
            warnings.filterwarnings("error", message="The VTK reader", category=UserWarning)
            return pyvista.read(path)
    except Exception as reason:  # VTK raises many kinds; all mean an unreadable file
        first_line = str(reason).splitlines()[0] if str(reason) else type(reason).__name__
        raise RunError(f"{path}: the file is damaged ({first_line.rstrip('.:')}).") from None
    finally:
        logging.disable(level)


def _cells(mesh: Any, path: Path, kind: int, nodes: int, name: str) -> IntArray:
    if mesh.n_cells == 0:
        raise RunError(f"{path}: the file has no cells.")
    if not np.all(np.asarray(mesh.celltypes) == kind):
        raise RunError(f"{path}: cells other than {name} were found.")
    return np.asarray(mesh.cell_connectivity, dtype=np.int64).reshape(-1, nodes)
