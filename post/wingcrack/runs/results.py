"""The results in a run's folder: tables, network and fields."""

from __future__ import annotations

import difflib
import html
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt

from wingcrack.errors import AbsentError, EnvironmentLacksError, RunError, SceneError
from wingcrack.figures.fields import Snapshot, nearest, read_series
from wingcrack.figures.table import FloatArray, Table, read_table
from wingcrack.names import error_column
from wingcrack.runs.fields import Fields, read_fields
from wingcrack.runs.scene_files import SceneFile
from wingcrack.runs.units import column_unit

if TYPE_CHECKING:
    import pandas
    import pyvista
    import xarray

    from wingcrack.figures.equilibrium import EquilibriumPath
    from wingcrack.figures.read import Run as Files

_TABLES = ("history", "tips", "fractures", "probes", "wells", "entries", "events", "slip_events")


class Results:
    """What a run has written: what `wingcrack.Run` is, but for drawing it.

    Parameters
    ----------
    directory : Path
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory

    def __repr__(self) -> str:
        """Folder and status."""
        return f"<wingcrack.Run {str(self.directory)!r}: {self.status}>"

    def _repr_html_(self) -> str:
        """Name, end, sizes and warnings, as a notebook shows a run."""
        record = self.record
        facts = {
            "scene": html.escape(self.name),
            "status": html.escape(self.status),
            "reason": html.escape(self.reason),
            "steps": record.get("steps", ""),
            "cells": record.get("cells", ""),
            "fracture cells": record.get("fracture_cells", ""),
            "CPU time": f"{record['cpu_s']:.3g} s" if "cpu_s" in record else "",
            "warnings": "<br>".join(map(html.escape, self.warnings)) or "none",
        }
        rows = "".join(
            f"<tr><th>{name}</th><td>{value}</td></tr>"
            for name, value in facts.items()
            if value != ""
        )
        return f"<table><caption>{html.escape(str(self.directory))}</caption>{rows}</table>"

    def refresh(self) -> Self:
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

        A run that was killed leaves no run.json, and 'running' for good.
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
    def entries(self) -> pandas.DataFrame:
        """Flow, share and pressure of each entry of the wells that have several, or a loss."""
        return self._frame("entries")

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
            history, tips, fractures, probes, wells, entries, events or slip_events.

        Raises
        ------
        AbsentError
            If the run has no such table.
        RunError
            If the table has no such column, or is damaged.
        """
        return column(self.table(table), name)

    def error(self, name: str, table: str = "history") -> npt.NDArray[Any] | None:
        """Estimated errors of a column, as an array.

        `None` if none is stated for it in this table (docs/output.md has the reasons), or if the
        run has no such column. Values of -1, where a run has no estimate, are NaN.

        Parameters
        ----------
        name : str
            Of the column whose errors are wanted, as ``max_slip_m``.
        table : str
            As for `column`.
        """
        wanted = error_column(f"{table}.csv", name)
        if wanted is None or not self.table(table).has(wanted):
            return None
        errors = self.column(wanted, table)
        if errors.dtype.kind != "f":
            return errors
        return np.where(errors < 0.0, np.nan, errors)

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

    # Network, fields

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

    @property
    def _scene_file(self) -> Path:
        """The file of the scene as understood, every default written out.

        Raises
        ------
        AbsentError
            If the run has written none.
        """
        path = self.directory / "scene.nml"
        if not path.is_file():
            raise AbsentError(f"{self.directory} has no scene.nml")
        return path

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

    def mesh(self, time: float | None = None) -> pyvista.UnstructuredGrid:
        """Rock in the written state nearest to a time as a grid of pyvista, with all its fields.

        Parameters
        ----------
        time : float or None
            As for `fields`.

        Raises
        ------
        AbsentError
            If no state is written.
        EnvironmentLacksError
            If pyvista is not installed.
        """
        try:
            import pyvista
        except ImportError as reason:
            raise EnvironmentLacksError(f"meshes need pyvista ({reason})") from None
        if not self._matrix:
            raise AbsentError(f"{self.directory} has no fields (VTU output off?)")
        state = self._matrix[-1] if time is None else nearest(self._matrix, time)
        return pyvista.UnstructuredGrid(str(state.path))

    def to_xarray(self) -> xarray.Dataset:
        """Histories of run, wells and probes as a dataset of xarray, units in the attributes.

        The coordinate is the time [s], or without a fluid the row (a load may fall), with the load
        factor as a variable. Columns of wells.csv, `wells_` before their names, have a
        dimension for the wells.

        Raises
        ------
        EnvironmentLacksError
            If xarray is not installed.
        """
        try:
            import xarray
        except ImportError as reason:
            raise EnvironmentLacksError(f"datasets need xarray ({reason})") from None
        clock = "time_s" if self.table("history").has("time_s") else "row"
        moments = self.moments if clock == "time_s" else np.arange(self.moments.size)
        tables = [self.table("history")]
        if (self.directory / "probes.csv").is_file():
            tables.append(self.table("probes"))
        variables = {
            name: ((clock,), column(table, name), {"units": column_unit(name)})
            for table in tables
            for name in table.cells
            if name != "time_s" and table.rows == moments.size
        }
        found = xarray.Dataset(variables, {clock: moments}, {"scene": self.name})
        if clock == "time_s" and (self.directory / "wells.csv").is_file():
            wells = self.wells.set_index(["time_s", "well"]).select_dtypes("number").to_xarray()
            for name in wells.data_vars:
                found[f"wells_{name}"] = wells[name].assign_attrs(units=column_unit(str(name)))
        return found

    @cached_property
    def equilibrium(self) -> EquilibriumPath:
        """The equilibrium path of length control, its unstable branches, the energy they release.

        Raises
        ------
        AbsentError
            If growth does not control the load, or nothing has grown.
        """
        from wingcrack.figures.equilibrium import equilibrium_path

        return equilibrium_path(self.files)

    # Inside

    @cached_property
    def files(self) -> Files:
        """The same folder as the drawing code of wingcrack.figures takes it.

        Raises
        ------
        RunError
            If no step has been accepted yet, or a file is damaged.
        """
        from wingcrack.figures.read import read_run

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
        from wingcrack.figures.read import optional_json

        return optional_json(self.directory / name)

    def _named(self) -> str:
        try:
            return str(SceneFile.read(self._scene_file)["scene.name"])
        except (AbsentError, SceneError):
            return self.directory.resolve().name


