"""Single panels of the house's figures, drawn into axes of the user's or new ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from wingcrack.errors import AbsentError, RunError
from wingcrack.figures import style
from wingcrack.figures.equilibrium_figure import AGAINST, draw_equilibrium
from wingcrack.figures.fields import FractureField
from wingcrack.figures.frames import (
    Frame,
    draw_field,
    draw_fractures,
    draw_fractures_by,
    extent,
    line_width,
    set_window,
    zoom_window,
)
from wingcrack.figures.history import INTENSITIES, draw_intensity, draw_states
from wingcrack.figures.load import abscissa, draw_load, moment_label
from wingcrack.figures.network import draw_network, grown_network
from wingcrack.figures.pressures import pressure_columns
from wingcrack.figures.profiles import draw_profile, fracture_labels, profile_columns
from wingcrack.figures.read import needed
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.story_map import draw_map
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import Unit, displacement_unit, length_unit, stress_unit
from wingcrack.figures.wells import MOST_WELLS, draw_well_flow, draw_well_pressure, well_rows
from wingcrack.runs.colours import colouring, rock_of, values_of
from wingcrack.runs.units import column_unit, column_words

if TYPE_CHECKING:
    from wingcrack.runs.results import Results

_MOST_ENTRIES = 8  # of a legend within the axes


def new_axes(ax: Axes | None) -> Axes:
    """Give the user's axes, or those of a new figure in the common style."""
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.figure(figsize=(style.SINGLE_COLUMN + 1.5, 3.4)).add_subplot()


@style.styled
def plot_history(run: Results, column: str | None, ax: Axes | None, **look: Any) -> Axes:
    """Draw a column of the history."""
    name = column or default_column(run)
    values = _numbers(run, name)
    axes = new_axes(ax)
    unit = fitting_unit(name, values)
    draw_history(axes, run, name, unit, **look)
    draw_band(axes, run, name, unit)
    axes.set_ylabel(f"{column_words(name)} [{unit.name}]")
    return axes


def default_column(run: Results) -> str:
    """What a run is about: the pressure of its first well, else the length of its fractures."""
    columns = list(pressure_columns(run.table("history")).values())
    return columns[0] if columns else "fracture_length_m"


def draw_history(axes: Axes, run: Results, column: str, unit: Unit, **look: Any) -> None:
    """Draw a column against time, or load, in a given unit."""
    values = _numbers(run, column)
    time, below = abscissa(run.files, run.moments)
    look = {"color": style.CYCLE[0], "marker": style.lone_marker(time.size), **look}
    axes.plot(time, unit.of(values), **look)
    axes.set_xlabel(below)


def draw_band(axes: Axes, run: Results, column: str, unit: Unit) -> None:
    """Draw the estimated error of a column of the history as a band, where it is stated."""
    errors = run.error(column)
    if errors is None:
        return
    values = _numbers(run, column)
    time, _ = abscissa(run.files, run.moments)
    low, high = unit.of(values - errors), unit.of(values + errors)
    axes.fill_between(time, low, high, color=axes.lines[-1].get_color(), alpha=0.2, linewidth=0)


def fitting_unit(column: str, *values: FloatArray) -> Unit:
    """Unit in which the values of a column read well."""
    name = column_unit(column)
    if name == "Pa":
        return stress_unit(*values)
    if name == "m":
        lengths = "length" in column
        return length_unit(*values) if lengths else displacement_unit(*values)
    return Unit(name, 1.0)


def _numbers(run: Results, column: str) -> FloatArray:
    values = run.column(column)
    if values.size == 0:
        raise AbsentError(f"{run.directory}: history.csv has no rows yet")
    if values.dtype.kind not in "if":
        raise RunError(f"history.csv: the column '{column}' contains text and cannot be plotted")
    return values.astype(np.float64)


@style.styled
def plot_tips(run: Results, quantity: str, ax: Axes | None) -> Axes:
    """Draw a stress intensity factor of every tip."""
    _choose("quantity", quantity, INTENSITIES)
    needed(run.files.tips, "tips.csv", "stress intensity factors")
    axes = new_axes(ax)
    _legend(axes, draw_intensity(axes, run.files, quantity))
    return axes


@style.styled
def plot_network(run: Results, colour: str, ax: Axes | None) -> Axes:
    """Draw the network at the end."""
    _choose("colour", colour, ("growth", "state"))
    files = run.files
    growths = grown_network(files)
    assert files.network is not None
    if colour == "state":
        cells = needed(files.fractures, "fractures.csv", "the states of the fractures")
        axes = new_axes(ax)
        handles = draw_map(axes, files, cells)
    else:
        axes = new_axes(ax)
        handles = draw_network(axes, growths, files.network, files.history, files.scene)
    _legend(axes, handles)
    return axes


