"""Random networks have the laws that they were drawn by, and keep their distance."""

from __future__ import annotations

import math
from pathlib import Path

import f90nml
import numpy as np
import pytest
import shapely
from shapely.geometry import LineString

from map_calls import fractures, needs_solver, rows
from wingcrack.command_line import main
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.random_network import Set, draw_angles, draw_lengths, random_network

COUNT = 40_000
BOX = (0.0, 0.0, 100.0, 80.0)


def drawn(
    name: str, *numbers: float, seed: int = 3
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return draw_lengths((name, numbers), COUNT, np.random.default_rng(seed))


def is_within(value: float, expected: float, standard_error: float) -> bool:
    """Four standard errors: by chance once in 16,000 times, and the seeds are fixed."""
    return abs(value - expected) <= 4.0 * standard_error


@pytest.mark.parametrize("exponent", [1.5, 2.5, 3.0])
def test_the_exponent_of_a_power_law_is_recovered(exponent: float) -> None:
    """By maximum likelihood (Clauset, Shalizi and Newman 2009), whose error is (a - 1)/sqrt(n)."""
    lengths = drawn("power", exponent, 1.0, 1e9)
    estimate = 1.0 + COUNT / np.log(lengths).sum()
    assert is_within(float(estimate), exponent, (exponent - 1.0) / math.sqrt(COUNT))


@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.5])
def test_a_bounded_power_law_has_its_distribution(exponent: float) -> None:
    """Shares below four lengths against the integral of l^-a, with the binomial's error."""
    lengths = drawn("power", exponent, 2.0, 50.0)
    assert lengths.min() >= 2.0
    assert lengths.max() <= 50.0
    fine = np.geomspace(2.0, 50.0, 200_001)
    density = fine**-exponent
    below = np.concatenate([[0.0], np.cumsum(np.diff(fine) * 0.5 * (density[1:] + density[:-1]))])
    for length in (3.0, 5.0, 10.0, 30.0):
        share = float(np.interp(length, fine, below / below[-1]))
        error = math.sqrt(share * (1.0 - share) / COUNT)
        assert is_within(float((lengths < length).mean()), share, error)


def test_lognormal_and_exponential_lengths() -> None:
    logarithms = np.log(drawn("lognormal", 5.0, 0.6))
    assert is_within(float(logarithms.mean()), math.log(5.0), 0.6 / math.sqrt(COUNT))
    assert is_within(float(logarithms.std()), 0.6, 0.6 / math.sqrt(2 * COUNT))
    assert is_within(float(drawn("exponential", 4.0).mean()), 4.0, 4.0 / math.sqrt(COUNT))
    # an exponential law beyond a bound starts again there
    beyond = drawn("exponential", 4.0, 3.0, 1e9)
    assert beyond.min() >= 3.0
    assert is_within(float(beyond.mean()), 7.0, 4.0 / math.sqrt(COUNT))
    assert set(drawn("constant", 2.0)) == {2.0}


@pytest.mark.parametrize("mean", [0.0, 30.0, 175.0])
def test_the_mean_direction_and_spread_are_recovered(mean: float) -> None:
    """By doubled angles; the mean resultant length for kappa = 10 is I_1(10)/I_0(10) = 0.948600."""
    angles = draw_angles(("vonmises", (mean, 10.0)), COUNT, np.random.default_rng(4))
    resultant = np.exp(2j * angles).mean()
    length = 0.9485998
    error = math.sqrt(1.0 / (COUNT * 10.0 * length))
    assert is_within(float(np.angle(resultant * np.exp(-2j * math.radians(mean)))), 0.0, error)
    variance = 1.0 - length / 10.0 - length**2
    assert is_within(abs(resultant), length, math.sqrt(variance / COUNT))


def test_uniform_directions_have_none() -> None:
    angles = draw_angles(("uniform", ()), COUNT, np.random.default_rng(5))
    assert abs(np.exp(2j * angles).mean()) < 4.0 / math.sqrt(COUNT)
    between = np.degrees(draw_angles(("uniform", (20.0, 50.0)), COUNT, np.random.default_rng(5)))
    assert 20.0 <= between.min() < 20.1
    assert 49.9 < between.max() <= 50.0


@pytest.mark.parametrize(
    ("density", "length"), [(("p20", 0.05), 3.0), (("p21", 0.3), 3.0), (("p21", 0.1), 20.0)]
)
def test_densities_come_out(density: tuple[str, float], length: float) -> None:
    law = Set(density, ("exponential", (length,)), ("uniform", ()))
    lines = random_network([law], BOX, 1, 0.0, False).lines
    if density[0] == "p20":
        assert len(lines) == 400
    total = sum(line.length for line in lines) / 8000.0
    longest = max(line.length for line in lines)
    if density[0] == "p21":
        assert abs(total - density[1]) <= 0.5 * longest / 8000.0
    centres = np.array([line.points.mean(axis=0) for line in lines])
    assert (centres >= 0.0).all()
    assert (centres <= [100.0, 80.0]).all()


