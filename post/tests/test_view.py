"""The pyvista view: a picture with the colours of the states, or one sentence without OpenGL."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from synthetic_run import STEPS, times
from wingcrack_post import (
    AbsentError,
    EnvironmentLacksError,
    RunError,
    read_run,
    render,
    style,
    view,
)
from wingcrack_post.stress import MEAN_COLOURS
from wingcrack_post.view import draw_view


def _drawn(run: Path, target: Path) -> Path:
    try:
        return draw_view(read_run(run), target)
    except EnvironmentLacksError as reason:
        pytest.skip(str(reason))


def test_picture_shows_the_states_of_the_last_time(wet_run: Path, tmp_path: Path) -> None:
    picture = imread(_drawn(wet_run, tmp_path / "view.png"))
    assert picture.shape[:2] == (1700, 3000)  # the whole body, and near the fracture
    for state in ("slip", "open"):
        same = np.all(np.abs(picture[:, :, :3] - to_rgb(style.STATE_COLOURS[state])) < 0.01, axis=2)
        assert same.sum() > 1000, state
    assert list(tmp_path.iterdir()) == [tmp_path / "view.png"]


def test_mechanics_only_shows_stress(dry_run: Path, tmp_path: Path) -> None:
    assert _drawn(dry_run, tmp_path / "view.png").stat().st_size > 10_000


def test_the_last_view_is_that_of_no_short_step(
    wet_run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def child(_directory: Path, aside: Path, place: int) -> subprocess.CompletedProcess[str]:
        asked.append(place)
        aside.write_bytes(b"")
        return subprocess.CompletedProcess([], 0, "", "")

    monkeypatch.setattr(view, "_call_child", child)
    monkeypatch.setattr(view, "last_settled", lambda *_: 7)
    draw_view(read_run(wet_run), tmp_path / "view.png")
    draw_view(read_run(wet_run), tmp_path / "view.png", float(times()[3]))
    assert asked == [7, 3]


def test_singular_cells_do_not_colour_the_view(dry_run: Path, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    run = Path(shutil.copytree(dry_run, tmp_path / "run"))
    path = run / f"matrix_{STEPS - 1:04d}.vtu"
    mesh = pyvista.read(path)
    mesh.cell_data["stress"][40] = -733.0e6
    mesh.save(path)
    scenery = render._scenery(read_run(run), STEPS - 1)
    assert scenery.limits == (-15.0, 15.0)
    assert scenery.colours == MEAN_COLOURS


def test_no_opengl_is_one_sentence(
    wet_run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    libraries = tmp_path / "broken"
    libraries.mkdir()
    # files that no loader accepts stand before the true libraries
    for name in ("libEGL.so.1", "libEGL.so", "libOSMesa.so.8", "libOSMesa.so", "libGL.so.1"):
        (libraries / name).touch()
    monkeypatch.setenv("LD_LIBRARY_PATH", str(libraries))
    monkeypatch.delenv("DISPLAY", raising=False)
    target = tmp_path / "view.png"
    with pytest.raises(EnvironmentLacksError, match="no OpenGL was found for the view; the"):
        draw_view(read_run(wet_run), target)
    assert not target.exists()


def test_damaged_field_is_named(own_run: Path, tmp_path: Path) -> None:
    read = read_run(own_run)
    read.matrix[-1].path.unlink()
    with pytest.raises(RunError, match=r"matrix_0012\.vtu: the file is missing"):
        draw_view(read, tmp_path / "view.png")


def test_run_without_fields(own_run: Path, tmp_path: Path) -> None:
    (own_run / "matrix.pvd").unlink()
    with pytest.raises(AbsentError, match=r"no matrix\.pvd"):
        draw_view(read_run(own_run), tmp_path / "view.png")
