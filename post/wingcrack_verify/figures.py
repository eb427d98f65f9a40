"""Figures of the report: profiles, convergence, work-precision diagrams, maps of two parameters."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from wingcrack.figures.maps import pressure_maps
from wingcrack.figures.network import network_figure
from wingcrack.figures.read import Run, read_run
from wingcrack.figures.story_map import draw_map
from wingcrack.figures.style import CYCLE, new_figure, outside_legend, styled
from wingcrack_verify.economy import observed_rate
from wingcrack_verify.judge import CheckReport, DrawnFigure, Measured
from wingcrack_verify.orders import Point, pareto_front
from wingcrack_verify.stability import MapReport

WIDTH, HEIGHT = 4.3, 2.7  # [inch]: at this width the letters keep their size on a phone
MARKERS = "osD^vP*X<>"
MOST_PROFILES = 4  # in one figure
RASTER_DPI = 160  # of fields, 200 in the size of the PDF
LABEL_LETTERS = 36  # that fit along an axis of this height


@dataclass(frozen=True)
class Drawing:
    """A finished figure."""

    # title, caption: text with the figure
    title: str
    caption: str
    svg: bytes


@styled
def profile_drawing(report: CheckReport) -> Drawing | None:
    """Result over its reference; None if the check has no profile."""
    shown = [
        item
        for item in report.measured
        if item.judged and item.profile and item.pair is not None and item.pair.x is not None
    ][-MOST_PROFILES:]
    if not shown:
        return None
    if shown[0].pair is not None and shown[0].pair.reference_x is not None:
        return _path_drawing(report, shown)
    figure, axes = _new()
    sign = -1.0 if report.check.reference.direction == "falling" else 1.0
    for index, item in enumerate(shown):
        assert item.pair is not None and item.pair.x is not None
        if report.check.reference.direction is None:
            last = index == len(shown) - 1
            label = "reference" if last else None
            axes.plot(item.pair.x, item.pair.reference, color="black", lw=0.8, label=label)
        axes.plot(
            item.pair.x,
            sign * item.pair.result,
            color=CYCLE[index],
            marker=MARKERS[index],
            linestyle="none",
            fillstyle="none",
            label=item.run.name,
        )
    axes.set(
        xlabel=report.check.abscissa or "value",
        ylabel=_wrapped(f"{report.check.quantity} [{report.check.unit}]"),
    )
    _legend(figure, axes)
    return _finish(figure, report.check.quantity, "Result and reference.")


def _path_drawing(report: CheckReport, shown: Sequence[Measured]) -> Drawing:
    """Paths over the paths that they are compared with, on equal axes."""
    figure, axes = _new()
    for index, item in enumerate(shown):
        assert item.pair is not None and item.pair.x is not None
        assert item.pair.reference_x is not None
        label = "reference" if index == len(shown) - 1 else None
        axes.plot(item.pair.reference_x, item.pair.reference, color="black", lw=0.8, label=label)
        axes.plot(
            item.pair.x, item.pair.result, color=CYCLE[index], ls="--", lw=1.0, label=item.run.name
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(
        xlabel=report.check.abscissa,
        ylabel=f"{report.check.result.all_columns[0]} [{report.check.unit}]",
    )
    _legend(figure, axes)
    return _finish(figure, report.check.quantity, "Path and reference.")


@styled
def order_drawing(report: CheckReport) -> Drawing | None:
    """Error over size with the expected slope; None if the check asks for no order."""
    check = report.check
    if check.order is None:
        return None
    figure, axes = _new()
    sizes: list[float] = []
    for index, order in enumerate(report.orders):
        points = sorted(
            (item.run.size, item.error)
            for item in report.measured
            if item.run.method == order.method and item.run.size and item.error
        )
        if not points:
            continue
        size, error = np.array(points).T
        sizes += list(size)
        observed = f": {order.fit.overall:.2f}" if order.fit else ""
        axes.loglog(
            size,
            error,
            color=CYCLE[index % len(CYCLE)],
            marker=MARKERS[index % len(MARKERS)],
            label=f"{order.method}{observed}",
        )
        slope = error[-1] * (size / size[-1]) ** check.order.expected
        label = f"order {check.order.expected:g}" if index == len(report.orders) - 1 else None
        axes.loglog(size, slope, color="#777777", linestyle=":", label=label)
    if not sizes:
        return None
    _plain_logs(axes)
    axes.set(xlabel="size (cell size [m] or time step [s])", ylabel=f"error, {check.metric}")
    _legend(figure, axes)
    return _finish(
        figure, f"{check.quantity}: convergence", "Observed order of each method in the legend."
    )


def work_precision_drawings(report: CheckReport) -> list[Drawing]:
    """Error against CPU seconds, and against unknowns where at least two runs tell theirs.

    Empty unless the check asks for it and two runs were measured.
    """
    points = [point for point in report.points if point.error > 0.0]
    if not report.check.work_precision or len(points) < 2:
        return []
    drawings = [
        _cost_drawing(
            f"{report.check.quantity}: error against run time",
            "Down and left is better; one line per method.",
            "CPU time [s]",
            [(point.cpu_s, point) for point in points],
        )
    ]
    sized = [(point.unknowns, point) for point in points if point.unknowns is not None]
    if len({unknowns for unknowns, _ in sized}) > 1:
        drawings.append(
            _cost_drawing(
                f"{report.check.quantity}: error against unknowns",
                "In the legend, the observed rate: error proportional to unknowns to this power.",
                "unknowns",
                sized,
                tell_rates=True,
            )
        )
    return drawings


@styled
def _cost_drawing(
    title: str,
    caption: str,
    label: str,
    costs: Sequence[tuple[float, Point]],
    tell_rates: bool = False,
) -> Drawing:
    """Error against a cost, a line per method; with the Pareto front unless rates are given."""
    figure, axes = _new()
    if not tell_rates:
        front = pareto_front([point for _, point in costs])
        axes.plot(
            [point.cpu_s for point in front],
            [100.0 * point.error for point in front],
            color="#BBBBBB",
            linewidth=5.0,
            zorder=1,
            label="Pareto front",
            solid_capstyle="round",
        )
    for index, method in enumerate(dict.fromkeys(point.method for _, point in costs)):
        of_method = [(cost, point) for cost, point in costs if point.method == method]
        rate = observed_rate([point for _, point in of_method]) if tell_rates else None
        axes.plot(
            [cost for cost, _ in of_method],
            [100.0 * point.error for _, point in of_method],
            color=CYCLE[index % len(CYCLE)],
            marker=MARKERS[index % len(MARKERS)],
            markersize=4,
            label=method if rate is None else f"{method}: {rate:.2f}",
        )
    defaults = [(cost, point) for cost, point in costs if point.default]
    if defaults:
        axes.plot(
            [cost for cost, _ in defaults],
            [100.0 * point.error for _, point in defaults],
            linestyle="none",
            marker="o",
            markersize=11,
            markeredgecolor="black",
            markeredgewidth=1.1,
            fillstyle="none",
            label="default setting",
        )
    axes.set(xscale="log", yscale="log")
    _plain_logs(axes)
    axes.set(xlabel=label, ylabel="error [% of the signal]")
    _legend(figure, axes)
    return _finish(figure, title, caption)


@styled
def requested_drawing(drawn: DrawnFigure) -> Drawing | None:
    """Draw a figure that a case asks for; None if none of its lines has data."""
    request = drawn.request
    if drawn.folder is not None and request.picture is not None:
        figure = picture_of(request.picture, drawn.folder)
        return _finish(figure, request.title, request.caption)
    if not drawn.lines:
        return None
    figure, axes = _new()
    for index, line in enumerate(drawn.lines):
        look: dict[str, Any] = {"color": CYCLE[index % len(CYCLE)], "label": line.label}
        if line.points:
            look |= {"linestyle": "none", "marker": MARKERS[index % len(MARKERS)]}
            look |= {"fillstyle": "none", "markersize": 4}
        else:
            look |= {"linestyle": ("-", "--", "-.")[index // len(CYCLE) % 3]}
        axes.plot(np.asarray(line.values.x), line.values.values, **look)
    axes.set(xlabel=request.x_label, ylabel=request.y_label)
    if request.x_log:
        axes.set_xscale("log")
    if request.y_log:
        axes.set_yscale("log")
    if request.equal_axes:
        axes.set_aspect("equal", adjustable="datalim")
    _legend(figure, axes)
    return _finish(figure, request.title, request.caption)


@styled
def numbers_drawing(title: str, points: Sequence[Any]) -> Drawing:
    """A curve of printed numbers: the thesis', those of an experiment, ours and the exact ones."""
    figure, axes = _new()
    x = np.array([point.number.x for point in points])
    curves = {
        "exact": [point.exact for point in points],
        "thesis": [point.number.thesis for point in points],
        "measured": [point.number.measured for point in points],
        "ours": [point.ours for point in points],
    }
    for index, (label, found) in enumerate(curves.items()):
        values = np.array([np.nan if value is None else value for value in found])
        if not np.isfinite(values).any():
            continue
        look: dict[str, Any] = {"color": "black", "linewidth": 0.8}
        if label != "exact":
            look = {"color": CYCLE[index - 1], "linestyle": "none", "marker": MARKERS[index]}
            look |= {"fillstyle": "none", "markersize": 5}
        axes.plot(x[np.isfinite(values)], values[np.isfinite(values)], label=label, **look)
    if float(x.min()) > 0.0 and float(x.max()) > 20.0 * float(x.min()):
        axes.set_xscale("log")
        _plain_logs(axes)
    said = points[0].number
    axes.set(xlabel=said.x_label, ylabel=_wrapped(f"{title} [{said.unit}]"))
    _legend(figure, axes)
    return _finish(figure, title, "")


