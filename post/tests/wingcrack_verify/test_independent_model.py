"""The independent model of scene C2 against closed forms and the catalogue of references."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from independent.elastic import (
    NODES,
    POINTS,
    Complexes,
    Elements,
    Numbers,
    equivalent_intensity,
    influence,
    intensity,
    shapes,
    symmetric_influence,
    turned,
)
from independent.geometry import Resolution, build_geometry
from independent.growth import find_onset
from independent.images import Supports, lattice
from independent.poroelastic import Pairs, Rock, exponential_integral, point_source
from independent.simulation import Scene, Simulation

ROCK = Rock(40e9, 0.2, 0.8, 0.01, 5e-20, 4e-10, 1e-4)
SCENE = Scene(
    ROCK,
    toughness=0.7e6,
    stress_xx=-20e6,
    stress_yy=-10e6,
    half_length=0.05,
    angle=math.pi / 4.0,
    aperture=1e-3,
    friction=0.5,
    dilation=math.tan(math.radians(1.0)),
    rate=5e-9,
    gain=0.25,
)


def graded(levels: int, ratio: float = 2.5) -> Numbers:
    """Places 0..1 that come closer towards 1."""
    return np.concatenate([1.0 - ratio ** -np.arange(levels), [1.0]])


def row(corners: list[complex], cuts: list[Numbers]) -> Elements:
    """Elements along a polyline with a free tip at its end."""
    centre, angle, half = [], [], []
    for start, end, places in zip(corners[:-1], corners[1:], cuts, strict=True):
        for low, high in pairwise(places):
            centre.append(start + (end - start) * (low + high) / 2.0)
            angle.append(np.angle(end - start))
            half.append(abs(end - start) * (high - low) / 2.0)
    tip = np.arange(len(half)) == len(half) - 1
    return Elements(np.array(centre), np.array(angle), np.array(half), tip)


def one_cell(half: float, angle: float = 0.0) -> tuple[Complexes, Numbers, Numbers]:
    return np.array([0j]), np.array([angle]), np.array([half])


@pytest.mark.parametrize("mode", [0, 1])
def test_straight_crack(mode: int) -> None:
    elements = row([0j, 1.0 + 0j], [np.linspace(0.0, 1.0, 5)])
    matrix = symmetric_influence(elements, 1.0)[mode, :, mode, :]
    coefficients = np.linalg.solve(matrix, -np.ones(elements.points.size))
    assert intensity(coefficients[-POINTS], elements.half[-1], 1.0) == pytest.approx(
        math.sqrt(math.pi), rel=2e-4
    )
    opening = np.concatenate([coefficients[:-POINTS], shapes(NODES, True) @ coefficients[-POINTS:]])
    exact = 4.0 * np.sqrt(1.0 - elements.points.real**2)
    assert np.abs(opening - exact).max() < 4e-3


@pytest.mark.parametrize(
    ("friction", "lateral", "length", "kink", "k1", "k2"),
    [  # catalogue 1.9
        (0.0, 0.0, 0.01, 70.528779, 0.5478194252, 0.09941944199),
        (0.3, 0.0, 0.2, 45.0, 0.219349968, 0.2165947589),
        (0.3, 0.0, 0.2, 70.528779, 0.257689214, -0.00598654377),
        (0.3, 0.05, 2.0, 45.0, 0.03051089082, 0.1020518748),
    ],
)
def test_winged_frictional_crack(
    friction: float, lateral: float, length: float, kink: float, k1: float, k2: float
) -> None:
    corner = np.exp(0.25j * math.pi)
    tip = corner + length * np.exp(1j * (math.pi / 4.0 - math.radians(kink)))
    levels = graded(12)
    wing = np.concatenate([0.5 * (1.0 - levels[::-1]), [0.75, 1.0]])
    elements = row([0j, complex(corner), complex(tip)], [levels, wing])
    count, closed = elements.points.size, (levels.size - 1) * POINTS
    far = turned(-np.ones(count), np.full(count, -lateral), np.zeros(count), elements.point_angles)
    rows = symmetric_influence(elements, 1.0).reshape(2, count, 2 * count)
    matrix, right = np.concatenate([rows[0], rows[1]]), -np.concatenate(far)
    slide = slice(count, count + closed)
    matrix[slide] += friction * matrix[:closed]
    right[slide] += friction * right[:closed]
    matrix[:closed] = np.eye(2 * count)[:closed]
    right[:closed] = 0.0
    solution = np.linalg.solve(matrix, right)
    scale = math.sqrt(math.pi)
    half = float(elements.half[-1])
    found = [intensity(solution[end - POINTS], half, 1.0) / scale for end in (count, 2 * count)]
    assert found == pytest.approx([k1, k2], abs=0.003 * max(abs(k1), abs(k2)))


def test_kinked_crack() -> None:
    branch = 1.0 + 0.2 * np.exp(0.25j * math.pi)
    levels = graded(12)
    both = np.concatenate([1.0 - levels[:0:-1], 1.0 + levels]) / 2.0
    wing = np.concatenate([0.5 * (1.0 - levels[::-1]), [0.75, 1.0]])
    elements = row([-1.0 + 0j, 1.0 + 0j, complex(branch)], [both, wing])
    count = elements.points.size
    rows = influence(elements, elements.points, elements.point_angles, 1.0)
    far = turned(np.zeros(count), np.ones(count), np.zeros(count), elements.point_angles)
    matrix = rows.reshape(2, count, 2 * count).reshape(2 * count, -1)
    solution = np.linalg.solve(matrix, -np.concatenate(far))
    half = float(elements.half[-1])
    found = [intensity(solution[end - POINTS], half, 1.0) for end in (count, 2 * count)]
    expected = [0.6549851593, 0.5229452518]  # catalogue 1.8, 45 degrees, b/a = 0.2
    assert np.array(found) / math.sqrt(math.pi) == pytest.approx(expected, rel=0.004)


def test_direction_of_pure_sliding() -> None:
    k_eq, angle = equivalent_intensity(0.0, 1.0)
    assert k_eq == pytest.approx(2.0 / math.sqrt(3.0))
    assert math.degrees(angle) == pytest.approx(-70.528779)


def test_exponential_integral() -> None:
    for u in (1e-6, 0.3, 0.999, 1.001, 3.0):
        series = sum((-u) ** k / (k * math.factorial(k)) for k in range(1, 60))
        exact = -0.5772156649015329 - math.log(u) - series
        assert exponential_integral(np.array([u]))[0] == pytest.approx(exact, abs=3e-7)


@pytest.mark.parametrize(
    ("distance", "time", "pressure", "radial", "tangential"),
    [  # catalogue 4.6, Q = 5e-9 [m, s, MPa]
        (0.1, 3600.0, 1.661201851, -0.728368068, -0.2683530423),
        (0.1, 54000.0, 3.761640764, -1.366629357, -0.8903551012),
        (0.5, 21600.0, 0.6973371886, -0.4142598364, -0.004142476754),
    ],
)
def test_line_source(
    distance: float, time: float, pressure: float, radial: float, tangential: float
) -> None:
    half = 1e-5
    away = np.exp(0.7j)
    for turn, stress in ((0.0, tangential), (math.pi / 2.0, radial)):
        line = np.array([0.7 + turn])
        pairs = Pairs(ROCK, np.array([distance * away]), line, *one_cell(half, 0.2))
        found = pairs.source(time)[:, 0, 0] * 5e-9 / (2.0 * half) / 1e6
        assert found[:2] == pytest.approx([pressure, stress], rel=1e-5, abs=1e-6)
    closed = np.array(point_source(ROCK, distance, time)) * 5e-9 / 1e6
    assert closed == pytest.approx([pressure, radial, tangential], rel=1e-5, abs=1e-6)


def test_jumps_are_undrained_at_first_and_drained_in_the_end() -> None:
    cell = one_cell(0.01, 0.3)
    points = np.array([0.006 * np.exp(0.3j), 0.03 + 0.01j, 0.2 - 0.1j])
    lines = np.array([0.3, 0.9, 2.0])
    elements = Elements(*cell, np.array([False]))
    unit = influence(elements, points, lines, 1.0).sum(axis=-1)  # [traction, point, jump]
    pairs = Pairs(ROCK, points, lines, *cell)
    assert pairs.elastic()[..., 0] == pytest.approx(unit.transpose(2, 0, 1), abs=1e-6)
    undrained = 0.5 * (3 * 38.4022 - 2 * 16.66667) / (3 * 38.4022 + 16.66667)  # nu of K_u, G
    assert ROCK.modulus + ROCK.stiffening == pytest.approx(
        2.0 * ROCK.shear / (1.0 - undrained), rel=1e-4
    )
    late = pairs.jump(1e9)[:, 1:3] / ROCK.modulus
    assert np.abs(late).max() < 1e-6 * np.abs(unit).max()


def test_pressure_of_a_jump_and_stress_of_a_source_are_reciprocal() -> None:
    places, lines = np.array([0j, 0.03 + 0.02j]), np.array([0.3, 1.2])
    pairs = Pairs(ROCK, places, lines, places, lines, np.array([1e-4, 1e-4]))
    time, step = 40.0, 1e-3
    volume = (pairs.source(time + step) - pairs.source(time - step)) / (2.0 * step)
    jump = pairs.jump(time)
    assert volume[1:3, 0, 1] == pytest.approx(-jump[:, 0, 1, 0], rel=1e-4)


def test_leak_off_is_one_dimensional_at_first() -> None:
    pairs = Pairs(ROCK, np.array([0.001 + 0j]), np.array([0.0]), *one_cell(0.01))
    pressure = pairs.source(0.2)[0, 0, 0]
    exact = math.sqrt(0.2 / math.pi) / math.sqrt(ROCK.mobility * ROCK.uniaxial_storage)
    assert pressure == pytest.approx(exact, rel=1e-3)


def test_undrained_start() -> None:
    simulation = Simulation(SCENE, Resolution())
    state = simulation.start()
    assert SCENE.initial_pressure == pytest.approx(6.902061032e6, rel=1e-9)  # catalogue 4.0
    drive = 5e6 - 0.5 * (15e6 - state.pressure)
    slipping = drive / (1.0 + 0.5 * SCENE.dilation)  # catalogue 3.1
    root = math.sqrt(math.pi * SCENE.half_length)
    assert state.k2 == pytest.approx(slipping * root, rel=1e-3)
    assert state.k1 == pytest.approx(slipping * SCENE.dilation * root, rel=1e-3)


@pytest.mark.parametrize("supports", ["tractions", "rollers"])
def test_sealed_body_fills_up(supports: Supports) -> None:
    """Late, under constant tractions, dp/dt = Q/(area (S + alpha^2/(lambda + G)))."""
    rate = 5e-10
    scene = replace(SCENE, toughness=1e9, rate=rate, supports=supports)
    simulation = Simulation(scene, Resolution(fracture_cells=4, side_cells=8))
    simulation.start()
    body = simulation.body([])
    matrices = body.influence(ROCK.modulus)
    for time in [*np.geomspace(1e3, 7e4, 12), 8e4, 9e4]:
        simulation.accept(simulation.trial(float(time), body, matrices))
    before, after = simulation.states[-2:]
    rise = (after.pressure - before.pressure) / (after.time - before.time)
    lame = ROCK.oedometric - 2.0 * ROCK.shear
    storage = ROCK.storage + ROCK.biot**2 / (lame + ROCK.shear)
    assert rise == pytest.approx(rate / (4.0 * storage), rel=0.02)


def test_nothing_flows_out_of_the_lattice() -> None:
    """Pressure of a crack and its mirror images on both sides of a side of the body."""
    points = np.array([0.99 + 0.3j, 1.01 + 0.3j, 0.2 + 0.99j, 0.2 + 1.01j])
    centre, angle, half = np.array([0.1 + 0.05j]), np.array([0.3]), np.array([0.01])
    pressure = np.zeros(4)
    for copy in lattice(-2, 2, 1.0):
        pairs = Pairs(ROCK, points, np.zeros(4), copy.places(centre), copy.directions(angle), half)
        pressure += copy.weight * pairs.source(5e4)[0, :, 0]
    assert pressure[::2] == pytest.approx(pressure[1::2], rel=1e-4)


def test_onset_does_not_depend_on_the_steps() -> None:
    times = []
    for growth in (1.3, 1.14):
        simulation = Simulation(SCENE, Resolution(step_growth=growth))
        simulation.start()
        times.append(find_onset(simulation, lambda state: None).time)
    assert times[0] == pytest.approx(times[1], rel=0.01)


def test_cells_cover_the_crack() -> None:
    geometry = build_geometry(Resolution(), 0.05, 0.5, None, [0.01 + 0j, 0.02 - 0.001j])
    assert geometry.wing == pytest.approx(0.01 + abs(0.01 - 0.001j))
    averages = geometry.averages()
    lengths = np.bincount(geometry.cell_of_element, weights=geometry.elements.half)
    assert lengths == pytest.approx(geometry.half)
    assert averages[:-1].sum(axis=1) == pytest.approx(1.0)
    assert geometry.points_from_cells().sum(axis=1) == pytest.approx(1.0)
    assert np.all(np.diff(geometry.places) > 0.0)
