"""Equilibrium paths: branches and energies against closed forms, and what is no such path.

A body whose compliance is C = c0 + c1 a^2 has G = f^2 c1 a: in equilibrium f = sqrt(G_c/(c1 a))
falls, and a load that stays at its first value f0 = f(a0) releases, up to the length a,

    G_c ((a^2 - a0^2)/(2 a0) - (a - a0))  [J/m].

Under grips it is the same with a stiffness S = c0 - c1 a^2 for the compliance.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

import wingcrack
from wingcrack.figures import AbsentError, read_run
from wingcrack.figures.equilibrium import equilibrium_path, find_releases
from wingcrack.figures.equilibrium_figure import draw_equilibrium, equilibrium_figure
from wingcrack.figures.scene import control_of, drive_of, read_groups
from wingcrack.figures.table import FloatArray

TOUGH, RISE, REST = 20.0, 1.0e3, 5.0e3  # G_c [J/m2], c1 [J/m3], c0 [J/m]

SCENE = """\
&scene name = 'path' /
&domain x_min = 0.0, x_max = 4.0, y_min = 0.0, y_max = 4.0 /
&material young = 1.0e9, poisson = 0.2, toughness = 1.0e5 /
&fracture name = 'crack', law = 'open', x = 0.0, 0.1, y = 2.0, 2.0 /
&side name = 'top', y_traction = 1.0e6 /
&restraint x = 0.0, y = 0.0, x_displacement = 0.0, y_displacement = 0.0 /
&load from = 0.0, to = 4.0, steps = 1, control = 'length' /
&growth enabled = .true., law = 'equilibrium' /
"""

Write = Callable[..., Path]


def falling(length: FloatArray) -> FloatArray:
    """Load factor in equilibrium."""
    return np.sqrt(TOUGH / (RISE * length))


def released(first: float, last: float) -> float:
    """Energy that a load sets free which stays at the factor of the first length [J/m]."""
    return TOUGH * ((last**2 - first**2) / (2.0 * first) - (last - first))


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Give a function that writes a run of a path."""

    def written(
        factor: FloatArray,
        length: FloatArray,
        compliance: FloatArray,
        scene: str = SCENE,
        tips: str = "",
        opening: float = 1.0e-4,
    ) -> Path:
        names = "load_factor,fracture_length_m,fracture_volume_m2,max_slip_m,strain_energy_j"
        lines = [
            f"{f!r},{a!r},{opening * a!r},1e-6,{0.5 * f * f * c!r}"
            for f, a, c in zip(factor.tolist(), length.tolist(), compliance.tolist(), strict=True)
        ]
        (tmp_path / "history.csv").write_text("\n".join([names, *lines, ""]))
        (tmp_path / "scene.nml").write_text(scene)
        if tips:
            (tmp_path / "tips.csv").write_text(tips)
        return tmp_path

    return written


def snap_back(write: Write, scene: str = SCENE, way: float = 1.0, states: int = 200) -> Path:
    """Write a path that falls from a length of 0.1 m to 0.6 m, after a state before the onset."""
    length = np.array([0.1, *np.linspace(0.1, 0.6, states)])
    factor = way * falling(length)
    factor[0] *= 0.5
    sign = 1.0 if "y_traction" in scene else -1.0
    return write(factor, length, REST + sign * RISE * length**2, scene)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_snap_back_releases_energy(write: Write, way: float) -> None:
    path = equilibrium_path(read_run(snap_back(write, way=way)))
    (release,) = path.releases
    assert (release.first, release.last, release.arrests) == (0, 199, False)
    assert release.factor == pytest.approx(way * np.sqrt(TOUGH / (0.1 * RISE)))
    assert release.length_m == pytest.approx(0.5)
    assert release.energy_j_m == pytest.approx(released(0.1, 0.6), rel=1e-4)
    assert path.under_forces
    assert path.unstable.all()
    assert path.factor.size == 200


def test_under_grips_the_force_is_conjugate(write: Write) -> None:
    scene = SCENE.replace("y_traction = 1.0e6", "y_displacement = 1.0e-3")
    path = equilibrium_path(read_run(snap_back(write, scene)))
    assert not path.under_forces
    assert path.conjugate_j_m is not None
    assert path.conjugate_j_m[0] == pytest.approx(path.factor[0] * (REST - RISE * 0.01))
    assert path.releases[0].energy_j_m == pytest.approx(released(0.1, 0.6), rel=1e-4)


