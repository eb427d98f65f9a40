"""Analysis of shut-ins: closed forms of a fracture with leak-off and of a well in rock."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.special import erfcx, exp1

from wingcrack.errors import RunError
from wingcrack.figures.table import FloatArray
from wingcrack.welltest.panels import shut_in_panels
from wingcrack.welltest.record import Record, read_record
from wingcrack.welltest.results import Rock, evaluate
from wingcrack.welltest.shut_in import FallOff, closures, diagnostic, fall_offs, lines, picks
from wingcrack.welltest.units import read_columns

# W1: 20 m fracture of 0.2 mm, 600 s of injection; leak-off in one dimension on both faces.
_RATE, _PUMPED = 1.0e-6, 600.0
_PERMEABILITY, _VISCOSITY, _STORAGE = 1.0e-18, 3.0e-4, 2.2e-11
_LEAKOFF = 40.0 * np.sqrt(_PERMEABILITY * _STORAGE / _VISCOSITY)


def _closed_fracture(storage: float) -> Callable[[FloatArray], FloatArray]:
    """Rise by a constant rate into a store (fracture and wellbore) with leak-off [Pa]."""
    store = 20.0 * 2.0e-4 * 5.0e-10 + storage

    def rise(time: FloatArray) -> FloatArray:
        place = (_LEAKOFF / store) ** 2 * np.maximum(time, 0.0)
        root = np.sqrt(place)
        shape = erfcx(root) - 1.0 + 2.0 * root / np.sqrt(np.pi)
        return np.asarray(_RATE * store / _LEAKOFF**2 * shape, dtype=np.float64)

    return rise


def _record(rise: Callable[[FloatArray], FloatArray], pumped: float, rate: float) -> Record:
    """What a gauge would show: 61 rows of injection, 25 a decade to 1,000 times as long."""
    time = np.concatenate(
        [np.linspace(0.0, pumped, 61), pumped * (1.0 + np.geomspace(1.0e-4, 1.0e3, 176))]
    )
    pressure = rise(time) - np.where(time > pumped, rise(time - pumped), 0.0)
    rates = np.where((time > 0.0) & (time <= pumped), rate, 0.0)
    return Record("w", time, pressure, rates, np.zeros_like(time), has_losses=False)


def _fall(storage: float = 0.0) -> FallOff:
    (fall,) = fall_offs(_record(_closed_fracture(storage), _PUMPED, _RATE))
    return fall


def test_shut_in_is_found_with_volume_and_time_of_injection() -> None:
    fall = _fall()
    assert fall.start == _PUMPED
    assert fall.rate == pytest.approx(_RATE)
    assert fall.injection == pytest.approx(_PUMPED)
    assert fall.volume == pytest.approx(_RATE * _PUMPED)


def test_a_rate_in_the_first_row_is_of_no_time() -> None:
    """0/0 in random scene 1006."""
    time = np.arange(9.0)
    rate = np.where(time == 0.0, 1.0, 0.0)
    with np.errstate(all="raise"):
        assert not list(
            fall_offs(Record("w", time, 9.0 - time, rate, 0.0 * time, has_losses=False))
        )


@pytest.mark.parametrize(
    ("storage", "ratio", "bourdet", "g_slope"),
    [
        (0.0, 0.01, 115673.5055, None),
        (0.0, 0.1, 309863.4464, 312916.756),
        (0.0, 1.0, 747312.1926, None),
        (0.0, 3.0, 1184192.487, 442891.3328),
        (0.0, 10.0, 2065291.484, 313037.9329),
        (0.0, 100.0, 6394971.601, 118802.4818),
        (1e-10, 0.001, 4181.327545, None),
        (1e-10, 0.01, 33285.62168, 34079.19066),
        (1e-10, 0.3, 352068.266, 322940.9767),
        (1e-10, 10.0, 2023092.43, 306641.7876),
    ],
)
def test_derivatives_are_those_of_the_closed_form(
    storage: float, ratio: float, bourdet: float, g_slope: float | None
) -> None:
    """Within 1 %, with 25 rows a decade: the smoothing makes up to 0.5 % of it."""
    fall = _fall(storage)
    curves = diagnostic(fall)
    inside = np.isfinite(curves["bourdet"])
    at, places = np.log(ratio * _PUMPED), np.log(fall.since[inside])
    assert np.interp(at, places, curves["bourdet"][inside]) == pytest.approx(bourdet, rel=0.01)
    if g_slope is not None:
        slope = (curves["g"] * curves["g_slope"])[inside]
        assert np.interp(at, places, slope) == pytest.approx(g_slope, rel=0.01)


@pytest.mark.parametrize("storage", [0.0, 1.0e-10])
def test_linear_flow_gives_area_and_reservoir_within_the_stated_error(storage: float) -> None:
    record = _record(_closed_fracture(storage), _PUMPED, _RATE)
    ((_, row),) = evaluate([record], Rock(_VISCOSITY, _STORAGE))
    value, error = float(row["area_root_k"] or 0.0), float(row["area_root_k_error"] or 0.0)
    exact = 40.0 * np.sqrt(_PERMEABILITY)
    assert value == pytest.approx(exact, rel=0.01)
    assert abs(value - exact) < error < 0.02 * exact
    assert abs(float(row["linear_reservoir_pa"] or 1e9)) < float(
        row["linear_reservoir_error_pa"] or 0.0
    )
    assert row["radial_slope"] is None


def test_radial_flow_gives_permeability_within_the_stated_error() -> None:
    """W2: a well of 0.1 m in rock of 1e-16 m2, Theis and Horner."""
    rate, viscosity, permeability = 1.0e-5, 3.0e-4, 1.0e-16

    def rise(time: FloatArray) -> FloatArray:
        place = 0.1**2 * 5.0e-11 * viscosity / (4.0 * permeability * np.maximum(time, 1e-30))
        found: FloatArray = rate * viscosity / (4.0 * np.pi * permeability) * exp1(place)
        return found

    ((fall, row),) = evaluate([_record(rise, 3600.0, rate)], Rock(viscosity))
    slope = {line.regime: line for line in lines(fall)}["radial"]
    assert slope.slope == pytest.approx(2387324.146, rel=0.01)
    assert float(row["k_h"] or 0.0) == pytest.approx(permeability, rel=0.01)
    assert abs(float(row["k_h"] or 0.0) - permeability) < float(row["k_h_error"] or 0.0)


def test_rates_in_stages_are_superposed() -> None:
    """The same area from an injection at three rates with a pause."""
    rise, rates = _closed_fracture(0.0), np.array([1.0, 0.5, 0.0, 2.0])
    starts, end = np.array([0.0, 200.0, 300.0, 400.0]), 600.0
    time = np.concatenate([np.linspace(0.0, end, 61), end + np.geomspace(0.1, 3e5, 160)])
    pressure = np.zeros_like(time)
    for step, start in zip(np.diff([0.0, *rates, 0.0]), [*starts, end], strict=True):
        pressure += step * rise(time - start)
    used = rates[np.searchsorted(starts, time, side="left") - 1] * _RATE
    rate = np.where((time > 0.0) & (time <= end), used, 0.0)
    record = Record("w", time, pressure, rate, np.zeros_like(time), has_losses=False)
    row = evaluate([record], Rock(_VISCOSITY, _STORAGE))[-1][1]
    assert float(row["area_leakoff"] or 0.0) == pytest.approx(_LEAKOFF, rel=0.01)


def test_no_closure_is_picked_where_nothing_closes() -> None:
    fall = _fall()
    assert not [pick for pick in picks(fall) if pick.method in ("tangent", "compliance")]
    assert closures(fall) == []


def test_true_closure_is_that_of_the_first_and_the_last_cell() -> None:
    record = _record(_closed_fracture(0.0), _PUMPED, _RATE)
    cells = np.interp(record.time, [0.0, 700.0, 900.0], [10.0, 10.0, 0.0])
    fall = next(iter(fall_offs(Record(**{**vars(record), "open_cells": np.ceil(cells)}))))
    first, last = closures(fall)
    assert (first.method, last.method) == ("first cell", "last cell")
    assert 100.0 < first.since <= 130.0
    assert 300.0 <= last.since < 330.0


def test_figure_has_four_panels() -> None:
    record = _record(_closed_fracture(0.0), _PUMPED, _RATE)
    ((fall, row),) = evaluate([record], Rock())
    assert len(shut_in_panels(fall, row).axes) == 4


_COLUMNS = read_columns("Rate=rate [bbl/min], Druck=pressure [psi], Zeit=time [min]")


def test_record_with_decimal_commas_is_read_in_its_units(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_text("Zeit;Rate;Druck;Bemerkung\n0;0;14,5;\n0,5;1,5;1000;auf\n1;0;900;zu\n")
    record = read_record(path, _COLUMNS)
    assert record.time == pytest.approx([0.0, 30.0, 60.0])
    assert record.rate[1] == pytest.approx(1.5 * 0.158987294928 / 60.0)
    assert record.pressure[1] == pytest.approx(6.894757293e6)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("Zeit,Rate\n0,0\n", "there is no column 'Druck'"),
        ("Zeit,Rate,Druck\n0,0,1\n1,x,1\n", "record.csv:3: Rate is 'x', no number"),
        ("Zeit,Rate,Druck\n0,0,1\n0,0,1\n", "record.csv:3: times must increase"),
        ("", "there is no column 'Rate'"),
    ],
)
def test_bad_record_is_refused_with_the_line(tmp_path: Path, text: str, reason: str) -> None:
    path = tmp_path / "record.csv"
    path.write_text(text)
    with pytest.raises(RunError, match=reason):
        read_record(path, _COLUMNS)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("q=rate", "not of the form"),
        ("q=flow [l/s]", "'flow' is none of"),
        ("q=rate [gal]", "'gal' is none of"),
        ("q=rate [l/s]", "no column is named for time, pressure"),
    ],
)
def test_bad_map_of_columns_is_refused(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        read_columns(text)
