"""Scene files that are read, changed, checked and written."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Any, Self, TypeAlias

import f90nml
import numpy as np

from wingcrack.errors import SceneError
from wingcrack.figures.text_files import namelist_groups, read_text, write_whole
from wingcrack.runs.parameter_table import Parameter, parameter, solver

_Groups: TypeAlias = dict[str, list[Any]]


class SceneFile:
    """A scene file in memory: what `wingcrack.Scene` is, but for running it.

    Parameters
    ----------
    path : str or Path
    """

    def __init__(self, path: str | Path = "scene.nml") -> None:
        self.path = Path(path)
        self._groups: _Groups = {}

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Read a scene file.

        Raises
        ------
        SceneError
            If it cannot be read.
        """
        scene = cls(path)
        try:
            groups = namelist_groups(read_text(scene.path))
        except (OSError, ValueError) as reason:
            raise SceneError(f"{path}: the scene file cannot be read ({reason})") from None
        for name, group in groups.items():
            scene._groups.setdefault(str(name), []).append(group)
        if not scene._groups:
            raise SceneError(f"{path}: the scene file has no groups")
        return scene

    def __repr__(self) -> str:
        """File and groups."""
        counts = ", ".join(
            name if len(items) == 1 else f"{len(items)} x {name}"
            for name, items in self._groups.items()
        )
        return f"<wingcrack.Scene {str(self.path)!r}: {counts}>"

    def __getitem__(self, address: str) -> Any:
        """Give the value at an address; a list for a list."""
        group, item, name = _parts(address)
        found = self._pick(group, item, address)
        if name not in found:
            parameter(group, name)  # says what it could be called
            raise SceneError(f"'{address}' is not given in {self.path}")
        return _plain(found[name])

    def __setitem__(self, address: str, value: Any) -> None:
        """Set a value; the solver judges it in `check` and `run`."""
        group, item, name = _parts(address)
        shown = _fortran(value, parameter(group, name))
        if item:
            self._pick(group, item, address)
        self.put(address, shown)

    def put(self, address: str, value: Any) -> None:
        """Set a value of any name; the item after the last one of a group is added."""
        group, item, name = _parts(address)
        items = self._groups.get(group, [])
        if (not items and not item) or item == str(len(items) + 1):
            self._groups[group] = [*items, f90nml.Namelist()]
        self._pick(group, item, address)[name] = value

    def __delitem__(self, address: str) -> None:
        """Take a value away, so that its default holds."""
        group, item, name = _parts(address)
        found = self._pick(group, item, address)
        if name not in found:
            raise SceneError(f"'{address}' is not given in {self.path}")
        del found[name]

    def __contains__(self, address: object) -> bool:
        """Whether a value is given."""
        try:
            group, item, name = _parts(str(address))
            return name in self._pick(group, item, str(address))
        except SceneError:
            return False

    def __iter__(self) -> Iterator[str]:
        """Addresses of all given values."""
        for group, items in self._groups.items():
            for number, item in enumerate(items, start=1):
                middle = f".{number}" if len(items) > 1 else ""
                yield from (f"{group}{middle}.{name}" for name in item)

    def add(self, group: str, **values: Any) -> None:
        """Add an item of a group: ``scene.add("probe", name="far", x=1.9, y=1.9)``."""
        entries = {name: parameter(group, name) for name in values}
        if self._groups.get(group) and not next(iter(entries.values())).repeated:
            raise SceneError(f"&{group} may be given once, and is there")
        item = f90nml.Namelist()
        for name, value in values.items():
            item[name] = _fortran(value, entries[name])
        self._groups.setdefault(group, []).append(item)

    def remove(self, group: str, item: str | int | None = None) -> None:
        """Take away a group, or one of its items by number or name."""
        if not self._groups.get(group):
            raise SceneError(f"{self.path} has no group &{group}")
        if item is None:
            del self._groups[group]
            return
        found = self._pick(group, str(item), f"{group}.{item}")
        self._groups[group] = [one for one in self._groups[group] if one is not found]

    def describe(self, address: str) -> Parameter:
        """Give kind, unit, default, range and meaning of ``group.name``."""
        group, _, name = _parts(address)
        return parameter(group, name)

    def text(self, *, stays: bool = False) -> str:
        """The scene file's text; remarks of the file that was read are not in it.

        Tables have their whole path, unless the scene stays next to them.
        """
        text = StringIO()
        for name, items in self._groups.items():
            for item in items:
                f90nml.Namelist({name: item if stays else self._beside(item)}).write(text)
                text.write("\n")
        return text.getvalue()

    def write(self, path: str | Path) -> Path:
        """Write the scene file, whole or not at all."""
        try:
            return write_whole(Path(path), self.text())
        except OSError as reason:
            raise SceneError(f"{path} cannot be written ({reason})") from None

    def check(self) -> str:
        """Let the solver judge the scene; gives its description.

        Raises
        ------
        SceneError
            If it is refused, with the reason. Lines count in what `text` gives.
        """
        with tempfile.TemporaryDirectory() as folder:
            file = self._file(folder)
            done = subprocess.run(
                [solver(), "check", file], capture_output=True, text=True, check=False
            )
            if done.returncode != 0:
                raise SceneError(self._said(done.stderr, file))
            return done.stdout

    def _file(self, folder: str) -> Path:
        stem = self.path.stem or "scene"
        return self.write(Path(folder) / f"{stem}.nml")

    def _said(self, text: str, file: Path) -> str:
        said = text.strip() or "the solver gave no reason"
        return said.replace(str(file), str(self.path))

    def _beside(self, item: Any) -> Any:
        """Name tables with their whole path: the file that is run lies elsewhere."""
        table = item.get("schedule")
        if not isinstance(table, str) or Path(table).is_absolute():
            return item
        moved = f90nml.Namelist(item)
        moved["schedule"] = str((self.path.parent / table).resolve())
        return moved

    def _pick(self, group: str, item: str, address: str) -> Any:
        items = self._groups.get(group, [])
        if not item:
            if len(items) != 1:
                few = f"are {len(items)} such groups; say which" if items else "is no such group"
                raise SceneError(f"'{address}': there {few}")
            return items[0]
        named = [one for one in items if str(one.get("name", "")) == item]
        if len(named) == 1:
            return named[0]
        if item.isdecimal() and len(item) < 10 and 1 <= int(item) <= len(items):
            return items[int(item) - 1]
        names = [str(one.get("name", number)) for number, one in enumerate(items, start=1)]
        known = f"there are {', '.join(names)}" if names else "there are none"
        raise SceneError(f"'{address}': there is no item '{item}' of &{group}; {known}")


