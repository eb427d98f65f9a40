"""Mechanics-only runs: load against growth, stress maps, and load factors instead of times."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection, TriMesh

from synthetic_run import square
from wingcrack.figures import AbsentError, Run, read_run, style
from wingcrack.figures.fields import MatrixField, read_matrix
from wingcrack.figures.frames import Window, extent, usual_limit
from wingcrack.figures.history import development, intensities
from wingcrack.figures.load import abscissa, load_figure, moment_label
from wingcrack.figures.maps import MEAN_COLOURS, stress_maps


@pytest.fixture
def loaded(dry_run: Path, tmp_path: Path) -> Run:
    """Give a mechanics-only run: a load factor stands where others have the time."""
    for item in dry_run.iterdir():
        if item.suffix in (".csv", ".json"):
            text = item.read_text(encoding="utf-8").replace("time_s", "load_factor")
            (tmp_path / item.name).write_text(text, encoding="utf-8")
        else:
            (tmp_path / item.name).symlink_to(item)
    return read_run(tmp_path)


def test_load_factor_stands_for_time(loaded: Run, wet_run: Path) -> None:
    factor = loaded.history.number("load_factor")
    values, label = abscissa(loaded, loaded.history.moments())
    assert values == pytest.approx(factor)
    assert label == "load factor [-]"
    assert moment_label(loaded, float(factor[-1])) == f"load factor {factor[-1]:.4g}"
    wet = read_run(wet_run)
    assert abscissa(wet, wet.history.moments())[1] == "time [h]"


def test_load_against_length(loaded: Run) -> None:
    against, rising, growing = load_figure(loaded).axes
    length = loaded.history.number("fracture_length_m")
    line = against.lines[0]
    assert np.asarray(line.get_ydata()) == pytest.approx(loaded.history.number("load_factor"))
    assert against.get_xlabel() == "total length [m]"
    assert np.asarray(line.get_xdata()) == pytest.approx(length)
    assert rising.get_ylabel() == "load factor [-]"
    assert growing.get_xlabel() == "step [-]"


def test_what_grows_under_a_load_is_drawn_by_step(loaded: Run) -> None:
    assert intensities(loaded).axes[0].get_xlabel() == "step [-]"
    assert development(loaded).axes[0].get_xlabel() == "step [-]"


def test_no_load_no_figure(wet_run: Path) -> None:
    with pytest.raises(AbsentError, match="no load factor"):
        load_figure(read_run(wet_run))


def _field(axes: Axes) -> PolyCollection | TriMesh:
    return next(c for c in axes.collections if isinstance(c, (PolyCollection, TriMesh)))


def test_singular_cells_do_not_set_the_colours() -> None:
    points, triangles = square(12)
    field = MatrixField(points[:, :2], triangles, {})
    values = np.full(len(triangles), 2.0e6)
    values[np.argmin(np.abs(points[triangles].mean(axis=1) - 1.0).sum(axis=1))] = -733.0e6
    assert usual_limit(field, values, extent([field])) == 2.0e6


def test_what_is_out_of_view_does_not_set_the_colours() -> None:
    """Each quarter of the body has a value of its own."""
    points, triangles = square(12)
    x, y = points[triangles].mean(axis=1)[:, :2].T
    values = np.where(y < 1.0, 0.0, -20.0) - np.where(x < 1.0, 1.0, 10.0)
    field = MatrixField(points[:, :2], triangles, {})
    limits = [
        usual_limit(field, values, Window(left, left + 1.0, low, low + 1.0))
        for low in (0.0, 1.0)
        for left in (0.0, 1.0)
    ]
    assert limits == [1.0, 10.0, 21.0, 30.0]
    assert usual_limit(field, values, Window(5.0, 6.0, 5.0, 6.0)) == 0.0


def test_stress_maps_show_mean_and_shear(loaded: Run) -> None:
    figure = stress_maps(loaded)
    panels = [axes for axes in figure.axes if axes.get_aspect() == 1.0]
    assert len(panels) == 12  # six states
    field_limits = {_field(axes).get_clim() for axes in panels[:6]}
    assert len(field_limits) == 1  # one scale
    labels = [axes.get_ylabel() for axes in figure.axes if axes not in panels]
    assert [label.split(" [")[0] for label in labels] == ["mean stress", "largest shear stress"]
    field = _field(panels[len(panels) // 2 - 1])
    stress = read_matrix(loaded.matrix[-1].path).cell["stress"]
    drawn = np.asarray(field.get_array())
    ratio = 0.5 * (stress[:, 0] + stress[:, 1]) / drawn
    assert ratio == pytest.approx(ratio[0])  # one unit
    low, high = field.get_clim()
    assert low < high
    every = [np.asarray(_field(axes).get_array()) for axes in panels[:6]]
    assert min(values.min() for values in every) <= 0.98 * low  # little room beyond
    assert 1.02 * high <= max(values.max() for values in every)
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == list(style.STATES)


def test_stress_maps_leave_pressure_to_others(wet_run: Path) -> None:
    with pytest.raises(AbsentError, match="pore pressure"):
        stress_maps(read_run(wet_run))


def test_states_of_one_load_are_told_by_their_step(loaded: Run) -> None:
    load = loaded.history.moments()
    assert moment_label(loaded, float(load[2]), 2) == moment_label(loaded, float(load[2]))
    cells = dict(loaded.history.cells)
    cells["load_factor"] = [cells["load_factor"][0]] * loaded.history.rows
    same = replace(loaded, history=replace(loaded.history, cells=cells))
    assert moment_label(same, float(load[0]), 2).endswith(", step 3")


def test_mean_stress_can_be_read_in_grey() -> None:
    """Lighter and lighter from compression to tension."""
    red, green, blue = MEAN_COLOURS(np.linspace(0.0, 1.0, 64))[:, :3].T
    assert np.all(np.diff(0.2126 * red + 0.7152 * green + 0.0722 * blue) > 0.0)
