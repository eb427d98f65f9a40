"""Rendering of the deformed body and its fractures with pyvista; `view` runs it as a child."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import Colormap

from wingcrack_post import style
from wingcrack_post.errors import EnvironmentLacksError, RunError
from wingcrack_post.fields import (
    cell_values,
    fracture_field,
    load_pyvista,
    matrix_field,
    nearest,
    read_grid,
)
from wingcrack_post.frames import Window, extent, usual_limit, zoom_window
from wingcrack_post.load import moment_label
from wingcrack_post.read import Run, read_run
from wingcrack_post.stress import MEAN_COLOURS, mean_stress
from wingcrack_post.table import FloatArray
from wingcrack_post.units import MEGAPASCAL, stress_unit
from wingcrack_post.view import BAD_INPUT, LACKING

WARP_SHARE = 0.03  # the largest displacement is drawn as this share of the body's width
_PANEL = (1500, 1700)  # pixels
_VALUE = "shown"  # name of the cell data that colours the body
_SCALAR_BAR = {
    "color": "black",
    "title_font_size": 38,
    "label_font_size": 32,
    "n_labels": 5,
    "position_x": 0.2,
    "width": 0.6,
    "position_y": 0.015,
    "height": 0.09,
    "fmt": "%.4g",
}


@dataclass(frozen=True)
class _Scenery:
    body: Any  # pyvista mesh, moved by the displacements
    lines: Any  # pyvista mesh of the fractures, moved likewise; None without fractures
    quantity: str  # what colours the body, with its unit
    colours: Colormap | str
    limits: tuple[float, float] | None  # of the colours; None for all values
    factor: float  # how much larger than in truth displacements are drawn
    views: Sequence[Window]


def render(run: Run, target: Path, place: int) -> None:
    """Make the picture in this process, which has to have OpenGL.

    `place` is that of the written state, from 0. On the left the whole body, on the right (where
    the fractures are small) what is near them.
    """
    pyvista = load_pyvista()
    scenery = _scenery(run, place)
    panels = len(scenery.views)
    plotter = pyvista.Plotter(
        off_screen=True,
        shape=(1, panels),
        window_size=(_PANEL[0] * panels, _PANEL[1]),
        border=False,
    )
    for panel in range(panels):
        plotter.subplot(0, panel)
        _draw_panel(plotter, scenery, panel)
    plotter.subplot(0, 0)
    plotter.add_text(
        f"{run.name}, {_label(run, place)}, displacements x {scenery.factor:.3g}",
        position=(0.06, 0.95),
        viewport=True,
        font_size=20,
        color="black",
    )
    plotter.screenshot(target)
    plotter.close()


def _label(run: Run, place: int) -> str:
    state = run.matrix[place]
    return moment_label(run, state.time_s, state.row).replace("$", "")


def _scenery(run: Run, place: int) -> _Scenery:
    snapshot = run.matrix[place]
    path = snapshot.path
    matrix = read_grid(path)
    body, factor = deformed(matrix, path)
    colours: Colormap | str = style.FIELD_COLOURS
    if "pressure" in matrix.cell_data:
        quantity, values = "pore pressure [MPa]", cell_values(matrix, path, "pressure")
        unit, limits = MEGAPASCAL, None
    else:
        cell_values(matrix, path, "stress")  # a run without it is refused by name
        field = matrix_field(matrix, path)
        values = mean_stress(field)
        limit = usual_limit(field, values, extent([field])) or 1.0
        unit, colours = stress_unit(limit), MEAN_COLOURS
        quantity = f"mean in-plane stress [{unit.name}]"
        limits = (-float(unit.of(limit)), float(unit.of(limit)))
    body.cell_data[_VALUE] = unit.of(values)
    x_min, x_max, y_min, y_max = body.bounds[:4]
    whole = Window(x_min, x_max, y_min, y_max)
    if not run.fracture_fields:
        return _Scenery(body, None, quantity, colours, limits, factor, [whole])
    path = nearest(run.fracture_fields, snapshot.time_s).path
    lines = read_grid(path)
    if lines.n_cells == 0:
        return _Scenery(body, None, quantity, colours, limits, factor, [whole])
    lines.points = lines.points + factor * displacement_at(lines.points, matrix, body)
    zoom = zoom_window(whole, [fracture_field(lines, path)])
    views = [whole] if zoom is None else [whole, zoom]
    return _Scenery(body, lines, quantity, colours, limits, factor, views)


def deformed(matrix: Any, path: Path) -> tuple[Any, float]:
    """Body moved by its displacements, and how much larger than in truth these are drawn."""
    cell_values(matrix, path, "displacement")
    nodal = matrix.cell_data_to_point_data()
    displacement = np.asarray(nodal.point_data["displacement"], dtype=float)
    largest = float(np.linalg.norm(displacement, axis=1).max())
    width = matrix.bounds[1] - matrix.bounds[0]
    factor = WARP_SHARE * width / largest if largest > 0.0 else 0.0
    body = matrix.copy()
    body.points = matrix.points + factor * displacement
    body.point_data["displacement"] = displacement
    return body, factor


def displacement_at(points: Any, matrix: Any, body: Any) -> FloatArray:
    """Displacement of the body at fracture points: mean of the nodes there, which are split."""
    displacement = np.asarray(body.point_data["displacement"], dtype=float)
    places = np.asarray(matrix.points, dtype=float)
    same = 1.0e-9 * float(np.ptp(places, axis=0).max())
    means = []
    for point in np.asarray(points, dtype=float):
        distance = np.linalg.norm(places - point, axis=1)
        means.append(displacement[distance <= distance.min() + same].mean(axis=0))
    return np.array(means)


def _draw_panel(plotter: Any, scenery: _Scenery, panel: int) -> None:
    view = scenery.views[panel]
    last = panel == len(scenery.views) - 1
    plotter.set_background("white")
    plotter.add_mesh(
        scenery.body.copy(),
        scalars=_VALUE,
        cmap=scenery.colours,
        clim=scenery.limits,
        show_edges=panel > 0,
        edge_color="white",
        edge_opacity=0.15,
        lighting=False,
        show_scalar_bar=panel == 0,
        # the line end keeps the title off the numbers
        scalar_bar_args={"title": f"{scenery.quantity}\n", **_SCALAR_BAR},
    )
    if scenery.lines is not None:
        _draw_fractures(plotter, scenery.lines, 0.006 * (view.x_max - view.x_min))
        if last:
            plotter.add_legend(
                [[state, style.STATE_COLOURS[state]] for state in style.STATES],
                bcolor="white",
                size=(0.15, 0.1),
                loc="lower right",
                face="rectangle",
            )
    _aim(plotter, view)


def _draw_fractures(plotter: Any, lines: Any, radius: float) -> None:
    states = np.asarray(lines.cell_data["state"])
    for number, state in enumerate(style.STATES):
        mine = np.flatnonzero(states == number)
        if mine.size:
            surface = lines.extract_cells(mine).extract_surface(algorithm=None)
            tube = surface.tube(radius=radius, capping=True)
            plotter.add_mesh(tube, color=style.STATE_COLOURS[state], lighting=False)


def _aim(plotter: Any, view: Window) -> None:
    """Look at the window from above, with room for the text and for the colour bar."""
    x, y = (view.x_min + view.x_max) / 2, (view.y_min + view.y_max) / 2
    plotter.view_xy()
    plotter.enable_parallel_projection()
    plotter.camera.focal_point = (x, y, 0.0)
    plotter.camera.position = (x, y, 1.0)
    ratio = _PANEL[1] / _PANEL[0]
    half = max((view.x_max - view.x_min) / 2 * ratio, (view.y_max - view.y_min) / 2)
    plotter.camera.parallel_scale = 1.27 * half
    plotter.renderer.reset_camera_clipping_range()


def main(arguments: Sequence[str]) -> int:
    """Draw one view: directory of the run, picture, place of the written state."""
    directory, target, place = arguments
    try:
        render(read_run(directory), Path(target), int(place))
    except RunError as reason:
        print(reason, file=sys.stderr)
        return BAD_INPUT
    except EnvironmentLacksError as reason:
        print(reason, file=sys.stderr)
        return LACKING
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
