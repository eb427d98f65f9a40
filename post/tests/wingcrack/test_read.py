"""A whole run: values come back, partial runs work, damaged ones are refused in a sentence."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from synthetic_run import (
    GROWTH_STEP,
    HOUR,
    STEPS,
    fracture_cells,
    matrix_pressure,
    times,
    well_pressure,
)
from wingcrack.figures import RunError, read_run
from wingcrack.figures.fields import nearest, read_fractures, read_matrix, read_series


def test_history_and_names(wet_run: Path) -> None:
    run = read_run(wet_run)
    assert run.name == "synthetic"
    assert run.fracture_name("1") == "flaw"
    assert run.fracture_name("2") == "fracture 2"
    assert run.history.number("time_s").tolist() == times().tolist()
    pressures = run.history.number("well_pressure_pa")
    assert pressures.tolist() == [well_pressure(step) for step in range(STEPS)]
    assert run.record is not None
    assert run.record["status"] == "finished"
    assert run.events is not None
    assert run.events.text("detail").tolist() == ["tip 1, 1 mm"]


def test_matrix_field_has_the_values_written(wet_run: Path) -> None:
    run = read_run(wet_run)
    assert [snapshot.time_s for snapshot in run.matrix] == times().tolist()
    field = read_matrix(nearest(run.matrix, 31.0 * HOUR).path)
    centres = field.points[field.triangles].mean(axis=1)
    expected = matrix_pressure(GROWTH_STEP, centres)
    assert np.allclose(field.cell["pressure"], expected, rtol=1e-12, atol=0.0)
    assert field.cell["displacement"].shape == (len(field.triangles), 3)
    assert field.cell["stress"].shape == (len(field.triangles), 6)


def test_triangles_fill_the_body(wet_run: Path) -> None:
    field = read_matrix(wet_run / "matrix_0000.vtu")
    a, b, c = (field.points[field.triangles[:, corner]] for corner in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert np.all(areas > 0.0)
    assert areas.sum() == pytest.approx(4.0, rel=1e-12)


def test_fracture_field_has_the_values_written(wet_run: Path) -> None:
    field = read_fractures(wet_run / f"fractures_{STEPS - 1:04d}.vtu")
    cells = fracture_cells(STEPS - 1)
    assert field.state.tolist() == cells.state.tolist()
    assert np.allclose(field.segments, cells.ends, rtol=1e-12, atol=0.0)


def test_running_run_needs_history_only(own_run: Path) -> None:
    for path in own_run.iterdir():
        if path.name != "history.csv":
            path.unlink()
    run = read_run(own_run)
    assert run.tips is None
    assert run.record is None
    assert run.matrix == ()
    assert run.name == "own"


def test_missing_directory(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"nowhere: there is no such directory\.$"):
        read_run(tmp_path / "nowhere")


def test_directory_of_something_else(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"history\.csv is missing, so this is no directory that"):
        read_run(tmp_path)


def test_run_without_a_step(own_run: Path) -> None:
    (own_run / "history.csv").write_text("time_s,dt_s\n", encoding="utf-8")
    with pytest.raises(RunError, match=r"history\.csv: the file has no rows yet"):
        read_run(own_run)


@pytest.mark.parametrize(
    ("file", "content", "message"),
    [
        ("run.json", "{", r"run\.json: the file is no valid JSON"),
        ("network.json", "[]", r"network\.json: a JSON object was expected"),
        ("tips.csv", "", r"tips\.csv: the file is empty"),
        ("matrix.pvd", "<VTKFile>", r"matrix\.pvd: the file is no valid PVD collection"),
        (
            "matrix.pvd",
            '<VTKFile><DataSet timestep="soon" file="a.vtu"/></VTKFile>',
            r"matrix\.pvd: the file is no valid PVD collection",
        ),
    ],
)
def test_damaged_file_is_named(own_run: Path, file: str, content: str, message: str) -> None:
    (own_run / file).write_text(content, encoding="utf-8")
    with pytest.raises(RunError, match=message):
        read_run(own_run)


def test_missing_and_damaged_vtu_are_named(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"a\.vtu: the file is missing, though its PVD"):
        read_matrix(tmp_path / "a.vtu")
    (tmp_path / "b.vtu").write_text("<VTKFile type='Unst", encoding="utf-8")
    with pytest.raises(RunError, match=r"b\.vtu: the file is damaged"):
        read_matrix(tmp_path / "b.vtu")


def test_lines_are_no_matrix(wet_run: Path) -> None:
    with pytest.raises(RunError, match=r"fractures_0000\.vtu: cells other than triangles"):
        read_matrix(wet_run / "fractures_0000.vtu")


def test_series_keeps_its_order_as_loads_may_fall(tmp_path: Path) -> None:
    path = tmp_path / "matrix.pvd"
    path.write_text(
        '<VTKFile><Collection><DataSet timestep="2.0" file="b.vtu"/>'
        '<DataSet timestep="1.0" file="a.vtu"/></Collection></VTKFile>',
        encoding="utf-8",
    )
    assert [snapshot.path.name for snapshot in read_series(path)] == ["b.vtu", "a.vtu"]
