"""Changes since the first state, the part of the body that changes, colours of both signs."""

from __future__ import annotations

import numpy as np
import pytest

from synthetic_run import square
from wingcrack.figures.fields import MatrixField
from wingcrack.figures.frames import Frame, changed_window, changes_since, extent, usual_range
from wingcrack.figures.maps import MEAN_COLOURS, signed_colours, stress_norm


def _frame(cells: int, pressure: object) -> Frame:
    points, triangles = square(cells)
    x, y = points[triangles].mean(axis=1)[:, :2].T
    field = MatrixField(points[:, :2], triangles, {"pressure": pressure(x, y)})  # type: ignore[operator]
    return Frame(0.0, 0, field, None)


def test_hydrostatic_pressure_is_taken_off_on_another_mesh() -> None:
    first = _frame(8, lambda x, y: 25.0e6 - 1.0e4 * y + 0.0 * x)
    later = _frame(13, lambda x, y: 25.0e6 - 1.0e4 * y + 2.0e6 * (x > 1.0))
    found = changes_since(first, later, "pressure")
    x = later.matrix.points[later.matrix.triangles].mean(axis=1)[:, 0]
    assert found == pytest.approx(2.0e6 * (x > 1.0), abs=1.0)


def test_layers_are_taken_off_cell_by_cell() -> None:
    first = _frame(8, lambda x, y: np.where(y < 1.0, 3.0e6, 1.0e6) + 0.0 * x)
    later = _frame(16, lambda x, y: np.where(y < 1.0, 4.0e6, 2.0e6) + 0.0 * x)
    assert changes_since(first, later, "pressure") == pytest.approx(1.0e6)


def test_the_view_keeps_to_what_changes() -> None:
    frame = _frame(20, lambda x, y: 0.0 * x + 0.0 * y)
    x, y = frame.matrix.points[frame.matrix.triangles].mean(axis=1).T
    body = extent([frame.matrix])
    change = np.exp(-(((x - 1.2) ** 2 + (y - 0.8) ** 2) / 0.01))
    window = changed_window(body, [frame], [change])
    assert window is not None
    assert window.x_min < 1.1 < 1.3 < window.x_max
    assert window.x_max - window.x_min < 0.9
    assert changed_window(body, [frame], [1.0 + 0.0 * x]) is None
    assert changed_window(body, [frame], [0.0 * x]) is None


def test_a_scale_has_no_room_for_the_other_sign() -> None:
    frame = _frame(12, lambda x, y: -30.0e6 + 0.0 * x + 0.0 * y)
    values = frame.matrix.cell["pressure"].copy()
    values[::50] = -733.0e6
    low, high = usual_range(frame.matrix, values, extent([frame.matrix]))
    assert (low, high) == (-30.0e6, -30.0e6)
    norm, unit = stress_norm(low, high)
    assert unit.name == "MPa"
    assert (norm.vmin, norm.vmax) == pytest.approx((-30.3, -29.7))
    assert signed_colours(-30.0, -10.0) == "cividis"


def test_colours_change_at_zero_where_there_are_both_signs() -> None:
    colours = signed_colours(-30.0, 10.0)
    assert not isinstance(colours, str)
    assert colours(0.75) == pytest.approx(MEAN_COLOURS(0.5), abs=0.02)
    assert colours(0.0) == pytest.approx(MEAN_COLOURS(0.0))
    assert colours(1.0) == pytest.approx(MEAN_COLOURS(1.0), abs=0.02)


def test_a_mesh_cut_by_a_fracture_can_be_searched() -> None:
    first = _frame(8, lambda x, y: np.where(y < 1.0, 3.0e6, 1.0e6) + 0.0 * x)
    matrix = first.matrix
    inside = np.flatnonzero(np.all(np.abs(matrix.points - 1.0) < 0.6, axis=1))
    triangles = matrix.triangles.copy()
    above = matrix.points[triangles].mean(axis=1)[:, 1] > 1.0
    slit = [node for node in inside if abs(matrix.points[node, 1] - 1.0) < 1e-12]
    points = np.concatenate((matrix.points, matrix.points[slit]))
    for k, node in enumerate(slit):
        triangles[above[:, None] & (triangles == node)] = len(matrix.points) + k
    cut = Frame(0.0, 0, MatrixField(points, triangles, matrix.cell), None)
    later = _frame(16, lambda x, y: np.where(y < 1.0, 4.0e6, 2.0e6) + 0.0 * x)
    assert slit
    assert changes_since(cut, later, "pressure") == pytest.approx(1.0e6)
