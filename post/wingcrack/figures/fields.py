"""Fields from the VTU files of a run, as plain arrays."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wingcrack.errors import AbsentError, RunError
from wingcrack.figures.durations import moment_of
from wingcrack.figures.table import FloatArray
from wingcrack.figures.vtu import Grid, IntArray, read_vtu

_ROW = re.compile(rb'Name="history_row"[^>]*>(\d+)<')
_TIME = re.compile(rb'Name="TimeValue"[^>]*>([-+.0-9eE]+)<')
_HEAD = 1000  # bytes of a VTU file that hold its row and its moment
_LINE, _TRIANGLE, _QUADRATIC_TRIANGLE = 3, 5, 22  # VTK cell types


@dataclass(frozen=True)
class Snapshot:
    """One written VTU file, with the row of history.csv (from 0) where the file says it."""

    time_s: float
    path: Path
    row: int | None = None


@dataclass(frozen=True)
class MatrixField:
    """Rock at one time."""

    points: FloatArray  # (n, 2) nodes [m]
    triangles: IntArray  # (m, 3) nodes of each cell, from 0
    cell: dict[str, FloatArray]  # cell data by name, first axis of length m
    # point data by name, first axis of length n
    nodal: dict[str, FloatArray] = field(default_factory=dict)


@dataclass(frozen=True)
class FractureField:
    """Fractures at one time."""

    segments: FloatArray  # (m, 2, 2) both ends of each fracture cell [m]
    state: IntArray  # (m,) 0 stick, 1 slip, 2 open
    # other cell data by name, first axis of length m
    cell: dict[str, FloatArray] = field(default_factory=dict)

    def of(self, name: str) -> FloatArray:
        """Slip (magnitude) or opening [m], or another field by its name.

        Raises `AbsentError` if the run did not write it.
        """
        whole = {"slip": "jump", "opening": "jump"}.get(name, name)
        if whole not in self.cell:
            raise AbsentError(f"the fractures have no field '{name}'")
        values = self.cell[whole]
        if name == "slip":
            return np.abs(values[:, 1])
        return values[:, 0] if name == "opening" else values


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
    states, taken = list[Snapshot](), set[float]()
    for listed, file in found:
        row, told = _told_by(file)
        # under a load that goes to and fro the collection counts rows; the file has the factor
        time = told if told is not None and listed == (row or 0) + 1.0 else listed
        while time in taken:  # moments tell states apart
            time = float(np.nextafter(time, np.inf))
        taken.add(time)
        states.append(Snapshot(time, file, row))
    # a falling load stands in the order of its factor
    rows = [state.row for state in states if state.row is not None]
    if len(rows) == len(states):
        states.sort(key=lambda state: state.row or 0)
    return tuple(states)


def _told_by(path: Path) -> tuple[int | None, float | None]:
    """Row of history.csv, from 0, and moment of a state, from the text at the head of its file."""
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except OSError:
        return None, None  # who needs the fields will say what is wrong
    row, time = _ROW.search(head), _TIME.search(head)
    return int(row[1]) - 1 if row else None, float(time[1]) if time else None


def nearest(series: Sequence[Snapshot], time_s: float) -> Snapshot:
    """Give the snapshot written closest to a time.

    Raises `RunError` if the time is no finite number.
    """
    wanted = moment_of(time_s)
    return min(series, key=lambda snapshot: abs(snapshot.time_s - wanted))


def read_matrix(path: Path) -> MatrixField:
    """Read a file of the matrix series: triangles, of six-node ones the corners."""
    grid = read_vtu(path)
    if grid.kinds.size > 0 and grid.kinds[0] == _QUADRATIC_TRIANGLE:
        triangles = _cells(grid, path, _QUADRATIC_TRIANGLE, 6, "six-node triangles")[:, :3]
    else:
        triangles = _cells(grid, path, _TRIANGLE, 3, "triangles")
    return MatrixField(grid.points[:, :2], triangles, grid.cell, grid.point)


def read_fractures(path: Path) -> FractureField:
    """Read a file of the fracture series, which holds lines only."""
    grid = read_vtu(path)
    if grid.kinds.size == 0:
        return FractureField(np.empty((0, 2, 2)), np.empty(0, dtype=np.int64))
    lines = _cells(grid, path, _LINE, 2, "lines")
    if "state" not in grid.cell:
        raise RunError(f"{path}: the cell data 'state' is missing.")
    return FractureField(grid.points[:, :2][lines], grid.cell["state"].astype(np.int64), grid.cell)


def _cells(grid: Grid, path: Path, kind: int, nodes: int, name: str) -> IntArray:
    if grid.kinds.size == 0:
        raise RunError(f"{path}: the file has no cells.")
    if not np.all(grid.kinds == kind):
        raise RunError(f"{path}: cells other than {name} were found.")
    if grid.connectivity.size != nodes * grid.kinds.size:
        raise RunError(f"{path}: the file is damaged (its cells have not {nodes} nodes each).")
    return grid.connectivity.reshape(-1, nodes)
