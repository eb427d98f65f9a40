"""Pictures of a run that a case can ask for: its network, its contact states, its pressure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from wingcrack_post.maps import pressure_maps
from wingcrack_post.network import network_figure
from wingcrack_post.read import Run, read_run
from wingcrack_post.story_map import draw_map
from wingcrack_post.style import new_figure, outside_legend
from wingcrack_verify.errors import CaseError
from wingcrack_verify.paths import NETWORK, network_table

_FRACTURES, _FIELDS = "fractures.csv", "matrix.pvd"
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


# What draws each, and the file without which it cannot.
PICTURES: dict[str, tuple[Callable[[Run], Figure], str]] = {
    "network": (network_figure, NETWORK),
    "states": (_states, _FRACTURES),
    "pressure": (_pressure, _FIELDS),
}


def require_files(picture: str, folder: Path) -> None:
    """Raise a `CaseError` if the run did not write what the picture shows."""
    needed = PICTURES[picture][1]
    if needed == NETWORK:
        network_table(folder / NETWORK)
    elif not (folder / needed).is_file():
        hint = '; set "output.vtu" = true' if needed == _FIELDS else ""
        raise CaseError(f"the run wrote no {needed}{hint}")


def picture_of(picture: str, folder: Path) -> Figure:
    """Draw the picture of a finished run."""
    return PICTURES[picture][0](read_run(folder))
