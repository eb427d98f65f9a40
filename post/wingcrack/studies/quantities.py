"""Numbers that a study reads from the files of each run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Self

from pydantic import model_validator

from wingcrack.errors import CaseError
from wingcrack.studies.outputs import select_in_run
from wingcrack.studies.units import column_name
from wingcrack.sweeps.fields import Text
from wingcrack.sweeps.selection import Selection


class Quantity(Selection):
    """One number per run, and where it stands in the files of a run."""

    name: Text
    unit: Text
    # no fault if no row or file is there: wings that have not grown have no onset
    may_be_absent: bool = False

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        one = self.take or self.interpolate or self.at or self.key
        if not one or len(self.columns) > 1:
            raise ValueError("one value is needed: 'take', 'at', 'interpolate', 'key'")
        return self

    @property
    def heading(self) -> str:
        """Its column in the table."""
        return column_name(self.name, self.unit)


def measure(
    quantity: Quantity, output: Path, constants: Mapping[str, float]
) -> tuple[float | None, str]:
    """Value of a quantity of a run, or None with the reason why there is none."""
    try:
        found = select_in_run(quantity, output, constants)
    except CaseError as reason:
        absent = (": no row where" in str(reason)) or (": the file is missing" in str(reason))
        if quantity.may_be_absent and absent:
            return None, ""
        return None, f"{quantity.name}: {reason}"
    return float(found.values[0]), ""
