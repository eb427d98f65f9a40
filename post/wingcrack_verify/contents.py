"""The contents of a case of ``verification/`` as typed values (docs/verification.md)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from wingcrack.sweeps.selection import Selection
from wingcrack_verify.economy import Economy


@dataclass(frozen=True)
class Run:
    """One call of the solver or of a verification program."""

    name: str
    method: str
    size: float | None
    default: bool
    scene: Path | None
    set: dict[str, Any]
    unset: tuple[str, ...]
    program: str | None
    args: tuple[str, ...]
    constants: dict[str, float]
    time_limit_s: float


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


@dataclass(frozen=True)
class Order:
    """Order of convergence that is expected, bounded on both sides."""

    expected: float
    within: float
    methods: tuple[str, ...] | None


@dataclass(frozen=True)
class Check:
    """One quantity, its reference and its tolerance."""

    quantity: str
    unit: str
    runs: tuple[str, ...]
    judged: tuple[str, ...]
    result: Selection
    reference: Reference
    metric: str
    by_range: bool
    tolerance: float
    scale: float | None
    order: Order | None
    economy: Economy | None
    front: float | None
    work_precision: bool
    known_gap: str | None
    x_label: str


@dataclass(frozen=True)
class Line:
    """A line of a further figure: from a run, or from a file of the case."""

    label: str
    run: str | None
    selection: Selection
    points: bool


@dataclass(frozen=True)
class FigureRequest:
    """A further figure: of lines, or a picture of a run."""

    title: str
    caption: str
    x_label: str
    y_label: str
    x_log: bool
    y_log: bool
    equal_axes: bool
    lines: tuple[Line, ...]
    picture: str | None = None
    run: str | None = None  # that the picture is of
    constants: dict[str, float] = field(default_factory=dict)  # for lines from files of the case


@dataclass(frozen=True)
class Part:
    """Runs, and the checks and figures of these: of a whole case, or of a ``[[part]]`` of it."""

    runs: tuple[Run, ...]
    checks: tuple[Check, ...]
    figures: tuple[FigureRequest, ...]
    quick: bool  # part of --quick

    def named(self, name: str) -> Part:
        """The same with the name of the part in front of all names."""

        def full(text: str) -> str:
            return f"{name}: {text}"

        def full_or_none(text: str | None) -> str | None:
            return None if text is None else full(text)

        def named_check(check: Check) -> Check:
            other = full_or_none(check.reference.other_run)
            return replace(
                check,
                quantity=full(check.quantity),
                runs=tuple(map(full, check.runs)),
                judged=tuple(map(full, check.judged)),
                reference=replace(check.reference, other_run=other),
            )

        def named_figure(figure: FigureRequest) -> FigureRequest:
            lines = tuple(replace(line, run=full_or_none(line.run)) for line in figure.lines)
            run = full_or_none(figure.run)
            return replace(figure, title=full(figure.title), run=run, lines=lines)

        return Part(
            tuple(replace(run, name=full(run.name)) for run in self.runs),
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
        return replace(self, parts=tuple(part for part in self.parts if part.quick))
