"""From the files of the runs to verdicts: every check measured, held against its tolerance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wingcrack.errors import CaseError
from wingcrack.sweeps.expressions import Array, evaluate
from wingcrack.sweeps.selection import Selection, Values, interpolated, select
from wingcrack_verify.contents import Case, Check, FigureRequest, Run, require_files
from wingcrack_verify.economy import Front, Saving, front, saving, unknowns_of, work_of
from wingcrack_verify.execute import Outcome
from wingcrack_verify.held import Holding, holding
from wingcrack_verify.metrics import METRICS, Pair, check_tolerance, measure, signal
from wingcrack_verify.orders import Advice, Fit, Point, advise, observed_order

PASSED, GAP, FAILED, ERROR = "passed", "known gap", "failed", "error"
VERDICTS = (PASSED, GAP, FAILED, ERROR)  # from good to bad
RED = (FAILED, ERROR)


@dataclass(frozen=True)
class Measured:
    """A check on one run."""

    run: Run
    judged: bool
    outcome: Outcome
    error: float | None
    signal: float | None
    pair: Pair | None
    profile: bool
    broken: str  # why it could not be measured, although the run is sound
    good: bool  # within the tolerance

    @property
    def ran(self) -> bool:
        """Whether the run came to its end."""
        return self.outcome.status == "finished"


@dataclass(frozen=True)
class MethodOrder:
    """Observed order of one method, or why there is none."""

    method: str
    fit: Fit | None
    good: bool
    broken: bool  # cannot be observed, although all runs are sound
    reason: str


@dataclass(frozen=True)
class CheckReport:
    """A check with all that was measured."""

    check: Check
    verdict: str
    reasons: tuple[str, ...]
    measured: tuple[Measured, ...]
    orders: tuple[MethodOrder, ...]
    points: tuple[Point, ...]
    advice: tuple[Advice, ...]
    saving: Saving | None = None
    front: Front | None = None
    holding: Holding | None = None

    @property
    def worst(self) -> Measured | None:
        """The judged run with the largest error."""
        judged = [item for item in self.measured if item.judged and item.error is not None]
        return max(judged, key=lambda item: item.error or 0.0, default=None)


@dataclass(frozen=True)
class DrawnLine:
    """A line of a further figure."""

    label: str
    values: Values
    points: bool


@dataclass(frozen=True)
class DrawnFigure:
    """A further figure with its data, or what is wrong with it."""

    request: FigureRequest
    lines: tuple[DrawnLine, ...]
    broken: str
    folder: Path | None = None  # of the run that the picture is of


@dataclass(frozen=True)
class CaseReport:
    """A case with its verdict."""

    name: str
    title: str
    group: str
    source: str
    folder: Path
    checks: tuple[CheckReport, ...] = ()
    figures: tuple[DrawnFigure, ...] = ()
    outcomes: Mapping[str, Outcome] = field(default_factory=dict)
    broken: str = ""

    @property
    def verdict(self) -> str:
        """The worst of the checks' verdicts."""
        verdicts = [report.verdict for report in self.checks]
        if self.broken or any(figure.broken for figure in self.figures):
            verdicts.append(ERROR)
        return worst_of(verdicts)


def worst_of(verdicts: list[str]) -> str:
    """Worst verdict of a list; an empty list proves nothing and is an error."""
    for verdict in reversed(VERDICTS):
        if verdict in verdicts:
            return verdict
    return ERROR


def judge_case(case: Case, outcomes: Mapping[str, Outcome]) -> CaseReport:
    """Measure and judge all checks of a case; `outcomes` by the runs' names."""
    measured = [_measure_check(case, check, outcomes) for check in case.checks]
    return CaseReport(
        name=case.name,
        title=case.title,
        group=case.group,
        source=case.source,
        folder=case.folder,
        checks=tuple(
            judge_check(check, found, _on_one_front(case.checks, measured, check))
            for check, found in zip(case.checks, measured, strict=True)
        ),
        figures=tuple(_figure(case, request, outcomes) for request in case.figures),
        outcomes=outcomes,
    )


def _measure_check(
    case: Case, check: Check, outcomes: Mapping[str, Outcome]
) -> tuple[Measured, ...]:
    return tuple(
        _measure(case, check, run, outcomes) for run in case.runs if run.name in check.runs
    )


