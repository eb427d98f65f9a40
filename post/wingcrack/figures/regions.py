"""Regions of a scene with a permeability of their own: their outlines, and how maps show them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import Unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.patches import Patch

_CURVE_PIECES = 200
_EDGE = "#777777"
_MORE, _LESS = ("#D6E4F0", "#9DBDD9"), ("#EFE6DA", "#CDB79B")  # a little, and 1000 times or more
_MOST_DECADES = 3.0


@dataclass(frozen=True)
class Region:
    """A part of the rock."""

    name: str
    corners: FloatArray  # (n, 2) of its outline, which may reach beyond the body [m]
    permeability_m2: tuple[float, float]  # components xx and yy [m2]


def read_region(
    name: str, shape: str, numbers: Mapping[str, Sequence[float]], body: FloatArray
) -> Region | None:
    """Make a region of the values of its group; `body` is a line around the body [m].

    None where values are missing, as in files of other versions.
    """
    lower, upper = body.min(axis=0), body.max(axis=0)
    try:
        corners = _corners(shape, numbers, lower, upper)
        both = tuple(numbers.get("permeability", ()))
        along_x, along_y = (
            (both[0], both[0])
            if both
            else (numbers["permeability_xx"][0], numbers["permeability_yy"][0])
        )
    except (KeyError, IndexError):
        return None
    return Region(name, corners, (along_x, along_y))


def _corners(
    shape: str, numbers: Mapping[str, Sequence[float]], lower: FloatArray, upper: FloatArray
) -> FloatArray:
    if shape == "parabola":
        return _parabola(numbers, lower, upper)
    line = np.column_stack((numbers["x"], numbers["y"])).astype(np.float64)
    if shape == "half_plane":
        # all to the left of the line, as far as the body reaches
        along = line[1] - line[0]
        along = along / float(np.linalg.norm(along))
        left = np.array([-along[1], along[0]])
        far = 4.0 * float(np.linalg.norm(upper - lower)) + float(
            np.linalg.norm(line[0] - 0.5 * (lower + upper))
        )
        a, b = line[0] - far * along, line[0] + far * along
        return np.array([a, b, b + far * left, a + far * left])
    if shape == "band":
        other = np.column_stack((numbers["x_other"], numbers["y_other"])).astype(np.float64)
        return np.concatenate((line, other[::-1]))
    return line


def _parabola(
    numbers: Mapping[str, Sequence[float]], lower: FloatArray, upper: FloatArray
) -> FloatArray:
    """Between two parabolas, or to the right of one."""
    y = np.linspace(lower[1], upper[1], _CURVE_PIECES + 1)
    curves = [
        np.column_stack((x0 + bend * (y - y0) ** 2, y))
        for x0, y0, bend in zip(
            numbers["x_vertex"], numbers["y_vertex"], numbers["curvature"], strict=True
        )
    ]
    if len(curves) == 1:
        right = max(float(upper[0]), float(curves[0][:, 0].max()))
        curves.append(np.column_stack((np.full(y.size, right), y)))
    return np.concatenate((curves[0], curves[1][::-1]))


def draw_regions(
    axes: Axes,
    regions: Sequence[Region],
    rock_m2: tuple[float, float] | None,
    body: FloatArray | None,
    unit: Unit,
) -> list[Patch]:
    """Shade regions below all else, by how much better or worse than the rock they conduct.

    Gives the entries of a legend. Regions that conduct worse are hatched too, for grey print.
    """
    from matplotlib.patches import Patch, Polygon  # late: a scene is read without them

    handles = []
    for region in regions:
        look = _look(region, rock_m2)
        patch = Polygon(
            unit.of(region.corners), closed=True, lw=0.5, ls=(0, (4, 2)), zorder=0.5, **look
        )
        axes.add_patch(patch)
        if body is not None:
            outline = Polygon(unit.of(body), closed=True, transform=axes.transData)
            patch.set_clip_path(outline)
        handles.append(Patch(lw=0.5, label=region_label(region), **look))
    return handles


def region_label(region: Region) -> str:
    """How a legend calls a region: its name and its permeability."""
    along_x, along_y = region.permeability_m2
    if along_x == along_y:
        return f"{region.name}: $k$ = {_power(along_x)} m²"
    # on two lines: one would be too long next to a map
    return f"{region.name}: $k_{{xx}}$ = {_power(along_x)} m²,\n$k_{{yy}}$ = {_power(along_y)} m²"


def _power(value: float) -> str:
    """Write a number as a product with a power of ten."""
    mantissa, exponent = f"{value:.2e}".split("e")
    digits = f"{float(mantissa):g}"
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if digits == "1" else f"${digits}\\cdot{power}$"


def _look(region: Region, rock_m2: tuple[float, float] | None) -> dict[str, Any]:
    decades = 0.0
    if rock_m2 is not None:
        ratio = np.log10(np.array(region.permeability_m2) / np.array(rock_m2))
        decades = float(ratio[np.argmax(np.abs(ratio))])
    pale, strong = _LESS if decades < 0.0 else _MORE
    share = min(1.0, abs(decades) / _MOST_DECADES)
    mixed = [
        round((1.0 - share) * int(pale[i : i + 2], 16) + share * int(strong[i : i + 2], 16))
        for i in (1, 3, 5)
    ]
    look: dict[str, Any] = {"facecolor": "#{:02X}{:02X}{:02X}".format(*mixed), "edgecolor": _EDGE}
    if decades < 0.0:
        look["hatch"] = "////"
    return look
