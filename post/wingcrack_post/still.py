"""Axes of a figure that is complete: nothing but their places changes any more.

matplotlib finds the ticks of an axis, and the boxes around their labels and spines, each time that
something depends on them: the label, the title, the layout; some seventeen times for a drawing. And
it lets each new tick look like the first one of its axis, whatever has been done to that.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from matplotlib.artist import Artist
from matplotlib.figure import Figure


def keep_still(figure: Figure) -> None:
    """Let each axis find its ticks, labels and spines once wherever it is; for good.

    Ticks look as their axis says from now on, single ones like all others.
    """
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            _Still(axis)
        for spine in axes.spines.values():
            _StillSpine(spine)


class _Still:
    """The ticks of an axis, and the boxes around their labels, where it is now.

    Parameters
    ----------
    axis : matplotlib.axis.Axis
        Asks here from now on.
    """

    def __init__(self, axis: Any) -> None:
        self._axis = axis
        self._find_ticks: Callable[[], list[Any]] = axis._update_ticks
        self._find_boxes: Callable[[Any, Any], tuple[list[Any], list[Any]]]
        self._find_boxes = axis._get_ticklabel_bboxes
        self._place: tuple[float, ...] = ()
        self._ticks: list[Any] = []
        self._boxes: tuple[list[Any], list[Any]] | None = None
        axis._update_ticks, axis._get_ticklabel_bboxes = self.ticks, self.boxes
        axis._copy_tick_props = _clip

    def ticks(self) -> list[Any]:
        """Ticks that will be drawn."""
        place = _place(self._axis)
        if place != self._place:
            self._ticks = self._find_ticks()
            self._boxes = None
            self._place = place
        return self._ticks

    def boxes(self, ticks: list[Any], renderer: Any) -> tuple[list[Any], list[Any]]:
        """Boxes around the labels on one side and on the other [pixel]."""
        if ticks is not self._ticks:
            return self._find_boxes(ticks, renderer)
        if self._boxes is None:
            self._boxes = self._find_boxes(ticks, renderer)
        return self._boxes


class _StillSpine:
    """The box around a spine and its ticks, where it is now.

    Parameters
    ----------
    spine : matplotlib.spines.Spine
        Asks here from now on.
    """

    def __init__(self, spine: Any) -> None:
        self._spine = spine
        self._find_box = spine.get_window_extent
        self._place: tuple[float, ...] = ()
        self._box: Any = None
        spine.get_window_extent = self.box

    def box(self, renderer: Any = None) -> Any:
        """Box around the spine [pixel]."""
        if self._spine.axis is None:
            return self._find_box(renderer)
        place = _place(self._spine.axis)
        if place != self._place:
            self._box = self._find_box(renderer)
            self._place = place
        return self._box


def _place(axis: Any) -> tuple[float, ...]:
    """What the ticks of a complete axis depend on."""
    return (*axis.get_view_interval(), *axis.axes.bbox.extents)


def _clip(first: Any, tick: Any) -> None:
    """Let the grid line of a new tick end where that of the first one does; no more is needed."""
    Artist.update_from(tick.gridline, first.gridline)
