"""Fields of a run in one written state, as numpy arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wingcrack.errors import AbsentError
from wingcrack.figures.fields import Snapshot, nearest, read_fractures, read_matrix
from wingcrack.figures.table import FloatArray
from wingcrack.figures.vtu import IntArray, read_vtu
from wingcrack.runs.units import field_unit


@dataclass(frozen=True)
class Fields:
    """Rock and fractures in one written state.

    Attributes
    ----------
    moment : float
        Time [s], or in a run without fluid the load factor [-].
    history_row : int or None
        Row of the history with the same state, from 0; None where the files do not tell it.
    points : (n, 2) array
        Nodes of the rock [m].
    triangles : (m, 3) array
        Nodes of each cell, from 0.
    rock : mapping of str to array
        Fields of the cells by name: pressure [Pa], stress [Pa] (XX, YY, ZZ, XY, YZ, XZ),
        displacement [m], permeability [m2]; first axis of length m.
    nodal : mapping of str to array
        Fields of the nodes, first axis of length n.
    segments : (k, 2, 2) array
        Both ends of each fracture cell [m].
    fractures : mapping of str to array
        Fields of the fracture cells: state (0 stick, 1 slip, 2 open), jump [m] (normal,
        tangential), traction [Pa], aperture [m], pressure [Pa], arc_length [m], fracture.
    units : mapping of str to str
        Unit of each field.
    """

    moment: float
    history_row: int | None
    points: FloatArray
    triangles: IntArray
    rock: Mapping[str, FloatArray]
    nodal: Mapping[str, FloatArray]
    segments: FloatArray
    fractures: Mapping[str, FloatArray]
    units: Mapping[str, str]

    def of_rock(self, name: str) -> FloatArray:
        """Field of the rock's cells; of several components ``name.component``, as stress.xx.

        Raises
        ------
        AbsentError
            If the state has no such field.
        """
        whole, _, component = name.partition(".")
        if whole not in self.rock:
            raise AbsentError(
                f"the rock has no field '{whole}' here (there are {', '.join(self.rock)})"
            )
        values = self.rock[whole]
        if values.ndim == 1 and not component:
            return values
        names = _COMPONENTS.get(1 if values.ndim == 1 else values.shape[1], ())
        if component not in names:
            raise AbsentError(f"'{whole}' needs one of {', '.join(f'{whole}.{n}' for n in names)}")
        return np.asarray(values[:, names.index(component)])


_COMPONENTS = {3: ("x", "y", "z"), 6: ("xx", "yy", "zz", "xy", "yz", "xz")}


def read_fields(
    directory: Path,
    matrix: tuple[Snapshot, ...],
    fractures: tuple[Snapshot, ...],
    moment: float | None,
) -> Fields:
    """Read the written state nearest to a moment, the last one for None.

    Raises
    ------
    AbsentError
        If no state is written.
    RunError
        If a file is missing or damaged, or the moment is no number.
    """
    if not matrix:
        raise AbsentError(f"{directory} has no fields (VTU output off, or no step written yet)")
    snapshot = matrix[-1] if moment is None else nearest(matrix, moment)
    rock = read_matrix(snapshot.path)
    segments, cells = np.empty((0, 2, 2)), dict[str, FloatArray]()
    if fractures:
        place = matrix.index(snapshot)
        same = len(fractures) == len(matrix)
        path = (fractures[place] if same else nearest(fractures, snapshot.time_s)).path
        segments, cells = read_fractures(path).segments, read_vtu(path).cell
    names = (*rock.cell, *rock.nodal, *cells)
    return Fields(
        moment=snapshot.time_s,
        history_row=snapshot.row,
        points=rock.points,
        triangles=rock.triangles,
        rock=rock.cell,
        nodal=rock.nodal,
        segments=segments,
        fractures=cells,
        units={name: field_unit(name) for name in names},
    )
