"""A study's file as typed values (docs/studies.md)."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from wingcrack.errors import CaseError
from wingcrack.figures.text_files import is_file
from wingcrack.studies.cluster import Cluster
from wingcrack.studies.distributions import SAMPLE, read_draws
from wingcrack.studies.outputs import judge_selection
from wingcrack.studies.plots import Plot
from wingcrack.studies.quantities import Quantity
from wingcrack.studies.units import NONE, column_name, spoken, unit_of_path
from wingcrack.sweeps.fields import (
    TIME_LIMIT_S,
    Entry,
    Numbers,
    Positive,
    Table,
    Text,
    Texts,
    read_entry,
    read_toml,
    whole,
)
from wingcrack.sweeps.scene import scene_text
from wingcrack.sweeps.selection import Selection
from wingcrack.sweeps.sweep import filled, grid_points

MOST_RUNS = 10_000

# Columns that the table of every study has, in addition to its own.
FIXED_COLUMNS = ("run", "label", "status", "reason", "cpu_s", "wall_s", "folder")


@dataclass(frozen=True)
class Parameter:
    """What differs from run to run."""

    name: str
    unit: str

    @property
    def heading(self) -> str:
        """Its column in the table."""
        return column_name(self.name, self.unit)


@dataclass(frozen=True)
class StudyRun:
    """One run of a study: its values, and the scene that they make."""

    number: int
    label: str
    values: Mapping[str, Any]
    text: str

    @property
    def place(self) -> str:
        """The place of the grid that a sample belongs to; all runs have one without samples."""
        names = list(self.values)
        of_grid = names[: names.index(SAMPLE)] if SAMPLE in names else []
        return ", ".join(f"{name} = {spoken(self.values[name])}" for name in of_grid)

    @property
    def constants(self) -> dict[str, float]:
        """Values that expressions can use by name."""
        return {
            name: float(value)
            for name, value in self.values.items()
            if name.isidentifier()
            and isinstance(value, int | float)
            and not isinstance(value, bool)
        }


@dataclass(frozen=True)
class Origin:
    """The state from which all runs go on."""

    run: Path  # folder of the run
    at: float | None  # [s]; none: the end of the run


@dataclass(frozen=True)
class Study:
    """Everything that a study's file says."""

    title: str
    scene: Path
    parameters: tuple[Parameter, ...]
    runs: tuple[StudyRun, ...]
    drawn: bool
    origin: Origin | None
    time_limit_s: float
    constants: Mapping[str, float]
    quantities: tuple[Quantity, ...]
    quantiles: tuple[float, ...]
    plots: tuple[Plot, ...]
    cluster: Cluster

    @property
    def places(self) -> dict[str, list[int]]:
        """Rows of the table by the place of the grid, in their order."""
        found: dict[str, list[int]] = {}
        for row, run in enumerate(self.runs):
            found.setdefault(run.place, []).append(row)
        return found

    @property
    def names(self) -> set[str]:
        """Names that expressions can use in addition to columns."""
        return {*self.constants, *(name for run in self.runs for name in run.constants)}

    @property
    def selections(self) -> list[tuple[str, Selection]]:
        """All that is read of a run, with its place for errors."""
        drawn = [(f"figure '{one.name}'", one.selection) for one in self.plots if one.selection]
        return [*((f"quantity '{one.name}'", one) for one in self.quantities), *drawn]


class _Quick(Entry):
    """``[quick]``: what the short form has otherwise."""

    over: Table = Field(default_factory=dict)
    set: Table = Field(default_factory=dict)
    count: Annotated[int | None, whole(1)] = None


class _StudyFile(Entry):
    """The file of a study."""

    title: Text
    about: Text = ""
    scene: Text = ""
    origin: Text = Field(default="", alias="from")
    at: Positive | None = None
    quick: _Quick | None = None
    set: Table = Field(default_factory=dict)
    unset: Texts = ()
    over: Table = Field(default_factory=dict)
    draw: Table | None = None
    units: dict[str, Text] = Field(default_factory=dict)
    time_limit_s: Positive = TIME_LIMIT_S
    constants: dict[str, float] = Field(default_factory=dict)
    quantity: Annotated[tuple[Quantity, ...], Field(strict=False)] = ()
    figure: Annotated[tuple[Plot, ...], Field(strict=False)] = ()
    quantiles: Numbers | None = None
    cluster: Cluster = Cluster()

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if self.quick and self.quick.count and self.draw is None:
            raise ValueError("quick: 'count' is for a study with [draw]")
        if not self.scene and not self.origin:
            raise ValueError("'scene' is missing, or 'from' with the folder of a run")
        if self.at is not None and not self.origin:
            raise ValueError("'at' is for a study with 'from'")
        shares = self.quantiles or ()
        if any(not 0.0 <= one <= 1.0 for one in shares) or sorted(set(shares)) != list(shares):
            raise ValueError("'quantiles' must be numbers from 0 to 1 that increase")
        return self