def _parts(address: str) -> tuple[str, str, str]:
    """Group, item or nothing, name. An item's name may have points in it."""
    group, _, rest = address.partition(".")
    item, _, name = rest.rpartition(".")
    if not group or not name:
        raise SceneError(f"'{address}' must be group.name or group.item.name")
    return group.lower(), item, name.lower()


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, list) else value


def _fortran(value: Any, known: Parameter) -> Any:
    """A value as a namelist can hold it."""
    where = f"{known.group}.{known.name}"
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        if not known.kind.startswith("list"):
            raise SceneError(f"{where} takes one {known.kind}, not a list")
        if not value:
            raise SceneError(f"{where} takes at least one value; del takes it away")
        return [_single(one, known, where) for one in value]
    return _single(value, known, where)


def _single(given: Any, known: Parameter, where: str) -> Any:
    value: Any = given
    if isinstance(value, np.generic):
        value = value.item()
    logical = "logical" in known.kind
    right: tuple[type, ...] = (bool,) if logical else ()
    if "number" in known.kind:
        right = (int, float)
    if "text" in known.kind:
        right = (*right, str)
    if not isinstance(value, right) or (isinstance(value, bool) and not logical):
        raise SceneError(f"{where} takes a {known.kind} [{known.unit}], not {value!r}")
    if isinstance(value, float) and not np.isfinite(value):
        raise SceneError(f"{where} takes a finite number, not {value!r}")
    if "whole" in known.kind and int(given) != given:
        raise SceneError(f"{where} takes a {known.kind}, not {value!r}")
    return int(given) if "whole" in known.kind else value