@styled
def map_drawing(report: MapReport) -> Drawing:
    """Mean Newton iterations over two parameters; a cross where the run did not converge."""
    chart = report.chart
    shape = (len(chart.y.values), len(chart.x.values))
    newton = np.array(
        [np.nan if cell.newton_mean is None else cell.newton_mean for cell in report.cells]
    ).reshape(shape)
    figure, axes = _new()
    colours = matplotlib.colormaps["cividis"]
    top = max(float(np.nanmax(newton)) if np.any(np.isfinite(newton)) else 2.0, 2.0)
    image = axes.imshow(newton, origin="lower", aspect="auto", cmap=colours, vmin=1.0, vmax=top)
    for index, cell in enumerate(report.cells):
        row, column = divmod(index, shape[1])
        if cell.newton_mean is None:
            axes.text(column, row, "x", ha="center", va="center", color="#D55E00", weight="bold")
            continue
        cuts = f"\n{cell.step_cuts:.0f} cut" if cell.step_cuts else ""
        dark = (cell.newton_mean - 1.0) / (top - 1.0) < 0.5
        axes.text(
            column,
            row,
            f"{cell.newton_mean:.1f}{cuts}",
            ha="center",
            va="center",
            fontsize=6,
            color="white" if dark else "black",
        )
    axes.grid(visible=False)
    axes.set_xticks(range(shape[1]), [f"{value:g}" for value in chart.x.values])
    axes.set_yticks(range(shape[0]), [f"{value:g}" for value in chart.y.values])
    axes.set(xlabel=chart.x.label, ylabel=chart.y.label)
    figure.colorbar(image, ax=axes, label="Newton iterations per step, mean")
    done = sum(cell.newton_mean is not None for cell in report.cells)
    return _finish(
        figure,
        chart.title,
        f"{done} of {len(report.cells)} converged; x: did not; cut: steps that were shortened.",
    )