def read_study(path: Path, quick: bool = False) -> Study:
    """Read a study's file and make the scene of each of its runs.

    Raises `CaseError` if anything in it is missing, unknown or contradicts itself.

    `path`: the TOML file; the scene is named relative to it. `quick`: whether to take the short
    form that ``[quick]`` tells.
    """
    said = read_entry(_StudyFile, read_toml(path), path.name)
    scene = path.parent / (said.scene or f"{said.origin}/scene.nml")
    if not is_file(scene):
        raise CaseError(f"{path.name}: there is no scene file {scene}")
    if quick and said.quick is None:
        raise CaseError(f"{path.name}: there is no [quick] in it, so it has no short form")
    short = said.quick if quick and said.quick else _Quick()
    changes, over = said.set | short.set, said.over | short.over
    if said.draw is not None:
        over[SAMPLE] = read_draws(said.draw, f"{path.name}: draw", MOST_RUNS, short.count)
    runs = _runs(scene, over, changes, said.unset, path.name)
    study = Study(
        title=said.title,
        scene=scene,
        parameters=_parameters(runs, changes, said.units, path.name),
        runs=runs,
        drawn=said.draw is not None,
        origin=Origin(path.parent / said.origin, said.at) if said.origin else None,
        time_limit_s=said.time_limit_s,
        constants=said.constants,
        quantities=said.quantity,
        quantiles=said.quantiles or ((0.1, 0.5, 0.9) if said.draw is not None else ()),
        plots=said.figure,
        cluster=said.cluster,
    )
    _check_columns(study, path.name)
    _check_plots(study, path.name)
    has_fluid = any(re.search(r"^\s*&fluid\b", run.text, re.MULTILINE) for run in runs)
    for place, selection in study.selections:
        judge_selection(selection, f"{path.name}: {place}", study.names, has_fluid)
    return study


def _runs(
    scene: Path, over: Table, changes: Table, unset: Sequence[str], place: str
) -> tuple[StudyRun, ...]:
    """All runs; the last parameter changes first."""
    _refuse_nested(over, place)
    points = grid_points(over, f"{place}: over", MOST_RUNS) if over else [{}]
    found: list[StudyRun] = []
    labels: set[str] = set()
    for number, point in enumerate(points, start=1):
        label = _label(point)
        if label in labels:
            raise CaseError(f"{place}: over: the run '{label}' stands twice")
        labels.add(label)
        whole, used = filled(changes, point, f"{place}: set")
        direct = {name: value for name, value in point.items() if "." in name}
        for name in sorted(direct.keys() & changes.keys()):
            raise CaseError(f"{place}: both [set] and the parameters give '{name}'")
        unused = set(point) - set(direct) - used - {SAMPLE}
        for name in sorted(unused):
            raise CaseError(
                f"{place}: nothing uses '{name}'; give the path of a namelist entry in quotes, "
                f'as in "injection.rate", or use it in [set], as in "{{{name}}}"'
            )
        text = scene_text(scene, whole | direct, unset)
        found.append(StudyRun(number, label, point, text))
    return tuple(found)


def _refuse_nested(over: Table, place: str) -> None:
    """A path without quotes is a table of tables to TOML; say so."""
    for name, value in over.items():
        nested = isinstance(value, Mapping) and name != SAMPLE
        if nested and not all(isinstance(item, list) for item in value.values()):
            raise CaseError(
                f"{place}: over.{name} is no list, nor a table of lists; "
                'the path of a namelist entry stands in quotes, as in "injection.rate"'
            )


def _label(point: Mapping[str, Any]) -> str:
    """Name of a run: all its values, or the number of its draw instead of what was drawn."""
    if SAMPLE in point:
        names = list(point)
        names = names[: names.index(SAMPLE) + 1]  # the drawn values stand behind the number
    else:
        names = list(point)
    return ", ".join(f"{name} = {spoken(point[name])}" for name in names) or "the scene"


def _parameters(
    runs: Sequence[StudyRun], changes: Table, units: Table, place: str
) -> tuple[Parameter, ...]:
    names = dict.fromkeys(itertools.chain.from_iterable(run.values for run in runs))
    for name in units:
        if name not in names:
            raise CaseError(f"{place}: units: there is no parameter '{name}'")
    return tuple(
        Parameter(name, units.get(name) or _unit(name, runs, changes, place)) for name in names
    )


def _unit(name: str, runs: Sequence[StudyRun], changes: Table, place: str) -> str:
    """Unit of a parameter: that of the entry it goes into, or none if it is no number."""
    values = [run.values.get(name) for run in runs]
    if name == SAMPLE or all(isinstance(value, str | bool) for value in values):
        return NONE
    paths = [name] if "." in name else [path for path, to in changes.items() if to == f"{{{name}}}"]
    found = {unit for path in paths if (unit := unit_of_path(path)) is not None}
    if len(found) == 1:
        return found.pop()
    if paths and not found:
        return NONE  # no such entry: the solver's check says so, with the nearest name
    raise CaseError(f"{place}: units: '{name}' is missing ('{NONE}' if it has none)")


def _check_columns(study: Study, place: str) -> None:
    columns = list(FIXED_COLUMNS)
    columns += [parameter.heading for parameter in study.parameters]
    columns += [quantity.heading for quantity in study.quantities]
    for name in columns:
        if columns.count(name) > 1:
            raise CaseError(f"{place}: the table would have two columns '{name}'")


def _check_plots(study: Study, place: str) -> None:
    """Refuse figures of parameters and quantities that the study does not have."""
    parameters = {parameter.name for parameter in study.parameters}
    quantities = {quantity.name for quantity in study.quantities}
    names = [plot.name for plot in study.plots]
    for plot in study.plots:
        where = f"{place}: figure '{plot.name}'"
        if names.count(plot.name) > 1:
            raise CaseError(f"{where} stands twice")
        for name in (*plot.by, *([plot.over] if plot.over else ())):
            if name not in parameters | (quantities if name == plot.over else set()):
                known = ", ".join(sorted(parameters)) or "none"
                raise CaseError(f"{where}: there is no parameter '{name}' (there are: {known})")
        if plot.quantity and plot.quantity not in quantities:
            known = ", ".join(sorted(quantities)) or "none"
            raise CaseError(f"{where}: there is no quantity '{plot.quantity}' (there are: {known})")