def test_growth_comes_to_rest_where_the_path_comes_back() -> None:
    """The factor falls along a parabola and rises again: the last piece counts up to its own f0."""
    length = np.linspace(1.0, 2.0, 41)
    factor = 1.0 + (length - 1.2) * (length - 1.7)
    first = int(np.argmax(factor[:9] < factor[0])) - 1
    assert first == 0
    (release,) = find_releases(factor, length, None)
    assert release.arrests
    back = release.last - 1 + release.share
    assert 1.0 + back / 40 == pytest.approx(1.9, abs=1e-3)  # where f is f(1) again
    assert release.length_m == pytest.approx(0.9, abs=1e-3)
    assert release.energy_j_m is None


def test_pieces_count_by_their_trapezoids() -> None:
    """Three states, by hand: f = 2, 1, 3 and C = 1, 2, 4; back at 2 in the middle of the last."""
    factor, length = np.array([2.0, 1.0, 3.0]), np.array([1.0, 2.0, 3.0])
    (release,) = find_releases(factor, length, np.array([1.0, 2.0, 4.0]))
    assert (release.share, release.length_m) == (0.5, 1.5)
    assert release.energy_j_m == pytest.approx(0.5 * 1.5 * 1.0 + 0.5 * 1.5 * 1.0)


@pytest.mark.parametrize(
    ("factor", "length"),
    [
        ([1.0, 2.0, 3.0], [1.0, 1.1, 1.2]),  # stable
        ([1.0, 0.995, 1.2], [1.0, 1.1, 1.2]),  # as far as K_eq may be off
        ([1.0, 0.5, 1.2], [1.0, 1.0, 1.2]),  # the load falls, and nothing grows
        ([1.0], [1.0]),
    ],
)
def test_what_is_not_unstable(factor: list[float], length: list[float]) -> None:
    assert find_releases(np.array(factor), np.array(length), None) == []


def test_growth_at_one_factor_by_its_tips(write: Write) -> None:
    """G - G_c is 0, 20 and 0 J/m2 at three states: trapezoids of it, for each of two tips."""
    tips = "history_row,tip,fracture,keq_pa_sqrtm,g_j_m2,advance_m\n" + "".join(
        f"{row},{tip},1,{1e5 * float(np.sqrt(g / 10.0))!r},{g},{advance}\n"
        for row, g, advance in ((1, 10.0, 0.0), (2, 30.0, 0.1), (3, 10.0, 0.05), (4, 10.0, 0.0))
        for tip in (1, 2)
    )
    scene = SCENE.replace("&load", "&in_situ syy = -1.0e6 /\n&load")
    factor, length = np.array([1.0, 1.0, 1.0, 1.5]), np.array([0.1, 0.3, 0.4, 0.4])
    path = equilibrium_path(read_run(write(factor, length, np.ones(4), scene, tips)))
    assert path.conjugate_j_m is None
    (release,) = path.releases
    assert (release.first, release.last, release.arrests) == (0, 2, True)
    assert release.length_m == pytest.approx(0.3)
    assert release.energy_j_m == pytest.approx(2 * (10.0 * 0.1 + 10.0 * 0.05))
    assert list(path.unstable) == [True, True, False]


def test_energy_without_tips_is_not_known(write: Write) -> None:
    scene = SCENE.replace("&load", "&gravity y = -9.81 /\n&load")
    factor, length = np.array([1.0, 1.0]), np.array([0.1, 0.3])
    path = equilibrium_path(read_run(write(factor, length, np.ones(2), scene)))
    assert [release.energy_j_m for release in path.releases] == [None]
    figure = equilibrium_figure(read_run(write(factor, length, np.ones(2), scene)))
    assert len(figure.axes) == 2


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("control = 'length'", "control = 'dead'"),
        ("law = 'equilibrium'", "law = 'paris'"),
        ("enabled = .true.", "enabled = .false."),
        ("control = 'length'", "factors = 1.0, 0.0"),
        ("&load", "&fluid viscosity = 1.0e-3 / &load"),
    ],
)
def test_no_length_control_no_path(write: Write, old: str, new: str) -> None:
    assert old in SCENE
    with pytest.raises(AbsentError, match="growth does not control the load"):
        equilibrium_path(read_run(snap_back(write, SCENE.replace(old, new))))


