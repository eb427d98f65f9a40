"""Comparison figures of a study, in the house's style."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from wingcrack.errors import CaseError
from wingcrack.figures import style
from wingcrack.studies.outputs import select_in_run
from wingcrack.studies.plots import Plot
from wingcrack.studies.quantities import Quantity
from wingcrack.studies.study import Parameter, Study, StudyRun
from wingcrack.studies.table import StudyTable
from wingcrack.studies.units import NONE, axis_label, pretty_number, pretty_unit, spoken
from wingcrack.sweeps.expressions import Array
from wingcrack.sweeps.selection import Values

_WIDTH, _HEIGHT = 0.7 * style.DOUBLE_COLUMN, 3.0  # [inch]
_MOST_IN_LEGEND = 12
_BAND_POINTS = 201


@dataclass(frozen=True)
class _Curve:
    """What one run gives to a figure."""

    run: StudyRun
    values: Values


def draw(
    study: Study, plot: Plot, table: StudyTable, out: Path, formats: Sequence[str]
) -> tuple[list[Path], list[str]]:
    """Draw a figure into ``figures/``; give its files, and what could not be drawn, run by run.

    Raises `CaseError` if there is nothing to draw.
    """
    if plot.selection is not None:
        curves, missing = _curves(study, plot, table, out)
        figure = _lines(study, plot, curves) if plot.kind == "lines" else _band(study, plot, curves)
    else:
        missing = []
        figure = _over(study, plot, table) if plot.kind == "over" else _bars(study, plot, table)
    return style.save(figure, out / "figures" / plot.name, formats), missing


def _curves(
    study: Study, plot: Plot, table: StudyTable, out: Path
) -> tuple[list[_Curve], list[str]]:
    assert plot.selection is not None
    found, missing = [], []
    for run, row in zip(study.runs, table.rows, strict=True):
        if row["status"] != "finished":
            continue  # the table tells of it
        try:
            output = out / row["folder"] / "output"
            constants = {**study.constants, **run.constants}
            values = select_in_run(plot.selection, output, constants, as_path=plot.kind == "lines")
            found.append(_Curve(run, values))
        except CaseError as reason:
            missing.append(f"{run.label}: {reason}")
    if not found:
        why = f" ({missing[0]})" if missing else ": no run has finished"
        raise CaseError(f"figure '{plot.name}': there is nothing to draw{why}")
    return found, missing


@style.styled
def _lines(study: Study, plot: Plot, curves: Sequence[_Curve]) -> Figure:
    """One line per run, with a legend as long as there are few."""
    figure, axes = _empty(plot)
    names = _told_apart(study, plot)
    few = len(curves) <= _MOST_IN_LEGEND
    for curve, look in zip(curves, _looks(curves, names), strict=True):
        assert curve.values.x is not None
        axes.plot(
            curve.values.x,
            curve.values.values,
            linewidth=1.2 if few else 0.5,
            alpha=1.0 if few else 0.6,
            marker=style.lone_marker(curve.values.values.size),
            label=_label(curve.run, names, study),
            **look,
        )
    if names and few:
        _legend(figure, axes, len(curves))
    axes.set(xlabel=plot.x_label, ylabel=plot.y_label)
    return figure


def _looks(curves: Sequence[_Curve], names: Sequence[str]) -> list[dict[str, Any]]:
    """Colours by the first of the names and dashes by the others, if there are enough of both.

    Otherwise every line has its own look. Lines that no parameter distinguishes look the same.
    """
    if not names:
        return [{"color": style.CYCLE[0]} for _ in curves]
    first = [spoken(curve.run.values.get(names[0])) for curve in curves]
    others = [tuple(spoken(curve.run.values.get(name)) for name in names[1:]) for curve in curves]
    colours, dashes = list(dict.fromkeys(first)), list(dict.fromkeys(others))
    if len(dashes) > len(style.LINE_STYLES) or len(colours) > len(style.CYCLE):
        return [style.line_look(index) for index in range(len(curves))]
    return [
        {
            "color": style.CYCLE[colours.index(colour)],
            "linestyle": style.LINE_STYLES[dashes.index(dash)],
        }
        for colour, dash in zip(first, others, strict=True)
    ]


@style.styled
def _band(study: Study, plot: Plot, curves: Sequence[_Curve]) -> Figure:
    """Quantiles of all lines, at places that all of them reach."""
    figure, axes = _empty(plot)
    first = max(float(np.min(_x(curve))) for curve in curves)
    last = min(float(np.max(_x(curve))) for curve in curves)
    if not first < last:
        raise CaseError(f"figure '{plot.name}': the lines of the runs share no stretch of x")
    logs = plot.x_log and first > 0.0
    x = np.geomspace(first, last, _BAND_POINTS) if logs else np.linspace(first, last, _BAND_POINTS)
    values = np.array([np.interp(x, _x(curve), curve.values.values) for curve in curves])
    shares = study.quantiles or (0.1, 0.5, 0.9)
    levels = np.quantile(values, shares, axis=0)
    for low in range(len(shares) // 2):
        high = len(shares) - 1 - low
        axes.fill_between(
            x,
            levels[low],
            levels[high],
            color=style.CYCLE[0],
            alpha=0.2,
            linewidth=0.0,
            label=f"{100 * shares[low]:g} to {100 * shares[high]:g} % of {len(curves)} runs",
        )
    if len(shares) % 2:
        middle = len(shares) // 2
        label = f"{100 * shares[middle]:g} %"
        axes.plot(x, levels[middle], color=style.CYCLE[0], label=label)
    axes.legend(loc="best")
    axes.set(xlabel=plot.x_label, ylabel=plot.y_label)
    return figure


@style.styled
def _over(study: Study, plot: Plot, table: StudyTable) -> Figure:
    """A quantity over a parameter or another quantity; a line for each value of the others."""
    assert plot.over is not None and plot.quantity is not None
    figure, axes = _empty(plot)
    x_column, x_label = _column(study, plot.over)
    y_column, y_label = _column(study, plot.quantity)
    x, y = table.numbers(x_column), table.numbers(y_column)
    kept = np.isfinite(x) & np.isfinite(y)
    if not kept.any():
        raise CaseError(f"figure '{plot.name}': no run has both numbers")
    others = [name for name in _told_apart(study, plot) if name != plot.over]
    labels = np.array([_label(run, others, study) for run in study.runs])
    groups = list(dict.fromkeys(labels[kept])) if not study.drawn or plot.by else [None]
    for index, group in enumerate(groups):
        rows = kept if group is None else kept & (labels == group)
        order = np.argsort(x[rows], kind="stable")
        look: dict[str, Any] = style.line_look(index)
        if study.drawn:
            look["linestyle"] = "none"
        marker = style.MARKERS[1 + index % (len(style.MARKERS) - 1)]
        axes.plot(x[rows][order], y[rows][order], marker=marker, label=group or "", **look)
    if len(groups) > 1:
        _legend(figure, axes, len(groups))
    axes.set(xlabel=plot.x_label or x_label, ylabel=plot.y_label or y_label)
    return figure


@style.styled
def _bars(study: Study, plot: Plot, table: StudyTable) -> Figure:
    """How a quantity is distributed, with its quantiles."""
    assert plot.quantity is not None
    figure, axes = _empty(plot)
    column, label = _column(study, plot.quantity)
    values = table.numbers(column)
    values = values[np.isfinite(values)]
    if values.size == 0:
        raise CaseError(f"figure '{plot.name}': no run has a {plot.quantity}")
    bins = _bins(values, plot.x_log).tolist()
    axes.hist(values, bins=bins, color=style.CYCLE[4], edgecolor="white")
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    for index, share in enumerate(study.quantiles):
        place = float(np.quantile(values, share))
        axes.axvline(
            place,
            color="black",
            linestyle=style.LINE_STYLES[index % len(style.LINE_STYLES)],
            label=f"{100 * share:g} %: {place:.4g}",
        )
    if study.quantiles:
        axes.legend(loc="best", title=f"{values.size} runs")
    axes.set(xlabel=plot.x_label or label, ylabel=plot.y_label or "runs")
    return figure


def _bins(values: Array, logs: bool) -> Array:
    """Edges of bars: by Freedman and Diaconis or Sturges, whichever are finer (numpy's auto)."""
    if not logs or values.min() <= 0.0:
        return np.asarray(np.histogram_bin_edges(values, "auto"))
    return np.asarray(10.0 ** np.histogram_bin_edges(np.log10(values), "auto"))


def _empty(plot: Plot) -> tuple[Figure, Axes]:
    figure = style.new_figure(_WIDTH, _HEIGHT)
    axes = figure.subplots()
    axes.set_title(plot.title)
    if plot.x_log:
        axes.set_xscale("log")
    if plot.y_log:
        axes.set_yscale("log")
    if plot.equal_axes:
        axes.set_aspect("equal", adjustable="datalim")
    return figure, axes


def _told_apart(study: Study, plot: Plot) -> list[str]:
    """Parameters that tell lines apart: those asked for, or all that differ."""
    if plot.by:
        return list(plot.by)
    if study.drawn:
        return []
    values: Mapping[str, set[str]] = {
        item.name: {spoken(run.values.get(item.name)) for run in study.runs}
        for item in study.parameters
    }
    return [name for name, found in values.items() if len(found) > 1]


def _label(run: StudyRun, names: Sequence[str], study: Study) -> str:
    units = {parameter.name: parameter.unit for parameter in study.parameters}
    parts = []
    for name in names:
        if name in run.values:
            unit = "" if units[name] == NONE else f" {pretty_unit(units[name])}"
            said = name.split(".")[-1].replace("_", " ")
            parts.append(f"{said} {pretty_number(run.values[name])}{unit}")
    return ", ".join(parts)


def _column(study: Study, name: str) -> tuple[str, str]:
    """Column of a quantity or parameter, and how an axis of it is called."""
    named: tuple[Quantity | Parameter, ...] = (*study.quantities, *study.parameters)
    for item in named:
        if item.name == name:
            return item.heading, axis_label(item.name, item.unit)
    raise CaseError(f"there is no quantity or parameter '{name}'")


def _legend(figure: Figure, axes: Axes, count: int) -> None:
    handles, labels = axes.get_legend_handles_labels()
    longest = max(map(len, labels), default=0)
    columns = max(1, min(count, 80 // (longest + 8)))
    figure.legend(handles, labels, loc="outside lower center", ncols=columns)


def _x(curve: _Curve) -> Array:
    assert curve.values.x is not None
    return curve.values.x
