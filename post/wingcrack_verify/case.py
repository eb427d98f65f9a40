"""Reading a case of ``verification/``: its check.toml as typed values (docs/verification.md)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from pydantic import Field

from wingcrack.errors import CaseError
from wingcrack.figures import text_files
from wingcrack.sweeps.fields import Entry, Table, Tables, Text, choice, read_entry, read_toml
from wingcrack.sweeps.likes import NAMED_BY, Likes, shared_likes
from wingcrack.sweeps.sweep import Defaults, read_tables
from wingcrack_verify.contents import GROUPS, Case, Check, FigureRequest, Part, Run

Texts: TypeAlias = tuple[str, ...]

_DEFAULTS = ("run", "check", "figure")  # kinds of entries that have some
_KEYS = {
    "run": {*Run.model_fields},
    "sweep": {*Run.model_fields},
    "check": {*Check.model_fields},
    "figure": {*FigureRequest.model_fields} - {"constants"},
}


class _PartFile(Entry):
    """What a ``[[part]]`` says, and a file without parts."""

    name: Text = ""
    quick: bool | None = None
    constants: dict[str, float] = Field(default_factory=dict)
    defaults: Table = Field(default_factory=dict)
    run: Tables = ()
    sweep: Tables = ()
    check: Tables = ()
    figure: Tables = ()


class _NamedPart(_PartFile):
    name: Text


class _CaseFile(_PartFile):
    title: Text
    source: Text
    group: Annotated[str, choice(GROUPS)]
    known_gap: Text | None = None
    part: Tables = ()


def read_case(folder: Path) -> Case:
    """Read ``check.toml`` of a case's folder.

    Raises `CaseError` if anything in it is missing, unknown or contradicts itself.
    """
    data = read_toml(folder / "check.toml")
    file = read_entry(_CaseFile, data, "check.toml")
    around = _Around(
        folder=folder,
        gap=file.known_gap,
        constants=file.constants,
        defaults=Defaults(file.defaults, _DEFAULTS),
        likes=Likes(data, "check.toml", shared_likes(folder.parent)),
    )
    quick = bool(file.quick)
    parts = []
    if not file.part or any(kind in data for kind in _KEYS):
        parts.append(_read_part(data, quick, around))
    for number, item in enumerate(file.part, 1):
        parts.append(_read_named_part(item, number, quick, around))
    around.defaults.done()
    case = Case(folder.name, folder, file.title, file.group, file.source, tuple(parts))
    refuse_doubles([run.name for run in case.runs], "run")
    refuse_doubles([check.quantity for check in case.checks], "quantity")
    return case


@dataclass(frozen=True)
class _Around:
    """What holds in a part in addition to what it says itself."""

    folder: Path
    gap: str | None
    constants: dict[str, float]
    defaults: Defaults
    likes: Likes


def _read_named_part(data: Mapping[str, Any], number: int, quick: bool, around: _Around) -> Part:
    """Read a ``[[part]]``: it has constants and defaults of its own, and those of the file."""
    name = data.get("name")
    place = f"part '{name}': check.toml" if name else f"part {number}"
    file = read_entry(_NamedPart, data, place)
    try:
        inside = replace(
            around,
            constants=around.constants | file.constants,
            defaults=Defaults(file.defaults, _DEFAULTS, around.defaults),
            likes=Likes(data, "check.toml", around.likes),
        )
        part = _read_part(data, quick if file.quick is None else file.quick, inside)
        inside.defaults.done()
    except CaseError as reason:
        raise CaseError(f"part '{file.name}': {reason}") from None
    return part.named(file.name)


def _read_part(data: Mapping[str, Any], quick: bool, around: _Around) -> Part:
    """Read the runs, checks and figures of a table: the file's, or a part's."""

    def tables(kind: str) -> list[tuple[str, Table]]:
        keys = _KEYS[kind]
        return read_tables(data.get(kind, ()), kind, keys, around.defaults, around.likes)

    runs = tuple(
        read_run(item, place, around.folder, around.constants)
        for kind in data  # in the order of the file
        if kind in ("run", "sweep")
        for place, item in tables(kind)
    )
    if not runs:
        raise CaseError("check.toml: a case needs at least one [[run]] or [[sweep]]")
    for run in runs:
        if "*" in run.name or run.name.startswith("!"):
            raise CaseError(f"run '{run.name}': '*', and '!' in front, are for patterns of names")
    refuse_doubles([run.name for run in runs], "run")
    checks = tuple(_read_check(item, place, runs, around.gap) for place, item in tables("check"))
    if not checks:
        raise CaseError("check.toml: a case needs at least one [[check]]")
    figures = tuple(
        _read_figure(item, place, runs, around.constants) for place, item in tables("figure")
    )
    return Part(runs, checks, figures, quick)


def refuse_doubles(names: list[str], kind: str) -> None:
    """Raise a `CaseError` if a name stands twice."""
    for name in names:
        if names.count(name) > 1:
            raise CaseError(f"check.toml: the {kind} '{name}' stands twice")


def place_of(data: Table, kind: str, place: str) -> str:
    """An entry by its name, where it has one."""
    name = data.get(NAMED_BY[kind])
    return f"{kind} '{name}'" if isinstance(name, str) and name else place


def read_run(data: Table, place: str, folder: Path, constants: Mapping[str, float]) -> Run:
    """Read one ``[[run]]``, to whose constants those of its case and its size belong."""
    place, scene = place_of(data, "run", place), data.get("scene")
    if isinstance(scene, str):
        if not text_files.is_file(folder / scene):
            raise CaseError(f"{place}: there is no scene file {scene}")
        data = {**data, "scene": folder / scene}
    run = read_entry(Run, data, place)
    size = {} if run.size is None else {"size": run.size}
    return run.model_copy(update={"constants": {**constants, **size, **run.constants}})


def _read_check(data: Table, place: str, runs: tuple[Run, ...], case_gap: str | None) -> Check:
    place = place_of(data, "check", place)
    check = read_entry(Check, data, place)
    names = tuple(run.name for run in runs)
    measured = _run_names(check.runs, "runs", place, names)
    judged = _run_names(check.judged, "judged", place, measured)
    other = check.reference.other_run
    if other is not None and other not in names:
        raise CaseError(f"{place}: reference: there is no run '{other}'")
    if other in measured:
        raise CaseError(f"{place}: the run '{other}' would be compared with itself")
    methods = {run.method for run in runs if run.name in measured}
    for name in (check.economy.method, check.economy.than) if check.economy else ():
        if name not in methods:
            raise CaseError(f"{place}: economy: no measured run has the method '{name}'")
    if check.front and sum(run.default for run in runs if run.name in measured) != 1:
        raise CaseError(f"{place}: 'front' needs exactly one default run")
    gap = check.known_gap or case_gap
    return check.model_copy(update={"runs": measured, "judged": judged, "known_gap": gap})


def _run_names(given: Texts, key: str, place: str, default: Texts) -> Texts:
    """Names out of `default`, in its order: given as such, by patterns, or without some (!)."""
    chosen: set[str] = set()
    for item in given:
        found = {name for name in default if _matches(item.removeprefix("!"), name)}
        if not found:
            raise CaseError(f"{place}: '{key}' names '{item}', which is no such run")
        if item.startswith("!") and not found & chosen:
            raise CaseError(f"{place}: '{key}' takes away '{item}', which is not there")
        chosen = chosen - found if item.startswith("!") else chosen | found
    if not chosen:
        raise CaseError(f"{place}: '{key}' is empty")
    return tuple(name for name in default if name in chosen)


def _matches(pattern: str, name: str) -> bool:
    """Whether a name is the pattern, whose stars stand for any text."""
    return re.fullmatch(".*".join(map(re.escape, pattern.split("*"))), name) is not None


def _read_figure(
    data: Table, place: str, runs: tuple[Run, ...], constants: dict[str, float]
) -> FigureRequest:
    place = place_of(data, "figure", place)
    if "constants" in data:
        raise CaseError(f"{place}: 'constants' is unknown")
    figure = read_entry(FigureRequest, {**data, "constants": constants}, place)
    names = {None, *(run.name for run in runs)}
    for index, line in enumerate(figure.lines, start=1):
        if line.run not in names:
            raise CaseError(f"{place}: line {index}: there is no run '{line.run}'")
    if figure.run not in names:
        raise CaseError(f"{place}: there is no run '{figure.run}'")
    return figure
