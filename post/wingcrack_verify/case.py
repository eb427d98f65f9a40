"""Reading a case of ``verification/``: its check.toml as typed values (docs/verification.md)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.figures import text_files
from wingcrack.sweeps.fields import TIME_LIMIT_S, Fields, as_number, read_toml
from wingcrack.sweeps.likes import Likes, shared_likes
from wingcrack.sweeps.selection import read_selection
from wingcrack.sweeps.sweep import Defaults, read_tables
from wingcrack_verify.contents import (
    Case,
    Check,
    FigureRequest,
    Line,
    Order,
    Part,
    Reference,
    Run,
)
from wingcrack_verify.economy import read_economy
from wingcrack_verify.groups import GROUPS
from wingcrack_verify.metrics import METRICS
from wingcrack_verify.picture_files import PICTURES

_DEFAULTS = ("run", "check", "figure")  # kinds of entries that have some


def read_case(folder: Path) -> Case:
    """Read ``check.toml`` of a case's folder.

    Raises `CaseError` if anything in it is missing, unknown or contradicts itself.
    """
    data = read_toml(folder / "check.toml")
    fields = Fields(data, "check.toml")
    title, source = fields.text("title"), fields.text("source")
    group, quick = fields.choice("group", tuple(GROUPS)), fields.flag("quick")
    around = _Around(
        folder=folder,
        gap=fields.text("known_gap", None),
        constants=fields.constants("constants"),
        defaults=Defaults(fields.mapping("defaults"), _DEFAULTS),
        likes=Likes(data, "check.toml", shared_likes(folder.parent)),
    )
    tables = fields.tables("part")
    parts = []
    if not tables or any(kind in data for kind in ("run", "sweep", "check", "figure")):
        parts.append(_read_part(fields, data, quick, around))
    parts += [
        _read_named_part(item, number, quick, around) for number, item in enumerate(tables, 1)
    ]
    fields.done()
    around.defaults.done()
    case = Case(folder.name, folder, title, group, source, tuple(parts))
    refuse_doubles([run.name for run in case.runs], "run")
    refuse_doubles([check.quantity for check in case.checks], "quantity")
    return case


@dataclass(frozen=True)
class _Around:
    """What holds in a part beside what it says itself."""

    folder: Path
    gap: str | None
    constants: dict[str, float]
    defaults: Defaults
    likes: Likes


def _read_named_part(data: Any, number: int, quick: bool, around: _Around) -> Part:
    """Read a ``[[part]]``: it has constants and defaults of its own, and those of the file."""
    fields = Fields(data, f"part {number}")
    name = fields.text("name")
    own = fields.flag("quick", quick)
    try:
        fields.place = "check.toml"
        defaults = Defaults(fields.mapping("defaults"), _DEFAULTS, around.defaults)
        inside = replace(
            around,
            constants=around.constants | fields.constants("constants"),
            defaults=defaults,
            likes=Likes(data, "check.toml", around.likes),
        )
        part = _read_part(fields, data, own, inside)
        fields.done()
        defaults.done()
    except CaseError as reason:
        raise CaseError(f"part '{name}': {reason}") from None
    return part.named(name)


def _read_part(fields: Fields, data: Mapping[str, Any], quick: bool, around: _Around) -> Part:
    """Read the runs, checks and figures of a table: the file's, or a part's."""

    def tables(kind: str) -> list[tuple[str, dict[str, Any]]]:
        return read_tables(fields, kind, around.defaults, around.likes)

    kinds = [kind for kind in data if kind in ("run", "sweep")]  # in the order of the file
    runs = tuple(
        read_run(item, place, around.folder, around.constants)
        for kind in kinds
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


def read_run(
    data: Any, place: str, folder: Path, constants: Mapping[str, float] | None = None
) -> Run:
    """Read one ``[[run]]``, to whose constants those of its case and its size belong."""
    fields = Fields(data, place)
    name = fields.text("name")
    fields.place = f"run '{name}'"
    method, size = fields.text("method"), fields.positive("size", None)
    default, own = fields.flag("default"), fields.constants("constants")
    known = {**(constants or {}), **({} if size is None else {"size": size}), **own}
    limit = fields.positive("time_limit_s", TIME_LIMIT_S)
    scene, program = fields.text("scene", None), fields.text("program", None)
    if (scene is None) == (program is None):
        raise CaseError(f"{fields.place}: either 'scene' or 'program' is needed")
    if scene is not None:
        changes, unset, args = fields.mapping("set"), fields.texts("unset", ()), ()
        path = folder / scene
        if not text_files.is_file(path):
            raise CaseError(f"{fields.place}: there is no scene file {scene}")
    else:
        changes, unset, args, path = {}, (), fields.texts("args", ()), None
    fields.done()
    return Run(name, method, size, default, path, changes, unset, program, args, known, limit)


def _read_check(data: Any, place: str, runs: tuple[Run, ...], case_gap: str | None) -> Check:
    fields = Fields(data, place)
    quantity = fields.text("quantity")
    fields.place = f"check '{quantity}'"
    unit = fields.text("unit")
    measured = _run_names(fields, "runs", tuple(run.name for run in runs))
    judged = _run_names(fields, "judged", measured)
    metric = fields.choice("metric", tuple(METRICS))
    normalise = fields.choice("normalise", ("magnitude", "range"), "magnitude")
    if normalise == "range" and not METRICS[metric].can_normalise:
        raise CaseError(f"{fields.place}: 'normalise' is not for the metric {metric}")
    reference = _read_reference(fields.take("reference"), f"{fields.place}: reference")
    _check_other_run(reference, runs, measured, fields.place)
    _check_kind(metric, reference, fields.place)
    if reference.limits is not None:
        tolerance = 0.5 * (reference.limits[1] - reference.limits[0])
    else:
        tolerance = fields.positive("tolerance")
    result_fields = Fields(fields.take("result"), f"{fields.place}: result")
    result = read_selection(result_fields, result_fields.text("file"))
    result_fields.done()
    order = _read_order(fields.take("order"), fields.place) if fields.has("order") else None
    economy = None
    if fields.has("economy"):
        methods = [run.method for run in runs if run.name in measured]
        economy = read_economy(fields.take("economy"), fields.place, methods)
    check = Check(
        quantity=quantity,
        unit=unit,
        runs=measured,
        judged=judged,
        result=result,
        reference=reference,
        metric=metric,
        by_range=normalise == "range",
        tolerance=tolerance,
        scale=fields.positive("scale", None),
        order=order,
        economy=economy,
        front=_read_front(fields, runs, measured),
        work_precision=fields.flag("work_precision"),
        known_gap=fields.text("known_gap", case_gap),
        x_label=fields.text("x_label", result.x or ""),
    )
    fields.done()
    if not set(judged) <= set(measured):
        raise CaseError(f"{fields.place}: 'judged' names a run that is not among 'runs'")
    return check


def _run_names(fields: Fields, key: str, default: tuple[str, ...]) -> tuple[str, ...]:
    """Names out of `default`, in its order: given as such, by patterns, or without some (!)."""
    given: tuple[str, ...] = fields.texts(key, default)
    if given == default:
        return default
    chosen: set[str] = set()
    for item in given:
        found = {name for name in default if _matches(item.removeprefix("!"), name)}
        if not found:
            raise CaseError(f"{fields.place}: '{key}' names '{item}', which is no such run")
        if item.startswith("!") and not found & chosen:
            raise CaseError(f"{fields.place}: '{key}' takes away '{item}', which is not there")
        chosen = chosen - found if item.startswith("!") else chosen | found
    if not chosen:
        raise CaseError(f"{fields.place}: '{key}' is empty")
    return tuple(name for name in default if name in chosen)


def _matches(pattern: str, name: str) -> bool:
    """Whether a name is the pattern, whose stars stand for any text."""
    return re.fullmatch(".*".join(map(re.escape, pattern.split("*"))), name) is not None


def _read_reference(data: Any, place: str) -> Reference:
    if isinstance(data, str):
        if data not in ("rising", "falling"):
            raise CaseError(f"{place}: '{data}' is neither 'rising' nor 'falling'")
        return Reference(direction=data)
    if isinstance(data, list) and data:
        return Reference(numbers=tuple(as_number(item, place) for item in data))
    if not isinstance(data, dict):
        return Reference(numbers=(as_number(data, place),))
    fields = Fields(data, place)
    if fields.has("lower"):
        lower, upper = fields.number("lower"), fields.number("upper")
        if not lower < upper:
            raise CaseError(f"{place}: 'lower' must be less than 'upper'")
        reference = Reference(limits=(lower, upper))
    elif fields.has("expression"):
        reference = Reference(expression=fields.text("expression"))
    elif fields.has("run"):
        other = fields.text("run")
        selection = read_selection(fields, fields.text("file"))
        reference = Reference(selection=selection, other_run=other)
    elif fields.has("run_file"):
        selection = read_selection(fields, fields.text("run_file"))
        reference = Reference(selection=selection, of_run=True)
    else:
        reference = Reference(selection=read_selection(fields, fields.text("file")))
    fields.done()
    return reference


def _check_other_run(
    reference: Reference, runs: tuple[Run, ...], measured: tuple[str, ...], place: str
) -> None:
    """Refuse a reference run that is none, or a run that would be compared with itself."""
    other = reference.other_run
    if other is None:
        return
    if other not in {run.name for run in runs}:
        raise CaseError(f"{place}: reference: there is no run '{other}'")
    if other in measured:
        raise CaseError(f"{place}: the run '{other}' would be compared with itself")


def _check_kind(metric: str, reference: Reference, place: str) -> None:
    if (metric == "range") != (reference.limits is not None):
        raise CaseError(f"{place}: the metric range and a reference {{lower, upper}} go together")
    if METRICS[metric].is_path and (reference.selection is None or not reference.selection.x):
        raise CaseError(f"{place}: the metric {metric} takes a selection with 'x'")
    if (metric == "monotonic") != (reference.direction is not None):
        raise CaseError(f"{place}: the metric monotonic and 'rising' or 'falling' go together")


def _read_front(fields: Fields, runs: Sequence[Run], measured: Sequence[str]) -> float | None:
    share: float | None = fields.positive("front", None)
    if share is None:
        return None
    if not share < 1.0:
        raise CaseError(f"{fields.place}: 'front' must be less than 1")
    if sum(run.default for run in runs if run.name in measured) != 1:
        raise CaseError(f"{fields.place}: 'front' needs exactly one default run")
    return share


def _read_order(data: Any, place: str) -> Order:
    fields = Fields(data, f"{place}: order")
    order = Order(
        fields.number("expected"), fields.positive("within"), fields.texts("methods", None)
    )
    fields.done()
    if not (math.isfinite(order.within) and order.within <= 0.5 * abs(order.expected)):
        raise CaseError(f"{place}: order: 'within' must be at most half of 'expected'")
    return order


def _read_figure(
    data: Any, place: str, runs: tuple[Run, ...], constants: dict[str, float]
) -> FigureRequest:
    fields = Fields(data, place)
    title = fields.text("title")
    fields.place = f"figure '{title}'"
    if fields.has("picture"):
        picture = fields.choice("picture", tuple(PICTURES))
        run, caption = fields.text("run"), fields.text("caption", "")
        fields.done()
        if run not in {item.name for item in runs}:
            raise CaseError(f"{fields.place}: there is no run '{run}'")
        return FigureRequest(title, caption, "", "", False, False, True, (), picture, run)
    lines = tuple(
        _read_line(item, f"{fields.place}: line {index}", runs)
        for index, item in enumerate(fields.tables("lines"), start=1)
    )
    if not lines:
        raise CaseError(f"{fields.place}: 'lines' is missing")
    request = FigureRequest(
        title=title,
        caption=fields.text("caption", ""),
        x_label=fields.text("x_label"),
        y_label=fields.text("y_label"),
        x_log=fields.flag("x_log"),
        y_log=fields.flag("y_log"),
        equal_axes=fields.flag("equal_axes"),
        lines=lines,
        constants=constants,
    )
    fields.done()
    return request


def _read_line(data: Any, place: str, runs: tuple[Run, ...]) -> Line:
    fields = Fields(data, place)
    label, run, points = fields.text("label"), fields.text("run", None), fields.flag("points")
    if run is not None and run not in {item.name for item in runs}:
        raise CaseError(f"{place}: there is no run '{run}'")
    selection = read_selection(fields, fields.text("file"))
    fields.done()
    if selection.x is None and selection.x_values is None:
        raise CaseError(f"{place}: 'x' is missing")
    return Line(label, run, selection, points)
