"""The table of a study: a row per run, as CSV and Parquet, and the statistics of draws."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from wingcrack.figures.text_files import write_whole
from wingcrack.runner.task import Outcome
from wingcrack.studies.quantities import measure
from wingcrack.studies.study import Study, StudyRun
from wingcrack.studies.units import spoken

Row: TypeAlias = dict[str, Any]

NOT_RUN = Outcome("", "not run", "", 0.0, 0.0)


@dataclass(frozen=True)
class StudyTable:
    """All rows with their columns in order, and the unit of each column that has one."""

    columns: tuple[str, ...]
    units: Mapping[str, str]
    rows: tuple[Row, ...]

    def numbers(self, column: str) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Values of a column; nan where there is none."""
        return np.array([_number(row[column]) for row in self.rows], dtype=np.float64)


def make_table(study: Study, outcomes: Mapping[int, Outcome], out: Path) -> StudyTable:
    """Read the quantities of all runs that finished, and put a row together for each run."""
    parameters = [parameter.heading for parameter in study.parameters]
    quantities = [quantity.heading for quantity in study.quantities]
    columns = ("run", "label", *parameters, "status", "reason", "cpu_s", "wall_s")
    units = {parameter.heading: parameter.unit for parameter in study.parameters}
    units |= {quantity.heading: quantity.unit for quantity in study.quantities}
    rows = tuple(_row(study, run, outcomes.get(run.number, NOT_RUN), out) for run in study.runs)
    return StudyTable(
        (*columns, *quantities, "folder"), units | {"cpu_s": "s", "wall_s": "s"}, rows
    )


def _row(study: Study, run: StudyRun, outcome: Outcome, out: Path) -> Row:
    reasons = [outcome.reason] if outcome.reason else []
    row: Row = {"run": run.number, "label": run.label}
    row |= {item.heading: run.values.get(item.name) for item in study.parameters}
    numbers: Row = {}
    for quantity in study.quantities:
        value, reason = None, ""
        if outcome.status == "finished":
            constants = {**study.constants, **run.constants}
            value, reason = measure(quantity, Path(outcome.folder) / "output", constants)
        numbers[quantity.heading] = value
        reasons += [reason] if reason else []
    row |= {"status": outcome.status, "reason": "; ".join(reasons)}
    row |= {"cpu_s": outcome.cpu_s, "wall_s": round(outcome.wall_s, 3)}
    folder = Path(outcome.folder) if outcome.folder else None
    within = folder is not None and folder.is_relative_to(out)
    return row | numbers | {"folder": str(folder.relative_to(out)) if folder and within else ""}


def write_csv(table: StudyTable, path: Path) -> None:
    """Write the table as CSV; what is not there is an empty cell."""
    rows = [[cell_text(row[column]) for column in table.columns] for row in table.rows]
    write_rows(path, table.columns, rows)


def write_parquet(table: StudyTable, csv_file: Path, path: Path) -> None:
    """Write the CSV file of the table as Parquet, with the units in the columns' metadata."""
    import pyarrow as pa
    from pyarrow import csv as arrow_csv
    from pyarrow import parquet

    kinds = {"flag": pa.bool_(), "text": pa.string(), "whole": pa.int64(), "number": pa.float64()}
    types = {name: kinds[_kind(name, table)] for name in table.columns}
    found = arrow_csv.read_csv(
        csv_file,
        parse_options=arrow_csv.ParseOptions(newlines_in_values=True),
        convert_options=arrow_csv.ConvertOptions(column_types=types, null_values=[""]),
    )
    fields = [
        pa.field(name, types[name], metadata=_metadata(table.units.get(name)))
        for name in table.columns
    ]
    content = io.BytesIO()
    parquet.write_table(found.cast(pa.schema(fields)), content)
    write_whole(path, content.getvalue())


def write_statistics(study: Study, table: StudyTable, path: Path) -> None:
    """Write mean, spread and quantiles of each quantity, over the runs that have it.

    Samples at several places of a grid have a row for each place.
    """
    names = [f"q{100.0 * share:g}" for share in study.quantiles]
    header = ["quantity", "runs", "absent", "mean", "standard_deviation", "min", *names, "max"]
    if len(study.places) > 1:
        header.append("place")
    rows = []
    for quantity in study.quantities:
        for place, of_place in study.places.items():
            values = table.numbers(quantity.heading)[of_place]
            finished = sum(table.rows[row]["status"] == "finished" for row in of_place)
            values = values[np.isfinite(values)]
            cells: list[Any] = [quantity.heading, values.size, finished - values.size]
            if values.size:
                spread = float(np.std(values, ddof=1)) if values.size > 1 else None
                quantiles = [float(value) for value in np.quantile(values, study.quantiles)]
                least, most = float(values.min()), float(values.max())
                cells += [float(values.mean()), spread, least, *quantiles, most]
            cells += [None] * (6 + len(names) + 1 - len(cells))
            rows.append([cell_text(cell) for cell in [*cells, place][: len(header)]])
    write_rows(path, header, rows)


def write_rows(path: Path, header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Write a CSV file that appears whole."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    write_whole(path, text.getvalue())


def cell_text(value: Any) -> str:
    """Text of a value in a table; empty where there is none."""
    if value is None:
        return ""
    return repr(value) if isinstance(value, float) else spoken(value)


def _kind(column: str, table: StudyTable) -> str:
    """What the values of a column are: all of them flags, whole numbers, numbers, or texts."""
    given = [row[column] for row in table.rows if row[column] is not None]
    if column in ("label", "status", "reason", "folder"):
        return "text"
    if given and all(isinstance(value, bool) for value in given):
        return "flag"
    if any(isinstance(value, bool) or not isinstance(value, int | float) for value in given):
        return "text"
    return "whole" if given and all(isinstance(value, int) for value in given) else "number"


def _metadata(unit: str | None) -> dict[str, str] | None:
    return {"unit": unit} if unit else None


def _number(value: Any) -> float:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number else float("nan")
