"""The figure of the mesh: every edge once, windows around the tips of the state."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.patches import Rectangle

from synthetic_run import square
from wingcrack.figures.fields import MatrixField
from wingcrack.figures.frames import extent
from wingcrack.figures.mesh import _edges, mesh_figure
from wingcrack.figures.read import read_run


def test_every_edge_is_drawn_once() -> None:
    points, triangles = square(6)
    field = MatrixField(points[:, :2], triangles, {})
    edges = _edges(field, extent([field]))
    # Euler: nodes - edges + triangles = 1
    assert len(edges) == len(points) + len(triangles) - 1
    assert len(np.unique(edges.reshape(len(edges), 4), axis=0)) == len(edges)


def test_windows_lie_around_the_tips(wet_run: Path) -> None:
    run = read_run(wet_run)
    assert run.scene is not None
    assert run.tips is not None
    figure = mesh_figure(replace(run, scene=replace(run.scene, window_m=0.2)))
    squares = [patch for patch in figure.axes[-1].patches if isinstance(patch, Rectangle)]
    last = run.tips.moments() == run.tips.moments()[-1]
    assert len(squares) == int(last.sum())
    centres = {(round(p.get_x() + 0.1, 9), round(p.get_y() + 0.1, 9)) for p in squares}
    tips = zip(run.tips.number("x_m")[last], run.tips.number("y_m")[last], strict=True)
    assert centres == {(round(float(x), 9), round(float(y), 9)) for x, y in tips}
    assert not mesh_figure(replace(run, scene=None)).axes[-1].patches
