"""The view: the body moved by its displacements, with the colours of the states."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba, to_rgba_array
from matplotlib.figure import Figure

from synthetic_run import BODY, STEPS, save_raw, times
from wingcrack.figures import AbsentError, Run, RunError, read_run, style
from wingcrack.figures import view as module
from wingcrack.figures.frames import Frame, read_frame
from wingcrack.figures.view import WARP_SHARE, displacement_at, view


def _body(figure: Figure, panel: int = 0) -> PolyCollection:
    return next(c for c in figure.axes[panel].collections if isinstance(c, PolyCollection))


def test_the_whole_body_and_what_is_near_the_fracture(wet_run: Path) -> None:
    figure = view(read_run(wet_run))
    panels = [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]
    assert len(panels) == 2
    assert _body(figure).get_array() is not None
    for panel in panels:
        lines = [c for c in panel.collections if isinstance(c, LineCollection)]
        colours = {tuple(to_rgba_array(line.get_colors())[0]) for line in lines}
        for state in ("slip", "open"):
            assert to_rgba(style.STATE_COLOURS[state]) in colours, state


def test_displacements_are_drawn_as_a_share_of_the_body(wet_run: Path) -> None:
    """The body of the synthetic run is compressed by its strain: -4e-4 x in x, -1e-4 y in y."""
    corners = np.concatenate([path.vertices for path in _body(view(read_run(wet_run))).get_paths()])
    assert np.ptp(corners[:, 0]) == pytest.approx(BODY * (1.0 - WARP_SHARE), rel=0.01)
    assert np.ptp(corners[:, 1]) == pytest.approx(BODY * (1.0 - WARP_SHARE / 4.0), rel=0.01)


def test_a_fracture_moves_with_the_mean_of_its_faces() -> None:
    nodes = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [3.0, 0.0]])
    displacement = np.array([[9.0, 9.0], [0.0, 1.0], [2.0, 3.0], [9.0, 9.0]])
    moved = displacement_at(np.array([[1.1, 0.0], [2.9, 0.1]]), nodes, displacement)
    assert moved.tolist() == [[1.0, 2.0], [9.0, 9.0]]


def test_nodal_displacements_are_taken_where_they_are_written(own_run: Path) -> None:
    read = read_run(own_run)
    frame = read_frame(read, 0)
    plain = module._nodal_displacement(frame.matrix, "file")
    given = np.zeros((len(plain), 3), dtype=np.float64)
    given[:, 0] = np.arange(len(plain))
    written = replace(frame.matrix, nodal={"nodal_displacement": given})
    assert np.array_equal(module._nodal_displacement(written, "file"), given[:, :2])
    assert not np.array_equal(plain, given[:, :2])


def test_mechanics_only_shows_stress(dry_run: Path) -> None:
    figure = view(read_run(dry_run))
    labels = [axes.get_xlabel() for axes in figure.axes]
    assert "mean in-plane stress [MPa]" in labels


def test_the_last_view_is_that_of_no_short_step(
    wet_run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def read(run: Run, place: int) -> Frame:
        asked.append(place)
        return read_frame(run, place)

    monkeypatch.setattr(module, "read_frame", read)
    monkeypatch.setattr(module, "last_settled", lambda *_: 7)
    view(read_run(wet_run))
    view(read_run(wet_run), [0.0, float(times()[3])])
    assert asked == [7, 3]


def test_singular_cells_do_not_colour_the_view(dry_run: Path, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    run = Path(shutil.copytree(dry_run, tmp_path / "run"))
    path = run / f"matrix_{STEPS - 1:04d}.vtu"
    mesh = pyvista.read(path)
    mesh.cell_data["stress"][40] = -733.0e6
    save_raw(mesh, path)
    assert _body(view(read_run(run))).get_clim() == pytest.approx((-15.0, -15.0), rel=0.02)


def test_damaged_field_is_named(own_run: Path) -> None:
    read = read_run(own_run)
    read.matrix[-1].path.unlink()
    with pytest.raises(RunError, match=r"matrix_0012\.vtu: the file is missing"):
        view(read)


def test_run_without_fields(own_run: Path) -> None:
    (own_run / "matrix.pvd").unlink()
    with pytest.raises(AbsentError, match=r"no matrix\.pvd"):
        view(read_run(own_run))
