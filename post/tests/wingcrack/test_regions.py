"""Regions: their outlines from the values of the scene, and how maps shade them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from wingcrack.figures.regions import _LESS, _MORE, Region, draw_regions, read_region, region_label
from wingcrack.figures.scene import read_scene
from wingcrack.figures.units import METRE

HEAD = """\
&domain x_min = 0.0, x_max = 2.0, y_min = 0.0, y_max = 1.0 /
&material permeability = 1.0e-18 /
"""


def regions(folder: Path, text: str) -> tuple[Region, ...]:
    (folder / "scene.nml").write_text(HEAD + text, encoding="utf-8")
    scene = read_scene(folder / "scene.nml")
    assert scene is not None
    assert scene.permeability_m2 == (1.0e-18, 1.0e-18)
    return scene.regions


def area(corners: np.ndarray) -> float:
    """Area of a polygon, by Gauss."""
    x, y = corners.T
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


def test_polygon_and_band(tmp_path: Path) -> None:
    square, band = regions(
        tmp_path,
        "&region name = 'square', x = 0.5, 1.0, 1.0, 0.5, y = 0.2, 0.2, 0.7, 0.7, "
        "permeability = 2.0e-17 /\n"
        "&region name = 'band', shape = 'band', x = 0.0, 2.0, y = 0.4, 0.6, x_other = 0.0, 2.0, "
        "y_other = 0.5, 0.7, permeability_xx = 1.0e-20, permeability_yy = 1.0e-19 /\n",
    )
    assert area(square.corners) == pytest.approx(0.25)
    assert area(band.corners) == pytest.approx(0.2)
    assert square.permeability_m2 == (2.0e-17, 2.0e-17)
    assert region_label(square) == r"square: $k$ = $2\cdot10^{-17}$ m²"
    assert region_label(band) == "band: $k_{xx}$ = $10^{-20}$ m²,\n$k_{yy}$ = $10^{-19}$ m²"


def test_all_to_the_left_of_a_line(tmp_path: Path) -> None:
    """A half plane covers the body's corners to the left of it and none to the right."""
    (half,) = regions(
        tmp_path,
        "&region name = 'h', shape = 'half_plane', x = 0.5, 1.5, y = 0.25, 0.75, "
        "permeability = 1.0e-19 /\n",
    )
    inside = Polygon(half.corners).get_path().contains_points([(0, 0.9), (0.1, 1), (2, 0), (1, 0)])
    assert inside.tolist() == [True, True, False, False]


def test_a_half_plane_reaches_to_the_body_from_afar() -> None:
    """Its line is given where the body's centre lies twice as far from the origin."""
    body = np.array([[1000.0, 0.0], [1002.0, 0.0], [1002.0, 1.0], [1000.0, 1.0]])
    line = {"x": [2002.0, 2003.0], "y": [0.5, 0.5], "permeability": [1.0e-19]}
    half = read_region("h", "half_plane", line, body)
    assert half is not None
    inside = Polygon(half.corners).get_path().contains_points(body)
    assert inside.tolist() == [False, False, True, True]


def test_parabolas(tmp_path: Path) -> None:
    """Between x = 0.5 + y^2 and x = 0.8 + y^2 there is 0.3 m2; to the right of a line 1.5 m2."""
    between, right = regions(
        tmp_path,
        "&region name = 'b', shape = 'parabola', x_vertex = 0.5, 0.8, y_vertex = 0.0, 0.0, "
        "curvature = 1.0, 1.0, permeability = 1.0e-17 /\n"
        "&region name = 'r', shape = 'parabola', x_vertex = 0.5, y_vertex = 0.0, curvature = 0.0, "
        "permeability = 1.0e-17 /\n",
    )
    assert area(between.corners) == pytest.approx(0.3)
    assert area(right.corners) == pytest.approx(1.5)


def test_values_that_are_missing_leave_the_region_out(tmp_path: Path) -> None:
    assert regions(tmp_path, "&region name = 'r', shape = 'band', x = 0, 1, y = 0, 1 /\n") == ()


def drawn(permeability: float) -> tuple[Axes, Polygon]:
    corners = np.array([[0.2, 0.2], [3.0, 0.2], [3.0, 0.8], [0.2, 0.8]])
    body = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    axes = Figure().add_subplot()
    region = Region("r", corners, (permeability, permeability))
    assert len(draw_regions(axes, [region], (1.0e-18, 1.0e-18), body, METRE)) == 1
    (patch,) = axes.patches
    assert isinstance(patch, Polygon)
    return axes, patch


def test_shades_tell_how_well_a_region_conducts() -> None:
    """The better the darker, to the eye in grey too; what conducts worse than rock is hatched."""
    weights = np.array([0.299, 0.587, 0.114])
    greys = [float(weights @ drawn(k)[1].get_facecolor()[:3]) for k in (2e-18, 1e-17, 1e-15, 1e-13)]
    assert greys[0] > greys[1] > greys[2] == greys[3]
    assert not drawn(1.0e-17)[1].get_hatch()
    assert drawn(1.0e-19)[1].get_hatch()


@pytest.mark.parametrize(("sign", "colours"), [(1.0, _MORE), (-1.0, _LESS)])
@pytest.mark.parametrize("decades", [0.75, 1.5, 3.0, 5.0])
def test_shades_lie_between_two_colours(
    sign: float, colours: tuple[str, str], decades: float
) -> None:
    """In proportion to the decades, from the pale one to the strong one at three and beyond."""
    pale, strong = (np.array(to_rgb(colour)) for colour in colours)
    wanted = pale + min(decades / 3.0, 1.0) * (strong - pale)
    found = drawn(10.0 ** (-18.0 + sign * decades))[1].get_facecolor()[:3]
    assert found == pytest.approx(wanted, abs=0.5 / 255.0)


def test_regions_end_at_the_body() -> None:
    _, patch = drawn(1.0e-17)
    clip = patch.get_clip_path()
    assert clip is not None