TEXTS = frozenset({"state", "kind", "detail", "ended_by", "well", "control"})
LABELS = frozenset({"fracture", "tip"})  # numbers, or names in files of earlier versions


def column(table: Table, name: str) -> npt.NDArray[Any]:
    """Give a column: whole numbers, numbers in the unit of its name, or text.

    Raises
    ------
    RunError
        If there is no such column, or it holds what is no number.
    """
    if name not in table.cells:
        near = difflib.get_close_matches(name, table.cells, n=1)
        hint = f"did you mean '{near[0]}'?" if near else f"it has {', '.join(table.cells)}"
        raise RunError(f"{table.path}: there is no column '{name}'; {hint}")
    text = table.text(name)
    if name in TEXTS:
        return text.copy()
    if text.size and np.all(np.char.isdecimal(text)) and np.char.str_len(text).max() < 19:
        return text.astype(np.int64)
    if name in LABELS and text.size:
        return text.copy()
    return table.number(name).copy()  # the user's own


def frame(table: Table) -> pandas.DataFrame:
    """Give a table as a pandas frame; ``frame.attrs["units"]`` tells the unit of each column.

    Raises
    ------
    EnvironmentLacksError
        If pandas is not installed.
    RunError
        If a column holds what is no number.
    """
    try:
        import pandas
    except ImportError as reason:
        raise EnvironmentLacksError(
            f"tables as frames need pandas ({reason}); run.column gives numpy arrays"
        ) from None
    found = pandas.DataFrame({name: column(table, name) for name in table.cells})
    found.attrs["units"] = {name: column_unit(name) for name in table.cells}
    found.attrs["file"] = str(table.path)
    return found
