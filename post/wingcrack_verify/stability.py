"""Stiff and extreme scenes: whether the solver converges or refuses, and at what cost."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.figures.text_files import is_file, read_json
from wingcrack.sweeps.fields import Fields, read_toml
from wingcrack.sweeps.likes import Likes, shared_likes
from wingcrack.sweeps.selection import read_selection, select
from wingcrack.sweeps.sweep import Defaults, read_tables
from wingcrack_verify.case import refuse_doubles
from wingcrack_verify.contents import Run
from wingcrack_verify.draws import read_draw
from wingcrack_verify.execute import Outcome
from wingcrack_verify.groups import GROUPS
from wingcrack_verify.judge import ERROR, FAILED, GAP, PASSED, worst_of

TIME_LIMIT_S = 20.0  # unless the file says otherwise: some hundred times what a trial takes
# In words of a trial; a run that crashed, or took too long, is neither.
_STATUS = {"finished": "converged", "failed": "stopped", "refused": "refused"}
EXPECTED = ("converged", "refused", "stopped", "settled")
# Every accepted state with all its fields, for `recompute`; `check` doubts such an interval.
ALL_FIELDS = {"output.vtu": True, "output.interval": 1.0e-30, "output.growth_states": 100000}


@dataclass(frozen=True)
class Trial:
    """A scene of the table, or a cell of a map."""

    run: Run
    expect: str  # "converged", "refused", "stopped", or "settled": one of them
    causes: tuple[str, ...]  # one of these is part of the reason; none: any reason will do
    note: str
    known_gap: str | None
    quick: bool = True  # part of --quick, if the file is


@dataclass(frozen=True)
class Axis:
    """Parameter of a map: all the names get each of the values, the others a multiple of it."""

    label: str
    names: tuple[str, ...]
    values: tuple[float, ...]
    multiples: dict[str, float]

    def changes(self, value: float) -> dict[str, float]:
        """Values of the scene at one place of the axis."""
        of_names = dict.fromkeys(self.names, value)
        return of_names | {name: value * factor for name, factor in self.multiples.items()}


@dataclass(frozen=True)
class Map:
    """Two parameters at a time; `trials` row by row, y first."""

    title: str
    x: Axis
    y: Axis
    trials: tuple[Trial, ...]
    known_gap: str | None


@dataclass(frozen=True)
class Stability:
    """The file ``stability.toml``."""

    name: str
    folder: Path
    title: str
    group: str
    source: str
    quick: bool
    mass_error_limit: float
    contact_residual_limit: float
    from_files: bool  # whether every state is judged again from the files
    trials: tuple[Trial, ...]
    maps: tuple[Map, ...]

    @property
    def quick_part(self) -> Stability:
        """What of it is part of --quick."""
        return replace(self, trials=tuple(trial for trial in self.trials if trial.quick))

    @property
    def runs(self) -> tuple[Run, ...]:
        """All runs, those of the maps last."""
        of_maps = itertools.chain.from_iterable(chart.trials for chart in self.maps)
        return tuple(trial.run for trial in (*self.trials, *of_maps))


@dataclass(frozen=True)
class TrialReport:
    """What became of a trial; numbers are None where the run has none."""

    trial: Trial
    verdict: str
    reason: str
    status: str
    newton_mean: float | None
    newton_max: float | None
    step_cuts: float | None
    mass_error: float | None
    contact_residual: float | None
    condition_estimate: float | None
    forward_error_bound: float | None
    cpu_s: float


@dataclass(frozen=True)
class MapReport:
    """A map with all its trials."""

    chart: Map
    cells: tuple[TrialReport, ...]
    verdict: str
    reason: str


@dataclass(frozen=True)
class StabilityReport:
    """The stability part of the report."""

    name: str
    title: str
    group: str
    source: str
    folder: Path
    trials: tuple[TrialReport, ...] = ()
    maps: tuple[MapReport, ...] = ()
    limits: tuple[float, float] = (0.0, 0.0)
    broken: str = ""

    @property
    def verdict(self) -> str:
        """The worst of all."""
        if self.broken:
            return ERROR
        trials = [item.verdict for item in self.trials]
        return worst_of(trials + [item.verdict for item in self.maps])


def read_stability(folder: Path) -> Stability:
    """Read ``stability.toml``; a `CaseError` tells what is wrong with it."""
    data = read_toml(folder / "stability.toml")
    fields = Fields(data, "stability.toml")
    title, source, quick = fields.text("title"), fields.text("source"), fields.flag("quick")
    group = fields.choice("group", tuple(GROUPS))
    base = folder / fields.text("scene")
    if not is_file(base):
        raise CaseError(f"stability.toml: there is no scene file {base.name}")
    mass, contact = fields.positive("mass_error_limit"), fields.positive("contact_residual_limit")
    limit_s, from_files = fields.positive("time_limit_s", TIME_LIMIT_S), fields.flag("from_files")
    maker = _Maker(base, ALL_FIELDS if from_files else {}, limit_s)
    defaults = Defaults(fields.mapping("defaults"), ("trial",))
    likes = Likes(data, "stability.toml", shared_likes(folder.parent))
    tables = read_tables(fields, "trial", defaults, likes)
    defaults.done()
    for index, item in enumerate(fields.tables("draw"), start=1):
        tables += read_draw(item, f"draw {index}")
    trials = tuple(maker.trial(item, place) for place, item in tables)
    maps = tuple(
        maker.map(item, f"map {index}") for index, item in enumerate(fields.tables("map"), start=1)
    )
    fields.done()
    if not trials:
        raise CaseError("stability.toml: at least one [[trial]] is needed")
    found = Stability(
        folder.name, folder, title, group, source, quick, mass, contact, from_files, trials, maps
    )
    refuse_doubles([run.name for run in found.runs], "trial")
    if quick and not any(trial.quick for trial in trials):
        raise CaseError("stability.toml: at least one [[trial]] of a quick file must be quick")
    return found


@dataclass(frozen=True)
class _Maker:
    """Makes trials and maps of tables; what they share."""

    base: Path
    fields: Mapping[str, Any]  # values of all scenes
    limit_s: float

    def trial(self, data: Any, place: str) -> Trial:
        """A trial of its table."""
        fields = Fields(data, place)
        name = fields.text("name")
        fields.place = f"trial '{name}'"
        changes, unset = fields.mapping("set"), fields.texts("unset", ())
        expect = fields.choice("expect", EXPECTED)
        causes = fields.texts("cause", ())
        if causes and expect == "converged":
            raise CaseError(f"{fields.place}: what converges has no cause")
        trial = Trial(
            self._run(name, changes, unset),
            expect,
            causes,
            fields.text("note", ""),
            fields.text("known_gap", None),
            fields.flag("quick", True),
        )
        fields.done()
        return trial

    def map(self, data: Any, place: str) -> Map:
        """A map of its table."""
        fields = Fields(data, place)
        title = fields.text("title")
        fields.place = f"map '{title}'"
        changes, unset = fields.mapping("set"), fields.texts("unset", ())
        gap = fields.text("known_gap", None)
        x, y = (_read_axis(fields.take(key), f"{fields.place}: {key}") for key in ("x", "y"))
        fields.done()
        trials = tuple(
            Trial(
                self._run(
                    f"{title}: {x_value:g}, {y_value:g}",
                    changes | x.changes(x_value) | y.changes(y_value),
                    unset,
                ),
                "converged",
                (),
                "",
                None,
            )
            for y_value in y.values
            for x_value in x.values
        )
        return Map(title, x, y, trials, gap)

    def _run(self, name: str, changes: Mapping[str, Any], unset: tuple[str, ...]) -> Run:
        values = {**self.fields, **changes}
        return Run(
            name,
            "stability",
            None,
            False,
            self.base,
            values,
            unset,
            None,
            (),
            {},
            self.limit_s,
        )


def _read_axis(data: Any, place: str) -> Axis:
    fields = Fields(data, place)
    axis = Axis(
        fields.text("label"),
        fields.texts("names"),
        fields.numbers("values"),
        fields.constants("multiples"),
    )
    fields.done()
    return axis


def judge_stability(found: Stability, outcomes: Mapping[str, Outcome]) -> StabilityReport:
    """Judge all trials; `outcomes` by the runs' names."""
    maps = []
    for chart in found.maps:
        cells = tuple(judge_trial(found, item, outcomes[item.run.name]) for item in chart.trials)
        bad = [cell for cell in cells if cell.verdict != PASSED]
        worst = worst_of([cell.verdict for cell in cells])
        reason = f"{bad[0].trial.run.name}: {bad[0].reason}" if bad else ""
        if chart.known_gap is not None and worst != ERROR:
            worst = GAP
        maps.append(MapReport(chart, cells, worst, reason))
    return StabilityReport(
        found.name,
        found.title,
        found.group,
        found.source,
        found.folder,
        tuple(judge_trial(found, item, outcomes[item.run.name]) for item in found.trials),
        tuple(maps),
        (found.mass_error_limit, found.contact_residual_limit),
    )