def _on_one_front(
    checks: Sequence[Check], measured: Sequence[tuple[Measured, ...]], check: Check
) -> list[tuple[Point, ...]]:
    """Errors of the other quantities that ask for the front of the same default run."""
    return [
        _points(found)
        for other, found in zip(checks, measured, strict=True)
        if other is not check
        and other.front
        and check.front
        and _default_of(found) == _default_of(measured[checks.index(check)])
    ]


def _default_of(measured: tuple[Measured, ...]) -> str | None:
    return next((item.run.name for item in measured if item.run.default), None)


def judge_check(
    check: Check, measured: tuple[Measured, ...], others: Sequence[Sequence[Point]] = ()
) -> CheckReport:
    """Judge one check; `others` are the quantities that share its front."""
    orders = _orders(check, measured)
    reasons = [f"{item.run.name}: {item.broken}" for item in measured if item.broken]
    broken = bool(reasons) or any(order.broken for order in orders)
    needed = [
        item for item in measured if item.judged or check.order or check.economy or check.front
    ]
    for item in needed:
        if not item.ran and not item.broken:
            status = item.outcome.status
            reasons.append(f"{item.run.name}: the run {status}: {item.outcome.reason}")
    found = _holding(check, measured)
    if found is not None and not found.good:
        reasons.append(found.reason)
    for item in measured:
        if check.held is None and item.judged and item.ran and not item.broken and not item.good:
            reasons.append(f"{item.run.name}: {item.error:.3g} exceeds {check.tolerance:.3g}")
    reasons += [order.reason for order in orders if not order.good]
    points = _points(measured)
    saved = None if check.economy is None else saving(check.economy, points)
    if saved is not None and not saved.good:
        reasons.append(saved.reason)
    place = None if check.front is None else front(points, check.front, others)
    if place is not None and not place.good:
        reasons.append(place.reason)
    good = not reasons and (
        check.held is not None or all(item.good for item in measured if item.judged)
    )
    if broken:
        verdict = ERROR
    elif check.known_gap is not None:
        verdict = GAP
        if good:
            reasons.append("within its tolerance now: the mark of a known gap can go")
    else:
        verdict = PASSED if good else FAILED
    advice = tuple(advise(points)) if check.work_precision else ()
    return CheckReport(
        check, verdict, tuple(reasons), measured, orders, points, advice, saved, place, found
    )


def _holding(check: Check, measured: Sequence[Measured]) -> Holding | None:
    """Whether the values of all judged runs together are within the tolerance, where asked."""
    if check.held is None:
        return None
    pairs = [item.pair for item in measured if item.judged and item.pair is not None]
    return holding(check.held, check.tolerance, [pair.result - pair.reference for pair in pairs])


def _points(measured: tuple[Measured, ...]) -> tuple[Point, ...]:
    return tuple(
        Point(
            item.run.name,
            item.run.method,
            item.outcome.cpu_s,
            item.error / item.signal,
            item.run.default,
            unknowns_of(Path(item.outcome.folder) / "output"),
            work_of(Path(item.outcome.folder) / "output"),
        )
        for item in measured
        if item.ran and item.error is not None and item.signal
    )


def _measure(case: Case, check: Check, run: Run, outcomes: Mapping[str, Outcome]) -> Measured:
    outcome = outcomes[run.name]
    judged = run.name in check.judged
    if outcome.status != "finished":
        broken = outcome.reason if outcome.status == "invalid" else ""
        return Measured(run, judged, outcome, None, None, None, False, broken, False)
    try:
        constants = run.constants
        output = Path(outcome.folder) / "output"
        result = select(check.result, output, constants, METRICS[check.metric].is_path)
        if check.reference.other_run is None:
            pair = _pair(check, case, result, output, constants)
        else:
            pair = _pair_of_runs(check, case, result, outcomes)
        error = measure(check.metric, pair, check.by_range)
        size = signal(check.metric, pair, check.scale)
        check_tolerance(check.tolerance, size)
    except CaseError as reason:
        return Measured(run, judged, outcome, None, None, None, False, str(reason), False)
    good = error <= check.tolerance  # a NaN is not good
    return Measured(run, judged, outcome, error, size, pair, result.profile, "", good)


