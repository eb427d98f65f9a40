"""Comparison figures of a study, in the house's style."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from wingcrack.errors import CaseError
from wingcrack.figures import style
from wingcrack.studies.convergence import extrapolate
from wingcrack.studies.distributions import SAMPLE
from wingcrack.studies.groups import column_of, grouped, label_of, told_apart
from wingcrack.studies.outputs import select_in_run
from wingcrack.studies.plots import Plot
from wingcrack.studies.study import Study, StudyRun
from wingcrack.studies.table import StudyTable
from wingcrack.studies.units import spoken
from wingcrack.sweeps.expressions import Array
from wingcrack.sweeps.selection import Values

_WIDTH, _HEIGHT = 0.7 * style.DOUBLE_COLUMN, 3.0  # [inch]
_ROWS, _ROW = 2, 0.16  # rows of the legend within that height, and the height of one
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
        figure = _OF_TABLE[plot.kind](study, plot, table)
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
    names = told_apart(study, plot)
    few = len(curves) <= _MOST_IN_LEGEND
    for curve, look in zip(curves, _looks(curves, names), strict=True):
        assert curve.values.x is not None
        axes.plot(
            curve.values.x,
            curve.values.values,
            linewidth=1.2 if few else 0.5,
            alpha=1.0 if few else 0.6,
            marker=style.lone_marker(curve.values.values.size),
            label=label_of(curve.run, names, study),
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
        raise CaseError(f"figure '{plot.name}': the lines of the runs share no interval of x")
    logs = plot.x_log and first > 0.0
    x = np.geomspace(first, last, _BAND_POINTS) if logs else np.linspace(first, last, _BAND_POINTS)
    shares = study.quantiles or (0.1, 0.5, 0.9)
    places = dict.fromkeys(curve.run.place for curve in curves)
    for index, place in enumerate(places):
        here = [curve for curve in curves if curve.run.place == place]
        values = np.array([np.interp(x, _x(curve), curve.values.values) for curve in here])
        levels = np.quantile(values, shares, axis=0)
        look: dict[str, Any] = {"color": style.CYCLE[index % len(style.CYCLE)]}
        said = f"{place}: " if place else ""
        for low in range(len(shares) // 2):
            high = len(shares) - 1 - low
            label = f"{said}{100 * shares[low]:g} to {100 * shares[high]:g} % of {len(here)} runs"
            axes.fill_between(
                x, levels[low], levels[high], alpha=0.2, linewidth=0.0, label=label, **look
            )
        if len(shares) % 2:
            middle = len(shares) // 2
            axes.plot(x, levels[middle], label=f"{said}{100 * shares[middle]:g} %", **look)
    axes.legend(loc="best")
    axes.set(xlabel=plot.x_label, ylabel=plot.y_label)
    return figure


@style.styled
def _over(study: Study, plot: Plot, table: StudyTable) -> Figure:
    """A quantity over a parameter or another quantity; a line for each value of the others."""
    figure, axes = _empty(plot)
    x_label, y_label, groups = grouped(study, plot, table)
    for index, (group, x, y) in enumerate(groups):
        look = _line_with_marks(index)
        if study.drawn:
            look["linestyle"] = "none"
        axes.plot(x, y, label=group, **look)
    if len(groups) > 1:
        _legend(figure, axes, len(groups))
    axes.set(xlabel=plot.x_label or x_label, ylabel=plot.y_label or y_label)
    return figure


@style.styled
def _convergence(study: Study, plot: Plot, table: StudyTable) -> Figure:
    """Difference of a quantity from its extrapolated value, with that and the observed order."""
    figure, axes = _empty(plot)
    axes.set(xscale="log", yscale="log")
    x_label, y_label, groups = grouped(study, plot, table)
    for index, (group, x, y) in enumerate(groups):
        found = extrapolate(x, y)
        said = f"{group}: " if group else ""
        if found is None:
            axes.plot([], [], label=f"{said}no order is observed", **_line_with_marks(index))
            continue
        label = f"{said}limit {found.limit:.5g}, order {found.order:.2f}"
        axes.plot(x, np.abs(y - found.limit), label=label, **_line_with_marks(index))
    _legend(figure, axes, len(groups))
    y_label = f"difference from the limit, {plot.y_label or y_label}"
    axes.set(xlabel=plot.x_label or x_label, ylabel=y_label)
    return figure


def _line_with_marks(index: int) -> dict[str, Any]:
    marker = style.MARKERS[1 + index % (len(style.MARKERS) - 1)]
    return {"marker": marker, **style.line_look(index)}


@style.styled
def _bars(study: Study, plot: Plot, table: StudyTable) -> Figure:
    """How a quantity is distributed, with its quantiles; at several places of a grid, each."""
    assert plot.quantity is not None
    figure, axes = _empty(plot)
    column, label = column_of(study, plot.quantity)
    values = table.numbers(column)
    if not np.isfinite(values).any():
        raise CaseError(f"figure '{plot.name}': no run has a {plot.quantity}")
    bins = _bins(values[np.isfinite(values)], plot.x_log).tolist()
    places = study.places
    for index, (place, rows) in enumerate(places.items()):
        found = values[rows][np.isfinite(values[rows])]
        colour = style.CYCLE[index % len(style.CYCLE)] if len(places) > 1 else style.CYCLE[4]
        alone: dict[str, Any] = {"color": colour, "edgecolor": "white"}
        beside: dict[str, Any] = {"color": colour, "histtype": "step", "label": place}
        axes.hist(found, bins=bins, **(alone if len(places) == 1 else beside))
        for number, share in enumerate(study.quantiles if found.size else ()):
            quantile = float(np.quantile(found, share))
            said = f"{100 * share:g} %: {quantile:.4g}" if len(places) == 1 else None
            look: dict[str, Any] = {"color": "black" if said else colour, "label": said}
            dashes = style.LINE_STYLES[number % len(style.LINE_STYLES)]
            axes.axvline(quantile, linestyle=dashes, linewidth=0.8, **look)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    if len(places) > 1:
        _legend(figure, axes, len(places))
    elif study.quantiles:
        axes.legend(loc="best", title=f"{np.isfinite(values).sum()} runs")
    axes.set(xlabel=plot.x_label or label, ylabel=plot.y_label or "runs")
    return figure


@style.styled
def _tornado(study: Study, plot: Plot, table: StudyTable) -> Figure:
    """Mean of a quantity where a parameter is low and where it is high, the widest on top.

    Low and high are the lowest and highest third of the runs, or of a grid the first and last
    value: the other parameters are spread over both alike.
    """
    assert plot.quantity is not None
    figure, axes = _empty(plot)
    column, label = column_of(study, plot.quantity)
    values = table.numbers(column)
    kept = np.isfinite(values)
    if not kept.any():
        raise CaseError(f"figure '{plot.name}': no run has a {plot.quantity}")
    bars = []
    for parameter in study.parameters:
        x = table.numbers(parameter.heading)
        rows = kept & np.isfinite(x)
        if parameter.name == SAMPLE or np.unique(x[rows]).size < 2:
            continue
        low, high = np.quantile(x[rows], (1.0 / 3.0, 2.0 / 3.0))
        means = [float(values[rows & part].mean()) for part in (x <= low, x >= high)]
        bars.append((abs(means[1] - means[0]), parameter.name.split(".")[-1], means))
    bars.sort()
    middle = float(values[kept].mean())
    for side, (said, colour) in enumerate((("low", style.CYCLE[4]), ("high", style.CYCLE[1]))):
        lengths = [means[side] - middle for _, _, means in bars]
        axes.barh(range(len(bars)), lengths, left=middle, height=0.6, color=colour, label=said)
    axes.axvline(middle, color="black", linewidth=0.8)
    axes.set_yticks(range(len(bars)), [name.replace("_", " ") for _, name, _ in bars])
    axes.grid(visible=False, axis="y")
    _legend(figure, axes, 2)
    axes.set(xlabel=plot.x_label or f"mean of {label}")
    return figure


def _bins(values: Array, logs: bool) -> Array:
    """Edges of bars: by Freedman and Diaconis or Sturges, whichever are finer (numpy's auto)."""
    if not logs or values.min() <= 0.0:
        return np.asarray(np.histogram_bin_edges(values, "auto"))
    return np.asarray(10.0 ** np.histogram_bin_edges(np.log10(values), "auto"))


_OF_TABLE = {"over": _over, "convergence": _convergence, "histogram": _bars, "tornado": _tornado}


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


def _legend(figure: Figure, axes: Axes, count: int) -> None:
    handles, labels = axes.get_legend_handles_labels()
    longest = max(map(len, labels), default=0)
    columns = max(1, min(count, 80 // (longest + 8)))
    more = -(-len(labels) // columns) - _ROWS
    figure.set_figheight(_HEIGHT + _ROW * max(more, 0))
    figure.legend(handles, labels, loc="outside lower center", ncols=columns)


def _x(curve: _Curve) -> Array:
    assert curve.values.x is not None
    return curve.values.x