def judge_trial(found: Stability, trial: Trial, outcome: Outcome) -> TrialReport:
    """Hold what became of a trial against what is expected of it."""
    if outcome.status == "invalid":
        return _report(trial, outcome, ERROR, outcome.reason, {})
    numbers: dict[str, float | None] = {}
    wrong = ""
    output = Path(outcome.folder) / "output"
    try:
        if outcome.status == "finished":
            numbers = _numbers(output)
        if found.from_files and outcome.status in ("finished", "failed"):
            wrong = _wrong_in_files(output)
    except (CaseError, OSError, ValueError, KeyError) as broken:
        return _report(trial, outcome, ERROR, f"files that cannot be judged: {broken}", numbers)
    reason = _complaint(found, trial, outcome, numbers) or wrong
    verdict = FAILED if reason else PASSED
    if trial.known_gap is not None:
        verdict = GAP
        reason = reason or "as expected now: the mark of a known gap can go"
    return _report(trial, outcome, verdict, reason, numbers)


def _wrong_in_files(output: Path) -> str:
    """What is wrong in any state of a run, by its files alone; empty if nothing is."""
    # Here, because the library that reads VTU files is slow to load, and few calls need it.
    from wingcrack_verify import recompute, recompute_growth

    faults = [*recompute.judge(output).wrong, *recompute_growth.judge_growth(output).wrong]
    if not faults:
        return ""
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    return f"wrong in the files: {faults[0]}{more}"


