"""Numbers that a study reads from the files of each run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.studies.outputs import select_in_run
from wingcrack.studies.units import column_name
from wingcrack.sweeps.fields import Fields
from wingcrack.sweeps.selection import Selection, read_selection


@dataclass(frozen=True)
class Quantity:
    """One number per run."""

    # name, unit: as figures and the table have it
    name: str
    unit: str
    selection: Selection  # where it stands in the files of a run
    # whether it is no fault if no row or file is there: wings that have not grown have no onset
    may_be_absent: bool

    @property
    def column(self) -> str:
        """Its column in the table."""
        return column_name(self.name, self.unit)


def read_quantity(data: Any, place: str) -> Quantity:
    """Read one ``[[quantity]]``.

    Raises `CaseError` if it selects a whole profile, or is wrong in another way.
    """
    fields = Fields(data, place)
    name = fields.text("name")
    fields.place = f"{place} ('{name}')"
    unit, absent = fields.text("unit"), fields.flag("may_be_absent")
    selection = read_selection(fields, fields.text("file"))
    fields.done()
    one = selection.take or selection.interpolate or selection.single_row or selection.key
    if not one or len(selection.columns) > 1:
        raise CaseError(f"{fields.place}: one value is needed: 'take', 'at', 'interpolate', 'key'")
    return Quantity(name, unit, selection, absent)


def measure(
    quantity: Quantity, output: Path, constants: Mapping[str, float]
) -> tuple[float | None, str]:
    """Value of a quantity of a run, or None with the reason why there is none."""
    try:
        found = select_in_run(quantity.selection, output, constants)
    except CaseError as reason:
        absent = (": no row where" in str(reason)) or (": the file is missing" in str(reason))
        if quantity.may_be_absent and absent:
            return None, ""
        return None, f"{quantity.name}: {reason}"
    return float(found.values[0]), ""
