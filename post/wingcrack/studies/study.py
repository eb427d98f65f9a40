"""A study's file as typed values (docs/studies.md)."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.figures.text_files import is_file
from wingcrack.studies.cluster import Cluster, read_cluster
from wingcrack.studies.distributions import SAMPLE, read_draws
from wingcrack.studies.outputs import judge_selection
from wingcrack.studies.plots import Plot, read_plot
from wingcrack.studies.quantities import Quantity, read_quantity
from wingcrack.studies.units import NONE, column_name, spoken, unit_of_path
from wingcrack.sweeps.fields import TIME_LIMIT_S, Fields, read_toml
from wingcrack.sweeps.scene import scene_text
from wingcrack.sweeps.selection import Selection
from wingcrack.sweeps.sweep import Table, filled, grid_points

MOST_RUNS = 10_000

# Columns that the table of every study has, beside those of its own.
FIXED_COLUMNS = ("run", "label", "status", "reason", "cpu_s", "wall_s", "folder")

# Keys that [quick] may give otherwise.
_QUICK = ("over", "set", "count")


@dataclass(frozen=True)
class Parameter:
    """What differs from run to run."""

    name: str
    unit: str

    @property
    def column(self) -> str:
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
class Study:
    """Everything that a study's file says."""

    title: str
    scene: Path
    parameters: tuple[Parameter, ...]
    runs: tuple[StudyRun, ...]
    drawn: bool
    time_limit_s: float
    constants: Mapping[str, float]
    quantities: tuple[Quantity, ...]
    quantiles: tuple[float, ...]
    plots: tuple[Plot, ...]
    cluster: Cluster

    @property
    def names(self) -> set[str]:
        """Names that expressions can use beside those of columns."""
        return {*self.constants, *(name for run in self.runs for name in run.constants)}

    @property
    def selections(self) -> list[Selection]:
        """All that is read of a run."""
        drawn = [plot.selection for plot in self.plots if plot.selection]
        return [*(quantity.selection for quantity in self.quantities), *drawn]


def read_study(path: Path, quick: bool = False) -> Study:
    """Read a study's file and make the scene of each of its runs.

    Raises `CaseError` if anything in it is missing, unknown or contradicts itself.

    Parameters
    ----------
    path : Path
        The TOML file; the scene is named relative to it.
    quick : bool
        Whether to take the short form that ``[quick]`` tells.
    """
    fields = Fields(read_toml(path), path.name)
    title = fields.text("title")
    fields.text("about", "")
    scene = path.parent / fields.text("scene")
    if not is_file(scene):
        raise CaseError(f"{path.name}: there is no scene file {scene}")
    given = fields.mapping("quick")
    if "count" in given and not fields.has("draw"):
        raise CaseError(f"{path.name}: quick: 'count' is for a study with [draw]")
    quickly = _quick(given, quick, path.name)
    changes = fields.mapping("set") | quickly.get("set", {})
    unset = fields.texts("unset", ())
    over = fields.mapping("over") | quickly.get("over", {})
    drawn = fields.has("draw")
    if drawn:
        draws = read_draws(
            fields.take("draw"), f"{path.name}: draw", MOST_RUNS, quickly.get("count")
        )
        over[SAMPLE] = draws
    units = fields.mapping("units")
    limit = fields.positive("time_limit_s", TIME_LIMIT_S)
    constants = fields.constants("constants")
    runs = _runs(scene, over, changes, unset, path.name)
    parameters = _parameters(runs, changes, units, path.name)
    quantities = tuple(
        read_quantity(item, f"{path.name}: quantity {index}")
        for index, item in enumerate(fields.tables("quantity"), start=1)
    )
    plots = tuple(
        read_plot(item, f"{path.name}: figure {index}")
        for index, item in enumerate(fields.tables("figure"), start=1)
    )
    study = Study(
        title=title,
        scene=scene,
        parameters=parameters,
        runs=runs,
        drawn=drawn,
        time_limit_s=limit,
        constants=constants,
        quantities=quantities,
        quantiles=_quantiles(fields, drawn),
        plots=plots,
        cluster=read_cluster(fields.mapping("cluster"), f"{path.name}: cluster"),
    )
    fields.done()
    _check_columns(study, path.name)
    _check_plots(study, path.name)
    has_fluid = any(re.search(r"^\s*&fluid\b", run.text, re.MULTILINE) for run in runs)
    for selection in study.selections:
        judge_selection(selection, study.names, has_fluid)
    return study


def _quick(data: Mapping[str, Any], wanted: bool, place: str) -> dict[str, Any]:
    fields = Fields(data, f"{place}: quick")
    found: dict[str, Any] = {key: fields.mapping(key) for key in ("over", "set")}
    count = fields.take("count", None)
    fields.done()
    if count is not None:
        if isinstance(count, bool) or not isinstance(count, int) or count < 1:
            raise CaseError(f"{place}: quick: 'count' must be a whole number from 1 on")
        found["count"] = count
    if wanted and not data:
        raise CaseError(f"{place}: there is no [quick] in it, so it has no short form")
    return found if wanted else {}


def _quantiles(fields: Fields, drawn: bool) -> tuple[float, ...]:
    given: tuple[float, ...] = fields.numbers("quantiles", (0.1, 0.5, 0.9) if drawn else ())
    if any(not 0.0 <= share <= 1.0 for share in given) or sorted(set(given)) != list(given):
        raise CaseError(f"{fields.place}: 'quantiles' must be numbers from 0 to 1 that increase")
    return given


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
    for name, unit in units.items():
        if name not in names:
            raise CaseError(f"{place}: units: there is no parameter '{name}'")
        if not isinstance(unit, str) or not unit:
            raise CaseError(f"{place}: units: '{name}' must be a text, '{NONE}' for none")
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
    columns += [parameter.column for parameter in study.parameters]
    columns += [quantity.column for quantity in study.quantities]
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