def _complaint(
    found: Stability, trial: Trial, outcome: Outcome, numbers: Mapping[str, float | None]
) -> str:
    """Why a trial did not end as expected; empty if it did."""
    status = _STATUS.get(outcome.status, outcome.status)
    if trial.expect == "converged" or (trial.expect == "settled" and status == "converged"):
        if status != "converged":
            return f"the run {outcome.status}: {outcome.reason}"
        return _beyond_limits(found, numbers)
    # A trial of fluid-free scenes need not tell before the run that it cannot be done.
    wanted = ("stopped",) if trial.expect == "stopped" else ("stopped", "refused")
    if status not in wanted or not outcome.reason:
        return f"the run {outcome.status}, and is to be {trial.expect} with a reason"
    if trial.causes and not any(cause in outcome.reason for cause in trial.causes):
        return f"the run {outcome.status} for another reason: {outcome.reason}"
    return ""


def _beyond_limits(found: Stability, numbers: Mapping[str, float | None]) -> str:
    for name, limit in (
        ("mass_error_relative", found.mass_error_limit),
        ("contact_residual", found.contact_residual_limit),
    ):
        value = numbers[name]
        if value is None:
            return f"{name} is missing"
        if not value <= limit:
            return f"{name} {value:.2g} exceeds {limit:g}"
    return ""


def _numbers(output: Path) -> dict[str, float | None]:
    """Numbers of a finished run; only the two estimates may be absent."""
    record = read_json(output / "run.json")
    numbers: dict[str, float | None] = {
        name: _finite(record.get(name), name)
        for name in ("mass_error_relative", "contact_residual", "step_cuts")
    }
    for name in ("condition_estimate", "forward_error_bound"):
        numbers[name] = _finite(record[name], name) if name in record else None
    for take in ("mean", "max"):
        fields = Fields({"column": "newton_iterations", "take": take}, "history.csv")
        values = select(read_selection(fields, "history.csv"), output, {})
        numbers[f"newton_{take}"] = float(values.values[0])
    return numbers


def _finite(value: object, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise CaseError(f"run.json: '{name}' is {value!r}, not a finite number")
    return float(value)


def _report(
    trial: Trial,
    outcome: Outcome,
    verdict: str,
    reason: str,
    numbers: Mapping[str, float | None],
) -> TrialReport:
    status = _STATUS.get(outcome.status, outcome.status)
    return TrialReport(
        trial,
        verdict,
        reason or (outcome.reason if status != "converged" else ""),
        status,
        numbers.get("newton_mean"),
        numbers.get("newton_max"),
        numbers.get("step_cuts"),
        numbers.get("mass_error_relative"),
        numbers.get("contact_residual"),
        numbers.get("condition_estimate"),
        numbers.get("forward_error_bound"),
        outcome.cpu_s,
    )
