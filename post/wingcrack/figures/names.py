"""Names on a map without overlaps; a name for which there is no space is omitted.

The free space is known once the figure is laid out, so places are found when it is drawn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.artist import Artist
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Bbox, IdentityTransform

from wingcrack.figures.table import FloatArray

HALO = [effects.withStroke(linewidth=1.8, foreground="white")]
_SIZE = 7  # [point]
_ASIDE, _BACK = 7.0, 4.0  # [point] from an end: away from the line, and beyond its end
_ROOM = 1.0  # [point] around what must stay clear


class Names(Artist):
    """Names of lines, in the order in which they are placed.

    Parameters
    ----------
    lines : sequence of (str, (n, 2) array)
        Names, and the lines that they stand beside, in the unit of the axes.
    others : sequence of (n, 2) array
        Lines that names should not cross, where another place is free.
    points : (n, 2) array
        Marks that names must not cover.
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
            box = size.translated(*place).padded(_ROOM * scale)
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
    """Places beside the ends of a line and its middle, first those above it."""
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
