"""Scenes that are run, and runs with their figures."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wingcrack.errors import RunError, RunFailedError, SceneError
from wingcrack.figures.choices import DEFAULT_FORMATS
from wingcrack.runs.checkpoint import read_checkpoint
from wingcrack.runs.parameter_table import solver
from wingcrack.runs.results import Results
from wingcrack.runs.scene_files import SceneFile

if TYPE_CHECKING:
    import pandas
    import pyvista
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIGNS = ("run.json", "history.csv", "scene.nml")  # files that only a run's folder has
_BAD_INPUT = 2


def open_run(directory: str | Path) -> Run:
    """Open the folder of a run that has ended, has failed, or still goes on.

    Parameters
    ----------
    directory : str or Path
        What ``wingcrack run`` wrote, for instance ``out/wing_crack``.

    Raises
    ------
    RunError
        If there is no such folder, or no run in it.

    Examples
    --------
    >>> run = wingcrack.open("out/wing_crack")  # doctest: +SKIP
    >>> run.tips.groupby("tip").keq_pa_sqrtm.max()  # doctest: +SKIP
    """
    folder = Path(directory)
    if not folder.is_dir():
        what = "it is a file" if folder.exists() else "there is no such folder"
        raise RunError(f"{folder}: {what}; a run's folder was expected, such as out/wing_crack")
    if not any((folder / name).is_file() for name in _SIGNS):
        raise RunError(f"{folder}: this folder contains no run (none of {', '.join(_SIGNS)})")
    return Run(folder)


class Run(Results):
    """What a run has written; files are read when they are asked for, once until `refresh`.

    All values are SI. Frames tell the units of their columns in ``.attrs["units"]``.

    Parameters
    ----------
    directory : Path
    """

    @cached_property
    def scene(self) -> Scene:
        """The scene as understood, every default written out.

        Raises
        ------
        AbsentError
            If the run has written none.
        """
        return Scene.read(self._scene_file)

    # Going on

    def continue_with(
        self,
        out: str | Path,
        changes: Mapping[str, Any] | None = None,
        *,
        end: float | None = None,
        threads: int = 1,
        quiet: bool = True,
    ) -> Run:
        """Go on from the newest checkpoint of this run, in another folder.

        Without changes the result equals that of a run that was not interrupted, bit for bit.

        Parameters
        ----------
        out : str or Path
            Folder for the results; the run's own folder is possible.
        changes : mapping, optional
            Values by address, as in `Scene`: of ``time``, ``output``, stages of wells, values of
            sides in time.
        end : float, optional
            Another end [s].
        threads : int
            For windows side by side and loops.
        quiet : bool
            No progress on the terminal.

        Raises
        ------
        SceneError
            If there is no checkpoint, or something is changed that a restart cannot change.
        RunFailedError
            If the run does not reach its end.

        Examples
        --------
        >>> run.continue_with("out/longer", end=2.0 * run.scene["time.end"])  # doctest: +SKIP
        """
        scene = self._changed(changes, end)
        return scene.run(out, threads=threads, quiet=quiet, restart=self.directory)

    def at(self, time: float, *, threads: int = 1, quiet: bool = True) -> State:
        """Give the state of this run at a time, from which other runs go on.

        The state at the end of the run is there. Another one is computed once, in ``states`` in
        the run's folder: after the end from there, else from the beginning.

        Parameters
        ----------
        time : float
            Time of the state [s].
        threads : int
            For windows side by side and loops.
        quiet : bool
            No progress on the terminal.

        Raises
        ------
        SceneError
            If the scene cannot end at this time.
        RunFailedError
            If the run does not reach it.

        Examples
        --------
        >>> injected = run.at(3600.0)  # doctest: +SKIP
        >>> for hours in (2, 3):  # doctest: +SKIP
        ...     injected.fork(f"out/{hours}", {"injection.well.end": 3600.0 * hours})
        """
        last = _last_checkpoint(self.directory)
        if _is_same(last, time):
            return State(self, self.directory)
        folder = self.directory / "states" / f"{time:.12g}"
        if not _is_same(_last_checkpoint(folder), time):
            restart = self.directory if 0.0 < last < time else None
            self._changed({}, time).run(folder, threads=threads, quiet=quiet, restart=restart)
        if not _is_same(_last_checkpoint(folder), time):
            reached = _last_checkpoint(folder)
            raise RunFailedError(f"the run ends at {reached:g} s, before {time:g} s", folder, 1)
        return State(self, folder)

    def _changed(self, changes: Mapping[str, Any] | None, end: float | None) -> Scene:
        scene = Scene.read(self._scene_file)
        for address, value in (changes or {}).items():
            scene[address] = value
        if end is not None:
            scene["time.end"] = end
        return scene

    # Figures

    def draw(
        self, only: Sequence[str] = (), formats: Sequence[str] = DEFAULT_FORMATS
    ) -> list[Path]:
        """Draw the figures that ``wingcrack plot`` draws, into ``figures`` in the run's folder.

        `only` names groups of them, or ``all``; default: those in which something happens.
        Those that are there and still true are not drawn again.
        """
        from wingcrack.figures.catalogue import draw_figures

        outcomes = draw_figures(self.directory, tuple(only), tuple(formats))
        return [file for outcome in outcomes for file in outcome.files]

    def well_test(self) -> pandas.DataFrame:
        """Analysis of the shut-ins of all wells: a row for each, as ``wingcrack analyse``.

        Raises
        ------
        AbsentError
            If the run has no wells.
        """
        import pandas

        from wingcrack.welltest.record import records_of_run
        from wingcrack.welltest.results import evaluate, rock_of_scene

        rock = rock_of_scene(self._scene_file)
        return pandas.DataFrame([row for _, row in evaluate(records_of_run(self.files), rock)])

    def figure(self, name: str) -> Figure:
        """Give one of the figures of ``wingcrack plot`` by its name, as 'story' or 'fracture_1'.

        Raises
        ------
        AbsentError
            If the run does not hold what the figure needs.
        RunError
            If there is no figure of that name.
        """
        from wingcrack.figures.catalogue import figure_of

        return figure_of(self.files, name)

    def plot_history(self, column: str | None = None, ax: Axes | None = None, **look: Any) -> Axes:
        """Draw a column of the history against time or load; default: pressure, else length.

        Parameters
        ----------
        column : str, optional
            As ``well_pressure_pa`` or ``fracture_length_m``.
        ax : matplotlib.axes.Axes, optional
            Where to draw; default: axes of a new figure.
        **look
            How, for matplotlib's plot: colour, label, ...
        """
        from wingcrack.runs import plots

        return plots.plot_history(self, column, ax, **look)

    def plot_tips(self, quantity: str = "keq", ax: Axes | None = None) -> Axes:
        """Draw a stress intensity factor of every tip: 'k1', 'k2' or 'keq' (with K_IC)."""
        from wingcrack.runs import plots

        return plots.plot_tips(self, quantity, ax)

    def plot_network(self, colour: str = "growth", ax: Axes | None = None) -> Axes:
        """Draw the network at the end, coloured by the order of 'growth' or by 'state'."""
        from wingcrack.runs import plots

        return plots.plot_network(self, colour, ax)

    def plot_map(
        self,
        field: str = "pressure",
        time: float | None = None,
        ax: Axes | None = None,
        *,
        close: bool = False,
        fractures_by: str = "state",
    ) -> Axes:
        """Draw a field of the rock with the fractures coloured by their state, slip or aperture.

        Parameters
        ----------
        field : str
            As ``pressure``, ``stress.xx`` or ``displacement.x``.
        time : float or None
            Time [s] or load factor [-], of which the nearest written state is drawn; None: the
            last one.
        ax : matplotlib.axes.Axes, optional
        close : bool
            Show what is near the fractures, not the whole body.
        fractures_by : str
            'state', 'slip', 'opening' or 'aperture'.
        """
        from wingcrack.runs import plots

        return plots.plot_map(self, field, time, ax, close=close, fractures_by=fractures_by)

    def plot_profile(
        self,
        column: str = "jump_t_m",
        fracture: str | int = 1,
        times: Sequence[float] = (),
        ax: Axes | None = None,
    ) -> Axes:
        """Draw a column of fractures.csv along a fracture, known by number or name, over time."""
        from wingcrack.runs import plots

        return plots.plot_profile(self, column, fracture, times, ax)

    def plot_wells(self, quantity: str = "pressure", ax: Axes | None = None) -> Axes:
        """Draw 'pressure' or 'flow' of each well."""
        from wingcrack.runs import plots

        return plots.plot_wells(self, quantity, ax)

    def plot_states(self, ax: Axes | None = None) -> Axes:
        """Draw how many fracture cells stick, slip and are open."""
        from wingcrack.runs import plots

        return plots.plot_states(self, ax)

    def plot_load(self, ax: Axes | None = None) -> Axes:
        """Draw the load factor against the fractures' length, in runs without a fluid."""
        from wingcrack.runs import plots

        return plots.plot_load(self, ax)

    def plot_equilibrium(self, against: str = "length", ax: Axes | None = None) -> Axes:
        """Draw the load factor of length control against 'length', 'opening' or 'conjugate'.

        The last is the quantity over which the energy that unstable growth releases is an area.
        """
        from wingcrack.runs import plots

        return plots.plot_equilibrium(self, against, ax)

    def scene3d(self, field: str | None = None, time: float | None = None) -> pyvista.Plotter:
        """Give a pyvista scene: fractures by state over a field, with a slider for the states.

        ``run.scene3d().show()`` opens a window; without a display ``.screenshot("a.png")`` draws.
        """
        from wingcrack.runs.pictures import build_scene

        return build_scene(self, field, time)

    def movie(
        self,
        path: str | Path,
        field: str | None = None,
        *,
        frames_per_second: float = 8.0,
        size: tuple[int, int] = (960, 720),
        progress: bool = True,
    ) -> Path:
        """Write a movie of all written states, MP4 or GIF by the end of its name; needs no display.

        Parameters
        ----------
        path : str or Path
            Appears whole, once the movie is done.
        field : str, optional
            As for `plot_map`; default: pressure, without a fluid the mean stress.
        frames_per_second : float
            Written states per second [1/s].
        size : tuple of int
            Width and height [pixel].
        progress : bool
            Whether a bar on stderr shows how far it is.
        """
        from wingcrack.runs.pictures import write_movie

        return write_movie(self, Path(path), field, frames_per_second, size, progress=progress)


