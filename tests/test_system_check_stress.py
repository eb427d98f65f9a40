"""`check --stress`: pressures in closed form, cost, table and figure."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path

import pytest
from system_scene import SCENE, SOLVER, TOP

from wingcrack.figures import mohr

pytestmark = pytest.mark.usefixtures("program")

# Steps of runs of shipped scenes (run.json); they depend on the scene alone, not on the machine.
STEPS = {
    "benchmarks/onset_2300": 21,
    "examples/crossing": 70,
    "examples/dfit": 151,
    "examples/field": 317,
    "examples/l_panel": 21,
    "examples/load_cycle": 51,
    "examples/two_lengths": 193,
    "paper_a/double_flaw": 121,
    "paper_a/imposed_slip": 81,
    "paper_a/single_flaw": 35,
    "paper_b/disc_path_30": 28,
    "paper_b/edge_mode1": 1,
    "paper_b/five_fractures": 55,
    "paper_b/three_fractures": 73,
    "paper_c/onset": 54,
    "paper_c/three_fractures": 92,
    "paper_c/wing_crack": 158,
    "paper_d/network": 228,
    "paper_d/permeability_case1": 129,
    "paper_d/permeability_case2": 160,
    "paper_d/rate": 113,
    "paper_d/stress_case1": 145,
    "paper_d/stress_case2": 192,
}


def described(scene: Path) -> str:
    """Give the solver's description."""
    words = [str(SOLVER), "check", str(scene), "--stress"]
    return str(subprocess.run(words, capture_output=True, text=True, check=True).stdout)


@pytest.mark.parametrize("name", STEPS)
def test_steps_within_a_factor_of_two(name: str) -> None:
    steps = json.loads(described(TOP / "inputs" / f"{name}.nml"))["cost"]["steps"]
    assert STEPS[name] / 2 <= steps <= STEPS[name] * 2


def test_pressures_in_closed_form(tmp_path: Path) -> None:
    """A fracture at 45 degrees under 20 and 10 MPa: 15 and 5 MPa; K_II of sqrt(3)/2 K_IC."""
    (tmp_path / "small.nml").write_text(SCENE)
    found = json.loads(described(tmp_path / "small.nml"))
    (part,) = found["fractures"]
    assert part["normal_pa"] == pytest.approx(15e6, rel=1e-12)
    assert part["shear_pa"] == pytest.approx(5e6, rel=1e-12)
    assert part["slip_tendency"] == pytest.approx(1 / 3, rel=1e-12)
    assert part["slips_at_pa"] == pytest.approx(5e6, rel=1e-12)
    assert part["opens_at_pa"] == pytest.approx(15e6, rel=1e-12)
    root = math.sqrt(math.pi * 0.05)
    grows = 15e6 - (5e6 - 0.5 * math.sqrt(3) * 0.3e6 / root) / 0.5
    assert part["grows_at_pa"] == pytest.approx(grows, rel=1e-9)
    # K_m = sqrt(32/pi) K_IC / (E'^3 12 mu Q)^(1/4)
    k_m = math.sqrt(32 / math.pi) * 0.3e6 / ((40e9 / 0.96) ** 3 * 12e-4 * 5e-9) ** 0.25
    assert found["wells"][0]["k_m"] == pytest.approx(k_m, rel=1e-12)


def test_an_opened_crack_grows_by_its_toughness(tmp_path: Path) -> None:
    """Across a principal stress: (p - 10 MPa) sqrt(pi a) = K_IC."""
    scene = SCENE.replace("0.9646446609406726, 1.0353553390593274", "1.0, 1.0")
    flat = scene.replace("x = 1.0, 1.0", "x = 0.95, 1.05", 1)
    (tmp_path / "flat.nml").write_text(flat)
    (part,) = json.loads(described(tmp_path / "flat.nml"))["fractures"]
    assert part["shear_pa"] == 0.0
    assert part["slips_at_pa"] == part["opens_at_pa"] == pytest.approx(10e6, rel=1e-12)
    expected = 10e6 + 0.3e6 / math.sqrt(math.pi * 0.05)
    assert part["grows_at_pa"] == pytest.approx(expected, rel=1e-9)


def test_the_table_and_the_diagram(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = SCENE.replace("rate = 5.0e-9,", "rate = 5.0e-9, pressure = 16e6,")
    (tmp_path / "small.nml").write_text(scene.replace("aperture = 1.0e-3", "aperture = 6.0e-3"))
    text = described(tmp_path / "small.nml")
    assert mohr.show(text, as_json=False, figure=tmp_path / "mohr.png") == 0
    said = capsys.readouterr().out.splitlines()
    row = next(line for line in said if line.startswith("f1")).split()
    assert row[1:9] == ["45", "15.00", "5.00", "0.00", "0.333", "0.500", "5.00", "15.00"]
    assert "well:         'well_1' at 16.00 MPa: 'f1' slips, opens, would grow" in said
    assert any("aperture is 0.006 m" in line for line in said)
    assert any("K_I is" in line and "would grow" in line for line in said)
    assert (tmp_path / "mohr.png").stat().st_size > 10_000


def test_a_stress_that_is_not_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = described(TOP / "inputs" / "paper_b" / "disc_sif.nml")
    assert mohr.show(text, as_json=False, figure=tmp_path / "no.png") == 0
    told = capsys.readouterr()
    assert "not known before a run: the body is no rectangle" in told.out
    assert "no Mohr diagram" in told.err
    assert not (tmp_path / "no.png").exists()
