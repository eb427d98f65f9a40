"""Which figures a study asks for."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.sweeps.fields import Fields
from wingcrack.sweeps.selection import Selection, read_selection

KINDS = ("lines", "over", "band", "histogram")


@dataclass(frozen=True)
class Plot:
    """One ``[[figure]]``."""

    # "lines" of all runs, a quantity "over" a parameter, the "band" of quantiles of lines, or the
    # "histogram" of a quantity
    kind: str
    name: str  # stem of its files
    title: str
    x_label: str
    y_label: str
    by: tuple[str, ...]  # parameters that tell lines apart; empty for all that differ
    x_log: bool
    y_log: bool
    equal_axes: bool
    selection: Selection | None = None  # for lines and bands: what is read from each run
    # quantity, over: for the others: the quantity, and the parameter or quantity that it is drawn
    # over
    quantity: str | None = None
    over: str | None = None


def read_plot(data: Any, place: str) -> Plot:
    """Read one ``[[figure]]``.

    Raises `CaseError` if a key is missing, unknown or not for this kind.
    """
    fields = Fields(data, place)
    name = fields.text("name")
    if not re.fullmatch(r"[A-Za-z0-9_-]+", name):
        raise CaseError(f"{place}: '{name}' must be letters, digits, _ and -: it names a file")
    fields.place = f"{place} ('{name}')"
    kind = fields.choice("kind", KINDS)
    lines = kind in ("lines", "band")
    selection = quantity = over = None
    if not lines:
        quantity = fields.text("quantity")
        over = fields.text("over") if kind == "over" else None
    plot = Plot(
        kind=kind,
        name=name,
        title=fields.text("title", ""),
        x_label=fields.text("x_label") if lines else fields.text("x_label", ""),
        y_label=fields.text("y_label") if lines else fields.text("y_label", ""),
        by=fields.texts("by", ()) if kind in ("lines", "over") else (),
        x_log=fields.flag("x_log"),
        y_log=fields.flag("y_log"),
        equal_axes=fields.flag("equal_axes"),
        selection=selection,
        quantity=quantity,
        over=over,
    )
    if lines:
        selection = read_selection(fields, fields.text("file"))
        if selection.x is None:
            raise CaseError(f"{fields.place}: 'x' is missing: lines need a column for it")
        plot = Plot(**{**vars(plot), "selection": selection})
    fields.done()
    return plot
