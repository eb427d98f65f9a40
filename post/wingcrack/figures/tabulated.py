"""Runs of one state: tables, where curves would be single dots on empty axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from wingcrack.figures import style
from wingcrack.figures.load import has_load
from wingcrack.figures.pressures import well_pressures
from wingcrack.figures.read import Run, needed
from wingcrack.figures.scales import jump_scale, run_length_unit, without_round_off
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import MEGAPASCAL, Unit, displacement_unit, intensity_unit, stress_unit

_ROW = 0.2  # [inch]
_LINE = 0.16  # [inch] of a remark


def table_figure(
    title: str, head: Sequence[str], rows: Sequence[Sequence[str]], remarks: Sequence[str] = ()
) -> Figure:
    """Draw a table with thin rules, as papers have it, and remarks below."""
    lines = len(rows) + 1
    figure = style.new_figure(
        style.DOUBLE_COLUMN if len(head) > 3 else style.SINGLE_COLUMN,
        0.35 + _ROW * lines + _LINE * len(remarks),
    )
    axes = figure.add_subplot()
    axes.set_title(title)
    axes.set_axis_off()
    table = axes.table(
        [list(row) for row in rows],
        colLabels=list(head),
        cellLoc="center",
        bbox=Bbox.unit(),
        edges="horizontal",
    )
    table.auto_set_font_size(False)
    table.set_fontsize(7)
    for cell in table.get_celld().values():
        cell.set_linewidth(0.4)
    if remarks:
        figure.supxlabel("\n".join(remarks), fontsize=7, x=0.02, ha="left")
    return figure


def intensities_table(run: Run) -> Figure:
    """Stress intensities of every tip, also divided by what makes them numbers.

    These are sigma sqrt(pi a) with the scene's load sigma and half the fracture's length (the
    whole, where it has one tip) for a, and the toughness, as far as the scene tells them.
    """
    table = needed(run.tips, "tips.csv", "stress intensity factors")
    columns = ("k1_pa_sqrtm", "k2_pa_sqrtm", "k1_dc_pa_sqrtm", "k2_dc_pa_sqrtm", "keq_pa_sqrtm")
    values = {name: table.number(name) for name in columns}
    unit = intensity_unit(*values.values())
    head = ["tip", r"$K_\mathrm{I}$", r"$K_\mathrm{II}$", r"$K_\mathrm{I}$ (DC)"]
    head += [r"$K_\mathrm{II}$ (DC)", r"$K_\mathrm{eq}$"]
    parts = [unit.of(value) for value in values.values()]
    remarks = [f"$K$ in {unit.name}, by the interaction integral; DC: by displacement correlation"]
    norm, remark = _load_intensity(run)
    if norm is not None:
        head += [r"$K_\mathrm{I}/K_0$", r"$K_\mathrm{II}/K_0$"]
        parts += [values["k1_pa_sqrtm"] / norm, values["k2_pa_sqrtm"] / norm]
        remarks.append(remark)
    toughness = run.scene.toughness_pa_sqrtm if run.scene else None
    if toughness:
        head.append(r"$K_\mathrm{eq}/K_\mathrm{IC}$")
        parts.append(values["keq_pa_sqrtm"] / toughness)
        remarks.append(rf"$K_\mathrm{{IC}}$ = {float(unit.of(toughness)):.4g} {unit.name}")
    tips, fractures = table.text("tip"), table.text("fracture")
    rows = [
        [f"{tip} ({run.fracture_name(str(fracture))})", *(f"{part[k]:.4g}" for part in parts)]
        for k, (tip, fracture) in enumerate(zip(tips, fractures, strict=True))
    ]
    return table_figure(f"stress intensities{_when(run)}", head, rows, remarks)


def state_table(run: Run) -> Figure:
    """What curves of the development would begin with."""
    history = run.history
    length_unit = run_length_unit(run)
    length = history.number("fracture_length_m")
    scale = jump_scale(run)
    slip = without_round_off(history.number("max_slip_m"), scale)
    opening = without_round_off(history.number("max_opening_m"), scale)
    unit = displacement_unit(slip, opening)
    entries: list[tuple[str, FloatArray, Unit]] = [
        ("total fracture length", length, length_unit),
        ("largest slip", slip, unit),
        ("largest opening", opening, unit),
    ]
    for name, pressure in well_pressures(history).items():
        entries.append((f"well pressure {name}".rstrip(), pressure, MEGAPASCAL))
    rows = [[name, f"{float(u.of(value)[0]):.5g}", u.name] for name, value, u in entries]
    for state in style.STATES:
        rows.append([f"cells that {_VERBS[state]}", f"{history.number(f'n_{state}')[0]:.0f}", "-"])
    return table_figure(f"the only state{_when(run)}", ["quantity", "value", "unit"], rows)


_VERBS = {"stick": "stick", "slip": "slip", "open": "are open"}


def _when(run: Run) -> str:
    if not has_load(run):
        return ""
    return f", load factor {run.history.number('load_factor')[0]:.4g}"


def _load_intensity(run: Run) -> tuple[FloatArray | None, str]:
    """K_0 = sigma sqrt(pi a) of each tip [Pa m^1/2] with the load sigma, and how it is made."""
    table, scene = needed(run.tips, "tips.csv", "stress intensity factors"), run.scene
    network = (run.network or {}).get("fractures", [])
    if scene is None or scene.load_pa is None or not has_load(run):
        return None, ""
    owners = table.text("fracture")
    sizes: dict[str, float] = {}
    for fracture in network:
        points = np.column_stack((fracture["x_m"], fracture["y_m"])).astype(float)
        label = str(fracture["fracture"])
        tips = int(np.sum(owners == label))
        whole = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        sizes[label] = whole / tips if tips else whole
    if any(str(owner) not in sizes for owner in owners):
        return None, ""
    stress = scene.load_pa * float(run.history.number("load_factor")[0])
    if stress == 0.0:
        return None, ""
    unit, length = stress_unit(stress), run_length_unit(run)
    half = np.array([sizes[str(owner)] for owner in owners])
    spread = " to ".join(f"{value:.4g}" for value in sorted({*length.of([half.min(), half.max()])}))
    remark = (
        rf"$K_0 = \sigma\sqrt{{\pi a}}$, $\sigma$: {scene.load_name}, "
        rf"{float(unit.of(stress)):.4g} {unit.name}; $a$ = {spread} {length.name}"
    )
    return stress * np.sqrt(np.pi * half), remark
