"""All cases of a call: reading the folders, listing their runs, judging the results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from wingcrack.errors import CaseError
from wingcrack_verify import case_folders
from wingcrack_verify.case import read_case
from wingcrack_verify.contents import UNREADABLE, Case, Run
from wingcrack_verify.execute import Job, Outcome
from wingcrack_verify.judge import CaseReport, judge_case, worst_of
from wingcrack_verify.stability import Stability, StabilityReport, judge_stability, read_stability

Item = TypeVar("Item")


@dataclass(frozen=True)
class BrokenCase:
    """A folder whose TOML file cannot be used."""

    name: str
    folder: Path
    reason: str


@dataclass(frozen=True)
class Suite:
    """What a call is about, in the order of the folders' names."""

    cases: tuple[Case | BrokenCase, ...]
    stability: tuple[Stability | BrokenCase, ...]

    @property
    def jobs(self) -> tuple[Job, ...]:
        """All runs; the long ones of the cases first, the small ones of stability last."""
        jobs = []
        for item in (*self.cases, *self.stability):
            runs: tuple[Run, ...] = () if isinstance(item, BrokenCase) else item.runs
            jobs += [Job(item.name, run) for run in runs]
        return tuple(jobs)


@dataclass(frozen=True)
class JudgedSuite:
    """All that the report tells."""

    cases: tuple[CaseReport, ...]
    stability: tuple[StabilityReport, ...]

    @property
    def folders(self) -> dict[str, Path]:
        """Folder of each case by its name."""
        cases = {item.name: item.folder for item in self.cases}
        return cases | {item.name: item.folder for item in self.stability}

    @property
    def verdict(self) -> str:
        """The worst of all; nothing judged is an error."""
        cases = [item.verdict for item in self.cases]
        return worst_of(cases + [item.verdict for item in self.stability])


def read_suite(top: Path, names: Sequence[str], quick: bool) -> Suite:
    """Read the named cases, all of which are there, or every one.

    Raises `CaseError` if nothing is left to run; a broken case is part of the suite, and red.
    """
    folders = case_folders(top)
    cases: list[Case | BrokenCase] = []
    stability: list[Stability | BrokenCase] = []
    for name in sorted(set(names) or folders):
        folder = folders[name]
        if (folder / "stability.toml").is_file():
            stability.append(_read(folder, read_stability))
        else:
            cases.append(_read(folder, read_case))
    if quick:
        cases = [
            item if isinstance(item, BrokenCase) else item.quick_part
            for item in cases
            if isinstance(item, BrokenCase) or item.quick
        ]
        stability = [
            item if isinstance(item, BrokenCase) else item.quick_part
            for item in stability
            if isinstance(item, BrokenCase) or item.quick
        ]
    if not cases and not stability:
        raise CaseError("there is no case to run")
    return Suite(tuple(cases), tuple(stability))


def _read(folder: Path, read: Callable[[Path], Item]) -> Item | BrokenCase:
    try:
        if not (folder / "README.md").is_file():
            raise CaseError("README.md is missing: a number without its problem says nothing")
        return read(folder)
    except CaseError as reason:
        return BrokenCase(folder.name, folder, str(reason))


def judge_suite(suite: Suite, outcomes: Mapping[tuple[str, str], Outcome]) -> JudgedSuite:
    """Judge all cases; `outcomes` by case and run."""
    cases = tuple(
        CaseReport(item.name, item.name, UNREADABLE, "", item.folder, broken=item.reason)
        if isinstance(item, BrokenCase)
        else judge_case(item, _of_case(outcomes, item.name))
        for item in suite.cases
    )
    stability = tuple(
        StabilityReport(item.name, item.name, UNREADABLE, "", item.folder, broken=item.reason)
        if isinstance(item, BrokenCase)
        else judge_stability(item, _of_case(outcomes, item.name))
        for item in suite.stability
    )
    return JudgedSuite(cases, stability)


def _of_case(outcomes: Mapping[tuple[str, str], Outcome], name: str) -> dict[str, Outcome]:
    return {run: outcome for (case, run), outcome in outcomes.items() if case == name}
