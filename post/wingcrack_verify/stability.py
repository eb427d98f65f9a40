"""Stiff and extreme scenes: whether the solver converges or refuses, and at what cost."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from wingcrack.errors import CaseError
from wingcrack.figures.text_files import is_file, read_json
from wingcrack.sweeps.fields import (
    Entry,
    Numbers,
    Positive,
    Table,
    Tables,
    Text,
    Texts,
    Values,
    choice,
    read_entry,
    read_toml,
    whole,
)
from wingcrack.sweeps.likes import Likes, shared_likes
from wingcrack.sweeps.selection import Selection, select
from wingcrack.sweeps.sweep import Defaults, read_tables
from wingcrack_verify.case import place_of, refuse_doubles
from wingcrack_verify.contents import GROUPS, Run
from wingcrack_verify.execute import Outcome
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
    expect: str = "converged"  # or "refused", "stopped", or "settled": one of them
    causes: tuple[str, ...] = ()  # one of these is part of the reason; none: any reason will do
    note: str = ""
    known_gap: str | None = None
    quick: bool = True  # part of --quick, if the file is


class _TrialFile(Entry):
    """One ``[[trial]]``."""

    name: Text
    set: Table = Field(default_factory=dict)
    unset: Texts = ()
    expect: Annotated[str, choice(EXPECTED)]
    cause: Texts = ()
    note: Text = ""
    known_gap: Text | None = None
    quick: bool = True

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if self.cause and self.expect == "converged":
            raise ValueError("what converges has no cause")
        return self


class Axis(Entry):
    """Parameter of a map: all the names get each of the values, the others a multiple of it."""

    label: Text
    names: Texts
    values: Numbers
    multiples: dict[str, float] = Field(default_factory=dict)

    def changes(self, value: float) -> dict[str, float]:
        """Values of the scene at one place of the axis."""
        of_names = dict.fromkeys(self.names, value)
        return of_names | {name: value * factor for name, factor in self.multiples.items()}


class _MapFile(Entry):
    """One ``[[map]]``."""

    title: Text
    set: Table = Field(default_factory=dict)
    unset: Texts = ()
    known_gap: Text | None = None
    x: Axis
    y: Axis


class _Range(Entry):
    """Range of a draw: between two numbers, or of a list."""

    first: Annotated[float | None, Field(alias="from")] = None
    last: Annotated[float | None, Field(alias="to")] = None
    log: bool = False
    of: Values | None = None

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if (self.of is None) != (self.first is not None and self.last is not None):
            raise ValueError("either 'from' and 'to', or 'of' is needed")
        if self.log and not min(self.first or 0.0, self.last or 0.0) > 0.0:
            raise ValueError("'log' needs numbers above 0")
        return self

    def places(self, shares: list[float]) -> list[Any]:
        """Values at shares of the range."""
        if self.of is not None:
            return [self.of[int(share * len(self.of))] for share in shares]
        first, last = self.first or 0.0, self.last or 0.0
        if self.log:
            return [first * math.exp(share * math.log(last / first)) for share in shares]
        return [first + share * (last - first) for share in shares]


class _DrawFile(Entry):
    """One ``[[draw]]``; with `quick` that many of its trials are part of ``--quick``."""

    count: Annotated[int, whole(1)]
    seed: Annotated[int, whole(1)]
    quick: Annotated[int | None, whole(1)] = None
    ranges: Annotated[dict[str, _Range], Field(min_length=1)]
    trial: Table

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if (self.quick or 0) > self.count:
            raise ValueError(f"'quick' must be at most 'count', {self.count}")
        return self


class _StabilityFile(Entry):
    """What the file says, before its trials are made."""

    title: Text
    source: Text
    quick: bool = False
    group: Annotated[str, choice(GROUPS)]
    scene: Text
    mass_error_limit: Positive
    contact_residual_limit: Positive
    time_limit_s: Positive = TIME_LIMIT_S
    from_files: bool = False  # whether every state is judged again from the files
    defaults: Table = Field(default_factory=dict)
    trial: Tables = ()
    draw: Tables = ()
    map: Tables = ()


_TRIAL_KEYS = {*_TrialFile.model_fields}


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
    said: _StabilityFile
    trials: tuple[Trial, ...]
    maps: tuple[Map, ...]

    @property
    def quick(self) -> bool:
        """Whether anything of it is part of --quick."""
        return self.said.quick

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
    """Read ``stability.toml``; a `CaseError` states what is wrong with it."""
    data = read_toml(folder / "stability.toml")
    said = read_entry(_StabilityFile, data, "stability.toml")
    base = folder / said.scene
    if not is_file(base):
        raise CaseError(f"stability.toml: there is no scene file {base.name}")
    values = ALL_FIELDS if said.from_files else {}

    def run(name: str, changes: Table, unset: tuple[str, ...]) -> Run:
        return Run(
            name=name,
            method="stability",
            scene=base,
            set={**values, **changes},
            unset=unset,
            time_limit_s=said.time_limit_s,
        )

    defaults = Defaults(said.defaults, ("trial",))
    likes = Likes(data, "stability.toml", shared_likes(folder.parent))
    tables = read_tables(said.trial, "trial", _TRIAL_KEYS, defaults, likes)
    defaults.done()
    for index, item in enumerate(said.draw, start=1):
        tables += _drawn(read_entry(_DrawFile, item, f"draw {index}"), f"draw {index}")
    trials = []
    for place, table in tables:
        item = read_entry(_TrialFile, table, place_of(table, "trial", place))
        made = run(item.name, item.set, item.unset)
        trials.append(Trial(made, item.expect, item.cause, item.note, item.known_gap, item.quick))
    maps = []
    for index, table in enumerate(said.map, start=1):
        chart = read_entry(_MapFile, table, f"map {index}")
        cells = tuple(
            Trial(
                run(
                    f"{chart.title}: {x:g}, {y:g}",
                    chart.set | chart.x.changes(x) | chart.y.changes(y),
                    chart.unset,
                )
            )
            for y in chart.y.values
            for x in chart.x.values
        )
        maps.append(Map(chart.title, chart.x, chart.y, cells, chart.known_gap))
    if not trials:
        raise CaseError("stability.toml: at least one [[trial]] is needed")
    found = Stability(folder.name, folder, said, tuple(trials), tuple(maps))
    refuse_doubles([one.name for one in found.runs], "trial")
    if said.quick and not any(trial.quick for trial in trials):
        raise CaseError("stability.toml: at least one [[trial]] of a quick file must be quick")
    return found


def _drawn(draw: _DrawFile, place: str) -> list[tuple[str, Table]]:
    """Tables of trials that a ``[[draw]]`` stands for, each with its place for errors.

    The names of its ranges are used in templates, as those of an ``over`` (`sweep`); `number` is
    that of the trial, from 1. So that each range is covered evenly however few the trials, it is
    cut into as many equal parts as there are trials, and each part is drawn from once (McKay,
    Beckman and Conover 1979).
    """
    random = np.random.default_rng(draw.seed)
    points: Table = {"number": list(range(1, draw.count + 1))}
    for name, entry in draw.ranges.items():
        shares = (random.permutation(draw.count) + random.random(draw.count)) / draw.count
        points[name] = entry.places(shares.tolist())
    tables = read_tables([{**draw.trial, "over": {"place": points}}], "trial", _TRIAL_KEYS)
    quick = draw.count if draw.quick is None else draw.quick
    return [
        (place, {"quick": number <= quick, **table})
        for number, (_, table) in enumerate(tables, start=1)
    ]


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
        found.said.title,
        found.said.group,
        found.said.source,
        found.folder,
        tuple(judge_trial(found, item, outcomes[item.run.name]) for item in found.trials),
        tuple(maps),
        (found.said.mass_error_limit, found.said.contact_residual_limit),
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
        if found.said.from_files and outcome.status in ("finished", "failed"):
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
        ("mass_error_relative", found.said.mass_error_limit),
        ("contact_residual", found.said.contact_residual_limit),
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
        wanted = Selection(file="history.csv", column="newton_iterations", take=take)
        values = select(wanted, output, {})
        numbers[f"newton_{take}"] = float(values.values[0])
    return numbers


def _finite(value: object, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise CaseError(f"run.json: '{name}' is {value!r}, not a finite number")
    return float(value)


def _report(
    trial: Trial, outcome: Outcome, verdict: str, reason: str, numbers: Mapping[str, float | None]
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
