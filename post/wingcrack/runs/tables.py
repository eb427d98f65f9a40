"""Tables of a run as pandas frames, and their columns as numpy arrays."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from wingcrack.errors import EnvironmentLacksError, RunError
from wingcrack.figures.table import Table
from wingcrack.runs.units import column_unit

if TYPE_CHECKING:
    import pandas

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