def test_nothing_grown_no_path(write: Write) -> None:
    run = read_run(write(np.array([1.0, 2.0]), np.array([0.1, 0.1]), np.ones(2)))
    with pytest.raises(AbsentError, match="nothing has grown"):
        equilibrium_figure(run)


def test_the_run_may_have_a_single_state(write: Write) -> None:
    run = read_run(write(np.array([1.0]), np.array([0.1]), np.ones(1)))
    with pytest.raises(AbsentError, match="nothing has grown"):
        equilibrium_path(run)


@pytest.mark.parametrize(
    ("text", "drive"),
    [
        ("&side y_traction = 2*1.0d6 /", "forces"),
        ("&fracture face_pressure = 1 /", "forces"),
        ("&restraint y_displacement = 1e-3 /", "grips"),
        ("&fracture slip = 1e-3 /", "grips"),
        ("&fracture slip = 1e-3 / &side y_traction = 1 /", ""),
        ("&side y_traction = 0.0, x_displacement = 0 /", ""),
        ("&side y_traction = 1 / &in_situ sxx = -1 /", ""),
        ("&side y_traction = 1 / &gravity y = -9.81 /", ""),
        ("&side y_traction = 1 / &fracture friction = 0.5 /", ""),
        ("&side y_traction = 1 / &fracture friction = 0.0 /", "forces"),
        ("&side y_traction = 1 / &fracture closure = 1e-3 normal_stiffness = 1e9 /", ""),
        ("&side y_traction = load /", "forces"),
        ("", ""),
    ],
)
def test_what_drives_a_body(text: str, drive: str) -> None:
    assert drive_of(read_groups(text)) == drive


def test_length_control_is_the_default() -> None:
    assert control_of(read_groups("&growth enabled = T /")) == "length"
    assert control_of(read_groups("&growth enabled = .TRUE. / &load factors = 1 0 /")) == "dead"
    assert control_of([]) == ""


def test_the_figure_has_branches_and_the_area(write: Write) -> None:
    length = np.linspace(1.0, 2.0, 41)
    factor = 1.0 + (length - 1.2) * (length - 1.7)
    length = np.array([1.0, *length])
    factor = np.array([0.2, *factor])
    figure = equilibrium_figure(read_run(write(factor, length, 1.0e3 * length)))
    against, opening, work = figure.axes
    labels = [line.get_label() for line in against.lines]
    assert {"stable", "unstable", "a load that stays"} <= set(labels)
    assert against.get_xlabel() == "total length [m]"
    assert opening.get_xlabel() == "mean opening [mm]"
    assert work.get_xlabel() == "conjugate displacement $2U/f$ [J/m]"
    (area,) = [patch for patch in work.patches if isinstance(patch, Polygon)]
    x, y = area.get_xy()[:-1].T
    shown = 0.5 * abs(float(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))))
    (release,) = equilibrium_path(read_run(write(factor, length, 1.0e3 * length))).releases
    assert release.energy_j_m is not None
    assert shown == pytest.approx(release.energy_j_m, rel=1e-2)
    assert [text.get_text() for text in work.texts] == [f"{release.energy_j_m:.3g} J/m"]


def test_a_crack_that_only_slips_shows_its_slip(write: Write) -> None:
    length = np.linspace(0.1, 0.6, 9)
    folder = write(falling(length), length, REST + RISE * length**2, opening=0.0)
    axes = Figure().subplots()
    draw_equilibrium(axes, read_run(folder), "opening")
    assert axes.get_xlabel().startswith("largest slip")


def test_axes_of_the_user(write: Write) -> None:
    run = wingcrack.open(snap_back(write, states=9))
    mine = Figure().subplots()
    assert run.plot_equilibrium("conjugate", mine) is mine
    assert run.equilibrium.releases[0].energy_j_m == pytest.approx(released(0.1, 0.6), rel=0.1)
    with pytest.raises(wingcrack.RunError, match="against 'time' cannot be drawn"):
        run.plot_equilibrium("time", mine)
    scene = SCENE.replace("&load", "&gravity y = -9.81 /\n&load")
    run = wingcrack.open(snap_back(write, scene, states=9))
    with pytest.raises(wingcrack.AbsentError, match="not all of the load is in proportion"):
        run.plot_equilibrium("conjugate")
