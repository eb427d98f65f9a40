"""The map of the one-page figure: the network at the end by contact state, wells, slip events."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Bbox, IdentityTransform

from wingcrack.errors import RunError
from wingcrack.figures import style
from wingcrack.figures.growth import Growth, foremost, read_growth
from wingcrack.figures.network import network_box
from wingcrack.figures.read import Run
from wingcrack.figures.regions import draw_regions
from wingcrack.figures.scene import Scene
from wingcrack.figures.slip import SEISMIC_COLOUR, seismic
from wingcrack.figures.table import FloatArray, Table
from wingcrack.figures.units import Unit, length_unit

HALO = [effects.withStroke(linewidth=1.8, foreground="white")]
_SIZE = 7  # [point]
_ASIDE, _BACK = 7.0, 4.0  # [point] from an end: away from the line, and beyond its end
_GAP = 1.0  # [point] around what must stay clear


class Names(Artist):
    """Names of lines without overlaps, in the order in which they are placed.

    A name for which there is no space is omitted. The free space is known once the figure is laid
    out, so places are found when it is drawn. `lines`: names and their lines, in the unit of the
    axes. `others`: lines that names should not cross, where another place is free. `points` (n, 2):
    marks that names must not cover.
    """

    def __init__(
        self,
        lines: Sequence[tuple[str, FloatArray]],
        others: Sequence[FloatArray],
        points: FloatArray,
    ) -> None:
        super().__init__()
        self._lines = list(lines)
        self._others = list(others)
        self._points = points
        self.placed: list[tuple[str, Bbox]] = []  # when it was drawn last [pixel]
        self.set_zorder(7)
        self.set_in_layout(False)

    def draw(self, renderer: Any) -> None:
        """Place the names and draw them."""
        self.placed = []
        if not self.get_visible() or self.axes is None:
            return
        scale = renderer.points_to_pixels(1.0)
        transform = self.axes.transData
        paths = [Path(transform.transform(line)) for line in self._others]
        marks = [_around(point, 3.0 * scale) for point in transform.transform(self._points)]
        for name, line in self._lines:
            text = self._text(name)
            size = text.get_window_extent(renderer)
            size = size.translated(-0.5 * (size.x0 + size.x1), -0.5 * (size.y0 + size.y1))
            place = self._place(transform.transform(line), size, (paths, marks), scale)
            if place is None:
                continue
            text.set_position((float(place[0]), float(place[1])))
            text.draw(renderer)
            self.placed.append((name, size.translated(*place)))

    def _text(self, name: str) -> Text:
        text = Text(
            0.0,
            0.0,
            name,
            ha="center",
            va="center",
            fontsize=_SIZE,
            path_effects=HALO,
            transform=IdentityTransform(),
        )
        assert self.axes is not None
        text.set_figure(self.axes.figure)
        return text

    def _place(
        self,
        line: FloatArray,
        size: Bbox,
        taken: tuple[Sequence[Path], Sequence[Bbox]],
        scale: float,
    ) -> FloatArray | None:
        """Middle of the name: the first free place, better one that no line crosses."""
        assert self.axes is not None
        frame = self.axes.bbox
        second = None
        for place in _candidates(line, scale):
            box = size.translated(*place).padded(_GAP * scale)
            inside = frame.x0 <= box.x0 <= box.x1 <= frame.x1
            if not (inside and frame.y0 <= box.y0 <= box.y1 <= frame.y1):
                continue
            if any(box.overlaps(other) for other in taken[1]):
                continue
            if any(box.overlaps(other) for _, other in self.placed):
                continue
            if not any(path.intersects_bbox(box, filled=False) for path in taken[0]):
                return place
            second = place if second is None else second
        return second


def _around(point: FloatArray, half: float) -> Bbox:
    return Bbox([point - half, point + half])


def _candidates(line: FloatArray, scale: float) -> Iterator[FloatArray]:
    """Places next to the ends of a line and its middle, first those above it."""
    along = line[0] - line[-1]
    along = along / max(float(np.linalg.norm(along)), 1e-300)
    above = np.array([-along[1], along[0]])
    if above[1] < 0.0 or (above[1] == 0.0 and above[0] < 0.0):
        above = -above
    middle = line[len(line) // 2] if len(line) > 2 else 0.5 * (line[0] + line[-1])
    for side in (above, -above):
        yield line[0] + scale * (_ASIDE * side - _BACK * along)
        yield line[-1] + scale * (_ASIDE * side + _BACK * along)
        yield middle + scale * _ASIDE * side
    yield line[0] + scale * 2.0 * _ASIDE * along
    yield line[-1] - scale * 2.0 * _ASIDE * along


# widths tell the states in grey print; what is open is hollow
_WIDTHS = {"stick": 1.2, "slip": 2.6, "open": 3.0}
_CORE = 1.3
_FLATTEST = 0.68  # height of the map over its width
_WELL: dict[str, Any] = {"mfc": "#FFFFFF", "mec": "#000000", "mew": 0.9, "ms": 6}
_JOINT: dict[str, Any] = {"mfc": "#FFFFFF", "mec": "#000000", "mew": 0.7, "ms": 3.2}
_WING: dict[str, Any] = {"mfc": "#000000", "mec": "#000000", "ms": 2.6}
_EVENTS: dict[bool, dict[str, Any]] = {  # by whether they are seismic
    True: {"mfc": "none", "mec": SEISMIC_COLOUR, "mew": 1.2},
    False: {"mfc": "none", "mec": "#CC79A7", "mew": 0.8},
}
EVENT_WORDS = {True: "seismic event", False: "aseismic slip"}
_EVENT_SIZES = (6.0, 20.0)  # [points] of the smallest and the largest event
_EVENT_RANGE = 3.0  # powers of ten of the moment between these, at least


def map_ratio(run: Run) -> float:
    """Height of the map over its width."""
    network = run.network or {}
    growths = read_growth(network) if network.get("steps") else []
    if not growths:
        return 1.0
    left, right, bottom, top = _flat(network_box(growths, run.scene), growths)
    return (top - bottom) / (right - left)


def draw_map(axes: Axes, run: Run, cells: Table) -> list[Artist]:
    """Draw the network into axes and give the entries of a legend."""
    network = run.network or {}
    growths = read_growth(network) if network.get("steps") else []
    box = _flat(network_box(growths, run.scene), growths)
    scene = run.scene
    body = None if scene is None else scene.outline
    unit = length_unit(box if body is None else body)
    handles: list[Artist] = []
    if scene is not None:
        handles += draw_regions(axes, scene.regions, scene.permeability_m2, body, unit)
    if body is not None:
        axes.plot(*unit.of(body).T, color="#888888", linewidth=0.8, zorder=1)
    handles = [*_draw_states(axes, network, cells, unit), *handles]
    begins = [points[0] for g in growths for points in (g.start, g.end) if len(points) > 1]
    if begins:
        axes.plot(*unit.of(np.array(begins)).T, "s", zorder=5, ls="none", **_WING)
        handles.append(style.handle(ls="none", marker="s", label="a wing begins", **_WING))
    joints = [(joint["x_m"], joint["y_m"]) for joint in network.get("joints", [])]
    if joints:
        axes.plot(*unit.of(np.array(joints)).T, "o", zorder=6, ls="none", **_JOINT)
        handles.append(style.handle(ls="none", marker="o", label="joint", **_JOINT))
    handles += draw_wells(axes, run, unit)
    wells = well_places(scene, network)
    named = [(item.name, unit.of(item.initial)) for item in foremost(growths, scene)]
    lines = [unit.of(np.concatenate((g.start[::-1], g.initial, g.end))) for g in growths]
    axes.add_artist(Names(named, lines, unit.of(np.array(wells).reshape(-1, 2))))
    handles += _draw_events(axes, run, unit)
    axes.set_xlim(*unit.of(np.array(box[:2])))
    axes.set_ylim(*unit.of(np.array(box[2:])))
    style.map_axes(axes, unit)
    return handles


def _flat(
    box: tuple[float, float, float, float], growths: Sequence[Growth]
) -> tuple[float, float, float, float]:
    """Leave out what is above and below a network that is wider than high."""
    left, right, bottom, top = box
    points = np.concatenate([np.concatenate((g.initial, g.start, g.end)) for g in growths])
    low, high = float(points[:, 1].min()), float(points[:, 1].max())
    margin = 0.12 * (high - low) + 0.03 * (right - left)
    height = min(top - bottom, max(high - low + 2.0 * margin, _FLATTEST * (right - left)))
    middle = min(max(0.5 * (low + high), bottom + 0.5 * height), top - 0.5 * height)
    return left, right, middle - 0.5 * height, middle + 0.5 * height


def _draw_states(axes: Axes, network: Mapping[str, Any], cells: Table, unit: Unit) -> list[Artist]:
    """Lines of the cells in their states in the last written state, runs of one state at once."""
    moments = cells.moments()
    rows = moments == moments[-1]
    if cells.has("history_row"):
        numbers = cells.number("history_row")
        rows = numbers == numbers[-1]
    owner, s = cells.number("fracture")[rows], cells.number("s_m")[rows]
    state = cells.text("state")[rows]
    found: set[str] = set()
    for item in network.get("fractures", []):
        mine = np.flatnonzero(owner == item["fracture"])
        if mine.size == 0:
            continue
        mine = mine[np.argsort(s[mine])]
        points = np.column_stack((item["x_m"], item["y_m"])).astype(np.float64)
        arc = float(item["s_start_m"]) + np.concatenate(
            ([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
        )
        middles = s[mine]
        edges = np.concatenate(([arc[0]], 0.5 * (middles[1:] + middles[:-1]), [arc[-1]]))
        edges = np.clip(edges, arc[0], arc[-1])
        first = 0
        for k in range(1, mine.size + 1):
            if k < mine.size and state[mine[k]] == state[mine[first]]:
                continue
            name = str(state[mine[first]])
            found.add(name)
            _draw_piece(axes, unit.of(_between(points, arc, edges[first], edges[k])), name)
            first = k
    return [
        style.handle(label=name, path_effects=_effects(name), **_look(name))
        for name in style.STATES
        if name in found
    ]


def _between(points: FloatArray, arc: FloatArray, start: float, end: float) -> FloatArray:
    """Part of a polyline between two arc lengths."""
    inside = (arc > start) & (arc < end)
    places = np.concatenate(([start], arc[inside], [end]))
    return np.column_stack([np.interp(places, arc, points[:, k]) for k in (0, 1)])


def _look(state: str) -> dict[str, Any]:
    return {
        "color": style.STATE_COLOURS[state],
        "linewidth": _WIDTHS[state],
        "solid_capstyle": "butt",
    }


def _effects(state: str) -> list[effects.AbstractPathEffect]:
    hollow = effects.Stroke(linewidth=_CORE, foreground="white")
    return [effects.Normal(), hollow] if state == "open" else [effects.Normal()]


def _draw_piece(axes: Axes, points: FloatArray, state: str) -> None:
    axes.plot(*points.T, zorder=3, path_effects=_effects(state), **_look(state))


def draw_wells(axes: Axes, run: Run, unit: Unit) -> list[Artist]:
    """Wells at their point; those along a whole fracture near its middle, as the scene has it."""
    wells = run.scene.wells if run.scene else ()
    places = well_places(run.scene, run.network or {})
    for place in places:
        axes.plot(*unit.of(np.array(place)), "v", zorder=8, **_WELL)
    if not places:
        return []
    whole = any(well.place_m is None for well in wells)
    label = "well, along its fracture" if whole else "well"
    return [style.handle(ls="none", marker="v", label=label, **_WELL)]


def well_places(scene: Scene | None, network: Mapping[str, Any]) -> list[tuple[float, float]]:
    """Where wells are drawn [m]: at their points, or on their fractures at the start of the run."""
    wells = scene.wells if scene else ()
    try:
        first = network["steps"][0] if network.get("steps") else network
        fractures = {item["name"]: item for item in first.get("fractures", [])}
        places = {_place(well.fracture, well.place_m, fractures) for well in wells}
    except (LookupError, TypeError, ValueError, AttributeError) as reason:
        raise RunError(f"the network is damaged ({reason!r}).") from None
    return sorted(place for place in places if place is not None)


def _place(
    name: str, place: tuple[float, float] | None, fractures: Mapping[str, Mapping[str, Any]]
) -> tuple[float, float] | None:
    if place is not None:
        return place
    item = fractures.get(name)
    if item is None:
        return None
    points = np.column_stack((item["x_m"], item["y_m"])).astype(np.float64)
    arc = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    # a little off the middle, where another fracture often crosses
    s = 0.6 * arc[-1]
    return float(np.interp(s, arc, points[:, 0])), float(np.interp(s, arc, points[:, 1]))


def _draw_events(axes: Axes, run: Run, unit: Unit) -> list[Artist]:
    """Circles that grow with the logarithm of the moment, by kind."""
    table = run.slip_events
    if table is None or table.rows == 0:
        return []
    share, fast = event_shares(table.number("moment_nm")), seismic(table)
    width = _EVENT_SIZES[0] + share * (_EVENT_SIZES[1] - _EVENT_SIZES[0])
    for k in np.argsort(-share):
        place = unit.of(np.array([table.number("x_m")[k], table.number("y_m")[k]]))
        axes.plot(*place, "o", zorder=5, ms=float(width[k]), **_EVENTS[bool(fast[k])])
    return [
        style.handle(ls="none", marker="o", ms=7, label=label, **_EVENTS[kind])
        for kind, label in EVENT_WORDS.items()
        if np.any(fast == kind)
    ]


def event_shares(moment: FloatArray) -> FloatArray:
    """Sizes of events from 0 to 1, by the logarithm of the moment."""
    size = np.log10(moment)
    largest = float(size.max(initial=-np.inf))
    lowest = min(float(size.min(initial=np.inf)), largest - _EVENT_RANGE)
    share: FloatArray = (size - lowest) / (largest - lowest)
    return share
