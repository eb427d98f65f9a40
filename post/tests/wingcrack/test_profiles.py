"""Profiles along fractures: values in their units, a fixed origin, the friction bound."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from synthetic_run import (
    FRICTION,
    LENGTH,
    STEPS,
    fracture_cells,
    times,
    wing_length,
)
from wingcrack.figures import AbsentError, RunError, read_run
from wingcrack.figures.profiles import arc_length, fracture_profiles, state_numbers

LAST = STEPS - 1


def test_panels_labels_and_units(wet_run: Path) -> None:
    ((label, figure),) = fracture_profiles(read_run(wet_run))
    assert label == "1"
    assert figure.get_suptitle() == "flaw"
    assert [axes.get_ylabel() for axes in figure.axes] == [
        r"aperture $a$ [mm]",
        r"opening $[u]_n$ [µm]",
        r"slip $[u]_\tau$ [mm]",
        r"fluid pressure $p_\mathrm{F}$ [MPa]",
        r"normal traction $f_n$ [MPa]",
        r"tangential traction $f_\tau$ [MPa]",
    ]
    assert {axes.get_xlabel() for axes in figure.axes[3:]} == {"distance along the fracture [m]"}


def test_mechanics_only_has_jumps_and_tractions(dry_run: Path) -> None:
    ((_, figure),) = fracture_profiles(read_run(dry_run))
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles == [
        "(a)  opening",
        "(b)  slip",
        "(c)  normal traction",
        "(d)  tangential traction",
    ]


def test_values_of_one_time(wet_run: Path) -> None:
    ((_, figure),) = fracture_profiles(read_run(wet_run), [float(times()[LAST])])
    cells = fracture_cells(LAST)
    expected = [
        1.0 + 1e3 * cells.jump_n,
        1e6 * cells.jump_n,
        1e3 * cells.jump_t,
        1e-6 * cells.pressure,
        1e-6 * cells.traction_n,
        1e-6 * cells.traction_t,
    ]
    for axes, values in zip(figure.axes, expected, strict=True):
        drawn = np.asarray(axes.lines[0].get_ydata())
        assert np.allclose(drawn, values, rtol=1e-12, atol=1e-15)
        x = np.asarray(axes.lines[0].get_xdata())
        # s counts from the tip of a wing, the axis from the old end of the fracture
        assert np.allclose(x, cells.s - wing_length(LAST), rtol=0.0, atol=1e-12)


def test_friction_bound_lies_on_the_side_of_the_traction(wet_run: Path) -> None:
    ((_, figure),) = fracture_profiles(read_run(wet_run), [float(times()[0])])
    cells = fracture_cells(0)
    bound = np.asarray(figure.axes[-1].lines[-1].get_ydata())
    assert np.allclose(bound, 1e-6 * FRICTION * cells.traction_n, rtol=1e-12)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["$t$ = 5 h", r"friction bound $\mu_s |f_n|$, $\mu_s$ = 0.5"]


def test_no_bound_where_the_scene_is_unknown(own_run: Path) -> None:
    (own_run / "scene.nml").unlink()
    ((_, figure),) = fracture_profiles(read_run(own_run), [0.0])
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["$t$ = 5 h"]
    assert figure.get_suptitle() == "flaw"  # as the network calls it
    (own_run / "network.json").unlink()
    ((_, figure),) = fracture_profiles(read_run(own_run), [0.0])
    assert figure.get_suptitle() == "fracture 1"


def test_lines_go_from_dark_to_light_with_time(wet_run: Path) -> None:
    ((_, figure),) = fracture_profiles(read_run(wet_run))
    lines = [line for line in figure.axes[0].lines if line.get_linestyle() == "-"]
    assert len(lines) >= 5
    weights = np.array([0.2126, 0.7152, 0.0722])
    light = [float(np.asarray(line.get_color())[:3] @ weights) for line in lines]
    assert light == sorted(light)
    assert light[-1] < 0.8  # still seen on white


def test_origin_stays_when_arc_length_already_does() -> None:
    time = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
    s = np.array([0.1, 0.3, 0.5, -0.1, 0.1, 0.3, 0.5])
    xy = np.column_stack((s, np.zeros(7)))
    assert np.allclose(arc_length(time, s, xy), s, atol=1e-15)


@pytest.mark.parametrize("factor", [1.0, 0.001, 50.0])
def test_origin_is_kept_between_centres(factor: float) -> None:
    """A straight fracture of 0.6 in three cells; then with a wing of 0.2 in five of 0.16."""
    time = np.array([0.0] * 3 + [1.0] * 5)
    s = factor * np.array([0.1, 0.3, 0.5, 0.08, 0.24, 0.40, 0.56, 0.72])
    x = s - factor * 0.2 * time
    shifted = arc_length(time, s, np.column_stack((0.6 * x, 0.8 * x)))
    assert shifted == pytest.approx(x, abs=1e-12 * factor)


def test_origin_is_kept_on_another_mesh() -> None:
    # the same straight fracture 0 <= x <= 0.6, in three cells; then with a wing of 0.2, in four
    time = np.array([0.0] * 3 + [1.0] * 4)
    s = np.array([0.1, 0.3, 0.5, 0.1, 0.3, 0.5, 0.7])
    x = np.array([0.1, 0.3, 0.5, -0.1, 0.1, 0.3, 0.5])
    shifted = arc_length(time, s, np.column_stack((x, 2.0 * np.ones(7))))
    assert np.allclose(shifted, x, atol=1e-15)


def test_initial_ends_are_marked(wet_run: Path) -> None:
    ((_, figure),) = fracture_profiles(read_run(wet_run), [0.0])
    marks = [np.asarray(line.get_xdata())[0] for line in figure.axes[0].lines[1:]]
    assert np.allclose(marks, [0.0, LENGTH], atol=1e-12)


def test_missing_column_is_named(own_run: Path) -> None:
    path = own_run / "fractures.csv"
    text = path.read_text(encoding="utf-8").replace("jump_t_m", "slip")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RunError, match=r"fractures\.csv: the column 'jump_t_m' is missing"):
        list(fracture_profiles(read_run(own_run)))


def test_run_without_fractures(own_run: Path) -> None:
    (own_run / "fractures.csv").unlink()
    with pytest.raises(AbsentError, match=r"the run has no fractures\.csv"):
        list(fracture_profiles(read_run(own_run)))


def _rewritten(run: Path, column: str, values: list[float]) -> None:
    path = run / "fractures.csv"
    header, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    for row, value in zip(rows, values, strict=False):
        row[header.index(column)] = repr(value)
    text = "\n".join(",".join(row) for row in [header, *rows])
    path.write_text(text + "\n", encoding="utf-8")


def test_round_off_is_drawn_as_zero(own_run: Path) -> None:
    noise = [(-1.0) ** k * 1.0e-6 for k in range(1000)]  # 1e-12 MPa beside tractions of 8 MPa
    _rewritten(own_run, "traction_t_pa", noise)
    ((_, figure),) = fracture_profiles(read_run(own_run))
    axes = figure.axes[-1]
    solid = [line for line in axes.lines if line.get_linestyle() == "-"]
    assert solid
    assert all(np.all(np.asarray(line.get_ydata()) == 0.0) for line in solid)
    assert axes.get_ylim() == (-1.0, 1.0)
    assert [text.get_text() for text in axes.texts] == ["zero"]


def test_narrow_wings_are_seen_beside_a_wide_fracture(own_run: Path) -> None:
    table = read_run(own_run).fractures
    assert table is not None
    s, time = table.number("s_m"), table.number("time_s")
    wide = [1.0e-3 if t == time[0] or x > 0.1 else 4.0e-5 for t, x in zip(time, s, strict=True)]
    _rewritten(own_run, "aperture_m", wide)
    ((_, figure),) = fracture_profiles(read_run(own_run))
    assert figure.axes[0].get_yscale() == "log"
    assert figure.axes[0].get_ylabel() == r"aperture $a$ [µm]"
    low, high = figure.axes[0].get_ylim()
    assert low < 40.0
    assert high > 1000.0


def test_states_at_one_load_are_told_apart() -> None:
    moments = np.array([1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0])
    s = np.array([0.1, 0.3, 0.1, 0.3, -0.1, 0.1, 0.3])
    assert state_numbers(moments, s).tolist() == [0, 0, 1, 1, 2, 2, 2]
