"""The text of a scene: the groups of the network, and for a complete scene all others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, Polygon
from shapely.strtree import STRtree

from wingcrack.scenes.namelist import Value, group_text
from wingcrack_maps.base import Base
from wingcrack_maps.body import domain_values
from wingcrack_maps.features import Area, Line, Points

FRACTURE_DEFAULTS: dict[str, Value] = {"friction": 0.6, "dilation_deg": 3.0, "aperture": 1.0e-4}
"""Of fractures where neither map nor call says it: ours, to start from."""

_CELLS = 8.0  # along a fracture
_MOST = 1500.0  # cells along all fractures: some two minutes
_RATE = 1.4e-7  # of the well for each metre of its cluster [m2/s per m]
_MOST_RATE = 1.0e-5  # and at most, where the median fracture has two metres [m2/s]
# Cells far from the fractures over those at them, and in the diagonal of the body: with less of one
# or the other cells grow too slowly from small ones in a wide body
_COARSENING, _ACROSS = 8.0, 25.0

_ROCK = """\
! Rock, fluid, stress, well and time are ours, to start from: granite at 2 km. Change them to yours.
&material
  young = 40.0e9, poisson = 0.25
  biot = 0.7, porosity = 0.01, permeability = 1.0e-18, toughness = 1.5e6