@style.styled
def plot_map(
    run: Results,
    field: str,
    time: float | None,
    ax: Axes | None,
    *,
    close: bool,
    fractures_by: str = "state",
) -> Axes:
    """Draw a field of the rock, with the fractures by state or by a value of their cells."""
    _choose("fractures_by", fractures_by, ("state", "slip", "opening", "aperture"))
    found = run.fields(time)
    look = colouring(map(run.fields, run.field_moments), field)
    values = look.unit.of(values_of(found, field))
    axes = new_axes(ax)
    matrix = rock_of(found)
    fractures = FractureField(
        found.segments,
        np.asarray(found.fractures.get("state", ()), dtype=np.int64),
        dict(found.fractures),
    )
    frame = Frame(found.moment, found.history_row, matrix, fractures)
    body = extent([matrix])
    zoom = zoom_window(body, [fractures])
    unit = run_length_unit(run.files)
    draw_field(axes, frame, values, look.norm, look.colours, unit)
    width = line_width(run.files, 2.2 if close or zoom is None else 1.0)
    if fractures_by == "state":
        draw_fractures(axes, fractures, width, unit)
    elif len(fractures.segments):
        _draw_by(axes, fractures, fractures_by, width, unit)
    set_window(axes, zoom if close and zoom is not None else body, unit)
    axes.set(
        title=moment_label(run.files, found.moment, found.history_row),
        xlabel=f"$x$ [{unit.name}]",
        ylabel=f"$y$ [{unit.name}]",
    )
    bar = axes.figure.colorbar(
        ScalarMappable(look.norm, look.colours), ax=axes, aspect=30, pad=0.03
    )
    bar.set_label(look.label)
    return axes


def _draw_by(axes: Axes, fractures: FractureField, name: str, width: float, unit: Unit) -> None:
    """Draw fractures by a value of their cells, with its colours below the map."""
    values = fractures.of(name)
    fitting = displacement_unit(values)
    norm = Normalize(0.0, float(fitting.of(values).max()) or 1.0)
    draw_fractures_by(axes, fractures, fitting.of(values), norm, width, unit)
    scale = ScalarMappable(norm, style.JUMP_COLOURS)
    bar = axes.figure.colorbar(scale, ax=axes, orientation="horizontal", aspect=30, shrink=0.8)
    bar.set_label(f"{name} [{fitting.name}]")


@style.styled
def plot_profile(
    run: Results, column: str, fracture: str | int, times: Sequence[float], ax: Axes | None
) -> Axes:
    """Draw a column of fractures.csv along a fracture."""
    table = needed(run.files.fractures, "fractures.csv", "the state along fractures")
    _choose("column", column, profile_columns(table))
    labels = fracture_labels(table)
    names = {run.files.fracture_name(label): label for label in labels}
    label = str(fracture) if str(fracture) in labels else names.get(str(fracture))
    if label is None:
        raise RunError(f"there is no fracture '{fracture}'; the run has {', '.join(names)}")
    axes = new_axes(ax)
    handles = draw_profile(axes, run.files, column, label, times)
    _legend(axes, handles)
    return axes


@style.styled
def plot_wells(run: Results, quantity: str, ax: Axes | None) -> Axes:
    """Draw pressure or flow of each well."""
    draws: dict[str, tuple[Callable[..., None], str]] = {
        "pressure": (draw_well_pressure, "pressure [MPa]"),
        "flow": (draw_well_flow, "flow [m²/s]"),
    }
    _choose("quantity", quantity, tuple(draws))
    table = needed(run.files.wells, "wells.csv", "what each well did")
    axes = new_axes(ax)
    draw, label = draws[quantity]
    for index, name, rows in well_rows(table):
        time, below = abscissa(run.files, table.moments()[rows])
        before = len(axes.lines)
        draw(axes, table, rows, time, style.CYCLE[index % MOST_WELLS])
        axes.lines[before].set_label(name)
    axes.set(xlabel=below, ylabel=label)
    axes.legend()
    return axes


@style.styled
def plot_states(run: Results, ax: Axes | None) -> Axes:
    """Draw how many fracture cells stick, slip and are open."""
    files = run.files
    axes = new_axes(ax)
    draw_states(axes, files)
    return axes


@style.styled
def plot_load(run: Results, ax: Axes | None) -> Axes:
    """Draw the load factor against length."""
    files = run.files
    if not files.history.has("load_factor"):
        raise AbsentError("no load factor drives the run")
    axes = new_axes(ax)
    draw_load(axes, files)
    return axes


@style.styled
def plot_equilibrium(run: Results, against: str, ax: Axes | None) -> Axes:
    """Draw the equilibrium path of length control."""
    _choose("against", against, AGAINST)
    axes = new_axes(ax)
    draw_equilibrium(axes, run.files, against)
    axes.legend()
    return axes


def _choose(what: str, given: str, known: Sequence[str]) -> None:
    if given not in known:
        raise RunError(f"{what} '{given}' cannot be drawn; there are {', '.join(known)}")


def _legend(axes: Axes, handles: Sequence[Artist]) -> None:
    """Put a legend into the axes, or below them where it is long."""
    if not handles:
        return
    entries = list(handles)
    if len(entries) <= _MOST_ENTRIES:
        axes.legend(handles=entries, loc="best", fontsize=6)
    else:
        axes.legend(handles=entries, loc="upper left", bbox_to_anchor=(1.02, 1.0), fontsize=6)
