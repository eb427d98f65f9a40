"""Figures of a study, as its file asks for them."""

from __future__ import annotations

import re
from typing import Annotated, Any, Self

from pydantic import model_validator

from wingcrack.sweeps.fields import Entry, Text, Texts, choice
from wingcrack.sweeps.selection import Selection

# Kinds with the keys that each needs: lines of all runs, a quantity over a parameter, its
# difference from the extrapolated value, the band of quantiles of lines, the histogram of a
# quantity, the effect of each parameter on it.
_NEEDS = {
    "lines": ("x_label", "y_label"),
    "over": ("quantity", "over"),
    "convergence": ("quantity", "over"),
    "band": ("x_label", "y_label"),
    "histogram": ("quantity",),
    "tornado": ("quantity",),
}
_ONLY = {
    "by": ("lines", "over", "convergence"),
    "over": ("over", "convergence"),
    "quantity": ("over", "convergence", "histogram", "tornado"),
}


class Plot(Entry):
    """One ``[[figure]]``."""

    name: Text  # stem of its files
    kind: Annotated[str, choice(_NEEDS)]
    title: Text = ""
    x_label: Text = ""
    y_label: Text = ""
    by: Texts = ()  # parameters that tell lines apart; empty for all that differ
    x_log: bool = False
    y_log: bool = False
    equal_axes: bool = False
    selection: Selection | None = None  # what lines and bands read of each run
    quantity: Text | None = None
    over: Text | None = None  # the parameter or quantity that `quantity` is drawn over

    @model_validator(mode="before")
    @classmethod
    def _select(cls, data: Any) -> Any:
        """Put the keys of lines and bands that select in a table of their own."""
        if "selection" in data:
            raise ValueError("'selection' is unknown")
        if data.get("kind") not in ("lines", "band"):
            return data
        keys = data.keys() & Selection.model_fields.keys()
        rest = {key: value for key, value in data.items() if key not in keys}
        return {**rest, "selection": {key: data[key] for key in keys}}

    @model_validator(mode="after")
    def _judge(self) -> Self:
        if not re.fullmatch(r"[A-Za-z0-9_-]+", self.name):
            raise ValueError(f"'{self.name}' must be letters, digits, _ and -: it names a file")
        for key in _NEEDS[self.kind]:
            if not getattr(self, key):
                raise ValueError(f"'{key}' is missing")
        for key, kinds in _ONLY.items():
            if getattr(self, key) and self.kind not in kinds:
                raise ValueError(f"'{key}' is unknown in figures of the kind {self.kind}")
        if self.selection is not None and self.selection.x_column is None:
            raise ValueError("'x' is missing: lines need a column for it")
        return self
