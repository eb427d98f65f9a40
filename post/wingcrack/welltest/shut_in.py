"""Shut-ins of a record: lines of flow regimes, instantaneous shut-in pressure, closure."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from wingcrack.figures.table import FloatArray
from wingcrack.welltest.curves import derivative, g_function, g_rate
from wingcrack.welltest.record import Record

SHUT = 0.01  # of the largest rate: a well with less is shut in
_LAST = 0.1  # share of the time of injection whose mean rate is the last rate
FEWEST = 5  # rows of a fall-off and of a line
# Largest over smallest derivative along a line, with the least ratio of times at its ends; the
# first pair with a line counts.
FLAT = ((1.02, 10.0), (1.05, 10.0), (1.1, 10.0), (1.02, 3.0), (1.05, 5.0))
COMPLIANCE_RISE = 1.1  # dp/dG over its minimum at contact (McClure et al., SPE J. 21 (2016) 1302)
TANGENT_DROP = 0.95  # G dp/dG over its tangent through the origin at closure (Barree)
RESPONSES: dict[str, Callable[[FloatArray], FloatArray]] = {"linear": np.sqrt, "radial": np.log}
EARLIEST = 0.01  # of the time of injection: no pick before
_ISIP = (0.001, 0.1)  # of the time of injection: rows extrapolated to the shut-in
_FEWEST_ISIP = 6  # rows of this extrapolation
SMOOTHING = 0.1  # of derivatives, in natural logarithms


@dataclass(frozen=True)
class FallOff:
    """Pressure of a well after a shut-in, and the injection before it.

    The time of injection is that of material balance: volume over the last rate.
    """

    well: str
    number: int  # from 1
    start: float  # time of the shut-in [s]
    injection: float  # time of injection [s]
    volume: float  # injected since the shut-in before [m2 or m3]
    rate: float  # mean of the last tenth of the time of injection [m2/s or m3/s]
    rates: FloatArray  # (changes) rate after each change over `rate`, from the start of the record
    changes: FloatArray  # (changes) time of each [s]
    since: FloatArray  # (rows) time since the shut-in, above 0 [s]
    pressure: FloatArray  # (rows) [Pa]
    pressure_error: FloatArray  # (rows) [Pa]
    pressure_before: float  # at the shut-in [Pa]
    open_cells: FloatArray | None  # (rows) open fracture cells
    open_before: float  # open fracture cells at the shut-in
    has_losses: bool  # whether losses of the well are part of the pressure

    def superposition(self, regime: str) -> FloatArray:
        """Sum the responses to all changes of the rate before and at the shut-in, (rows).

        The response of the pressure to a unit rate is sqrt(t) in the linear regime, ln(t) in the
        radial one, t the time since a change [s].
        """
        steps = np.diff(self.rates, prepend=0.0)
        elapsed = self.start + self.since[:, None] - self.changes[None, :]
        return RESPONSES[regime](elapsed) @ steps


@dataclass(frozen=True)
class Line:
    """Straight line of the pressure against the superposed response of a flow regime."""

    regime: str  # linear (into the faces of fractures) or radial
    begin: float  # time since the shut-in [s]
    end: float
    slope: float  # [Pa] per unit of the superposed response
    slope_error: float
    pressure: float  # at response 0: of the reservoir [Pa]
    pressure_error: float


@dataclass(frozen=True)
class Pick:
    """A closure by one of the usual methods, or as the run has it."""

    method: str  # tangent, compliance, root, first cell or last cell
    since: float  # time since the shut-in [s]
    pressure: float  # [Pa]


def fall_offs(record: Record) -> Iterator[FallOff]:
    """Give the fall-offs of a record that have at least `FEWEST` rows."""
    if not np.any(record.rate > 0.0):
        return
    flows = record.rate > SHUT * np.max(record.rate)
    shut = np.abs(record.rate) <= SHUT * np.max(record.rate)
    steps = np.diff(record.time)
    volumes = np.append(0.0, np.cumsum(steps * record.rate[1:]))
    kept = np.flatnonzero(np.diff(record.rate[1:], prepend=0.0) != 0.0)
    earlier, number = 0, 0
    # A rate is that of the time before its row: that of the first row is of no time.
    for last in (1 + np.flatnonzero(flows[1:-1] & shut[2:])).tolist():
        behind, start = last + 1, float(record.time[last])
        open_again = np.flatnonzero(~shut[behind:])
        end = behind + int(open_again[0]) if open_again.size else shut.size
        volume = float(volumes[last] - volumes[earlier])
        lately = _LAST * (start - float(record.time[earlier]))
        rate = (volumes[last] - np.interp(start - lately, record.time, volumes)) / lately
        if end - behind >= FEWEST and volume > 0.0 and rate > 0.0:
            number += 1
            before = kept[kept < last]
            yield FallOff(
                well=record.well,
                number=number,
                start=start,
                injection=volume / rate,
                volume=volume,
                rate=float(rate),
                rates=np.append(record.rate[1:][before] / rate, 0.0),
                changes=np.append(record.time[before], start),
                since=record.time[behind:end] - start,
                pressure=record.pressure[behind:end],
                pressure_error=record.pressure_error[behind:end],
                pressure_before=float(record.pressure[last]),
                open_cells=None if record.open_cells is None else record.open_cells[behind:end],
                has_losses=record.has_losses,
                open_before=0.0 if record.open_cells is None else float(record.open_cells[last]),
            )
        earlier = end - 1


def lines(fall: FallOff) -> list[Line]:
    """Give the lines of the flow regimes that are there, each the longest of its kind.

    A regime is there where the pressure's derivative by its superposed response is even, as `FLAT`
    says.
    """
    found = []
    log_time = np.log(fall.since)
    for regime in RESPONSES:
        place = fall.superposition(regime)
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = derivative(log_time, fall.pressure, SMOOTHING) / derivative(
                log_time, place, SMOOTHING
            )
        even = (_longest_even(log_time, slope, flat, np.log(span)) for flat, span in FLAT)
        rows = next((rows for rows in even if rows is not None), None)
        if rows is not None:
            found.append(_line(regime, fall, place, rows))
    return found


def _longest_even(place: FloatArray, value: FloatArray, flat: float, span: float) -> slice | None:
    """Give the longest interval of `place`, of `span` at least, with `value` even within `flat`."""
    best, longest = None, span
    for first in range(value.size - FEWEST + 1):
        if not value[first] > 0.0:
            continue
        with np.errstate(invalid="ignore"):
            low = np.minimum.accumulate(value[first:])
            even = np.maximum.accumulate(value[first:]) <= flat * low
        even &= low > 0.0
        count = even.size if np.all(even) else int(np.argmin(even))
        if count >= FEWEST and place[first + count - 1] - place[first] > longest:
            longest = place[first + count - 1] - place[first]
            best = slice(first, first + count)
    return best


def _line(regime: str, fall: FallOff, place: FloatArray, rows: slice) -> Line:
    """Fit a line; its error: of the fit, between its halves, and of the pressures.

    Stated errors of the pressures change slowly with time: a line is fitted to them as well.
    """
    x, y = place[rows], fall.pressure[rows]
    (slope, pressure), covariance = np.polyfit(x, y, 1, cov=True)
    middle = x.size // 2
    halves = [np.polyfit(x[part], y[part], 1) for part in (slice(middle + 1), slice(middle, None))]
    curved = np.ptp(halves, axis=0)
    stated = np.abs(np.polyfit(x, fall.pressure_error[rows], 1))
    errors = np.sqrt(np.diag(covariance)) + curved + stated
    return Line(
        regime=regime,
        begin=float(fall.since[rows][0]),
        end=float(fall.since[rows][-1]),
        slope=float(slope),
        slope_error=float(errors[0]),
        pressure=float(pressure),
        pressure_error=float(errors[1]),
    )


def instantaneous_pressure(fall: FallOff) -> tuple[float, float]:
    """Instantaneous shut-in pressure with its error [Pa]: extrapolated to the shut-in.

    A parabola in the square root of the time since then is fitted to the rows within 0.1 to 10 % of
    the time of injection; of fewer than six it is the pressure of the first row. Error: the change
    without the later half of the rows, also with a straight line, or where losses of the well are
    no part of the pressure the difference to that before the shut-in, and the estimated error of
    the pressures.
    """
    ratio = fall.since / fall.injection
    rows = np.flatnonzero((ratio >= _ISIP[0]) & (ratio <= _ISIP[1]))
    first = float(fall.pressure[0])
    if rows.size < _FEWEST_ISIP:
        return first, abs(fall.pressure_before - first) + float(fall.pressure_error[0])
    place = np.sqrt(fall.since)
    nearer = rows[: (rows.size + 1) // 2]
    pressure, *others = (
        float(np.polyfit(place[part], fall.pressure[part], degree)[degree])
        for part, degree in ((rows, 2), (nearer, 2), (nearer, 1))
    )
    spread = max(abs(pressure - other) for other in others)
    if not fall.has_losses:
        spread = max(spread, abs(pressure - fall.pressure_before))
    return pressure, spread + float(np.max(fall.pressure_error[rows]))


def picks(fall: FallOff) -> list[Pick]:
    """Give the closures by the usual picks.

    tangent: G dp/dG leaves its tangent through the origin by 5 %, where it has one; compliance:
    dp/dG is 10 % above its minimum; root: the steepest place against the square root of time.
    """
    slope = diagnostic(fall)["g_slope"]
    rows = np.flatnonzero(np.isfinite(slope) & (fall.since >= EARLIEST * fall.injection))
    if rows.size < FEWEST:
        return []
    slope = slope[rows]
    found = []
    steepest = int(np.argmax(slope))
    below = np.flatnonzero(slope[steepest:] < TANGENT_DROP * slope[steepest])
    if steepest and below.size:
        found.append(_pick("tangent", fall, rows[steepest + int(below[0])]))
    least = int(np.argmin(slope[: steepest + 1]))
    above = np.flatnonzero(slope[least : steepest + 1] > COMPLIANCE_RISE * slope[least])
    if above.size:
        found.append(_pick("compliance", fall, rows[least + int(above[0])]))
    by_root = slope * g_rate(fall.since[rows], fall.injection) * np.sqrt(fall.since[rows])
    top = int(np.argmax(by_root))
    if 0 < top < rows.size - 1:
        found.append(_pick("root", fall, rows[top]))
    return found


def closures(fall: FallOff) -> list[Pick]:
    """Give the true closure of a run: its first and last open fracture cell that closes."""
    cells = fall.open_cells
    if cells is None or fall.open_before <= 0.0:
        return []
    found = []
    for method, closed in (("first cell", cells < fall.open_before), ("last cell", cells <= 0.0)):
        if np.any(closed):
            found.append(_pick(method, fall, int(np.argmax(closed))))
    return found


def _pick(method: str, fall: FallOff, row: int) -> Pick:
    return Pick(method, float(fall.since[row]), float(fall.pressure[row]))


def diagnostic(fall: FallOff) -> dict[str, FloatArray]:
    """Give the curves of a fall-off: times, drop of pressure, and the usual derivatives.

    `bourdet`: dp/dln(dt tp/(tp + dt)) [Pa]; `g`: the G-function; `g_slope`: dp/dG [Pa].
    """
    slope = -derivative(np.log(fall.since), fall.pressure, SMOOTHING)
    g = g_function(fall.since, fall.injection)
    return {
        "since": fall.since,
        "drop": fall.pressure_before - fall.pressure,
        "bourdet": slope * (1.0 + fall.since / fall.injection),
        "g": g,
        "g_slope": slope / (fall.since * g_rate(fall.since, fall.injection)),
    }
