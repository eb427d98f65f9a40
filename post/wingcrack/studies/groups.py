"""Runs of a study that belong together, and what they and their numbers are called."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from wingcrack.errors import CaseError
from wingcrack.studies.plots import Plot
from wingcrack.studies.quantities import Quantity
from wingcrack.studies.study import Parameter, Study, StudyRun
from wingcrack.studies.table import StudyTable
from wingcrack.studies.units import NONE, axis_label, pretty_number, pretty_unit, spoken
from wingcrack.sweeps.expressions import Array


def grouped(
    study: Study, plot: Plot, table: StudyTable
) -> tuple[str, str, list[tuple[str, Array, Array]]]:
    """Labels of both axes, and for each value of the other parameters its name, x and y in order.

    Raises `CaseError` if no run has both numbers.
    """
    assert plot.over is not None and plot.quantity is not None
    x_column, x_label = column_of(study, plot.over)
    y_column, y_label = column_of(study, plot.quantity)
    x, y = table.numbers(x_column), table.numbers(y_column)
    kept = np.isfinite(x) & np.isfinite(y)
    if not kept.any():
        raise CaseError(f"figure '{plot.name}': no run has both numbers")
    others = [name for name in told_apart(study, plot) if name != plot.over]
    labels = np.array([label_of(run, others, study) for run in study.runs])
    groups = []
    for group in dict.fromkeys(labels[kept]):
        rows = np.flatnonzero(kept & (labels == group))
        rows = rows[np.argsort(x[rows], kind="stable")]
        groups.append((str(group), x[rows], y[rows]))
    return x_label, y_label, groups


def told_apart(study: Study, plot: Plot) -> list[str]:
    """Parameters that tell lines apart: those asked for, or all that differ."""
    if plot.by:
        return list(plot.by)
    if study.drawn:
        return []
    values: Mapping[str, set[str]] = {
        item.name: {spoken(run.values.get(item.name)) for run in study.runs}
        for item in study.parameters
    }
    return [name for name, found in values.items() if len(found) > 1]


def label_of(run: StudyRun, names: Sequence[str], study: Study) -> str:
    """Name of a run by some of its parameters, for a legend."""
    units = {parameter.name: parameter.unit for parameter in study.parameters}
    parts = []
    for name in names:
        if name in run.values:
            unit = "" if units[name] == NONE else f" {pretty_unit(units[name])}"
            said = name.split(".")[-1].replace("_", " ")
            parts.append(f"{said} {pretty_number(run.values[name])}{unit}")
    return ", ".join(parts)


def column_of(study: Study, name: str) -> tuple[str, str]:
    """Column of a quantity or parameter, and how an axis of it is called."""
    named: tuple[Quantity | Parameter, ...] = (*study.quantities, *study.parameters)
    for item in named:
        if item.name == name:
            return item.heading, axis_label(item.name, item.unit)
    raise CaseError(f"there is no quantity or parameter '{name}'")
