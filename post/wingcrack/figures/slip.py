"""Slip events by kind: fast slip is seismic and has a magnitude, slow slip only a moment."""

from __future__ import annotations

from wingcrack.figures.read import Run
from wingcrack.figures.table import BoolArray, Table

SEISMIC_COLOUR, ASEISMIC_COLOUR = "#D55E00", "#777777"


def seismic(events: Table) -> BoolArray:
    """Which rows of slip_events.csv are seismic; none of a run that does not tell them apart."""
    kinds = events.text("kind" if events.has("kind") else "event")
    fast: BoolArray = kinds == "seismic"
    return fast


def slip_words(run: Run) -> list[str]:
    """Number and size of the seismic events, and of the aseismic slip; nothing without slip."""
    events = run.slip_events
    if events is None or events.rows == 0:
        return []
    fast, lines = seismic(events), []
    if fast.any():
        largest = float(events.number("magnitude")[fast].max())
        plural = "s" if fast.sum() > 1 else ""
        lines.append(f"{fast.sum()} seismic event{plural}, largest $M_w$ = ${largest:.2f}$")
    if not fast.all():
        slow = ~fast
        moment = float(events.number("moment_nm")[slow].sum())
        plural = "s" if slow.sum() > 1 else ""
        lines.append(f"{slow.sum()} aseismic slip{plural}, moment {moment:.2g} N m")
    return lines
