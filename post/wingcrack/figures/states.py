"""The states of a run: when growth began, and which of the written ones a figure shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wingcrack.errors import RunError
from wingcrack.figures.durations import moment_of
from wingcrack.figures.pressures import well_pressures
from wingcrack.figures.read import Run
from wingcrack.figures.table import FloatArray
from wingcrack.figures.vtu import IntArray

_GROWTH = ("growth", "unstable_growth")  # kinds of events
_LONGER = 1.0 + 1.0e-9
_SHORT = 0.5  # share of the regular step below which a step is a short one


def growth_start(run: Run) -> float | None:
    """Moment at which tips first advanced; None without growth.

    A row of history.csv holds the state before the growth that follows it, so the first longer row
    comes one state after that moment.
    """
    if run.events is not None and run.events.rows:
        grown = np.flatnonzero(np.isin(run.events.text("kind"), _GROWTH))
        if grown.size:
            return float(run.events.moments()[grown[0]])
    if not run.history.has("fracture_length_m"):
        return None
    length = run.history.number("fracture_length_m")
    longer = np.flatnonzero(length > length[0] * _LONGER)
    return float(run.history.moments()[longer[0] - 1]) if longer.size else None


def grows(run: Run) -> bool:
    """Whether tips have advanced."""
    return growth_start(run) is not None


def slips_or_opens(run: Run) -> bool:
    """Whether a fracture cell slips or is open in some state; True where the files do not tell."""
    counts = [run.history.number(name) for name in ("n_slip", "n_open") if run.history.has(name)]
    return not counts or bool(np.any(counts))


def select_states(
    run: Run,
    written: Sequence[float] | FloatArray,
    count: int,
    wanted: Sequence[float] = (),
    *,
    rows: Sequence[int | None] = (),
    since_growth: bool = False,
) -> list[int]:
    """Choose some of the written states and give their places in `written`, in order.

    `rows` are their rows of history.csv, from 0, where known.

    With `wanted` these are the states nearest to those moments. Without, they are the first one,
    the one in which growth began, states of equally spaced fracture length, the one with the
    highest well pressure, and the last one; without growth, states at equal distances from the
    start of the injection on. Short steps that follow growth are passed over: in them the fracture
    has not come to rest. With `since_growth` states before growth are taken only where there are
    too few others.
    """
    moments = np.asarray(written, dtype=float)
    if moments.size == 0:
        raise RunError(f"{run.directory}: no fields are written yet.")
    if len(wanted):
        return sorted({int(np.argmin(np.abs(moments - moment_of(moment)))) for moment in wanted})
    in_history = _history_rows(run, moments, rows)
    places = np.flatnonzero(_settled(run, in_history))
    begun = _begun(run, in_history[places])
    if since_growth and begun is not None:
        skipped = max(0, min(begun, places.size - count))
        places, begun = places[skipped:], begun - skipped
    if begun == places.size - 1:
        begun = None  # nothing between it and the last state
    values = _spacing(run, in_history[places], begun)
    chosen = _spread(values, begun or 0, count)
    chosen = _with_peak(run, in_history[places], chosen, begun)
    return [int(places[index]) for index in _filled(chosen, places.size, count)]


def last_settled(run: Run, written: Sequence[float], rows: Sequence[int | None] = ()) -> int:
    """Place of the last written state that is not in a short step after growth."""
    in_history = _history_rows(run, np.asarray(written, dtype=float), rows)
    return int(np.flatnonzero(_settled(run, in_history))[-1])


def settled_rows(run: Run) -> IntArray:
    """Rows of history.csv but those of the short steps that follow growth."""
    return np.flatnonzero(_settled(run, np.arange(run.history.rows)))


def _history_rows(run: Run, written: FloatArray, told: Sequence[int | None] = ()) -> IntArray:
    """Row of history.csv of each written state, as the files tell it.

    Files of earlier versions do not. Several rows can share a moment (a load under which growth
    goes on by itself); the last written state is then the last of them, the one before it an
    earlier one.
    """
    moments = run.history.moments()
    known = [row for row in told if row is not None and row < moments.size]
    if known and len(known) == written.size:
        return np.array(known, dtype=np.int64)
    rows = np.zeros(written.size, dtype=np.int64)
    bound = moments.size
    for place in reversed(range(written.size)):
        distance = np.abs(moments[:bound] - written[place])
        rows[place] = np.flatnonzero(distance == distance.min())[-1]
        bound = max(1, int(rows[place]))
    return rows


def _settled(run: Run, rows: IntArray) -> IntArray:
    """Whether each state is the first one or none of the short steps that follow growth."""
    history = run.history
    settled = np.ones(rows.size, dtype=np.int64)
    if history.has("load_factor") or not history.has("dt_s", "fracture_length_m"):
        return settled
    steps, length = history.number("dt_s"), history.number("fracture_length_m")
    if run.scene and run.scene.chosen_steps:
        return settled  # steps follow from their error: short ones are as good as long ones
    regular = (run.scene.step_s if run.scene else None) or float(steps.max())
    full = steps >= _SHORT * regular
    for place, row in enumerate(rows):
        before = np.flatnonzero(full[: row + 1])
        base = length[before[-1]] if before.size else length[0]
        settled[place] = int(full[row] or length[row] <= base * _LONGER)
    settled[0] = 1
    return settled


def _begun(run: Run, rows: IntArray) -> int | None:
    """Which of the states is the first at or after the moment of growth; None without growth."""
    start = growth_start(run)
    if start is None:
        return None
    row = int(np.argmin(np.abs(run.history.moments() - start)))
    later = np.flatnonzero(rows >= row)
    return int(later[0]) if later.size else None


def _spacing(run: Run, rows: IntArray, begun: int | None) -> FloatArray:
    """What is equally spaced: lengths where fractures grow, else the moments."""
    if begun is not None:
        return run.history.number("fracture_length_m")[rows]
    moments = run.history.moments()[rows]
    if np.any(np.diff(moments) < 0.0):  # a load that falls
        return np.arange(rows.size, dtype=float)
    wells = run.scene.wells if run.scene else ()
    if not run.history.has("injected_m2") or not wells:
        return moments
    # nothing happens before the well starts: its time counts as none
    start = min(well.start_s for well in wells)
    return np.maximum(moments, start) if start < moments[-1] else moments


def _spread(values: FloatArray, begun: int, count: int) -> list[int]:
    """The first state, and equally spaced ones from `begun` to the last."""
    later = values[begun:]
    number = count - 1 if begun > 0 else count
    steps = np.linspace(later[0], later[-1], number)
    if np.all(np.diff(later) >= 0.0) and begun > 0:
        # lengths never shrink: the first state that reaches each
        reached = np.searchsorted(later, steps * (1.0 - 1e-12))
    else:
        reached = np.array([int(np.argmin(np.abs(later - step))) for step in steps])
    inner = np.minimum(reached, later.size - 1)[:-1] + begun
    return sorted({0, *(int(index) for index in inner), values.size - 1})


def _with_peak(run: Run, rows: IntArray, chosen: list[int], begun: int | None) -> list[int]:
    """Replace the state nearest to the highest well pressure by that with the highest."""
    pressures = well_pressures(run.history)
    if not pressures:
        return chosen
    peak = int(np.argmax(np.max(list(pressures.values()), axis=0)[rows]))
    free = [index for index in chosen if index not in (0, begun, rows.size - 1)]
    if peak in chosen or not free:
        return sorted({*chosen, peak}) if peak in chosen or len(chosen) < 3 else chosen
    nearest = min(free, key=lambda index: abs(index - peak))
    return sorted({*chosen, peak} - {nearest})


def _filled(chosen: list[int], size: int, count: int) -> list[int]:
    """Add the states farthest from all chosen ones until there are enough."""
    taken = set(chosen)
    while len(taken) < min(count, size):
        rest = (index for index in range(size) if index not in taken)
        taken.add(max(rest, key=lambda index: min(abs(index - other) for other in taken)))
    return sorted(taken)