@dataclass(frozen=True)
class State:
    """A state of a run, from which other runs go on: `Run.at`."""

    run: Run
    directory: Path  # has a checkpoint of the state

    def fork(
        self,
        out: str | Path,
        changes: Mapping[str, Any] | None = None,
        *,
        end: float | None = None,
        threads: int = 1,
        quiet: bool = True,
    ) -> Run:
        """Go on in another folder, with what a restart can change; as `Run.continue_with`."""
        scene = self.run._changed(changes, end)
        return scene.run(out, threads=threads, quiet=quiet, restart=self.directory)


def _last_checkpoint(folder: Path) -> float:
    """Time of the newest checkpoint [s]; 0: there is none."""
    file = folder / "checkpoint.bin"
    return float(read_checkpoint(file)["about/time"]) if file.is_file() else 0.0


def _is_same(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=1e-9)


class Scene(SceneFile):
    """A scene file in memory; nothing is known here that the solver's own table does not tell.

    Entries have addresses: ``group.name``, or in groups that are repeated ``group.item.name``,
    where an item is its number from 1 or its name.

    Parameters
    ----------
    path : str or Path
        Where it came from, or how it would be called: the stem names a scene without a name, and
        tables that it mentions lie beside it.

    Examples
    --------
    >>> scene = wingcrack.Scene.read("inputs/paper_c/onset.nml")  # doctest: +SKIP
    >>> scene["fracture.f1.friction"] = 0.4  # doctest: +SKIP
    >>> print(scene.check())  # doctest: +SKIP
    >>> run = scene.run("out/weaker")  # doctest: +SKIP
    """

    def run(
        self,
        out: str | Path,
        *,
        threads: int = 1,
        quiet: bool = True,
        restart: str | Path | None = None,
    ) -> Run:
        """Run the scene to its end.

        Parameters
        ----------
        out : str or Path
            Folder for the results.
        threads : int
            For windows side by side and loops.
        quiet : bool
            No progress on the terminal.
        restart : str or Path, optional
            Folder of a run, from whose newest checkpoint this one goes on.

        Raises
        ------
        SceneError
            If the scene is refused; nothing is written then.
        RunFailedError
            If the run does not reach its end; its `directory` holds the last good state.
        """
        if threads < 1:
            raise SceneError(f"threads must be at least 1, not {threads}")
        with tempfile.TemporaryDirectory() as folder:
            file = self._file(folder)
            words = [str(solver()), "run", str(file), "--out", str(out)]
            if restart is not None:
                words += ["--restart", str(restart)]
            status, said = _supervised([*words, "--quiet"] if quiet else words, threads)
            if status == _BAD_INPUT:
                raise SceneError(self._said(said, file))
            if status != 0:
                reason = self._said(said, file).splitlines()[-1]
                raise RunFailedError(reason, Path(out), status)
        return open_run(out)


def _supervised(words: list[str], threads: int) -> tuple[int, str]:
    """Exit status and last words of the solver; an interrupt reaches it, and is waited for."""
    count = str(threads)
    surroundings = {
        **os.environ,
        "OPENBLAS_NUM_THREADS": count,
        "OMP_NUM_THREADS": count,
        "OMP_WAIT_POLICY": "passive",
    }
    with subprocess.Popen(
        words, env=surroundings, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL
    ) as process:
        try:
            _, said = process.communicate()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            process.communicate()
            raise
    return process.returncode, said
