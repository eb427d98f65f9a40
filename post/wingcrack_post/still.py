"""Axes of a figure that is being drawn: nothing but their places changes any more.

matplotlib finds the ticks of an axis, and the boxes around their labels, each time that something
depends on them: the label, the title, a spine, the layout; some seventeen times for a drawing.
"""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure


def keep_still(figure: Figure) -> None:
    """Let each axis find its ticks and their boxes once wherever it is; for good."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            _Still(axis)


class _Still:
    """The ticks of an axis, and the boxes around their labels, where it is now.

    Parameters
    ----------
    axis : matplotlib.axis.Axis
        Asks here from now on.
    """

    def __init__(self, axis: Any) -> None:
        self._axis = axis
        self._find_ticks, self._find_boxes = axis._update_ticks, axis._get_ticklabel_bboxes
        self._place: tuple[float, ...] = ()
        self._ticks: list[Any] = []
        self._boxes: tuple[list[Any], list[Any]] | None = None
        axis._update_ticks, axis._get_ticklabel_bboxes = self.ticks, self.boxes

    def ticks(self) -> list[Any]:
        """Ticks that will be drawn."""
        place = (*self._axis.get_view_interval(), *self._axis.axes.bbox.extents)
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
