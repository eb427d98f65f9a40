"""Scenes with some values changed: the namelists of a scene file, edited by group and name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from io import StringIO
from pathlib import Path
from typing import Any, TypeAlias

import f90nml

from wingcrack.errors import CaseError
from wingcrack.figures.text_files import namelist_groups, read_text
from wingcrack.runner.task import hash_of

_Groups: TypeAlias = dict[str, list[Any]]

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
        groups = _groups(namelist_groups(read_text(path)))
    except (OSError, ValueError) as reason:
        raise CaseError(f"{path.name}: {reason}") from None
    for address in unset:
        _remove(groups, address)
    for address, value in (DEFAULTS | dict(changes)).items():
        _set(groups, address, value)
    text = StringIO()
    for name, items in groups.items():
        for item in items:
            f90nml.Namelist({name: item}).write(text)
    return text.getvalue()


@lru_cache(maxsize=1)
def scene_hash() -> str:
    """Hash of this module, which changes scenes; results are always judged again."""
    return hash_of(Path(__file__).read_bytes())


def _groups(scene: Any) -> _Groups:
    """All groups by name, each as a list of its items: most have one."""
    groups: _Groups = {}
    for name, group in scene.items():
        groups.setdefault(str(name), []).append(group)
    return groups


def _set(groups: _Groups, address: str, value: Any) -> None:
    group_name, *item, name = _parts(address)
    items = groups.setdefault(group_name, [])
    if not items or item == [str(len(items) + 1)]:  # the first of its kind, or one more
        items.append(f90nml.Namelist())
    group = _pick(items, item, address)
    values = list(value) if isinstance(value, list | tuple) else [value]
    if not all(isinstance(one, str | int | float) for one in values):
        raise CaseError(f"'{address}' must be numbers, texts or truth values, not {value}")
    group[name] = values if isinstance(value, list | tuple) else value


def _remove(groups: _Groups, address: str) -> None:
    """Take away a group, an item of it or a name in it."""
    group_name, _, rest = address.lower().partition(".")
    items = groups.get(group_name, [])
    if not items:
        raise CaseError(f"unset: the scene has no group '{group_name}'")
    if not rest:
        del groups[group_name]
    elif "." not in rest and not (len(items) == 1 and rest in items[0]):
        items.remove(_pick(items, [address.partition(".")[2]], address))
    else:
        _, *item, name = _parts(address)
        group = _pick(items, item, address)
        if name not in group:
            raise CaseError(f"unset: the scene has no '{address}'")
        del group[name]


def _pick(items: Sequence[Any], item: Sequence[str], address: str) -> Any:
    """Item of a group by number or name; the only one if neither is given."""
    if not item:
        if len(items) != 1:
            raise CaseError(f"'{address}': there are {len(items)} such groups; say which")
        return items[0]
    (wanted,) = item
    if wanted.isdecimal() and len(wanted) < 10:
        if not 1 <= int(wanted) <= len(items):
            raise CaseError(f"'{address}': there is no item {wanted} (there are {len(items)})")
        return items[int(wanted) - 1]
    named = [entry for entry in items if str(entry.get("name", "")) == wanted]
    if len(named) != 1:
        raise CaseError(f"'{address}': there is no item '{wanted}' of that name")
    return named[0]


def _parts(address: str) -> list[str]:
    """Group, perhaps item, name."""
    group, *item, name = address.split(".") if "." in address else ("", "", "", "")
    if not (group and name and len(item) <= 1 and all(item)):
        raise CaseError(f"'{address}' must be group.name or group.item.name")
    return [group.lower(), *item, name.lower()]
