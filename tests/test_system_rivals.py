"""Fractures with a well each: which of them grow together, and what is said about it."""

from __future__ import annotations

from pathlib import Path

import pytest
from system_scene import TOP, rows, run

pytestmark = pytest.mark.usefixtures("program")

PAIR = (TOP / "verification/competing_wells/pair.nml").read_text()


def coarse_pair(*changes: tuple[str, str]) -> str:
    """Give two equal fractures, 0.6 m apart, in few cells."""
    text = PAIR
    for old, new in (
        ("x = -0.525, 0.525", "x = -0.5, 0.5"),
        ("y = -0.1, -0.1", "y = -0.3, -0.3"),
        ("y = 0.1, 0.1", "y = 0.3, 0.3"),
        ("size_fracture = 0.05", "size_fracture = 0.1"),
        ("increment = 0.05", "increment = 0.1"),
        *changes,
    ):
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


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
