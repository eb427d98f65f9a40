"""A run's folder: its tables, fields, network and figures."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from wingcrack.errors import AbsentError, RunError, SceneError
from wingcrack.fields import Fields, read_fields
from wingcrack.tables import column, frame
from wingcrack_post.choices import DEFAULT_FORMATS
from wingcrack_post.fields import Snapshot, read_series
from wingcrack_post.table import FloatArray, Table, read_table

if TYPE_CHECKING:
    import pandas
    import pyvista
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from wingcrack.scenes import Scene
    from wingcrack_post.equilibrium import EquilibriumPath
    from wingcrack_post.read import Run as Files

_TABLES = ("history", "tips", "fractures", "probes", "wells", "events", "slip_events")
_SIGNS = ("run.json", "history.csv", "scene.nml")  # files that only a run's folder has


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
        raise RunError(f"{folder}: this folder holds no run (none of {', '.join(_SIGNS)} is in it)")
    return Run(folder)


class Run:
    """What a run has written; files are read when they are asked for, once until `refresh`.

    All values are SI. Frames tell the units of their columns in ``.attrs["units"]``.

    Parameters
    ----------
    directory : Path
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory

    def __repr__(self) -> str:
        """Folder and status."""
        return f"<wingcrack.Run {str(self.directory)!r}: {self.status}>"

    def refresh(self) -> Run:
        """Forget what was read: a run that goes on has more by now. Gives the run itself."""
        for name in [name for name in vars(self) if name != "directory"]:
            del vars(self)[name]
        return self

    # What happened

    @cached_property
    def record(self) -> dict[str, Any]:
        """Contents of run.json; empty until the run has ended."""
        return self._json("run.json") or {}

    @property
    def name(self) -> str:
        """Name of the scene."""
        return str(self.record.get("scene") or self._named())

    @property
    def status(self) -> str:
        """'finished', 'stopped', 'failed', or 'running' until run.json is there.

        A run that was killed from outside leaves no run.json, and 'running' for good.
        """
        return str(self.record.get("status", "running"))

    @property
    def reason(self) -> str:
        """Why the run ended; empty while it goes on."""
        return str(self.record.get("reason", ""))

    @property
    def warnings(self) -> list[str]:
        """What the user should know."""
        return [str(text) for text in self.record.get("warnings", [])]

    # Tables

    @cached_property
    def history(self) -> pandas.DataFrame:
        """A row per accepted step."""
        return self._frame("history")

    @cached_property
    def tips(self) -> pandas.DataFrame:
        """A row per tip and step: stress intensity factors, place, advance."""
        return self._frame("tips")

    @cached_property
    def fractures(self) -> pandas.DataFrame:
        """A row per fracture cell and written state: opening, slip, tractions, pressure, state."""
        return self._frame("fractures")

    @cached_property
    def probes(self) -> pandas.DataFrame:
        """Pressure, displacement and stress at the probe points."""
        return self._frame("probes")

    @cached_property
    def wells(self) -> pandas.DataFrame:
        """Stage, rate, pressure, volume and injectivity of each well."""
        return self._frame("wells")

    @cached_property
    def events(self) -> pandas.DataFrame:
        """Slip, opening, growth, joints, with their moments and places."""
        return self._frame("events")

    @cached_property
    def slip_events(self) -> pandas.DataFrame:
        """A row per event of slip: time, place, area, moment, stress drop, magnitude."""
        return self._frame("slip_events")

    def column(self, name: str, table: str = "history") -> npt.NDArray[Any]:
        """Column of a table as a numpy array, without pandas.

        Parameters
        ----------
        name : str
            With its unit, as ``well_pressure_pa``.
        table : str
            history, tips, fractures, probes, wells, events or slip_events.

        Raises
        ------
        AbsentError
            If the run has no such table.
        RunError
            If the table has no such column, or is damaged.
        """
        return column(self.table(table), name)

    def table(self, name: str) -> Table:
        """Table as it stands in its file; see `column` and the properties for more comfort."""
        if name not in _TABLES:
            raise RunError(f"there is no table '{name}'; a run has {', '.join(_TABLES)}")
        key = f"_{name}_table"
        if key not in vars(self):
            vars(self)[key] = self._read_table(name)
        found: Table = vars(self)[key]
        return found

    @property
    def moments(self) -> FloatArray:
        """Time [s], or without a fluid the load factor [-], of each row of the history."""
        return self.table("history").moments()

    # Network, scene, fields

    @cached_property
    def network(self) -> dict[str, Any]:
        """Contents of network.json: fractures, tips and joints at the end and by step.

        Raises
        ------
        AbsentError
            If it is not written yet.
        """
        found = self._json("network.json")
        if found is None:
            raise AbsentError(f"{self.directory} has no network.json yet")
        return found

    @cached_property
    def scene(self) -> Scene:
        """The scene as understood, every default written out.

        Raises
        ------
        AbsentError
            If the run has written none.
        """
        from wingcrack.scenes import Scene

        path = self.directory / "scene.nml"
        if not path.is_file():
            raise AbsentError(f"{self.directory} has no scene.nml")
        return Scene.read(path)

    @property
    def field_moments(self) -> list[float]:
        """Moments of the states whose fields are written [s], or their load factors [-]."""
        return [snapshot.time_s for snapshot in self._matrix]

    def fields(self, time: float | None = None) -> Fields:
        """Fields of rock and fractures in the written state nearest to a time, or the last one.

        Parameters
        ----------
        time : float or None
            Time [s], or without a fluid the load factor [-].

        Raises
        ------
        AbsentError
            If no state is written.
        RunError
            If a file is missing or cut off.
        """
        return read_fields(self.directory, self._matrix, self._fracture_series, time)

    # Figures

    def draw(
        self, only: Sequence[str] = (), formats: Sequence[str] = DEFAULT_FORMATS
    ) -> list[Path]:
        """Draw the figures that ``wingcrack plot`` draws, into ``figures`` in the run's folder.

        `only` names groups of them, or ``all``; default: those in which something happens.
        Those that are there and still true are not drawn again.
        """
        from wingcrack_post.figures import draw_figures

        outcomes = draw_figures(self.directory, tuple(only), tuple(formats))
        return [file for outcome in outcomes for file in outcome.files]

    def figure(self, name: str) -> Figure:
        """Give one of the figures of ``wingcrack plot`` by its name, as 'story' or 'fracture_1'.

        Raises
        ------
        AbsentError
            If the run does not hold what the figure needs.
        RunError
            If there is no figure of that name.
        """
        from wingcrack_post.figures import figure_of

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
        from wingcrack import plots

        return plots.plot_history(self, column, ax, **look)

    def plot_tips(self, quantity: str = "keq", ax: Axes | None = None) -> Axes:
        """Draw a stress intensity factor of every tip: 'k1', 'k2' or 'keq' (with K_IC)."""
        from wingcrack import plots

        return plots.plot_tips(self, quantity, ax)

    def plot_network(self, colour: str = "growth", ax: Axes | None = None) -> Axes:
        """Draw the network at the end, coloured by the order of 'growth' or by 'state'."""
        from wingcrack import plots

        return plots.plot_network(self, colour, ax)

    def plot_map(
        self,
        field: str = "pressure",
        time: float | None = None,
        ax: Axes | None = None,
        *,
        close: bool = False,
    ) -> Axes:
        """Draw a field of the rock with the fractures coloured by their state.

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
        """
        from wingcrack import plots

        return plots.plot_map(self, field, time, ax, close=close)

    def plot_profile(
        self,
        column: str = "jump_t_m",
        fracture: str | int = 1,
        times: Sequence[float] = (),
        ax: Axes | None = None,
    ) -> Axes:
        """Draw a column of fractures.csv along a fracture, known by number or name, over time."""
        from wingcrack import plots

        return plots.plot_profile(self, column, fracture, times, ax)

    def plot_wells(self, quantity: str = "pressure", ax: Axes | None = None) -> Axes:
        """Draw 'pressure' or 'flow' of each well."""
        from wingcrack import plots

        return plots.plot_wells(self, quantity, ax)

    def plot_states(self, ax: Axes | None = None) -> Axes:
        """Draw how many fracture cells stick, slip and are open."""
        from wingcrack import plots

        return plots.plot_states(self, ax)

    def plot_load(self, ax: Axes | None = None) -> Axes:
        """Draw the load factor against the fractures' length, in runs without a fluid."""
        from wingcrack import plots

        return plots.plot_load(self, ax)

    @cached_property
    def equilibrium(self) -> EquilibriumPath:
        """The equilibrium path of length control, its unstable branches, the energy they release.

        Raises
        ------
        AbsentError
            If growth does not control the load, or nothing has grown.
        """
        from wingcrack_post.equilibrium import equilibrium_path

        return equilibrium_path(self.files)

    def plot_equilibrium(self, against: str = "length", ax: Axes | None = None) -> Axes:
        """Draw the load factor of length control against 'length', 'opening' or 'conjugate'.

        The last is the quantity over which the energy that unstable growth releases is an area.
        """
        from wingcrack import plots

        return plots.plot_equilibrium(self, against, ax)

    def scene3d(self, field: str | None = None, time: float | None = None) -> pyvista.Plotter:
        """Give a pyvista scene: fractures by state over a field, with a slider for the states.

        ``run.scene3d().show()`` opens a window; without a display ``.screenshot("a.png")`` draws.
        """
        from wingcrack.pictures import build_scene

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
        from wingcrack.movies import write_movie

        return write_movie(self, Path(path), field, frames_per_second, size, progress=progress)

    # Inside

    @cached_property
    def files(self) -> Files:
        """The same folder as the drawing code of wingcrack_post takes it.

        Raises
        ------
        RunError
            If no step has been accepted yet, or a file is damaged.
        """
        from wingcrack_post.read import read_run

        return read_run(self.directory)

    @cached_property
    def _matrix(self) -> tuple[Snapshot, ...]:
        return read_series(self.directory / "matrix.pvd")

    @cached_property
    def _fracture_series(self) -> tuple[Snapshot, ...]:
        return read_series(self.directory / "fractures.pvd")

    def _frame(self, name: str) -> pandas.DataFrame:
        return frame(self.table(name))

    def _read_table(self, name: str) -> Table:
        path = self.directory / f"{name}.csv"
        if not path.exists():
            why = f": {self.reason}" if self.status == "failed" and self.reason else ""
            raise AbsentError(f"{self.directory} has no {path.name} (run {self.status}{why})")
        return read_table(path)

    def _json(self, name: str) -> dict[str, Any] | None:
        from wingcrack_post.read import optional_json

        return optional_json(self.directory / name)

    def _named(self) -> str:
        try:
            return str(self.scene["scene.name"])
        except (AbsentError, SceneError):
            return self.directory.resolve().name
