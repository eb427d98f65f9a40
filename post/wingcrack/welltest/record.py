"""Pressure and rate of a well against time, from a run or from a measured CSV file."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wingcrack.errors import RunError
from wingcrack.figures.read import Run, needed
from wingcrack.figures.table import FloatArray
from wingcrack.figures.wells import well_rows
from wingcrack.welltest.units import UNITS


@dataclass(frozen=True)
class Record:
    """What a well did.

    The rate of a row is the mean since the row before, as in wells.csv; positive: injection.
    """

    well: str
    time: FloatArray  # [s], increasing
    pressure: FloatArray  # [Pa]
    rate: FloatArray  # [m2/s], or of a measured record [m3/s]
    pressure_error: FloatArray  # estimated errors [Pa]; 0 where none are known
    has_losses: bool  # whether losses of the well are part of the pressure
    open_cells: FloatArray | None = None  # number of open fracture cells at these times


def records_of_run(run: Run) -> list[Record]:
    """Give the records of all wells of a run, in the order of wells.csv.

    Raises `AbsentError` if the run has no wells.
    """
    table = needed(run.wells, "wells.csv", "what each well did")
    history = run.history
    records = []
    for _, name, rows in well_rows(table):
        time = table.moments()[rows]
        error = (
            np.maximum(table.number("pressure_error_pa")[rows], 0.0)
            if table.has("pressure_error_pa")
            else np.zeros_like(time)
        )
        records.append(
            Record(
                well=name,
                time=time,
                pressure=table.number("pressure_pa")[rows],
                rate=table.number("rate_m2_s")[rows],
                pressure_error=error,
                has_losses=False,
                open_cells=np.interp(time, history.moments(), history.number("n_open")),
            )
        )
    return records


def read_record(path: Path, columns: Mapping[str, tuple[str, str]]) -> Record:
    """Read a measured record: a CSV file with commas, semicolons or tabs, decimal commas or points.

    Raises `RunError` with file, line and reason.
    """
    text = path.read_text(encoding="utf-8-sig")
    delimiter = max(";\t,", key=text.partition("\n")[0].count)
    rows = list(csv.reader(text.splitlines(), delimiter=delimiter))
    header = [cell.strip() for cell in rows[0]] if rows else []
    places = {}
    for quantity, (name, _) in columns.items():
        if name not in header:
            raise RunError(f"{path}: there is no column '{name}' (there are: {', '.join(header)})")
        places[quantity] = header.index(name)
    values: dict[str, list[float]] = {quantity: [] for quantity in columns}
    for line, row in enumerate(rows[1:], start=2):
        if not any(cell.strip() for cell in row):
            continue
        for quantity, place in places.items():
            cell = row[place].strip() if place < len(row) else ""
            try:
                number = float(cell.replace(",", ".") if delimiter != "," else cell)
            except ValueError:
                number = np.nan
            if not np.isfinite(number):
                raise RunError(f"{path}:{line}: {header[place]} is '{cell}', no number")
            values[quantity].append(number * UNITS[quantity][columns[quantity][1]])
    time = np.array(values["time"])
    if time.size < 2 or np.any(np.diff(time) <= 0.0):
        late = 3 + int(np.argmax(np.diff(time) <= 0.0)) if time.size > 1 else len(rows)
        raise RunError(f"{path}:{late}: times must increase, over two rows at least")
    return Record(
        well=path.stem,
        time=time,
        pressure=np.array(values["pressure"]),
        rate=np.array(values["rate"]),
        pressure_error=np.zeros_like(time),
        has_losses=True,
    )
