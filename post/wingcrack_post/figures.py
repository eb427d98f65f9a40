"""All figures of a run: which there are, and writing the chosen ones to files."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from wingcrack_post import style
from wingcrack_post.errors import AbsentError, EnvironmentLacksError
from wingcrack_post.history import balance, development, intensities
from wingcrack_post.load import load_figure
from wingcrack_post.maps import pressure_maps
from wingcrack_post.network import network_figure
from wingcrack_post.probes import probe_histories
from wingcrack_post.profiles import fracture_profiles
from wingcrack_post.read import Run
from wingcrack_post.story import story
from wingcrack_post.stress import stress_maps
from wingcrack_post.view import draw_view
from wingcrack_post.wells import well_histories


@dataclass(frozen=True)
class Outcome:
    """What became of one figure.

    Attributes
    ----------
    name : str
        Name of the figure, the stem of its files (for profiles: of the first part of them).
    files : tuple of Path
        What was written; empty if it was left out.
    reason : str
        Why it was left out, else empty.
    lacking : bool
        Whether it was left out as this machine lacks something.
    """

    name: str
    files: tuple[Path, ...]
    reason: str = ""
    lacking: bool = False


@dataclass(frozen=True)
class _Figures:
    group: str
    name: str
    draw: Callable[[Run, Sequence[float]], Iterator[tuple[str, Figure]]]


def _one(
    function: Callable[..., Figure], *, timed: bool = False
) -> Callable[..., Iterator[tuple[str, Figure]]]:
    def draw(run: Run, times_s: Sequence[float]) -> Iterator[tuple[str, Figure]]:
        yield "", function(run, times_s) if timed else function(run)

    return draw


_FIGURES = (
    _Figures("story", "story", _one(story)),
    _Figures("network", "network", _one(network_figure)),
    _Figures("maps", "pressure_maps", _one(pressure_maps, timed=True)),
    _Figures("maps", "stress_maps", _one(stress_maps, timed=True)),
    _Figures("fractures", "fracture", fracture_profiles),
    _Figures("tips", "intensities", _one(intensities)),
    _Figures("tips", "load", _one(load_figure)),
    _Figures("tips", "development", _one(development)),
    _Figures("tips", "balance", _one(balance)),
    _Figures("wells", "wells", _one(well_histories)),
    _Figures("probes", "probes", _one(probe_histories)),
)


def draw_figures(
    run: Run,
    only: Sequence[str],
    formats: Sequence[str] = style.FORMATS,
    times_s: Sequence[float] = (),
) -> Iterator[Outcome]:
    """Draw the figures of the named groups into ``figures`` in the run's directory.

    Yields an outcome per figure as soon as it is known. Damaged files raise `RunError`.
    """
    folder = run.directory / "figures"
    for figures in _FIGURES:
        if figures.group in only:
            yield _drawn(run, figures, folder, formats, times_s)
    if "view" in only:
        yield _viewed(run, folder / "view.png", formats, times_s)


def _drawn(
    run: Run, figures: _Figures, folder: Path, formats: Sequence[str], times_s: Sequence[float]
) -> Outcome:
    files: list[Path] = []
    try:
        for label, figure in figures.draw(run, times_s):
            name = f"{figures.name}_{label}" if label else figures.name
            files += style.save(figure, folder / re.sub(r"[^\w.-]+", "_", name), formats)
    except AbsentError as reason:
        return Outcome(figures.name, tuple(files), str(reason))
    except EnvironmentLacksError as reason:
        return Outcome(figures.name, tuple(files), str(reason), lacking=True)
    return Outcome(figures.name, tuple(files))


def _viewed(run: Run, target: Path, formats: Sequence[str], times_s: Sequence[float]) -> Outcome:
    if "png" not in formats:
        return Outcome("view", (), "the view is drawn as PNG only")
    try:
        return Outcome("view", (draw_view(run, target, times_s[-1] if times_s else None),))
    except AbsentError as reason:
        return Outcome("view", (), str(reason))
    except EnvironmentLacksError as reason:
        return Outcome("view", (), str(reason), lacking=True)
