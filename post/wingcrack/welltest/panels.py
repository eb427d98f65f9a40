"""Figure of a shut-in: four panels, as well tests are read."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wingcrack.figures import style
from wingcrack.figures.units import MEGAPASCAL
from wingcrack.welltest.curves import g_function
from wingcrack.welltest.results import Cell
from wingcrack.welltest.shut_in import EARLIEST, FallOff, Line, diagnostic, lines

_PICKS = {  # of the columns closure_..._s: label and colour
    "tangent": ("closure, tangent", style.CYCLE[1]),
    "compliance": ("closure, compliance", style.CYCLE[2]),
    "root": ("closure, root of time", style.CYCLE[3]),
    "first_cell": ("first cell closes", style.CYCLE[4]),
    "last_cell": ("last cell closes", style.CYCLE[5]),
}
_LINES = {"linear": style.CYCLE[2], "radial": style.CYCLE[3]}


@style.styled
def shut_in_panels(fall: FallOff, row: dict[str, Cell]) -> Figure:
    """Pressure and shut-in pressure; Bourdet's derivative; G-function; the longest line."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 5.2)
    panels = list(figure.subplots(2, 2).flat)
    curves = diagnostic(fall)
    found = lines(fall)
    _draw_pressure(panels[0], fall, row)
    _draw_derivative(panels[1], curves["since"], curves["drop"], curves["bourdet"], found)
    _draw_g(panels[2], fall, row, curves["g"], curves["g"] * curves["g_slope"])
    _draw_line(panels[3], fall, found)
    style.letter(panels)
    figure.suptitle(f"{fall.well}, shut-in {fall.number}", fontsize=9)
    return figure


def _draw_pressure(axes: Axes, fall: FallOff, row: dict[str, Cell]) -> None:
    axes.semilogx(fall.since, MEGAPASCAL.of(fall.pressure), color=style.CYCLE[0])
    axes.axhline(1e-6 * float(row["isip_pa"] or 0.0), color="#555555", ls="--", label="ISIP")
    for name, (label, colour) in _PICKS.items():
        since, at = row[f"closure_{name}_s"], row[f"closure_{name}_pa"]
        if since is not None and at is not None:
            axes.plot(float(since), 1e-6 * float(at), "o", color=colour, label=label)
    axes.set(
        title="pressure after the shut-in",
        xlabel="time since the shut-in [s]",
        ylabel="pressure [MPa]",
    )
    axes.legend()


def _draw_derivative(
    axes: Axes, since: np.ndarray, drop: np.ndarray, slope: np.ndarray, found: list[Line]
) -> None:
    shown = drop > 0.0
    axes.loglog(since[shown], MEGAPASCAL.of(drop[shown]), color=style.CYCLE[0], label="drop")
    shown = slope > 0.0
    axes.loglog(since[shown], MEGAPASCAL.of(slope[shown]), color=style.CYCLE[1], label="derivative")
    for line in found:
        axes.axvspan(line.begin, line.end, color=_LINES[line.regime], alpha=0.15, lw=0.0)
        axes.plot([], [], color=_LINES[line.regime], alpha=0.3, lw=6.0, label=f"{line.regime} flow")
    axes.set(
        title="drop of pressure and its derivative",
        xlabel="time since the shut-in [s]",
        ylabel="pressure [MPa]",
    )
    axes.legend()


def _draw_g(
    axes: Axes, fall: FallOff, row: dict[str, Cell], place: np.ndarray, value: np.ndarray
) -> None:
    axes.plot(place, MEGAPASCAL.of(value), color=style.CYCLE[0], label="G dp/dG")
    top = 1.1 * float(np.nanmax(value, initial=0.0))
    touching = row["closure_tangent_s"]
    if touching is not None:
        later = np.isfinite(value) & (fall.since < float(touching))
        slope = float(np.max((value / place)[later & (fall.since >= EARLIEST * fall.injection)]))
        axes.plot([0.0, top / slope], [0.0, 1e-6 * top], ":", color="#555555", label="tangent")
    for name, (label, colour) in _PICKS.items():
        since = row[f"closure_{name}_s"]
        if since is not None:
            at = float(g_function(np.array(float(since)), fall.injection))
            axes.axvline(at, color=colour, label=label)
    axes.set(
        title="G-function", xlabel="G [-]", ylabel="G dp/dG [MPa]", ylim=(0.0, 1e-6 * top or 1.0)
    )
    axes.legend()


def _draw_line(axes: Axes, fall: FallOff, found: list[Line]) -> None:
    longest = max(found, key=lambda line: line.end / line.begin, default=None)
    regime = longest.regime if longest else "linear"
    place = fall.superposition(regime)
    axes.plot(place, MEGAPASCAL.of(fall.pressure), ".-", color=style.CYCLE[0])
    if longest:
        ends = np.array([0.0, np.max(place[fall.since >= longest.begin])])
        line = MEGAPASCAL.of(longest.pressure + longest.slope * ends)
        axes.plot(ends, line, "--", color=style.CYCLE[1])
    label = {
        "linear": r"superposed $\sqrt{t}$ [$\sqrt{\mathrm{s}}$]",
        "radial": r"superposed $\ln t$ (Horner) [-]",
    }
    axes.set(title=f"{regime} flow", xlabel=label[regime], ylabel="pressure [MPa]")