def _pair(
    check: Check, case: Case, result: Values, output: Path, constants: Mapping[str, float]
) -> Pair:
    reference = check.reference
    if reference.direction is not None:
        sign = 1.0 if reference.direction == "rising" else -1.0
        return Pair(sign * result.values, sign * result.values, result.x)
    if reference.limits is not None:
        return _paired(result, np.array([0.5 * sum(reference.limits)]))
    if reference.numbers is not None:
        return _paired(result, np.array(reference.numbers))
    if reference.expression is not None:
        names: dict[str, Array | float] = dict(constants)
        if result.x is not None:
            names["x"] = result.x
        return _paired(result, np.atleast_1d(evaluate(reference.expression, names)))
    assert reference.selection is not None
    folder = output if reference.of_run else case.folder
    is_path = METRICS[check.metric].is_path
    return _beside(reference.selection, result, folder, constants, is_path)


def _pair_of_runs(
    check: Check, case: Case, result: Values, outcomes: Mapping[str, Outcome]
) -> Pair:
    """Result and the same quantity of another run of the case."""
    assert check.reference.selection is not None
    other = next(run for run in case.runs if run.name == check.reference.other_run)
    if outcomes[other.name].status != "finished":
        raise CaseError(f"the run '{other.name}' that it is compared with has not finished")
    folder = Path(outcomes[other.name].folder) / "output"
    is_path = METRICS[check.metric].is_path
    return _beside(check.reference.selection, result, folder, other.constants, is_path)


def _beside(
    selection: Selection,
    result: Values,
    folder: Path,
    constants: Mapping[str, float],
    as_path: bool,
) -> Pair:
    found = select(selection, folder, constants, as_path)
    if as_path:
        return Pair(result.values, found.values, result.x, found.x)
    if found.x is not None and result.x is not None:
        return _paired(result, interpolated(found, result.x, selection.file))
    return _paired(result, found.values)


def _paired(result: Values, reference: Array) -> Pair:
    if reference.size not in (1, result.values.size):
        raise CaseError(
            f"{reference.size} values in the reference for {result.values.size} in the result"
        )
    return Pair(result.values, np.broadcast_to(reference, result.values.shape), result.x)


def _orders(check: Check, measured: tuple[Measured, ...]) -> tuple[MethodOrder, ...]:
    if check.order is None:
        return ()
    sized = [item for item in measured if item.run.size is not None]
    methods = check.order.methods or tuple(dict.fromkeys(item.run.method for item in sized))
    if not methods:
        return (MethodOrder("", None, False, True, "order: no run has a 'size'"),)
    return tuple(
        _order(check, method, [item for item in sized if item.run.method == method])
        for method in methods
    )


def _order(check: Check, method: str, items: list[Measured]) -> MethodOrder:
    assert check.order is not None
    if not all(item.ran for item in items):
        return MethodOrder(method, None, False, False, f"order of {method}: a run is missing")
    errors = [np.nan if item.error is None else item.error for item in items]
    size = min((item.signal for item in items if item.signal is not None), default=1.0)
    try:
        fit = observed_order([item.run.size or 0.0 for item in items], errors, size)
    except CaseError as broken:
        return MethodOrder(method, None, False, True, f"order of {method}: {broken}")
    good = abs(fit.overall - check.order.expected) <= check.order.within
    wanted = f"{check.order.expected:g} +- {check.order.within:g}"
    reason = "" if good else f"order of {method}: {fit.overall:.2f} is not {wanted}"
    return MethodOrder(method, fit, good, False, reason)


def _figure(case: Case, request: FigureRequest, outcomes: Mapping[str, Outcome]) -> DrawnFigure:
    if request.picture is not None and request.run is not None:
        if outcomes[request.run].status != "finished":
            return DrawnFigure(request, (), "")  # the run's own checks say so
        folder = Path(outcomes[request.run].folder) / "output"
        try:
            require_files(request.picture, folder)
        except CaseError as reason:
            return DrawnFigure(request, (), f"{request.title}: {reason}")
        return DrawnFigure(request, (), "", folder)
    lines = []
    runs = {run.name: run for run in case.runs}
    for line in request.lines:
        if line.run is None:
            folder, constants = case.folder, request.constants
        else:
            if outcomes[line.run].status != "finished":
                continue  # the run's own checks say so
            folder = Path(outcomes[line.run].folder) / "output"
            constants = runs[line.run].constants
        try:
            values = select(line, folder, constants, as_path=True)
        except CaseError as reason:
            return DrawnFigure(request, (), f"{request.title}, {line.label}: {reason}")
        lines.append(DrawnLine(line.label, values, line.points))
    return DrawnFigure(request, tuple(lines), "")
