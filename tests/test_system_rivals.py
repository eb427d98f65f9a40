"""Fractures with a well each: which of them grow together, and what is said about it."""

from __future__ import annotations

from pathlib import Path

import pytest
from system_scene import TOP, changed, rows, run

pytestmark = pytest.mark.usefixtures("program")

# Two equal fractures, both beyond their toughness at the start, one with a well.
FED_AND_NOT = """\
&domain x_min = 0.0, x_max = 2.0, y_min = 0.0, y_max = 2.0 /
&material
  young = 40.0e9, poisson = 0.2, biot = 0.8, porosity = 0.01, permeability = 5.0e-20
  toughness = 1.0e6
/
&fluid compressibility = 4.4e-10, viscosity = 1.0e-4 /
&fracture
  name = 'fed', friction = 0.5, dilation_deg = 1.0, aperture = 1.0e-3
  x = 0.85, 1.15
  y = 0.35, 0.60
/
&fracture
  name = 'not', friction = 0.5, dilation_deg = 1.0, aperture = 1.0e-3
  x = 0.85, 1.15
  y = 1.40, 1.65
/
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&side name = 'top', y_traction = -10.0e6 /
&injection fracture = 'fed', rate = 5.0e-7 /
&initial fracture_pressure = 'equilibrated' /
&time end = 1.0 /
&coarse size_fracture = 0.05, size_boundary = 0.4 /
&fine window = 0.1, size_ratio = 0.5 /
&growth enabled = .true., new_aperture = 1.0e-5 /
&output vtu = .false. /
"""

PAIR = (TOP / "verification/competing_wells/pair.nml").read_text()


def coarse_pair(*changes: tuple[str, str]) -> str:
    """Give two equal fractures, 0.6 m apart, in few cells."""
    return changed(
        PAIR,
        ("x = -0.525, 0.525", "x = -0.5, 0.5"),
        ("y = -0.1, -0.1", "y = -0.3, -0.3"),
        ("y = 0.1, 0.1", "y = 0.3, 0.3"),
        ("size_fracture = 0.05", "size_fracture = 0.1"),
        ("increment = 0.05", "increment = 0.1"),
        *changes,
    )


def gains(out: Path) -> list[float]:
    """Sum up what each tip has grown [m]."""
    gain: dict[int, float] = {}
    for row in rows(out / "tips.csv"):
        tip = int(row["tip"])
        gain[tip] = gain.get(tip, 0.0) + float(row["advance_m"])
    return [gain[tip] for tip in sorted(gain)]


def test_equal_fractures_go_together(tmp_path: Path) -> None:
    """Nothing tells them from each other, though any lead would grow: that is said."""
    out = run(tmp_path, coarse_pair(("&time end = 40.0 /", "&time end = 45.0 /")))
    gain = gains(out)
    assert gain == pytest.approx([gain[0]] * 4, rel=1e-6)
    assert gain[0] > 0.05
    assert [row["kind"] for row in rows(out / "events.csv")].count("bifurcation") == 1


def test_a_viscous_fluid_holds_them_together(tmp_path: Path) -> None:
    """Who runs ahead of the fluid loses pressure: there is no bifurcation."""
    out = run(
        tmp_path,
        coarse_pair(
            ("viscosity = 2.6e-5", "viscosity = 0.26"),
            ("&time end = 40.0 /", "&time end = 90.0 /"),
        ),
    )
    gain = gains(out)
    assert gain == pytest.approx([gain[0]] * 4, rel=0.02)
    assert gain[0] > 0.05
    assert "bifurcation" not in [row["kind"] for row in rows(out / "events.csv")]


def test_none_goes_along_below_its_toughness(tmp_path: Path) -> None:
    """At the start all four tips grow alike; after that the well drives those of its fracture.

    The others had gone along with them once, at less than half of their toughness. They may take
    the rest of a short segment and the shortest advance of the next, a twentieth of the
    increment of 0.025 m.
    """
    out = run(tmp_path, FED_AND_NOT)
    later = [row for row in rows(out / "tips.csv") if float(row["time_s"]) > 1.0e-3]
    grown = [row for row in later if float(row["advance_m"]) > 0.0]
    assert sum(float(row["advance_m"]) for row in grown) > 2.0e-3
    others = [float(row["advance_m"]) for row in grown if row["fracture"] != "1"]
    assert sum(others) <= 0.06 * 0.025
    for row in grown:
        error = max(float(row["k1_error_pa_sqrtm"]), float(row["k2_error_pa_sqrtm"]))
        assert float(row["keq_pa_sqrtm"]) + max(error, 0.1e6) > 1.0e6
