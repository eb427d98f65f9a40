"""Drawing the pictures of a run: its network, its contact states, its pressure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from wingcrack.figures.maps import pressure_maps
from wingcrack.figures.network import network_figure
from wingcrack.figures.read import Run, read_run
from wingcrack.figures.story_map import draw_map
from wingcrack.figures.style import new_figure, outside_legend

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
