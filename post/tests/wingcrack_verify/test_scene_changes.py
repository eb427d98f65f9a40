"""Scenes with some values changed."""

from __future__ import annotations

from io import StringIO
from pathlib import Path
from typing import Any

import f90nml
import pytest

from wingcrack.errors import CaseError
from wingcrack.sweeps.scene import scene_text

_SCENE = """\
! a scene / with a slash in a comment
&scene
  name = 'small', title = 'It''s & small /'
/
&side name = 'left', x_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&fracture
  name = 'f1'
  x = 0.96, 1.04
  y = 2*0.5
/
&coarse size_boundary = 0.1 /
"""


def changed(tmp_path: Path, changes: dict[str, Any], *unset: str) -> Any:
    file = tmp_path / "scene.nml"
    file.write_text(_SCENE)
    return f90nml.read(StringIO(scene_text(file, changes, unset)))


def test_what_is_not_changed_stays(tmp_path: Path) -> None:
    before = f90nml.reads(_SCENE)
    after = changed(tmp_path, {})
    del after["output"]  # the fields for ParaView are left out
    assert after == before


def test_values_change_by_group_number_and_name(tmp_path: Path) -> None:
    scene = changed(
        tmp_path,
        {
            "coarse.size_boundary": 0.25,
            "side.2.x_traction": -1.5e7,
            "side.left.y_displacement": 0.0,
            "fracture.f1.x": [0.9, 1.1],
            "growth.enabled": False,
            "fracture.2.name": "f2",
            "fracture.2.friction": 0.5,
        },
    )
    assert scene["coarse"]["size_boundary"] == 0.25
    assert [side.get("x_traction") for side in scene["side"]] == [None, -1.5e7]
    assert scene["side"][0]["y_displacement"] == 0.0
    assert scene["fracture"][0]["x"] == [0.9, 1.1]
    assert scene["growth"]["enabled"] is False
    assert dict(scene["fracture"][1]) == {"name": "f2", "friction": 0.5}


def test_names_items_and_groups_are_taken_away(tmp_path: Path) -> None:
    scene = changed(tmp_path, {}, "side.right", "coarse", "side.1.x_displacement", "fracture.y")
    assert dict(scene["side"]) == {"name": "left"}
    assert "coarse" not in scene
    assert "y" not in scene["fracture"]


@pytest.mark.parametrize("unset", ["growth", "side.3", "side.top", "coarse.size_fracture"])
def test_what_is_not_there_cannot_be_taken_away(tmp_path: Path, unset: str) -> None:
    with pytest.raises(CaseError):
        changed(tmp_path, {}, unset)


@pytest.mark.parametrize("address", ["side.x_traction", "side.4.name", "side.top.name", "coarse"])
def test_an_address_that_leads_nowhere_is_an_error(tmp_path: Path, address: str) -> None:
    with pytest.raises(CaseError):
        changed(tmp_path, {address: 1.0})


def test_a_file_that_is_no_scene_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(CaseError):
        scene_text(tmp_path / "nowhere.nml", {}, ())
