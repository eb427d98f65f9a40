"""The fracture network: initial fractures thick, grown segments thin, coloured by their order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.growth import Growth, moment_of, read_growth
from wingcrack.figures.read import Run
from wingcrack.figures.regions import draw_regions
from wingcrack.figures.scene import Scene
from wingcrack.figures.table import FloatArray, Table
from wingcrack.figures.units import Unit, length_unit, time_unit

THICK, THIN = 2.2, 1.1
INITIAL = "#000000"
_MARGIN = 0.12  # around the network, as a share of its size
_LARGE = 0.5  # share of the body from which on the whole body is shown
_SIZE = (3.6, 5.0)  # [inch] of the axes at most
_BESIDE = (1.75, 0.95)  # [inch] for labels and colour bar
_ONLY_LABELS = 0.8  # [inch] next to the axes without a colour bar
_BAR = 0.9  # [inch] for a colour bar below


@style.styled
def network_figure(run: Run) -> Figure:
    """Draw the network at the end of a run, with the outline of the body.

    Raises `AbsentError` if the run has no network, or none with fractures.
    """
    growths = grown_network(run)
    assert run.network is not None
    box = network_box(growths, run.scene)
    ratio = (box[3] - box[2]) / (box[1] - box[0])
    # in a column the colour bar stands below
    has_bar, below = bool(_order(growths)), _BESIDE[1]
    wide = style.chosen(page=has_bar, column=False, slide=has_bar)
    beside = _BESIDE[0] if wide else _ONLY_LABELS
    width = min(_SIZE[0] if wide else style.SINGLE_COLUMN - beside, _SIZE[1] / ratio)
    if has_bar and not wide:
        below, beside = below + _BAR, style.SINGLE_COLUMN - width
    figure = style.new_figure(width + beside, width * ratio + below)
    axes = figure.add_subplot()
    handles = draw_network(axes, growths, run.network, run.history, run.scene)
    # a region's entry is as long as two others
    style.outside_legend(figure, handles, 2 if any(isinstance(h, Patch) for h in handles) else 3)
    return figure


def grown_network(run: Run) -> list[Growth]:
    """Growth of all fractures.

    Raises `AbsentError` if the run has no network, or none with fractures.
    """
    if run.network is None:
        raise AbsentError("the run has no network.json")
    if not run.network.get("steps"):
        raise AbsentError("network.json does not tell how the network has grown")
    growths = read_growth(run.network)
    if not growths:
        raise AbsentError("the scene has no fractures")
    return growths


def draw_network(
    axes: Axes,
    growths: Sequence[Growth],
    network: Mapping[str, Any],
    history: Table,
    scene: Scene | None,
) -> list[Artist]:
    """Draw a network into axes, with colour bar and labels, and give the legend's entries.

    Colours count the increments of growth; the load factor (in scenes with a fluid the time) at
    which each came stands beside the number.

    `network`: contents of network.json. `history`: history.csv. `scene`: for the outline of the
    body.
    """
    box = network_box(growths, scene)
    # that of the body, as in all other maps, not of the part in view
    unit = length_unit(box if scene is None or scene.outline is None else scene.outline)
    if scene is not None and scene.outline is not None:
        x, y = unit.of(scene.outline).T
        axes.plot(x, y, color="#888888", linewidth=0.8, zorder=1)
    regions: list[Patch] = []
    if scene is not None:
        regions = draw_regions(axes, scene.regions, scene.permeability_m2, scene.outline, unit)
    order = _order(growths)
    norm = Normalize(1, max([2, *order.values()]))
    colours = style.time_colours()
    for item in growths:
        axes.plot(*unit.of(item.initial).T, color=INITIAL, lw=THICK, zorder=3)
        wings = ((item.start, item.start_steps), (item.end, item.end_steps))
        for wing, (points, steps) in enumerate(wings):
            if len(points) < 2:
                continue
            pieces = unit.of(np.stack((points[:-1], points[1:]), axis=1))
            numbers = [order[item.number, wing, k] for k in range(len(steps))]
            lines = LineCollection(
                list(pieces),
                colors=[colours(norm(number)) for number in numbers],
                linewidths=THIN,
                capstyle="round",
                zorder=4,
            )
            axes.add_collection(lines, autolim=False)
    for joint in network.get("joints", []):
        place = unit.of(np.array([joint["x_m"], joint["y_m"]]))
        axes.plot(*place, "o", mfc="white", mec="#D55E00", mew=0.9, ms=4, zorder=5)
    axes.set_xlim(*unit.of(np.array(box[:2])))
    axes.set_ylim(*unit.of(np.array(box[2:])))
    style.map_axes(axes, unit)
    axes.locator_params(nbins=5)
    if order:
        _colour_bar(axes, norm, order, growths, network, history)
    return _handles(regions, has_growth=bool(order), has_joints=bool(network.get("joints")))


def _order(growths: Sequence[Growth]) -> dict[tuple[int, int, int], int]:
    """Number of the increment, from 1, that made each segment (fracture, wing, segment).

    In one step several increments may follow each other: the k-th segments of all wings that grew
    in it belong to the k-th of them.
    """
    keyed: dict[tuple[int, int, int], tuple[int, int]] = {}
    for item in growths:
        for wing, steps in enumerate((item.start_steps, item.end_steps)):
            for k, step in enumerate(steps):
                first = int(np.searchsorted(steps, step))
                keyed[item.number, wing, k] = (int(step), k - first)
    ranks = {key: rank for rank, key in enumerate(sorted(set(keyed.values())), start=1)}
    return {piece: ranks[key] for piece, key in keyed.items()}


def _colour_bar(
    axes: Axes,
    norm: Normalize,
    order: Mapping[tuple[int, int, int], int],
    growths: Sequence[Growth],
    network: Mapping[str, Any],
    history: Table,
) -> None:
    when = [moment_of(step) for step in network["steps"]]
    moments: dict[int, float] = {}
    for item in growths:
        for wing, steps in enumerate((item.start_steps, item.end_steps)):
            moments |= {order[item.number, wing, k]: when[step] for k, step in enumerate(steps)}
    unit, what = Unit("", 1.0), "load factor"
    if not history.has("load_factor"):
        unit = time_unit(float(history.moments()[-1]))
        what = f"time [{unit.name}]"
    values = {number: float(unit.of(moment)) for number, moment in moments.items()}
    bar = axes.figure.colorbar(
        ScalarMappable(norm, style.time_colours()),
        ax=axes,
        location=style.chosen(page="right", column="bottom", slide="right"),
        aspect=30,
        pad=0.03,
        shrink=0.9,
    )
    places = MaxNLocator(style.chosen(page=6, column=3, slide=6), integer=True).tick_values(
        1, max(values)
    )
    ticks = [1, *(round(place) for place in places if 1 < place <= max(values))]
    bar.set_ticks(ticks, labels=_tick_labels(ticks, values))
    bar.set_label(f"increment of growth ({what}{_constant_from(values)})")
    if len(set(values.values())) == 1:
        single = f"{what} {values[1]:.3g}" if unit.name == "" else f"{values[1]:.3g} {unit.name}"
        bar.set_ticks(ticks, labels=[f"{tick}" for tick in ticks])
        bar.set_label(f"increment of growth (all at {single})")


def _tick_labels(ticks: Sequence[int], values: Mapping[int, float]) -> list[str]:
    """Number of the increment, with the load or time where it differs from the tick before."""
    labels, before = [], ""
    for tick in ticks:
        text = f"{values[tick]:.3g}" if tick in values else ""
        labels.append(f"{tick} ({text})" if text and text != before else f"{tick}")
        before = text or before
    return labels


def _constant_from(values: Mapping[int, float]) -> str:
    """Say from which increment on the value stays, where growth went on by itself."""
    numbers = sorted(values)
    changed = [number for number in numbers if values[number] != values[numbers[-1]]]
    if not changed or numbers[-1] - changed[-1] < 3:
        return ""
    return f", constant from {changed[-1] + 1} on"


def _handles(regions: Sequence[Patch], *, has_growth: bool, has_joints: bool) -> list[Artist]:
    handles: list[Artist] = [style.handle(color=INITIAL, linewidth=THICK, label="at the start")]
    if has_growth:
        colour = style.time_colours()(0.5)
        handles.append(style.handle(color=colour, linewidth=THIN, label="grown"))
    if has_joints:
        look: dict[str, Any] = {"mfc": "white", "mec": "#D55E00", "mew": 0.9, "ms": 4}
        handles.append(style.handle(linestyle="none", marker="o", label="joint", **look))
    return [*handles, *regions]


def network_box(
    growths: Sequence[Growth], scene: Scene | None
) -> tuple[float, float, float, float]:
    """What is shown: the body, or a square around a network that is small in it."""
    points = np.concatenate([np.concatenate((g.initial, g.start, g.end)) for g in growths])
    lower, upper = points.min(axis=0), points.max(axis=0)
    size = float((upper - lower).max())
    outline = None if scene is None else scene.outline
    if outline is not None:
        corner, opposite = outline.min(axis=0), outline.max(axis=0)
        if size >= _LARGE * float((opposite - corner).max()):
            margin = 0.02 * (opposite - corner)
            return _limits(corner - margin, opposite + margin)
    centre, half = 0.5 * (lower + upper), (0.5 + _MARGIN) * size
    return _limits(centre - half, centre + half)


def _limits(lower: FloatArray, upper: FloatArray) -> tuple[float, float, float, float]:
    return float(lower[0]), float(upper[0]), float(lower[1]), float(upper[1])
