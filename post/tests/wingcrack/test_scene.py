"""The values that figures take from ``scene.nml``."""

from __future__ import annotations

from pathlib import Path

import pytest

from wingcrack.errors import RunError
from wingcrack.figures.scene import read_groups, read_scene

# in the form in which the solver writes it
WRITTEN = """\
! The scene as understood, every default written out: running it again gives the same run.

&scene
  name = 'wing_crack'
  title = 'injection / slip ! and ''wings'''
/

&material
  young = 4.0e+10  ! [Pa]
  toughness = 7.0e+5  ! [Pa m^1/2]
  ! permeability_xx: see permeability
/

&fracture
  name = 'ab'
  x =  ! [m]
    1.0
    1.0
  friction = 0.5
/

&fracture
  name = 'cd'
  friction = 0.0
/
"""


def _scene(folder: Path, text: str) -> Path:
    path = folder / "scene.nml"
    path.write_text(text, encoding="utf-8")
    return path


def test_written_scene(tmp_path: Path) -> None:
    scene = read_scene(_scene(tmp_path, WRITTEN))
    assert scene is not None
    assert scene.name == "wing_crack"
    assert scene.title == "injection / slip ! and 'wings'"
    assert scene.toughness_pa_sqrtm == 7.0e5
    assert [(law.name, law.friction) for law in scene.fractures] == [("ab", 0.5), ("cd", 0.0)]


def test_fracture_is_found_by_name_and_by_number_from_one(tmp_path: Path) -> None:
    scene = read_scene(_scene(tmp_path, WRITTEN))
    assert scene is not None
    assert scene.fracture("cd") is scene.fractures[1]
    assert scene.fracture("1") is scene.fractures[0]
    assert scene.fracture("0") is None
    assert scene.fracture("3") is None
    assert scene.fracture("xy") is None


def test_several_values_on_a_line_and_any_case() -> None:
    text = "&Fracture NAME='a', X = 0.1, 0.2 y= 1 2 /"
    assert read_groups(text) == [
        ("fracture", {"name": ["'a'"], "x": ["0.1", "0.2"], "y": ["1", "2"]})
    ]


def test_text_between_groups_is_no_value() -> None:
    assert read_groups("a = 1 &time end = 2 / b = 3") == [("time", {"end": ["2"]})]


def test_unlimited_toughness_and_missing_file_are_none(tmp_path: Path) -> None:
    scene = read_scene(_scene(tmp_path, "&material\n  ! toughness: unlimited\n/\n"))
    assert scene is not None
    assert scene.toughness_pa_sqrtm is None
    assert read_scene(tmp_path / "other.nml") is None


def test_fortran_double_precision_exponent(tmp_path: Path) -> None:
    scene = read_scene(_scene(tmp_path, "&material toughness = 1.5D6 /"))
    assert scene is not None
    assert scene.toughness_pa_sqrtm == 1.5e6


def test_the_body_as_window_has_no_edge(tmp_path: Path) -> None:
    for words, edge in (("'body'", None), ("0.5", 0.5)):
        scene = read_scene(_scene(tmp_path, f"&fluid /\n&fine window = {words} /"))
        assert scene is not None
        assert scene.window_m == edge


def test_bad_number_is_located(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"scene\.nml: 'high' for toughness in &material is no"):
        read_scene(_scene(tmp_path, "&material toughness = high /"))


@pytest.mark.parametrize(
    ("x", "y", "is_known"),
    [
        ("0.0, 4.0, 4.0", "0.0, 0.0, 3.0", True),
        ("0.0, 4.0, 4.0", "0.0, 0.0", False),
        ("0.0, 4.0", "0.0, 0.0", False),
        ("0.0, 4.0", "0.0, 0.0, 3.0", False),
    ],
)
def test_a_polygon_has_three_corners_and_each_both_coordinates(
    tmp_path: Path, x: str, y: str, is_known: bool
) -> None:
    (tmp_path / "scene.nml").write_text(f"&domain shape = 'polygon', x = {x}, y = {y} /\n")
    scene = read_scene(tmp_path / "scene.nml")
    assert scene is not None
    corners = None if scene.outline is None else scene.outline.tolist()
    assert corners == ([[0, 0], [4, 0], [4, 3], [0, 0]] if is_known else None)