def _wrapped(label: str) -> str:
    """Label in lines that fit along an axis."""
    return textwrap.fill(label, LABEL_LETTERS)


def _new() -> tuple[Figure, Axes]:
    figure = new_figure(WIDTH, HEIGHT)
    return figure, figure.add_subplot()


def _plain_logs(axes: Axes) -> None:
    """Ticks in plain numbers, the closer the fewer decades there are; powers of ten if many."""
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if limits[1] < 1.0e3 * limits[0]:
            close = limits[1] < 10.0 * limits[0]
            subs = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0) if close else (1.0, 2.0, 5.0)
            axis.set_major_locator(LogLocator(subs=subs))
            axis.set_major_formatter(FuncFormatter(lambda value, _position: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())


def _legend(figure: Figure, axes: Axes) -> None:
    """Legend below the axes, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        longest = max(len(label) for label in labels)
        columns = 1 if longest > 36 else 2 if longest > 16 else 3
        rows = -(-len(handles) // columns)
        figure.set_size_inches(WIDTH, HEIGHT + 0.16 * max(0, rows - 1))
        figure.legend(handles, labels, loc="outside lower center", ncols=columns)


def _finish(figure: Figure, title: str, caption: str) -> Drawing:
    """Draw a figure; without a date and by its title, so that it gives the same bytes again."""
    svg = BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": title, "savefig.dpi": RASTER_DPI}):
        figure.savefig(svg, format="svg", metadata={"Date": None})
    return Drawing(title, caption, svg.getvalue())


def check_drawings(report: CheckReport) -> Sequence[Drawing]:
    """All figures of a check."""
    drawings = (profile_drawing(report), order_drawing(report))
    found = [drawing for drawing in drawings if drawing is not None]
    return [*found, *work_precision_drawings(report)]


_STATE_SIZE = (4.3, 3.6)  # [inch]


def _states(run: Run) -> Figure:
    """The network at the end by contact state."""
    figure = new_figure(*_STATE_SIZE)
    assert run.fractures is not None
    outside_legend(figure, draw_map(figure.add_subplot(), run, run.fractures), 3)
    return figure


def _pressure(run: Run) -> Figure:
    """The pore pressure at the end, the fractures on top."""
    return pressure_maps(run, (float(run.history.moments()[-1]),))


_DRAW: dict[str, Callable[[Run], Figure]] = {
    "network": network_figure,
    "states": _states,
    "pressure": _pressure,
}


def picture_of(picture: str, folder: Path) -> Figure:
    """Draw the picture of a finished run that has written what it takes (`picture_files`)."""
    return _DRAW[picture](read_run(folder))
