"""Pressure maps: panels, labels, one colour scale, states in the colours of the legend."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection, TriMesh
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from synthetic_run import HOUR, STATES, fracture_cells, save_raw, times
from wingcrack.figures import AbsentError, read_run, style
from wingcrack.figures.fields import FractureField
from wingcrack.figures.frames import Window, zoom_window
from wingcrack.figures.maps import pressure_maps
from wingcrack.figures.units import MEGAPASCAL


def _maps(figure: Figure) -> list[Axes]:
    return [axes for axes in figure.axes if axes.get_aspect() == 1.0]


def _field(axes: Axes) -> PolyCollection | TriMesh:
    return next(c for c in axes.collections if isinstance(c, (PolyCollection, TriMesh)))


def test_default_panels_and_labels(wet_run: Path) -> None:
    figure = pressure_maps(read_run(wet_run))
    panels = _maps(figure)
    assert len(panels) == 6  # three times, each the whole body and near the fracture
    assert [axes.get_title(loc="left")[:3] for axes in panels[:3]] == ["(a)", "(b)", "(c)"]
    assert panels[0].get_title(loc="left") == "(a)  $t$ = 25 h"  # when growth begins
    assert panels[0].get_ylabel() == "$y$ [m]"
    assert panels[3].get_xlabel() == "$x$ [m]"
    assert panels[0].get_xlim() == (0.0, 2.0)
    bars = [axes for axes in figure.axes if axes not in panels]
    assert [axes.get_ylabel() for axes in bars] == ["pore pressure [MPa]"]


def test_one_colour_scale_in_megapascal(wet_run: Path) -> None:
    run = read_run(wet_run)
    panels = _maps(pressure_maps(run))
    limits = {_field(axes).get_clim() for axes in panels}
    assert len(limits) == 1
    low, high = limits.pop()
    assert low == pytest.approx(6.8, abs=0.01)
    assert 12.0 < high < 13.0  # the well's 13 MPa, a little less in the nearest cell


def test_colour_of_states_is_that_of_the_legend(wet_run: Path) -> None:
    step = 6  # all three states
    cells = fracture_cells(step)
    assert set(cells.state) == {0, 1, 2}
    figure = pressure_maps(read_run(wet_run), [float(times()[step])])
    legend = {
        text.get_text(): str(line.get_color())
        for text, line in zip(
            figure.legends[0].get_texts(), figure.legends[0].get_lines(), strict=True
        )
    }
    assert legend == style.STATE_COLOURS
    for axes in _maps(figure):
        for number, state in enumerate(STATES):
            drawn = [c for c in axes.collections if c.get_label() == state]
            assert len(drawn) == 1
            assert isinstance(drawn[0], LineCollection)
            colours = np.asarray(drawn[0].get_colors())
            assert np.allclose(colours, [to_rgba(legend[state])], rtol=0.0, atol=1e-12)
            segments = np.array(drawn[0].get_segments())
            assert np.allclose(segments, cells.ends[cells.state == number], rtol=1e-12)


def test_zoom_holds_the_fracture_in_a_square_inside_the_body() -> None:
    body = Window(0.0, 2.0, 0.0, 1.0)
    near_corner = FractureField(np.array([[[0.0, 0.0], [0.1, 0.05]]]), np.array([0]))
    zoom = zoom_window(body, [near_corner])
    assert zoom is not None
    assert (zoom.x_min, zoom.y_min) == (0.0, 0.0)
    assert zoom.x_max == pytest.approx(0.14, rel=1e-12)
    assert zoom.ratio == pytest.approx(1.0, rel=1e-12)


def test_zoom_in_the_far_corner_ends_there() -> None:
    ends = np.array([[[1.9, 0.95], [2.0, 1.0]]])
    zoom = zoom_window(Window(0.0, 2.0, 0.0, 1.0), [FractureField(ends, np.array([0]))])
    assert zoom is not None
    found = (zoom.x_min, zoom.x_max, zoom.y_min, zoom.y_max)
    assert found == pytest.approx((1.86, 2.0, 0.86, 1.0), rel=1e-12)


@pytest.mark.parametrize("shift", [(0.0, -2000.0), (3000.0, 500.0)])
def test_zoom_moves_with_the_body(shift: tuple[float, float]) -> None:
    """In a body of 4 m x 2 m squares of 1.4 fractures, and none above two fifths of its height."""
    x, y = shift
    body = Window(x, x + 4.0, y, y + 2.0)
    for size, is_zoomed in ((0.5, True), (0.79, True), (0.81, False)):
        ends = np.array([[[x + 1.0, y + 1.0], [x + 1.0 + size, y + 1.0]]])
        zoom = zoom_window(body, [FractureField(ends, np.array([0]))])
        assert (zoom is not None) == is_zoomed
        if zoom is not None:
            found = (zoom.x_min - x, zoom.x_max - x, zoom.y_min - y, zoom.y_max - y)
            left, low = 1.0 - 0.2 * size, 1.0 - 0.7 * size
            wanted = (left, left + 1.4 * size, low, low + 1.4 * size)
            assert found == pytest.approx(wanted, abs=1e-9)


def test_large_fracture_needs_no_zoom() -> None:
    body = Window(0.0, 2.0, 0.0, 2.0)
    large = FractureField(np.array([[[0.5, 1.0], [1.5, 1.0]]]), np.array([0]))
    assert zoom_window(body, [large]) is None
    assert zoom_window(body, []) is None


def test_chosen_time_is_drawn_with_its_pressure(wet_run: Path) -> None:
    figure = pressure_maps(read_run(wet_run), [19.0 * HOUR])
    panels = _maps(figure)
    assert len(panels) == 2
    assert panels[0].get_title(loc="left") == "(a)  $t$ = 20 h"
    values = np.asarray(_field(panels[0]).get_array())
    # time step 3: the well's pressure, reached within a cell's distance only
    assert 6.8 <= values.min() < values.max() <= float(MEGAPASCAL.of(8.5e6))


def test_uniform_pressure_has_a_scale(own_run: Path) -> None:
    import pyvista

    path = own_run / "matrix_0000.vtu"
    mesh = pyvista.read(path)
    mesh.cell_data["pressure"] = np.full(mesh.n_cells, 6.8e6)
    save_raw(mesh, path)
    low, high = _field(_maps(pressure_maps(read_run(own_run), [0.0]))[0]).get_clim()
    assert low is not None
    assert high is not None
    assert low < 6.8 < high


def test_without_pressure_or_fields_there_is_no_map(dry_run: Path, own_run: Path) -> None:
    with pytest.raises(AbsentError, match="no pore pressure \\(mechanics only\\)"):
        pressure_maps(read_run(dry_run))
    (own_run / "matrix.pvd").unlink()
    with pytest.raises(AbsentError, match=r"no matrix\.pvd"):
        pressure_maps(read_run(own_run))


def test_the_peak_is_shown_and_the_wells_stop_named(own_run: Path) -> None:
    path = own_run / "history.csv"
    header, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    for row in rows[7:]:  # the well stops at the end of step 6, at 35 h
        row[header.index("well_pressure_pa")] = "7e6"
    text = "\n".join(",".join(row) for row in [header, *rows])
    path.write_text(text + "\n", encoding="utf-8")
    with (own_run / "scene.nml").open("a", encoding="utf-8") as scene:
        scene.write(f"&injection end = {35 * HOUR} /\n")
    titles = [axes.get_title(loc="left") for axes in _maps(pressure_maps(read_run(own_run)))]
    assert [title[5:] for title in titles if "well" in title] == ["$t$ = 35 h, well stops"]
