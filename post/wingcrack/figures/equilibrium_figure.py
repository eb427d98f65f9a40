"""Figure of the equilibrium path: load factor against length, opening and conjugate quantity."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.equilibrium import EquilibriumPath, Release, equilibrium_path
from wingcrack.figures.load import LOAD_LABEL
from wingcrack.figures.read import Run
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.table import BoolArray, FloatArray
from wingcrack.figures.units import displacement_unit

AGAINST = ("length", "opening", "conjugate")

_STABLE, _UNSTABLE, _RELEASED = style.CYCLE[0], style.CYCLE[1], style.CYCLE[5]
_HELD: dict[str, Any] = {"color": "#555555", "linestyle": ":", "linewidth": 0.9}
_SHEAR = 1.0e-3  # share of the slip below which opening says nothing


@style.styled
def equilibrium_figure(run: Run) -> Figure:
    """Load factor against length, against opening, and against what is conjugate to it.

    Raises `AbsentError` if the run is not one in length control, or nothing has grown.
    """
    path = equilibrium_path(run)
    shown = AGAINST if path.conjugate_j_m is not None else AGAINST[:2]
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.7)
    panels = np.atleast_1d(figure.subplots(1, len(shown), sharey=True))
    for axes, against in zip(panels, shown, strict=True):
        draw_equilibrium(axes, run, against)
        if axes is not panels[0]:
            axes.set_ylabel("")
    panels[0].legend(loc="best")
    style.letter(list(panels))
    return figure


def draw_equilibrium(axes: Axes, run: Run, against: str = "length") -> None:
    """Draw the path with its branches, and the energy where it is an area, into axes.

    Raises `AbsentError` if the run is not one in length control, nothing has grown, or 'conjugate'
    is wanted of a load that is not in proportion to its factor.
    """
    path = equilibrium_path(run)
    if against == "conjugate" and path.conjugate_j_m is None:
        raise AbsentError("not all of the load is in proportion to its factor")
    abscissa, label, title = _abscissa(run, path, against)
    for pieces, colour, dashes, name in (
        (~path.unstable, _STABLE, "-", "stable"),
        (path.unstable, _UNSTABLE, "--", "unstable"),
    ):
        x, y = _pieces(abscissa, path.factor, pieces)
        if x.size:
            axes.plot(x, y, color=colour, linestyle=dashes, marker=".", markersize=2, label=name)
    for release in path.releases:
        _draw_release(
            axes,
            path,
            abscissa,
            release,
            is_area=against == "conjugate",
            is_told=against == ("length" if path.conjugate_j_m is None else "conjugate"),
        )
    if path.releases:
        axes.plot([], [], label="a load that stays", **_HELD)
    axes.set(title=title, xlabel=label, ylabel=LOAD_LABEL)


def _abscissa(run: Run, path: EquilibriumPath, against: str) -> tuple[FloatArray, str, str]:
    """What the factor is drawn against, how its axis is called, and the panel."""
    if against == "length":
        unit = run_length_unit(run)
        return unit.of(path.length_m), f"total length [{unit.name}]", "length"
    if against == "opening":
        slips = path.opening_m.max() < _SHEAR * path.slip_m.max()
        values = path.slip_m if slips else path.opening_m
        unit = displacement_unit(values)
        name = "largest slip" if slips else "mean opening"
        return unit.of(values), f"{name} [{unit.name}]", "slip" if slips else "opening"
    if against == "conjugate" and path.conjugate_j_m is not None:
        what = "displacement" if path.under_forces else "force"
        return path.conjugate_j_m, f"conjugate {what} $2U/f$ [J/m]", "released energy"
    raise ValueError(f"against must be one of {', '.join(AGAINST)}, not {against!r}")


def _pieces(x: FloatArray, y: FloatArray, wanted: BoolArray) -> tuple[FloatArray, FloatArray]:
    """The wanted pieces of a line, with gaps between them."""
    ends = np.flatnonzero(wanted)
    gaps = np.full(ends.size, np.nan)
    return (
        np.column_stack((x[ends], x[ends + 1], gaps)).ravel(),
        np.column_stack((y[ends], y[ends + 1], gaps)).ravel(),
    )


def _draw_release(
    axes: Axes,
    path: EquilibriumPath,
    abscissa: FloatArray,
    release: Release,
    *,
    is_area: bool,
    is_told: bool,
) -> None:
    """Draw the way of a load that stays, with the energy, in the plane of work as an area."""
    along = np.array([*range(release.first, release.last), release.last - 1 + release.share])
    places = np.arange(abscissa.size)
    x, y = np.interp(along, places, abscissa), np.interp(along, places, path.factor)
    if is_area:
        # where the path does not come back, the body is loaded on along its last straight line
        end = x[-1] * release.factor / y[-1]
        axes.fill(
            [*x, end], [*y, release.factor], color=_RELEASED, alpha=0.35, linewidth=0, zorder=0.5
        )
    else:
        end = x[-1]
    if is_told and release.energy_j_m is not None:
        axes.annotate(
            f"{release.energy_j_m:.3g} J/m",
            (0.5 * (x[0] + end) if is_area else end, release.factor),
            xytext=(0, 3) if is_area else (5, -2),
            textcoords="offset points",
            ha="center" if is_area else "left",
            va="bottom" if is_area else "top",
            fontsize=7,
        )
    axes.plot([x[0], end], [release.factor] * 2, **_HELD)
    axes.plot([x[0]], [release.factor], color=_UNSTABLE, marker="o", markersize=3, linestyle="")
    if release.arrests:
        axes.plot([end], [release.factor], color=_STABLE, marker="s", markersize=3, linestyle="")
