"""The files of a run with a fluid as tables and states, read without the solver."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias
from xml.etree import ElementTree

import f90nml
import numpy as np
import numpy.typing as npt
import pyvista

from wingcrack.figures.text_files import csv_rows, read_json

Numbers: TypeAlias = npt.NDArray[np.float64]
Table: TypeAlias = dict[str, npt.NDArray[Any]]


@dataclass
class State:
    """One accepted state: its row of history.csv, its fracture cells, the rock."""

    history: dict[str, float]
    cells: Table
    lengths: Numbers
    rock: Table
    areas: Numbers
    angle: float


@dataclass
class Run:
    """The files of a run."""

    scene: Any
    record: dict[str, Any]
    states: list[State]


def read_table(path: Path) -> Table:
    """A CSV file by its columns; numbers where all items are numbers."""
    rows = csv_rows(path.read_text().splitlines())
    table: Table = {}
    for k, name in enumerate(rows[0]):
        column = [row[k] for row in rows[1:]]
        try:
            table[name] = np.array(column, dtype=float)
        except ValueError:
            table[name] = np.array(column)
    return table


def read_run(folder: Path) -> Run:
    """All files of a run that has written its fields in each accepted state."""
    record = read_json(folder / "run.json")
    history = read_table(folder / "history.csv")
    scene = f90nml.read(folder / "scene.nml")
    if not len(history["time_s"]):
        return Run(scene, record, [])
    fractures = read_table(folder / "fractures.csv")
    matrices, fields = files_of(folder / "matrix.pvd"), files_of(folder / "fractures.pvd")
    states = []
    for number, time in enumerate(history["time_s"]):
        rows = fractures["time_s"] == time
        matrix = pyvista.read(folder / matrices[float(time)])
        lines = pyvista.read(folder / fields[float(time)])
        ends = np.asarray(lines.points)[lines.cells.reshape(-1, 3)[:, 1:]]
        corners = np.asarray(matrix.points)[matrix.cells.reshape(-1, 4)[:, 1:]]
        states.append(
            State(
                history={name: float(column[number]) for name, column in history.items()},
                cells={name: column[rows] for name, column in fractures.items()},
                lengths=np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1),
                rock={name: np.asarray(matrix.cell_data[name]) for name in matrix.cell_data},
                areas=areas_of(corners),
                angle=smallest_angle(corners),
            )
        )
    return Run(scene, record, states)


def files_of(collection: Path) -> dict[float, str]:
    """The file of each time that a PVD file lists."""
    entries = ElementTree.parse(collection).getroot().iter("DataSet")
    return {float(entry.attrib["timestep"]): entry.attrib["file"] for entry in entries}


def areas_of(corners: Numbers) -> Numbers:
    """Areas of triangles, of (n, 3, 3) corners."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas: Numbers = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return areas


def smallest_angle(corners: Numbers) -> float:
    """The smallest angle of triangles in degrees."""
    smallest = math.pi
    for k in range(3):
        a, b = corners[:, k - 2] - corners[:, k], corners[:, k - 1] - corners[:, k]
        cross = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        smallest = min(smallest, float(np.arctan2(cross, (a * b).sum(axis=1)).min()))
    return math.degrees(smallest)
