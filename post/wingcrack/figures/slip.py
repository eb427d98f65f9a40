"""Slip events by kind: fast slip is seismic and has a magnitude, slow slip only a moment."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from wingcrack.figures.read import Run
from wingcrack.figures.table import BoolArray, Table
from wingcrack.figures.text_files import write_whole

SEISMIC_COLOUR, ASEISMIC_COLOUR = "#D55E00", "#777777"


def seismic(events: Table) -> BoolArray:
    """Which rows of slip_events.csv are seismic; none of a run that does not tell them apart."""
    kinds = events.text("kind" if events.has("kind") else "event")
    fast: BoolArray = kinds == "seismic"
    return fast


def has_seismic(run: Run) -> bool:
    """Whether a run has seismic events."""
    return run.slip_events is not None and bool(seismic(run.slip_events).any())


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


def write_points(run: Run, folder: Path) -> list[Path]:
    """Write all slip events as points for ParaView, with what is known of each; none without."""
    events = run.slip_events
    if events is None or events.rows == 0:
        return []
    fast = seismic(events)
    return [write_whole(folder / "slip_events.vtp", "\n".join(_points(events, fast)) + "\n")]


def _points(events: Table, fast: BoolArray) -> Iterator[str]:
    n = events.rows
    yield '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>'
    yield f'<Piece NumberOfPoints="{n}" NumberOfVerts="{n}"><Points>'
    yield '<DataArray type="Float64" NumberOfComponents="3" format="ascii">'
    places = zip(events.number("x_m"), events.number("y_m"), strict=True)
    yield from (f"{float(x)!r} {float(y)!r} 0" for x, y in places)
    yield '</DataArray></Points><Verts><DataArray type="Int64" Name="connectivity" format="ascii">'
    yield " ".join(map(str, range(n)))
    yield '</DataArray><DataArray type="Int64" Name="offsets" format="ascii">'
    yield " ".join(map(str, range(1, n + 1)))
    yield "</DataArray></Verts><PointData>"
    yield '<DataArray type="Int64" Name="seismic" format="ascii">'
    yield " ".join(str(int(kind)) for kind in fast)
    yield "</DataArray>"
    for name in ("time_s", "end_s", "moment_nm", "magnitude", "mean_slip_m", "stress_drop_pa"):
        if not events.has(name):
            continue
        values = events.number(name)
        if name == "magnitude":  # of seismic events alone
            values = np.where(fast, values, np.nan)
        yield f'<DataArray type="Float64" Name="{name}" format="ascii">'
        yield " ".join(repr(float(value)) for value in values)
        yield "</DataArray>"
    yield "</PointData></Piece></PolyData></VTKFile>"
