"""The text of a scene: the groups of the network, and for a complete scene all others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, Polygon
from shapely.strtree import STRtree

from wingcrack.scenes.namelist import Value, group_text
from wingcrack_maps.base import Base
from wingcrack_maps.body import domain_values
from wingcrack_maps.features import Area, Line

FRACTURE_DEFAULTS: dict[str, Value] = {"friction": 0.6, "dilation_deg": 3.0, "aperture": 1.0e-4}
"""Of fractures where neither map nor call says it: ours, to start from."""

_CELLS = 8.0  # of the median fracture
_COARSENING = 8.0  # cells far from the fractures over those at them

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
! Without the exclamation mark fractures grow. Remove size_fracture of &coarse then, so that cells,
! increments and windows follow from the length of each fracture:
! &growth enabled = .true. /
"""

_GROWTH = """\
! Cells, increments and windows follow from the length of each fracture (docs/theory.md).
&growth enabled = .true. /
"""

_WELL = """\
! A well in the fractures that hang together over the largest length. Its pressure limit is 3 MPa
! above the smallest compression: fractures across that open.
"""


@dataclass
class Network:
    """All that goes into the scene."""

    lines: Sequence[Line]
    line_values: Sequence[dict[str, Value]]
    regions: Sequence[Area]
    region_values: Sequence[dict[str, Value]]
    body: Polygon | None
    cell: float | None
    grows: bool = False


def cell_size(lines: Sequence[Line]) -> float:
    """Cells at the fractures: an eighth of the median length, at most the shortest fracture [m]."""
    lengths = np.array([line.length for line in lines if line.length > 0.0])
    size = min(float(np.median(lengths)) / _CELLS, float(lengths.min()))
    grain = 10.0 ** (math.floor(math.log10(size)) - 1)
    return float(f"{math.floor(size / grain * (1.0 + 1e-12)) * grain:.2g}")


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
    groups = _geometry(network, base)
    if base is not None:
        growth = _GROWTH if network.grows else ""
        return f"{base.text.rstrip()}\n\n{comment}{groups}{growth}"
    holds = _RECTANGLE if "x_min" in domain_values(_body(network)) else _POLYGON
    time = _TIME_WITH_GROWTH + _GROWTH if network.grows else _TIME + _NO_GROWTH
    return f"{comment}\n{groups}\n{_ROCK}{holds}{_WELL}{_well(network.lines)}{time}"


def _body(network: Network) -> Polygon:
    assert network.body is not None
    return network.body


def _geometry(network: Network, base: Base | None) -> str:
    present = base.groups if base is not None else {}
    pieces = []
    if "domain" not in present:
        pieces.append(group_text("domain", domain_values(_body(network))))
    if network.cell is not None and not ({"coarse", "fe"} & present.keys()):
        name = "coarse" if base is None or "fluid" in present else "fe"
        pieces.append(group_text(name, _sizes(network)))
    for area, values in zip(network.regions, network.region_values, strict=True):
        x, y = (list(map(float, row)) for row in area.points.T)
        text = group_text("region", {"name": area.name, "x": x, "y": y, **values})
        if not values:  # without rock of its own a region is none
            text = "".join(f"! {line}\n" for line in text.splitlines())
        pieces.append(text)
    for line, values in zip(network.lines, network.line_values, strict=True):
        x, y = (list(map(float, row)) for row in line.points.T)
        pieces.append(group_text("fracture", {"name": line.name, "x": x, "y": y, **values}))
    return "".join(pieces)


def _sizes(network: Network) -> dict[str, Value]:
    assert network.cell is not None
    low_x, low_y, high_x, high_y = _body(network).bounds
    edges = np.hypot(*np.diff(np.array(_body(network).exterior.coords), axis=0).T)
    far = min(_COARSENING * network.cell, high_x - low_x, high_y - low_y, float(edges.min()))
    return {"size_fracture": network.cell, "size_boundary": max(far, network.cell)}


def _well(lines: Sequence[Line]) -> str:
    """A well in the longest fracture of what hangs together over the largest length."""
    shapes = [LineString(line.points) for line in lines]
    tree = STRtree(shapes)
    # shares of a cell's size are nothing here, and meeting ends differ by rounding
    touching = [tree.query(shape, "dwithin", 1e-9 * shape.length) for shape in shapes]
    cluster = list(range(len(lines)))
    for i, others in enumerate(touching):
        for j in others:
            old, new = cluster[int(j)], cluster[i]
            cluster = [new if number == old else number for number in cluster]
    total = [sum(lines[j].length for j, c in enumerate(cluster) if c == own) for own in cluster]
    longest = max(range(len(lines)), key=lambda i: (total[i], lines[i].length))
    return group_text(
        "injection", {"fracture": lines[longest].name, "rate": 1.0e-5, "pressure": 33.0e6}
    )
