"""The contents of a case of ``verification/`` as typed values (docs/verification.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from wingcrack.errors import CaseError
from wingcrack.sweeps.fields import (
    TIME_LIMIT_S,
    Entry,
    Positive,
    Table,
    Text,
    Texts,
    as_number,
    choice,
    is_number,
    read_by,
    read_entry,
)
from wingcrack.sweeps.paths import NETWORK, network_table
from wingcrack.sweeps.selection import Selection
from wingcrack_verify.economy import Economy
from wingcrack_verify.held import Held
from wingcrack_verify.metrics import METRICS

# The physics of a case, in the order of the report; a case names its group in its own file.
GROUPS = {
    "elasticity": "Elasticity and cracks",
    "contact": "Contact and friction",
    "poroelasticity": "Poroelasticity",
    "flow": "Flow in fractures",
    "wells": "Wells",
    "growth": "Growth",
    "networks": "Networks and windows",
    "stability": "Stability and extremes",
    "cost": "Cost",
}
UNREADABLE = ""  # group of a case whose file cannot be used, which stands first
_FIELDS = "matrix.pvd"
# Pictures of a run (network, contact states, pore pressure), each with the file that it requires.
PICTURES = {"network": NETWORK, "states": "fractures.csv", "pressure": _FIELDS}


def require_files(picture: str, folder: Path) -> None:
    """Raise a `CaseError` if the run did not write what the picture shows."""
    needed = PICTURES[picture]
    if needed == NETWORK:
        network_table(folder / NETWORK)
    elif not (folder / needed).is_file():
        hint = '; set "output.vtu" = true' if needed == _FIELDS else ""
        raise CaseError(f"the run wrote no {needed}{hint}")


class Run(Entry):
    """One call of the solver or of a verification program."""

    name: Text
    method: Text
    size: Positive | None = None
    default: bool = False
    quick: bool = True  # part of --quick, if its part is
    scene: Path | None = None
    set: Table = Field(default_factory=dict)
    unset: Texts = ()
    program: Text | None = None
    args: Texts = ()
    constants: dict[str, float] = Field(default_factory=dict)
    time_limit_s: Positive = TIME_LIMIT_S

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if (self.scene is None) == (self.program is None):
            raise ValueError("either 'scene' or 'program' is needed")
        if self.args and self.scene is not None:
            raise ValueError("'args' are for a program")
        if (self.set or self.unset) and self.scene is None:
            raise ValueError("'set' and 'unset' are for a scene")
        return self


@dataclass(frozen=True)
class Reference:
    """What the result is compared with; exactly one of these is given."""

    numbers: tuple[float, ...] | None = None
    expression: str | None = None
    selection: Selection | None = None
    of_run: bool = False
    other_run: str | None = None
    limits: tuple[float, float] | None = None
    direction: str | None = None


class _Range(Entry):
    lower: float
    upper: float


class _Expression(Entry):
    expression: Text


class _OfRun(Selection):
    run: Text


def _reference(data: Any, place: str = "reference") -> Reference:
    if isinstance(data, str):
        if data not in ("rising", "falling"):
            raise CaseError(f"{place}: '{data}' is neither 'rising' nor 'falling'")
        return Reference(direction=data)
    if isinstance(data, list) and data:
        return Reference(numbers=tuple(as_number(item, place) for item in data))
    if not isinstance(data, Mapping):
        return Reference(numbers=(as_number(data, place),))
    if "lower" in data:
        found = read_entry(_Range, data, place)
        if not found.lower < found.upper:
            raise CaseError(f"{place}: 'lower' must be less than 'upper'")
        return Reference(limits=(found.lower, found.upper))
    if "expression" in data:
        return Reference(expression=read_entry(_Expression, data, place).expression)
    if "run" in data:
        other = read_entry(_OfRun, data, place)
        return Reference(selection=other, other_run=other.run)
    if "run_file" in data:
        named = {("file" if key == "run_file" else key): value for key, value in data.items()}
        return Reference(selection=read_entry(Selection, named, place), of_run=True)
    return Reference(selection=read_entry(Selection, data, place))


class Order(Entry):
    """Order of convergence that is expected, bounded on both sides."""

    expected: float
    within: Positive
    methods: Texts | None = None

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if not self.within <= 0.5 * abs(self.expected):
            raise ValueError("'within' must be at most half of 'expected'")
        return self


class Check(Entry):
    """One quantity, its reference and its tolerance."""

    quantity: Text
    unit: Text
    runs: Texts = ("*",)  # patterns, then names
    judged: Texts = ("*",)
    result: Selection
    reference: Annotated[Reference, read_by(_reference)]
    metric: Annotated[str, choice(METRICS)]
    normalise: Annotated[str, choice(("magnitude", "range"))] = "magnitude"
    tolerance: Positive
    scale: Positive | None = None
    order: Order | None = None
    economy: Economy | None = None
    held: Held | None = None
    front: Annotated[float, Field(gt=0.0, lt=1.0)] | None = None
    work_precision: bool = False
    known_gap: Text | None = None
    x_label: Text = ""

    @model_validator(mode="before")
    @classmethod
    def _half_of_a_range(cls, data: Any) -> Any:
        """Give a check of a range its tolerance."""
        ends = data.get("reference")
        if not isinstance(ends, Mapping) or "lower" not in ends:
            return data
        if "tolerance" in data:
            raise ValueError("'tolerance' is not for a reference {lower, upper}")
        lower, upper = ends["lower"], ends.get("upper")
        known = is_number(lower) and is_number(upper)
        return {**data, "tolerance": 0.5 * (upper - lower) if known else 1.0}

    @model_validator(mode="after")
    def _judge(self) -> Self:
        metric, reference = METRICS[self.metric], self.reference
        if self.by_range and not metric.can_normalise:
            raise ValueError(f"'normalise' is not for the metric {self.metric}")
        if (self.metric == "range") != (reference.limits is not None):
            raise ValueError("the metric range and a reference {lower, upper} go together")
        if metric.is_path and (reference.selection is None or not reference.selection.x_column):
            raise ValueError(f"the metric {self.metric} takes a selection with 'x'")
        if (self.metric == "monotonic") != (reference.direction is not None):
            raise ValueError("the metric monotonic and 'rising' or 'falling' go together")
        return self

    @property
    def by_range(self) -> bool:
        """Whether the error is divided by the range of the reference."""
        return self.normalise == "range"

    @property
    def abscissa(self) -> str:
        """Label of the axis of a profile."""
        return self.x_label or self.result.x_column or ""


class Line(Selection):
    """A line of a further figure: from a run, or from a file of the case."""

    label: Text
    run: Text | None = None
    points: bool = False

    @model_validator(mode="after")
    def _has_x(self) -> Self:
        if self.x is None:
            raise ValueError("'x' is missing")
        return self


class FigureRequest(Entry):
    """A further figure: of lines, or a picture of a run."""

    title: Text
    caption: Text = ""
    x_label: Text = ""
    y_label: Text = ""
    x_log: bool = False
    y_log: bool = False
    equal_axes: bool = False
    lines: Annotated[tuple[Line, ...], Field(strict=False)] = ()
    picture: Annotated[str | None, choice(PICTURES)] = None
    run: Text | None = None  # that the picture is of
    constants: dict[str, float] = Field(
        default_factory=dict
    )  # of the part, for lines from files of the case

    @model_validator(mode="after")
    def _judge(self) -> Self:
        of_picture = {"title", "caption", "picture", "run", "constants"}
        needed = ("run",) if self.picture else ("lines", "x_label", "y_label")
        for key in needed:
            if not getattr(self, key):
                raise ValueError(f"'{key}' is missing")
        for key in sorted(self.model_fields_set - of_picture if self.picture else ()):
            raise ValueError(f"'{key}' is not for a picture")
        if self.run and not self.picture:
            raise ValueError("'run' is for a picture")
        return self


@dataclass(frozen=True)
class Part:
    """Runs, and the checks and figures of these: of a whole case, or of a ``[[part]]`` of it."""

    runs: tuple[Run, ...]
    checks: tuple[Check, ...]
    figures: tuple[FigureRequest, ...]
    quick: bool  # part of --quick

    @property
    def quick_part(self) -> Part:
        """What of it is part of --quick: without checks and figures that have nothing left."""
        names = {run.name for run in self.runs if run.quick}

        def kept(names_of_check: Texts) -> Texts:
            return tuple(name for name in names_of_check if name in names)

        return replace(
            self,
            runs=tuple(run for run in self.runs if run.quick),
            checks=tuple(
                check.model_copy(update={"runs": kept(check.runs), "judged": kept(check.judged)})
                for check in self.checks
                if kept(check.judged) and check.reference.other_run in (None, *names)
            ),
            figures=tuple(
                figure
                for figure in self.figures
                if {figure.run, *(line.run for line in figure.lines)} <= {None, *names}
            ),
        )

    def named(self, name: str) -> Part:
        """The same with the name of the part in front of all names."""

        def full(text: str) -> str:
            return f"{name}: {text}"

        def full_or_none(text: str | None) -> str | None:
            return None if text is None else full(text)

        def named_check(check: Check) -> Check:
            other = full_or_none(check.reference.other_run)
            changes = {
                "quantity": full(check.quantity),
                "runs": tuple(map(full, check.runs)),
                "judged": tuple(map(full, check.judged)),
                "reference": replace(check.reference, other_run=other),
            }
            return check.model_copy(update=changes)

        def named_figure(figure: FigureRequest) -> FigureRequest:
            lines = [
                line.model_copy(update={"run": full_or_none(line.run)}) for line in figure.lines
            ]
            changes = {"title": full(figure.title), "run": full_or_none(figure.run)}
            return figure.model_copy(update={**changes, "lines": tuple(lines)})

        return Part(
            tuple(run.model_copy(update={"name": full(run.name)}) for run in self.runs),
            tuple(map(named_check, self.checks)),
            tuple(map(named_figure, self.figures)),
            self.quick,
        )


@dataclass(frozen=True)
class Case:
    """A folder of ``verification/``."""

    name: str
    folder: Path
    title: str
    group: str
    source: str
    parts: tuple[Part, ...]

    @property
    def runs(self) -> tuple[Run, ...]:
        """Those of all parts."""
        return tuple(run for part in self.parts for run in part.runs)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those of all parts."""
        return tuple(check for part in self.parts for check in part.checks)

    @property
    def figures(self) -> tuple[FigureRequest, ...]:
        """Those of all parts."""
        return tuple(figure for part in self.parts for figure in part.figures)

    @property
    def quick(self) -> bool:
        """Whether anything of it is part of --quick."""
        return any(part.quick for part in self.parts)

    @property
    def quick_part(self) -> Case:
        """What of it is part of --quick."""
        return replace(self, parts=tuple(part.quick_part for part in self.parts if part.quick))
