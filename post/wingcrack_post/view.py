"""A pyvista view of the last VTU files: the deformed body and its fractures, as PNG.

VTK ends the whole process where it finds no OpenGL, so the picture is made in a child process:
a machine without OpenGL then costs the view and not the other figures.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from wingcrack_post import style
from wingcrack_post.errors import AbsentError, EnvironmentLacksError, RunError
from wingcrack_post.fields import load_pyvista, nearest
from wingcrack_post.history import clock_of
from wingcrack_post.read import Run, read_run

WARP_SHARE = 0.03  # the largest displacement is drawn as this share of the body's width
SECONDS_ALLOWED = 300
_PIXELS = (2000, 1500)


def draw_view(run: Run, target: Path, time_s: float | None = None) -> Path:
    """Draw the body at the written time nearest to `time_s` (default: the last) into `target`.

    Raises
    ------
    AbsentError
        If the run wrote no VTU files.
    EnvironmentLacksError
        If there is no OpenGL here.
    """
    if not run.matrix:
        raise AbsentError("the run has no matrix.pvd (VTU output off, or no step written yet)")
    target.parent.mkdir(parents=True, exist_ok=True)
    aside = target.with_name(f".{target.stem}.{os.getpid()}.png")
    moment = run.matrix[-1].time_s if time_s is None else nearest(run.matrix, time_s).time_s
    package_root = str(Path(__file__).resolve().parents[1])
    environment = {
        # EGL needs no display; without this VTK first tries X and warns
        "VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow",
        **os.environ,
        "PYTHONPATH": os.pathsep.join(
            part for part in (package_root, os.environ.get("PYTHONPATH", "")) if part
        ),
    }
    command = [sys.executable, "-m", __name__, str(run.directory), str(aside), repr(moment)]
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=SECONDS_ALLOWED,
            check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        aside.unlink(missing_ok=True)
        raise EnvironmentLacksError(
            f"the 3-D view was given up after {SECONDS_ALLOWED} s of rendering"
        ) from None
    if done.returncode == 2:
        raise RunError(done.stderr.strip().splitlines()[-1])
    if not aside.is_file():
        raise EnvironmentLacksError(
            "no OpenGL was found for the 3-D view; the package libegl1 (or libosmesa6) gives it"
        )
    aside.replace(target)
    return target


def render(run: Run, target: Path, time_s: float) -> None:
    """Make the picture in this process, which has to have OpenGL."""
    pyvista = load_pyvista()
    matrix = _read(pyvista, nearest(run.matrix, time_s).path)
    plotter = pyvista.Plotter(off_screen=True, window_size=_PIXELS)
    plotter.set_background("white")
    points = matrix.cell_data_to_point_data()
    displacement = np.asarray(points.point_data["displacement"], dtype=float)
    largest = float(np.linalg.norm(displacement, axis=1).max())
    width = matrix.bounds[1] - matrix.bounds[0]
    factor = WARP_SHARE * width / largest if largest > 0.0 else 0.0
    values, label = _coloured(matrix)
    points.cell_data[label] = values
    body = points.warp_by_vector("displacement", factor=factor)
    plotter.add_mesh(
        body, scalars=label, preference="cell", cmap=style.FIELD_COLOURS, show_edges=True,
        edge_color="#555555", edge_opacity=0.25, line_width=1, lighting=False,
        scalar_bar_args={
            "color": "black", "title_font_size": 40, "label_font_size": 34, "n_labels": 5,
            "position_x": 0.25, "width": 0.5, "position_y": 0.03, "fmt": "%.3g",
        },
    )  # fmt: skip
    if run.fracture_fields:
        lines = _read(pyvista, nearest(run.fracture_fields, time_s).path)
        _add_fractures(plotter, pyvista, lines, points, factor, width)
    clock = clock_of(run)
    caption = (
        f"{run.name},  t = {float(clock.of(time_s)):.4g} {clock.name},  "
        f"displacements drawn {factor:.3g} times larger"
    )
    plotter.add_text(caption, position=(0.03, 0.94), viewport=True, font_size=16, color="black")
    plotter.view_xy()
    plotter.camera.zoom(1.15)
    plotter.screenshot(target)
    plotter.close()


def _read(pyvista: Any, path: Path) -> Any:
    if not path.is_file():
        raise RunError(f"{path}: the file is missing, though its PVD collection names it.")
    return pyvista.read(path)


def _coloured(matrix: Any) -> tuple[Any, str]:
    """Pore pressure, or the mean in-plane stress in mechanics-only runs, per cell."""
    if "pressure" in matrix.cell_data:
        return np.asarray(matrix.cell_data["pressure"]) / 1e6, "pore pressure [MPa]"
    stress = np.asarray(matrix.cell_data["stress"])
    return (stress[:, 0] + stress[:, 1]) / 2e6, "mean in-plane stress [MPa]"


def _add_fractures(
    plotter: Any, pyvista: Any, lines: Any, body: Any, factor: float, width: float
) -> None:
    if lines.n_cells == 0:
        return
    moved = lines.copy()
    # the body moves; its lines move with the node next to each of their ends
    nodes = [body.find_closest_point(point) for point in lines.points]
    moved.points = lines.points + factor * np.asarray(body.point_data["displacement"])[nodes]
    legend = []
    for number, state in enumerate(style.STATES):
        mine = np.flatnonzero(np.asarray(lines.cell_data["state"]) == number)
        colour = style.STATE_COLOURS[state]
        legend.append([state, colour])
        if mine.size:
            tube = moved.extract_cells(mine).extract_geometry().tube(radius=0.003 * width)
            plotter.add_mesh(tube, color=colour, lighting=False)
    plotter.add_legend(legend, bcolor="white", border=False, size=(0.12, 0.12), face="rectangle")


def _child(arguments: list[str]) -> int:
    directory, target, time = arguments
    try:
        render(read_run(directory), Path(target), float(time))
    except (RunError, KeyError) as reason:
        print(f"{directory}: {reason}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(_child(sys.argv[1:]))
