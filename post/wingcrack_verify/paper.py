"""The file of a paper (``inputs/papers``): its numbers, figures and studies, as typed values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self, TypeVar

from pydantic import Field, model_validator

from wingcrack.errors import CaseError
from wingcrack.sweeps.fields import (
    Entry,
    Numbers,
    Table,
    Tables,
    Text,
    Texts,
    read_entry,
    read_toml,
)
from wingcrack.sweeps.selection import Selection
from wingcrack.sweeps.sweep import Defaults, read_tables
from wingcrack_verify.case import read_case, read_run
from wingcrack_verify.contents import Case, Part, Run


class Number(Entry):
    """A number that the thesis prints, or a point of a curve of it."""

    place: Text  # "table 2, page 8"
    quantity: Text
    unit: Text
    thesis: float | None = None
    measured: float | None = None  # in an experiment that the thesis quotes
    exact: float | str | None = None  # a number, or a constant of the run
    run: Text | None = None  # "CASE: RUN"; without one nothing of ours corresponds
    ours: Selection | None = None
    error: Text | None = None  # the column of the estimated error, in place of that of `ours`
    series: Text | None = None  # the curve that the number is a point of, drawn over `x`
    x: float | None = None
    x_label: Text | None = None
    note: str = ""
    quick: bool = False

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if (self.run is None) != (self.ours is None):
            raise ValueError("'run' and 'ours' go together")
        if self.series and (self.x is None or not self.x_label):
            raise ValueError("'series' needs 'x' and 'x_label'")
        return self


class PaperFigure(Entry):
    """A figure: of a run as `./wingcrack plot` draws it, or of a case as its report shows it."""

    place: Text
    caption: str = ""
    run: Text | None = None  # "CASE: RUN"
    of: Texts = ()  # names of figures of `run`
    times_s: Numbers | None = None
    case: Text | None = None  # "CASE: TITLE of a figure or QUANTITY of a check"
    quick: bool = False

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if bool(self.run and self.of) == bool(self.case):
            raise ValueError("either 'run' and 'of' or 'case' are needed")
        return self


Kind = TypeVar("Kind", Number, PaperFigure)


class _PaperFile(Entry):
    title: Text
    remarks: Texts = ()
    studies: Texts = ()
    number: Tables = ()
    figure: Tables = ()
    run: Tables = ()
    sweep: Tables = ()
    defaults: Table = Field(default_factory=dict)


@dataclass(frozen=True)
class Paper:
    """What is reproduced of a paper, with the runs of verification cases that it takes."""

    name: str
    title: str
    remarks: tuple[str, ...]
    studies: tuple[Path, ...]
    numbers: tuple[Number, ...]
    figures: tuple[PaperFigure, ...]
    shown: Mapping[str, Case]  # cases reduced to a figure or check, by its name
    runs: Mapping[str, Run]  # by "CASE: RUN"


def read_paper(file: Path, cases: Path, quick: bool) -> Paper:
    """Read the file of a paper; with `quick` only its quick entries, and no studies.

    Raises `CaseError` if anything in it is missing, unknown or contradicts itself.
    """
    data = read_toml(file)
    said = read_entry(_PaperFile, data, file.name)
    defaults = Defaults(said.defaults, ("number", "figure"))

    def entries(kind: type[Kind], data: Sequence[Any], name: str) -> tuple[Kind, ...]:
        tables = read_tables(data, name, set(kind.__pydantic_fields__), defaults)
        found = [read_entry(kind, item, f"{file.name}: {place}") for place, item in tables]
        return tuple(item for item in found if item.quick or not quick)

    numbers = entries(Number, said.number, "number")
    figures = entries(PaperFigure, said.figure, "figure")
    own = [
        read_run(item, place, file.parent, {})
        for kind in ("run", "sweep")
        for place, item in read_tables(data.get(kind, ()), kind, {*Run.model_fields})
    ]
    known = {f"{file.stem}: {run.name}": run for run in own}
    named = {item.run for item in numbers if item.run}
    named |= {item.run for item in figures if item.run}
    names = {name.partition(": ")[0] for name in named - known.keys()}
    names |= {item.case.partition(": ")[0] for item in figures if item.case}
    if lacking := sorted(name for name in names if not (cases / name / "check.toml").is_file()):
        raise CaseError(f"{file.name}: there is no case '{lacking[0]}'")
    found = {name: read_case(cases / name) for name in sorted(names)}
    shown = {item.case: _shown(item.case, found, file.name) for item in figures if item.case}
    named |= {f"{case.name}: {run.name}" for case in shown.values() for run in case.runs}
    known |= {f"{name}: {run.name}": run for name, case in found.items() for run in case.runs}
    if lacking := sorted(named - known.keys()):
        raise CaseError(f"{file.name}: there is no run '{lacking[0]}'")
    return Paper(
        name=file.stem,
        title=said.title,
        remarks=said.remarks,
        studies=() if quick else tuple((file.parent / one).resolve() for one in said.studies),
        numbers=numbers,
        figures=figures,
        shown=shown,
        runs={name: run for name, run in known.items() if name in named},
    )


def _shown(name: str, cases: Mapping[str, Case], place: str) -> Case:
    """Give the case with nothing but the named figure or check, and its runs."""
    case, _, title = name.partition(": ")
    for part in cases[case].parts:
        figures = tuple(figure for figure in part.figures if figure.title == title)
        checks = tuple(check for check in part.checks if check.quantity == title)
        if not figures and not checks:
            continue
        wanted = {figure.run for figure in figures}
        wanted |= {line.run for figure in figures for line in figure.lines}
        wanted |= {run for check in checks for run in check.runs}
        wanted |= {check.reference.other_run for check in checks}
        runs = tuple(run for run in part.runs if run.name in wanted)
        return replace(cases[case], parts=(Part(runs, checks, figures, quick=True),))
    raise CaseError(f"{place}: the case '{case}' has no figure or check '{title}'")
