"""Faults in scenes and calls: the real program names them, ends with 2 and writes nothing."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from system_scene import SCENE, TOP, bare, varied

pytestmark = pytest.mark.usefixtures("program")

# What is changed in the scene; then the group and the words that the refusal must hold. All other
# refusals: fortran/scene/tests/test_scene_faults.f90.
FAULTS = {
    "unknown group": ("&fluid", "&fluit", "&fluit", "the nearest is &fluid"),
    "missing value": ("friction = 0.5, ", "", "&fracture", "friction"),
    "body that can move": (
        "&side name = 'left', x_displacement = 0.0 /",
        "",
        "&side",
        "the body can move in x; give a &side or a &restraint an",
    ),
    "fracture outside": ("y = 0.96", "y = -0.96", "&fracture", "leaves the domain at (0.964645, -"),
}


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("command", ["run", "check"])
def test_a_faulty_scene_is_refused(command: str, fault: str, tmp_path: Path) -> None:
    old, new, group, words = FAULTS[fault]
    (tmp_path / "faulty.nml").write_text(varied((old, new)))
    options = ["--out", "out"] if command == "run" else []
    done = bare(tmp_path, command, "faulty.nml", *options)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("wingcrack: faulty.nml:")
    assert done.stderr.count("\n") == 1
    assert group in done.stderr
    assert words in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["faulty.nml"]


# The L of a polygon with a crack in it; then what is changed, and what the refusal must hold.
POLYGON = """\
&domain shape = 'polygon'
  x = 0.0, 2.0, 2.0, 1.0, 1.0, 0.0
  y = 0.0, 0.0, 1.0, 1.0, 2.0, 2.0
