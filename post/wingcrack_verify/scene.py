"""Scenes with some values changed: the namelists of a scene file, edited by group and name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

import f90nml

from wingcrack_verify.errors import CaseError

# No fields for ParaView: nothing here reads them, and their cost is not that of the numbers.
DEFAULTS: dict[str, Any] = {"output.vtu": False}


def scene_text(path: Path, changes: Mapping[str, Any], unset: Sequence[str]) -> str:
    """Text of a scene file after the changes.

    Parameters
    ----------
    path : Path
        The scene file.
    changes : mapping
        New values by ``group.name`` or, in repeated groups, ``group.item.name``; an item is its
        number from 1 or its name.
    unset : sequence of str
        Names, items or groups that are taken away first.

    Raises
    ------
    CaseError
        If the file cannot be read or an address leads nowhere.
    """
    try:
        scene = f90nml.read(path)
    except Exception as reason:  # the library raises many kinds, ValueError and AttributeError too
        raise CaseError(f"{path.name}: not a namelist file ({reason})") from None
    for address in unset:
        _remove(scene, address)
    for address, value in (DEFAULTS | dict(changes)).items():
        _set(scene, address, value)
    text = StringIO()
    scene.write(text)
    return text.getvalue()


def _set(scene: Any, address: str, value: Any) -> None:
    group_name, *item, name = _parts(address)
    items = _items(scene, group_name)
    if not items or item == [str(len(items) + 1)]:  # the first of its kind, or one more
        items = [*items, f90nml.Namelist()]
        scene[group_name] = items if len(items) > 1 else items[0]
    group = _group(scene, group_name, item, address)
    group[name] = list(value) if isinstance(value, list | tuple) else value


def _remove(scene: Any, address: str) -> None:
    if "." not in address:
        if address.lower() not in scene:
            raise CaseError(f"unset: the scene has no group '{address}'")
        del scene[address.lower()]
        return
    group_name, *item, last = _parts(address)
    found = scene.get(group_name)
    if not item and (isinstance(found, list) or last not in (found or {})):
        _drop_item(scene, group_name, last, address)
        return
    group = _group(scene, group_name, item, address)
    if last not in group:
        raise CaseError(f"unset: the scene has no '{address}'")
    del group[last]


def _drop_item(scene: Any, group_name: str, item: str, address: str) -> None:
    items = _items(scene, group_name)
    kept = [entry for entry in items if entry is not _pick(items, item, address)]
    del scene[group_name]
    if kept:
        scene[group_name] = kept if len(kept) > 1 else kept[0]


def _group(scene: Any, name: str, item: Sequence[str], address: str) -> Any:
    items = _items(scene, name)
    if item:
        return _pick(items, item[0], address)
    if len(items) != 1:
        raise CaseError(f"'{address}': there are {len(items)} groups '{name}'; say which")
    return items[0]


def _items(scene: Any, name: str) -> list[Any]:
    found = scene.get(name)
    if found is None:
        return []
    return list(found) if isinstance(found, list) else [found]


def _pick(items: Sequence[Any], item: str, address: str) -> Any:
    if item.isdigit():
        if not 1 <= int(item) <= len(items):
            raise CaseError(f"'{address}': there is no item {item} (there are {len(items)})")
        return items[int(item) - 1]
    named = [entry for entry in items if str(entry.get("name", "")) == item]
    if len(named) != 1:
        raise CaseError(f"'{address}': there is no item '{item}' of that name")
    return named[0]


def _parts(address: str) -> list[str]:
    parts = address.split(".")
    if not 2 <= len(parts) <= 3 or not all(parts):
        raise CaseError(f"'{address}' must be group.name or group.item.name")
    return [parts[0].lower(), *parts[1:-1], parts[-1].lower() if len(parts) == 3 else parts[-1]]