/
&fluid compressibility = 4.5e-10, viscosity = 3.0e-4 /
&initial pressure = 20.0e6 /
! Total stress; the largest compression is along x.
&in_situ sxx = -45.0e6, syy = -30.0e6 /
"""

_RECTANGLE = """\
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
"""

_POLYGON = "&side name = 'held', edges = 1, x_displacement = 0.0, y_displacement = 0.0 /\n"

_TIME = "&time end = 3600.0 /\n"

_TIME_WITH_GROWTH = """\
! With this tolerance a fracture has 10 cells, with 0.01 it has 20.
&time end = 3600.0, tolerance = 0.02 /
"""

_NO_GROWTH = """\
! Without the exclamation mark fractures grow. Remove &coarse and every cell_size then, so that
! cells, increments and windows follow from the length of each fracture, and raise the well's
! pressure above the smallest compression:
! &growth enabled = .true. /
"""

_GROWTH = """\
! Cells, increments and windows follow from the length of each fracture (docs/theory.md).
&growth enabled = .true. /
"""

_WELL = """\
! A well in the fractures that hang together over the largest length. Its rate suits their length,
"""
_LIMIT = """\
! its pressure limit is 1 MPa below the smallest compression: fractures slip. Above it they open and
! would grow, and the run takes two to seven times as long.
"""
_LIMIT_WITH_GROWTH = """\
! its pressure limit is 3 MPa above the smallest compression.
"""


@dataclass
class Network:
    """All that goes into the scene."""

    lines: Sequence[Line]
    line_values: Sequence[dict[str, Value]]
    regions: Sequence[Area]
    region_values: Sequence[dict[str, Value]]
    body: Polygon | None
    cell: float | None  # of all fractures [m]
    cells: Sequence[float]  # of each where there is none for all [m]
    grows: bool = False
    wells: Sequence[Line] = ()
    well_values: Sequence[dict[str, Value]] = ()


def cell_sizes(lines: Sequence[Line]) -> tuple[list[float], str]:
    """Cells along each fracture [m]: an eighth of it or of the median, or what a short run bears.

    Shorter fractures have fewer cells, one at least, and every segment has one.

    Returns
    -------
    list of float, str
        The sizes, and a sentence on them.
    """
    # one of no length is refused when the scene is checked
    lengths = np.maximum([line.length for line in lines], 1e-9 * max(line.length for line in lines))
    segments = [np.hypot(*np.diff(line.points, axis=0).T) for line in lines]
    owner = np.repeat(np.arange(len(lines)), [len(own) for own in segments])
    gaps = np.concatenate(segments)

    def sizes(least: float) -> Points:
        return np.minimum(np.maximum(lengths / _CELLS, least), 0.999 * lengths)

    def cells(least: float) -> float:
        return float(np.maximum(gaps / sizes(least)[owner], 1.0).sum())

    high = float(np.median(lengths))
    least = high / _CELLS
    if cells(least) > _MOST:
        for _ in range(40):
            middle = 0.5 * (least + high)
            least, high = (middle, high) if cells(middle) > _MOST else (least, middle)
        least = high
    found = [float(f"{size:.3g}") for size in 0.995 * sizes(least)]
    words = (
        f"cells of {min(found):.3g} to {max(found):.3g} m along fractures: about"
        f" {cells(least):.0f} where none is too narrow for them"
    )
    if cells(least) > 1.1 * _MOST:
        words += (
            f"; {len(gaps)} segments have a cell each: --simplify leaves out vertices,"
            " --drop-shorter short traces"
        )
    return found, words


def scene_text(network: Network, heading: str, base: Base | None) -> str:
    """Write the scene.

    Parameters
    ----------
    heading : str
        Comment on where the network comes from.
    base : Base, optional
        The scene that it is added to; without one all that a scene needs is written.
    """
    comment = "".join(f"! {line}\n" for line in heading.splitlines())
    groups = _geometry(network, base) + _wells(network)
    if base is not None:
        growth = _GROWTH if network.grows else ""
        return f"{base.text.rstrip()}\n\n{comment}{groups}{growth}"
    holds = _RECTANGLE if "x_min" in domain_values(_body(network)) else _POLYGON
    well = "" if network.wells else _WELL + _well(network.lines, network.grows)
    time = _TIME_WITH_GROWTH + _GROWTH if network.grows else _TIME + _NO_GROWTH
    return f"{comment}\n{groups}\n{_ROCK}{holds}{well}{time}"


def _body(network: Network) -> Polygon:
    assert network.body is not None
    return network.body


def _geometry(network: Network, base: Base | None) -> str:
    present = base.groups if base is not None else {}
    pieces = []
    if "domain" not in present:
        pieces.append(group_text("domain", domain_values(_body(network))))
    if (network.cell is not None or network.cells) and not ({"coarse", "fe"} & present.keys()):
        name = "coarse" if base is None or "fluid" in present else "fe"
        pieces.append(group_text(name, _sizes(network)))
    for area, values in zip(network.regions, network.region_values, strict=True):
        x, y = (list(map(float, row)) for row in area.points.T)
        text = group_text("region", {"name": area.name, "x": x, "y": y, **values})
        if not values:  # without rock of its own a region is none
            text = "".join(f"! {line}\n" for line in text.splitlines())
        pieces.append(text)
    for k, (line, values) in enumerate(zip(network.lines, network.line_values, strict=True)):
        x, y = (list(map(float, row)) for row in line.points.T)
        own: dict[str, Value] = {"cell_size": network.cells[k]} if network.cells else {}
        pieces.append(group_text("fracture", {"name": line.name, "x": x, "y": y, **own, **values}))
    return "".join(pieces)


def _sizes(network: Network) -> dict[str, Value]:
    near = network.cell or float(np.median(network.cells))
    least = network.cell or max(network.cells)
    low_x, low_y, high_x, high_y = _body(network).bounds
    edges = np.hypot(*np.diff(np.array(_body(network).exterior.coords), axis=0).T)
    far = max(_COARSENING * near, np.hypot(high_x - low_x, high_y - low_y) / _ACROSS)
    far = min(far, high_x - low_x, high_y - low_y, float(edges.min()))
    own: dict[str, Value] = {} if network.cell is None else {"size_fracture": network.cell}
    return {**own, "size_boundary": max(far, least)}


def _wells(network: Network) -> str:
    """Write the wells of the map: each in the nearest fracture, with a radius in the rock."""
    pieces = []
    for well, values in zip(network.wells, network.well_values, strict=True):
        x, y = map(float, well.points[0])
        where: dict[str, Value] = {} if "radius" in values else {"fracture": "nearest"}
        pieces.append(
            group_text("injection", {"name": well.name, **where, "x": x, "y": y, **values})
        )
    return "".join(pieces)


def _well(lines: Sequence[Line], grows: bool) -> str:
    """A well in the longest fracture of what hangs together over the largest length."""
    shapes = [LineString(line.points) for line in lines]
    tree = STRtree(shapes)
    # shares of a cell's size are nothing here, and meeting ends differ by rounding
    touching = [tree.query(shape, "dwithin", 1e-9 * shape.length) for shape in shapes]
    one = np.repeat(np.arange(len(lines)), [len(others) for others in touching])
    other = np.concatenate(touching)
    cluster, before = np.arange(len(lines)), np.empty(0, dtype=int)
    while not np.array_equal(cluster, before):
        before = cluster.copy()
        np.minimum.at(cluster, one, before[other])
        np.minimum.at(cluster, other, before[one])
    total = np.bincount(cluster, [line.length for line in lines])[cluster]
    longest = max(range(len(lines)), key=lambda i: (total[i], lines[i].length))
    # larger networks take more before anything slips
    most = _MOST_RATE * max(1.0, 0.5 * float(np.median([line.length for line in lines])))
    rate = float(f"{min(most, _RATE * total[longest]):.1g}")
    well: dict[str, Value] = {
        "fracture": lines[longest].name,
        "rate": rate,
        "pressure": 33e6 if grows else 29e6,
    }
    return (_LIMIT_WITH_GROWTH if grows else _LIMIT) + group_text("injection", well)
