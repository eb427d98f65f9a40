"""VTU files are read as VTK reads them, and refused in a sentence where they are damaged."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from synthetic_run import save_raw
from wingcrack.figures import RunError
from wingcrack.figures.fields import read_matrix
from wingcrack.figures.vtu import read_vtu

pyvista = pytest.importorskip("pyvista")


def _six_node(path: Path) -> Any:
    points = np.array(
        [[0, 0], [2, 0], [0, 2], [1, 0], [1, 1], [0, 1], [2, 2], [2, 1], [1, 2]], dtype=float
    )
    points = np.column_stack((points, np.zeros(9)))
    cells = np.array([[0, 1, 2, 3, 4, 5], [1, 6, 2, 7, 8, 4]])
    grid = pyvista.UnstructuredGrid({pyvista.CellType.QUADRATIC_TRIANGLE: cells}, points)
    grid.cell_data["stress"] = np.arange(12.0).reshape(2, 6)
    grid.cell_data["region"] = np.array([1, 2], dtype=np.int32)
    grid.point_data["nodal_displacement"] = points * 0.5
    save_raw(grid, path)
    return grid


def test_values_are_those_that_vtk_reads(tmp_path: Path) -> None:
    path = tmp_path / "a.vtu"
    _six_node(path)
    there, here = pyvista.read(path), read_vtu(path)
    assert np.array_equal(here.points, there.points)
    assert np.array_equal(here.connectivity, there.cell_connectivity)
    assert np.array_equal(here.kinds, there.celltypes)
    assert set(here.cell) == {"stress", "region"}
    for name, values in here.cell.items():
        assert np.array_equal(values, there.cell_data[name]), name
    assert np.array_equal(here.point["nodal_displacement"], there.point_data["nodal_displacement"])
    assert read_matrix(path).triangles.tolist() == [[0, 1, 2], [1, 6, 2]]


def test_a_file_that_is_cut_off_anywhere_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.vtu"
    _six_node(path)
    content = path.read_bytes()
    end = content.rindex(b"</AppendedData>")
    for length in range(0, end - 10, 7):
        path.write_bytes(content[:length])
        with pytest.raises(RunError, match=r"a\.vtu: the file is damaged \(.+\)"):
            read_vtu(path)


def test_another_layout_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "a.vtu"
    grid = _six_node(path)
    grid.save(path)  # compressed, as text
    with pytest.raises(RunError, match="it has no raw appended arrays"):
        read_vtu(path)


def test_a_node_that_is_not_there(tmp_path: Path) -> None:
    path = tmp_path / "a.vtu"
    _six_node(path)
    content = path.read_bytes()
    nodes = np.array([0, 1, 2, 3, 4, 5, 1, 6, 2, 7, 8, 4])
    old = next(nodes.astype(kind).tobytes() for kind in ("<i8", "<i4")
               if nodes.astype(kind).tobytes() in content)  # fmt: skip
    wrong = old[: -len(old) // 12] + (99).to_bytes(len(old) // 12, "little")
    path.write_bytes(content.replace(old, wrong))
    with pytest.raises(RunError, match="a cell has a node that is not there"):
        read_vtu(path)
