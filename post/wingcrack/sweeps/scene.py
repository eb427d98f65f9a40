"""Scenes with some values changed, as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import Any

from wingcrack.errors import CaseError, SceneError
from wingcrack.runner.task import hash_of
from wingcrack.runs.scene_files import SceneFile

# No fields for ParaView: nothing here reads them, and their cost is not that of the numbers.
DEFAULTS: dict[str, Any] = {"output.vtu": False}


def scene_text(path: Path, changes: Mapping[str, Any], unset: Sequence[str]) -> str:
    """Text of a scene file after the changes.

    Raises `CaseError` if the file cannot be read or an address leads nowhere.

    `path`: the scene file. `changes`: new values by ``group.name`` or, in repeated groups,
    ``group.item.name``; an item is its number from 1 or its name. `unset`: names, items or groups
    that are taken away first.
    """
    try:
        scene = deepcopy(_read(path, _changed(path)))
        for address in unset:
            _remove(scene, address)
        for address, value in (DEFAULTS | dict(changes)).items():
            values = list(value) if isinstance(value, list | tuple) else value
            if not all(isinstance(one, str | int | float) for one in _listed(values)):
                raise SceneError(f"'{address}' must be numbers, texts or truth values, not {value}")
            scene.put(address, values)
    except SceneError as reason:
        raise CaseError(f"{path.name}: {reason}") from None
    return scene.text(stays=True)  # a run has copies of its tables


@lru_cache(maxsize=1)
def _read(path: Path, _changed_ns: int) -> SceneFile:
    """All runs of a study have the same scene file."""
    return SceneFile.read(path)


def _changed(path: Path) -> int:
    return path.stat().st_mtime_ns if path.exists() else 0


@lru_cache(maxsize=1)
def scene_hash() -> str:
    """Hash of this module, which changes scenes; results are always judged again."""
    return hash_of(Path(__file__).read_bytes())


def _listed(values: Any) -> list[Any]:
    return values if isinstance(values, list) else [values]


def _remove(scene: SceneFile, address: str) -> None:
    """Take away a group, an item of it or a name in it."""
    group, _, rest = address.partition(".")
    if "." in rest or address in scene:
        del scene[address]
    else:
        scene.remove(group.lower(), rest or None)
