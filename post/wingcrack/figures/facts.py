"""The run in words and numbers, for its page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wingcrack.figures.load import abscissa, has_load
from wingcrack.figures.pressures import highest_pressures, pumped_volumes
from wingcrack.figures.read import Run
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.slip import slip_words
from wingcrack.figures.units import MEGAPASCAL, displacement_unit, stress_unit, volume_unit

_MOST_WELLS = 4  # with a line of their own, those with the highest pressures


@dataclass(frozen=True)
class Facts:
    """What a page says about a run."""

    # title, status, ended: what the scene is called; 'finished', 'stopped', 'failed' or 'running';
    # how it ended
    title: str
    status: str
    ended: str
    # results, errors, warnings, left_out, used: lines of text
    results: list[str]
    errors: list[str]
    warnings: list[str]
    left_out: list[str]
    used: list[str]

    def left(self) -> list[str]:
        """Results and their errors."""
        return [*self.results, "", *self.errors]

    def right(self, marks: Sequence[str] = ()) -> list[str]:
        """Events, warnings and what the run did without."""
        warned = [f"! {text}" for text in self.warnings] or ["no warnings"]
        left = [f"- {text}" for text in self.left_out]
        parts = [list(marks), warned, ["left out:", *left] if left else []]
        lines: list[str] = []
        for part in parts:
            lines += [*([""] if lines and part else []), *part]
        return lines


def gather_facts(run: Run) -> Facts:
    """Collect what a page says; a run that goes on has no record yet."""
    record = run.record or {}
    title = (run.scene.title if run.scene else "") or run.name
    status = str(record.get("status", "running"))
    reason = str(record.get("reason", ""))
    ended = f"{status}: {reason}" if reason else status
    if not record:
        ended = "running, or killed: there is no run.json"
    return Facts(
        title=title if run.name in title else f"{run.name}: {title}",
        status=status,
        ended=ended,
        results=_results(run),
        errors=_errors(run),
        warnings=_texts(record.get("warnings")),
        left_out=_texts(record.get("left_out")),
        used=_texts(record.get("used")),
    )


def _texts(found: object) -> list[str]:
    return [str(text) for text in found] if isinstance(found, list) else []


def _results(run: Run) -> list[str]:
    history, record = run.history, run.record or {}
    moments, below = abscissa(run, history.moments())
    name, _, unit = below.partition(" [")
    unit = unit.strip("-]")
    lines = [f"{name} at the end: {moments[-1]:.4g} {unit}".rstrip()]
    lines[0] += f" after {history.rows} state{'s' if history.rows != 1 else ''}"
    if "cells" in record:
        cells = f"{record['cells']} cells"
        if "fracture_cells" in record:
            cells += f", {record['fracture_cells']} of fractures"
        lines.append(cells)
    for name, row, highest_pa in highest_pressures(history)[:_MOST_WELLS]:
        of_well = f"highest pressure of {name}" if name else "highest well pressure"
        shown = float(MEGAPASCAL.of(highest_pa))
        lines.append(f"{of_well}: {shown:.4g} MPa at {moments[row]:.3g} {unit}")
    if has_load(run):
        highest = int(np.argmax(moments))
        lines.append(f"highest load factor: {moments[highest]:.4g} in state {highest + 1}")
    if history.has("injected_m2"):
        injected, produced = pumped_volumes(run)
        size = volume_unit(run.thickness_m, injected, produced)
        line = f"injected: {float(size.of(injected)):.3g} {size.name}"
        if produced > 0.0:
            line += f", produced: {float(size.of(produced)):.3g} {size.name}"
        elif injected > 0.0 and history.has("leakoff_m2"):
            line += f", leaked off {100.0 * history.number('leakoff_m2')[-1] / injected:z.0f} %"
        lines.append(line)
    return [*lines, *_of_fractures(run), *slip_words(run)]


def _of_fractures(run: Run) -> list[str]:
    history, record = run.history, run.record or {}
    lines = []
    if history.has("fracture_length_m"):
        unit = run_length_unit(run)
        length = unit.of(history.number("fracture_length_m"))
        lines.append(
            f"length of fractures: {length[0]:.4g} {unit.name} at first,"
            f" {length[-1]:.4g} {unit.name} at the end"
        )
    for column, what in (("max_slip_m", "slip"), ("max_opening_m", "opening")):
        if history.has(column):
            value = float(np.nanmax(history.number(column)))
            fitting = displacement_unit(value)
            lines.append(f"largest {what}: {float(fitting.of(value)):.3g} {fitting.name}")
    ratio = record.get("keq_over_kic")
    if isinstance(ratio, int | float):
        lines.append(rf"largest $K_\mathrm{{eq}}/K_\mathrm{{IC}}$ of a state: {ratio:.4g}")
    joints = [
        joint
        for joint in (run.network or {}).get("joints", [])
        if float(joint.get("time_s", joint.get("load_factor", 0.0))) > 0.0
    ]
    if joints:
        lines.append(f"places where fractures have met since the start: {len(joints)}")
    return lines


def _errors(run: Run) -> list[str]:
    history, record = run.history, run.record or {}
    lines = []
    for key, what in (
        ("mass_error_relative", "mass error, relative"),
        ("contact_residual", "residual of contact, relative"),
        ("forward_error_bound", "bound of the solver's error"),
        ("energy_error_relative", "estimated error of the energy, relative"),
    ):
        value = record.get(key)
        if isinstance(value, int | float) and not (has_load(run) and key.startswith("mass")):
            lines.append(f"{what}: {value:.1e}")
    for column, what in (
        ("fracture_length_error_m", "estimated error of the length"),
        ("well_pressure_error_pa", "estimated error of the pressure"),
    ):
        if history.has(column):
            values = history.number(column)
            if np.any(np.isfinite(values)):
                largest = float(np.nanmax(values))
                unit = run_length_unit(run) if column.endswith("_m") else stress_unit(largest)
                lines.append(f"{what}, largest: {float(unit.of(largest)):.2g} {unit.name}")
    lines += _of_intensities(run)
    if record.get("step_cuts"):
        lines.append(f"steps that were cut: {record['step_cuts']}")
    return ["errors:", *(f"- {line}" for line in lines)] if lines else ["no errors are known yet"]


def _of_intensities(run: Run) -> list[str]:
    """Estimated error of K at the end, in the share of K_eq there."""
    table = run.tips
    names = ("k1_error_pa_sqrtm", "k2_error_pa_sqrtm")
    if table is None or table.rows == 0 or not table.has(*names):
        return []
    last = table.moments() == table.moments()[-1]
    largest = float(np.nanmax(np.abs(table.number("keq_pa_sqrtm")[last]), initial=0.0))
    errors = np.concatenate([table.number(name)[last] for name in names])
    if largest == 0.0 or not np.any(np.isfinite(errors)):
        return []
    share = 100.0 * float(np.nanmax(errors)) / largest
    return [f"estimated error of K at the end: {share:.2g} % of the largest"]