/
&material young = 1.0e9, poisson = 0.2, density = 2500.0 /
&gravity y = -9.81 /
&fracture name = 'f', x = 0.4, 0.6, y = 0.5, 0.5, law = 'open' /
&side name = 'floor', edges = 1, x_displacement = 0.0, y_displacement = 0.0 /
&side name = 'end', edges = 2, normal_traction = -1.0e6 /
&fe size_fracture = 0.1, size_boundary = 0.5 /
"""
POLYGON_FAULTS = {
    "corner twice": (
        "y = 0.0, 0.0, 1.0",
        "y = 0.0, 0.0, 0.0",
        "faulty.nml:1: &domain",
        "corner 2 and corner 3 lie at one place",
    ),
    "edges cross": ("y = 0.0, 0.0, 1.0", "y = 0.0, 3.0, 1.0", "faulty.nml:1: &domain", "meet"),
}


@pytest.mark.parametrize("fault", POLYGON_FAULTS)
def test_a_faulty_polygon_is_refused(fault: str, tmp_path: Path) -> None:
    old, new, place, words = POLYGON_FAULTS[fault]
    assert old in POLYGON
    (tmp_path / "faulty.nml").write_text(POLYGON.replace(old, new, 1))
    done = bare(tmp_path, "run", "faulty.nml", "--out", "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert place in done.stderr
    assert words in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["faulty.nml"]


# A second fracture of the scene, and what the refusal of the two must hold; f1 is on line 8.
LAW = "friction = 0.5, aperture = 1.0e-3 /"
NETWORK_FAULTS = {
    "V at 1.6 degrees": (
        "x = 1.0353553390593274, 0.9, y = 1.0353553390593274, 0.896",
        "8: &fracture: fracture 'f1' and fracture 'f2' (line 14) meet at too small an angle at "
        "(1.03536, 1.03536)",
    ),
    "leaves the body": (
        "x = 1.5, 2.5, y = 1.5, 1.5",
        "14: &fracture: fracture 'f2' leaves the domain at (2.5, 1.5); shorten it or enlarge",
    ),
    "the same again": (
        "x = 0.9646446609406726, 1.0353553390593274, y = 0.9646446609406726, 1.0353553390593274",
        "8: &fracture: fracture 'f1' and fracture 'f2' (line 14) overlap at (0.964645, 0.964645)",
    ),
    "nearly touch": (
        "x = 1.0, 1.2, y = 1.00001, 1.3",
        "8: &fracture: fracture 'f1' and fracture 'f2' (line 14) come within 7.07107e-06 m",
    ),
}


@pytest.mark.parametrize("fault", NETWORK_FAULTS)
def test_check_and_run_judge_a_network_alike(fault: str, tmp_path: Path) -> None:
    vertices, words = NETWORK_FAULTS[fault]
    fracture = f"&fracture name = 'f2', {vertices}\n  {LAW}\n"
    first_side = "&side name = 'left'"
    growth = ("intensities = .true.", "enabled = .true.")
    (tmp_path / "faulty.nml").write_text(varied((first_side, fracture + first_side), growth))
    checked = bare(tmp_path, "check", "faulty.nml")
    ran = bare(tmp_path, "run", "faulty.nml", "--out", "out")
    assert checked.stderr == ran.stderr
    assert checked.stderr.startswith(f"wingcrack: faulty.nml:{words}")
    assert (checked.returncode, ran.returncode, checked.stdout, ran.stdout) == (2, 2, "", "")
    assert [path.name for path in tmp_path.iterdir()] == ["faulty.nml"]


# What is too large for any machine, with the number of it.
SIZES = {
    "steps": (
        ("end = 18000.0, step = 3600.0", "end = 1.0e12, step = 1.0e-3"),
        "&time: step asks for about 1000000000000000 steps, and a run counts up to 2150000000",
    ),
    "tables": (
        ("end = 18000.0, step = 3600.0", "end = 2.0e9, step = 1.0"),
        "&time: step asks for about 2000000000 steps; their tables need at least",
    ),
    "cells": (
        (
            "size_fracture = 0.02, size_boundary = 0.25",
            "size_fracture = 1e-6, size_boundary = 1e-6",
        ),
        "&coarse: the sizes ask for about 9240000000000 cells, and a run numbers up to 10700000",
    ),
    "cells that rounding blurs": (
        ("size_fracture = 0.02", "size_fracture = 1e-9"),
        "&coarse: size_fracture is 1.0e-9 but must be at least 2.828e-8: elements of less than",
    ),
    "elements that rounding blurs": (
        ("&fine window", "&fine size_ratio = 1e-7, window"),
        "&fine: size_ratio is 1.0e-7 but must be at least 1.414e-6: elements of less than",
    ),
    "cells at the fracture": (
        ("size_fracture = 0.02", "size_fracture = 1e-7"),
        "&coarse: the sizes ask for about",
    ),
}


@pytest.mark.parametrize("size", SIZES)
def test_a_scene_that_is_too_large_is_refused_with_the_number(size: str, tmp_path: Path) -> None:
    change, words = SIZES[size]
    (tmp_path / "large.nml").write_text(varied(change))
    checked = bare(tmp_path, "check", "large.nml")
    ran = bare(tmp_path, "run", "large.nml", "--out", "out")
    assert checked.stderr == ran.stderr
    assert words in checked.stderr
    assert checked.stderr.startswith("wingcrack: large.nml:")
    assert (checked.returncode, ran.returncode, checked.stdout, ran.stdout) == (2, 2, "", "")
    assert [path.name for path in tmp_path.iterdir()] == ["large.nml"]


@pytest.mark.parametrize("radius", ["1e-9", "1e-12", "1e-300"])
def test_a_rosette_that_rounding_blurs_is_refused_with_the_number(
    radius: str, tmp_path: Path
) -> None:
    scene = (TOP / "inputs/paper_b/edge_mode1.nml").read_text()
    text = scene.replace("&fe\n", f"&fe\n  rosette_radius = {radius}\n", 1)
    (tmp_path / "small.nml").write_text(text)
    done = bare(tmp_path, "run", "small.nml", "--out", "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert "&fe: rosette_radius is 1.0e-" in done.stderr
    assert "but must be at least 2.236e-8" in done.stderr
    least = text.replace(radius, "2.3e-8", 1)
    (tmp_path / "small.nml").write_text(least)
    done = bare(tmp_path, "run", "small.nml", "--out", "out", "--quiet")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("out", ["file", "file/deeper"])
def test_to_the_bare_solver_neither(out: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("somebody's file\n")
    (tmp_path / "small.nml").write_text(SCENE)
    done = bare(tmp_path, "run", "small.nml", "--out", out)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"cannot make the directory {out}" in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "small.nml"]


def test_a_description_that_cannot_be_written_is_a_failure(tmp_path: Path) -> None:
    (tmp_path / "small.nml").write_text(SCENE)
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [TOP / "wingcrack", "check", "small.nml"],
            cwd=tmp_path,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    assert done.returncode == 1
    assert "the output cannot be written: No space left on device" in done.stderr
