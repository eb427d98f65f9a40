"""What each well did in each stage, as a table to report: report.csv and part of the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from wingcrack.figures.read import Run
from wingcrack.figures.slip import seismic
from wingcrack.figures.table import FloatArray, Table
from wingcrack.figures.text_files import write_whole
from wingcrack.figures.wells import Rows, well_rows

NAME = "report.csv"
_NEEDED = ("stage", "control", "rate_m2_s", "pressure_pa", "injectivity_m2_s_pa")
_COUNTED = {"growth_events": ("growth", "growth_onset", "growth_jump"), "joints": ("joint",)}
_LENGTHS = ("fracture_length_m", "stimulated_length_m", "connected_length_m")

Cell = float | int | str


def report_rows(run: Run) -> list[dict[str, Cell]]:
    """Give a row for each well and stage; stage 0 is the time before its first and after its last.

    Pressures are those in fracture or rock at the well; volumes and events are those of the stage,
    lengths and injectivity are at its end.

    None of a run without wells, or of a version that wrote less about them.
    """
    table = run.wells
    if table is None or table.rows == 0 or not table.has(*_NEEDED):
        return []
    rows = []
    for _, well, of_well in well_rows(table):
        stages = table.text("stage")[of_well]
        first = 0 if of_well.size == 1 else 1  # the row of the initial state has no stage yet
        edges = first + 1 + np.flatnonzero(stages[first + 1 :] != stages[first:-1])
        begins, ends = [first, *edges.tolist()], [*edges.tolist(), of_well.size]
        for begin, end in zip(begins, ends, strict=True):
            before = of_well[max(begin - 1, 0)]
            rows.append(_stage_row(run, table, well, before, of_well[begin:end]))
    return rows


def _stage_row(run: Run, table: Table, well: str, before: int, rows: Rows) -> dict[str, Cell]:
    """One stage: `before` is the row in which it begins, `rows` are its states."""
    time, pressure = table.moments(), table.number("pressure_pa")
    last = rows[-1]
    highest = int(rows[np.argmax(pressure[rows])])
    flowed = np.diff(time[[before, *rows]]) * table.number("rate_m2_s")[rows]
    row: dict[str, Cell] = {
        "well": well,
        "stage": int(table.text("stage")[last]),
        "controls": " ".join(dict.fromkeys(table.text("control")[rows].tolist())),
        "begin_s": float(time[before]),
        "end_s": float(time[last]),
        "pressure_at_begin_pa": float(pressure[before]),
        "pressure_at_end_pa": float(pressure[last]),
        "pressure_at_end_error_pa": _error(table, "pressure_error_pa", last),
        "highest_pressure_pa": float(pressure[highest]),
        "highest_pressure_error_pa": _error(table, "pressure_error_pa", highest),
        "highest_pressure_time_s": float(time[highest]),
        "injected_m2": float(np.sum(flowed[flowed > 0.0])),
        "produced_m2": float(np.sum(np.abs(flowed[flowed < 0.0]))),
        "injected_m3": 0.0,
        "produced_m3": 0.0,
        "injectivity_m2_s_pa": float(table.number("injectivity_m2_s_pa")[last]),
        "injectivity_error_m2_s_pa": _error(table, "injectivity_error_m2_s_pa", last),
    }
    for kind in ("injected", "produced"):
        row[f"{kind}_m3"] = run.thickness_m * float(row[f"{kind}_m2"])
    moments = run.history.moments()
    at = int(np.argmin(np.abs(moments - time[last])))
    for name in _LENGTHS:
        if run.history.has(name):
            row[name] = float(run.history.number(name)[at])
    return row | _events(run, float(time[before]), float(time[last]))


def _error(table: Table, column: str, row: int) -> Cell:
    """Stated error; an empty cell where there is none."""
    value = float(table.number(column)[row]) if table.has(column) else -1.0
    return value if value >= 0.0 else ""


def _events(run: Run, begin: float, end: float) -> dict[str, Cell]:
    """Events of the whole network between two times, the second included."""
    found: dict[str, Cell] = {}
    if run.events is not None:
        kinds = run.events.text("kind")[_within(run.events.moments(), begin, end)]
        for name, counted in _COUNTED.items():
            found[name] = int(np.isin(kinds, counted).sum())
    if run.slip_events is not None:
        inside = _within(run.slip_events.moments(), begin, end)
        fast = seismic(run.slip_events)[inside]
        found["seismic_events"] = int(fast.sum())
        found["aseismic_slips"] = int((~fast).sum())
    return found


def _within(time: FloatArray, begin: float, end: float) -> np.ndarray:
    inside: np.ndarray = (time > begin) & (time <= end)
    return inside


def write_report(rows: Sequence[Mapping[str, Cell]], folder: Path) -> list[Path]:
    """Write the table into a folder; give its file, or nothing where there are no rows."""
    if not rows:
        return []
    lines = [",".join(rows[0]), *(",".join(str(cell) for cell in row.values()) for row in rows)]
    folder.mkdir(parents=True, exist_ok=True)
    return [write_whole(folder / NAME, "\n".join(lines) + "\n")]
