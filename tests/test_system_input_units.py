"""Other units than SI in scenes and tables of wells: the same run to the last digits."""

from __future__ import annotations

from pathlib import Path

import pytest
from system_scene import bare, numbers

pytestmark = pytest.mark.usefixtures("program")

# 0.1 l/s, 0.2 l/s up to 28 MPa and a shut-in, over 30 m
SI = """\
&scene name = 'units', thickness = 30 /
&domain x_min = -20, x_max = 20, y_min = -20, y_max = 20 /
&material young = 30e9, poisson = 0.25, biot = 0.6, porosity = 0.05, permeability = 1e-17 /
&fluid compressibility = 4.5e-10, viscosity = 1e-3 /
&fracture name = 'c', x = -2, 2, y = -1, 1, friction = 0.6, aperture = 1e-4 /
&in_situ sxx = -30e6, syy = -25e6 /
&initial pressure = 15e6 /
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&injection
  name = 'w', fracture = 'c', time = 0, 60, 120
  rate = 3.3333333333333333e-6, 6.6666666666666666e-6, 0, pressure = 28e6, 1e30, 1e30
/
&time end = 200 /
&coarse size_fracture = 0.4, size_boundary = 5 /
"""
OTHER = (
    SI.replace("young = 30e9", "young_gpa = 30")
    .replace("aperture = 1e-4", "aperture_mm = 0.1")
    .replace("sxx = -30e6, syy = -25e6", "sxx_mpa = -30, SYY_bar = -250")
    .replace("&initial pressure = 15e6", "&initial pressure_kpa = 15000")
    .replace("end = 200", "end_min = 3.3333333333333333")
    .replace("size_fracture = 0.4", "size_fracture_cm = 40")
)
TIMES, RATES = (
    SI[SI.index(", time") : SI.index("\n  rate")],
    SI[SI.index("\n  rate") : SI.index("\n/")],
)
TABLE = "time_min;rate_l_per_s;Remark;pressure_mpa\n0;0,1;begin;28\n1;0,2;;\n2;0;end;\n"
RECORD = "Zeit;Q;;P\n0;0,1;x;28\n0,5;0,1;y;28\n1;0,2;;\n2;0;;\n"
NAMES = "columns = 'Zeit=time [min], Q=rate [l/s], P=pressure [MPa]'"


_COMPARED = ("time_s", "well_pressure_pa", "injected_m2", "leakoff_m2", "fracture_volume_m2")


def _history(place: Path, text: str) -> list[list[float]]:
    place.mkdir(exist_ok=True)
    (place / "scene.nml").write_text(text)
    (place / "table.csv").write_text(TABLE)
    (place / "record.csv").write_text(RECORD)
    done = bare(place, "run", "scene.nml", "--out", "out", "--quiet")
    assert done.returncode == 0, done.stderr
    history = place / "out" / "history.csv"
    return [numbers(history, column) for column in _COMPARED]


@pytest.mark.parametrize(
    "well",
    [
        ", time = 0, 60, 120\n rate_l_s = 0.1, 0.2, 0, pressure_psi = 4061.0566, 2*1.5e26",
        ", schedule = 'table.csv'",
        f", schedule = 'record.csv', {NAMES}",
    ],
)
def test_units_change_nothing(tmp_path: Path, well: str) -> None:
    """To 1e-12 of the largest; the limit is not reached: its digits in psi do not matter."""
    expected = _history(tmp_path / "si", SI)
    found = _history(tmp_path / "other", OTHER.replace(TIMES, well).replace(RATES, ""))
    for wanted, values in zip(expected, found, strict=True):
        assert values == pytest.approx(wanted, rel=1e-12, abs=1e-12 * max(map(abs, wanted)))


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("young_gpa = 30", "young_gpa = -3", "scene.nml:3: &material: young is -3 but must be"),
        ("young_gpa = 30", "young_bpm = 30", "scene.nml:3: &material: unknown name young_bpm"),
        ("[l/s]", "[gal]", "record.csv:1: the column 'Q' must be one of rate_m2_s"),
        ("Q=rate", "R=rate", "record.csv:1: there is no column 'R', which columns names"),
        ("Q=rate [l/s]", "Q", "scene.nml:11: &injection: columns has 'Q' but must have"),
        ("schedule = 'record.csv', ", "", "columns is given without schedule"),
    ],
)
def test_wrong_units_and_columns_are_refused(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    text = OTHER.replace(TIMES, f", schedule = 'record.csv', {NAMES}").replace(RATES, "")
    (tmp_path / "scene.nml").write_text(text.replace(old, new))
    (tmp_path / "record.csv").write_text(RECORD)
    done = bare(tmp_path, "check", "scene.nml")
    assert done.returncode == 2
    assert reason in done.stderr