@pytest.mark.parametrize("crossings", [False, True])
def test_the_least_distance_is_kept(crossings: bool) -> None:
    law = Set(("p21", 0.15), ("power", (2.5, 3.0, 30.0)), ("uniform", ()))
    shapes = [
        LineString(line.points) for line in random_network([law], BOX, 2, 0.8, crossings).lines
    ]
    crossed = 0
    for i, shape in enumerate(shapes):
        for other in shapes[:i]:
            meet = shape.intersects(other)
            crossed += meet
            ends = shapely.points(shapely.get_coordinates(shape))
            if meet:
                assert min(shapely.distance(ends, other)) >= 0.8
            else:
                assert shape.distance(other) >= 0.8
    assert (crossed > 0) == crossings


def test_rejection_leaves_the_lengths_as_they_were_drawn() -> None:
    law = Set(("p21", 0.12), ("power", (2.5, 3.0, 30.0)), ("vonmises", (30.0, 5.0)))
    free = random_network([law], BOX, 3, 0.0, False)
    kept = random_network([law], BOX, 3, 1.0, False)
    assert [line.length for line in kept.lines] == pytest.approx(
        [line.length for line in free.lines], rel=1e-12
    )
    rejected = next(note.what for note in kept.notes if note.kind == "rejected")
    assert int(rejected.split()[0]) > 0


def test_a_seed_gives_its_network_and_another_one_another() -> None:
    law = Set(("p20", 0.01), ("constant", (5.0,)), ("uniform", ()))
    first, again, other = (random_network([law], BOX, s, 0.5, False).lines for s in (1, 1, 2))
    assert all((a.points == b.points).all() for a, b in zip(first, again, strict=True))
    assert not all((a.points == b.points).all() for a, b in zip(first, other, strict=True))


@pytest.mark.parametrize(
    ("density", "length", "distance", "reason"),
    [
        (("p20", 0.2), ("constant", (8.0,)), 4.0, "found a place, and the next one, 8 m long"),
        (("p20", 1e-6), ("constant", (8.0,)), 0.0, "gives no fracture in this box"),
        (("p20", 1e3), ("constant", (8.0,)), 0.0, "more than 20000 fractures"),
        (("p21", 1e3), ("constant", (0.1,)), 0.0, "more than 20000 fractures"),
        (("p20", 0.1), ("lognormal", (1.0, 0.1, 50.0, 60.0)), 0.0, "hardly ever gives lengths"),
    ],
)
def test_what_cannot_be_is_refused(
    density: tuple[str, float], length: tuple[str, tuple[float, ...]], distance: float, reason: str
) -> None:
    with pytest.raises(SceneError, match=reason):
        random_network([Set(density, length, ("uniform", ()))], BOX, 1, distance, False)


@needs_solver
def test_two_sets_become_a_scene_that_the_solver_takes(tmp_path: Path) -> None:
    out = tmp_path / "r.nml"
    call = ["import", "--box=0,0,60,40", "--seed=7", "--distance=0.5", "--out", str(out)]
    for length, angle in (("power:2.5,4,20", "vonmises:30,20"), ("constant:3", "constant:120")):
        call += ["--density=p21=0.05", f"--length={length}", f"--orientation={angle}"]
    assert main(call) == 0
    names = list(fractures(out))
    assert any(name.startswith("set1_") for name in names)
    assert any(name.startswith("set2_") for name in names)
    assert {row[0] for row in rows(out, "noted")} == {"density", "rejected", "assumed", "cells"}


@needs_solver
def test_a_network_grows_with_cells_by_the_lengths(tmp_path: Path) -> None:
    out = tmp_path / "r.nml"
    call = ["import", "--box=0,0,60,40", "--seed=7", "--distance=0.5", "--out", str(out)]
    call += ["--density=p20=0.002", "--length=power:2.5,4,20", "--orientation=uniform"]
    assert main([*call, "--growth"]) == 0
    assert "enabled = .true." in out.read_text()
    assert "coarse" not in f90nml.read(out)


@pytest.mark.parametrize(
    ("option", "reason"),
    [
        ("--box=0,0,1e308,1e308", "must be X0,Y0,X1,Y1, none beyond 1e+08 m"),
        ("--box=0,0,1e-300,1", "with X0 < X1"),
        ("--margin=1e308", "must be at most 1e+08 m"),
        ("--length=constant:1e300", "lengths must be at most 1e+08 m"),
        ("--length=lognormal:1,1e3", "SIGMA must be at most 20"),
        ("--out=.mine.nml", "begins with a letter or a digit"),
    ],
)
def test_numbers_and_names_of_a_call_are_bounded(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    option: str,
    reason: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    given = {
        "--box": "0,0,9,9",
        "--density": "p20=1",
        "--length": "constant:1",
        "--orientation": "uniform",
        "--out": "n.nml",
    }
    name, _, value = option.partition("=")
    given[name] = value
    with pytest.raises(SystemExit) as ended:
        main(["import", *(f"{key}={text}" for key, text in given.items())])
    assert ended.value.code == 2
    assert reason in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
