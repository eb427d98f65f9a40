"""Mechanics-only scenes through the real program; others against exact values in verification."""

from __future__ import annotations

import json
import math
import re
import struct
from pathlib import Path

import pytest
from system_scene import TOP, bare, changed, numbers, record, rows, run

pytestmark = pytest.mark.usefixtures("program")

FLUID_COLUMNS = ("pressure", "injected", "leakoff", "prefilled", "mass_error", "_p_pa")


def run_input(place: Path, name: str, *changes: tuple[str, str]) -> Path:
    """Run a scene of inputs/, changed in places, and give the directory of its files."""
    return run(place, changed((TOP / "inputs" / name).read_text(), *changes))


def test_no_trace_of_fluid(tmp_path: Path) -> None:
    """No column of a table speaks of a fluid, and scene.nml runs again to the same results."""
    out = run_input(tmp_path, "paper_b/edge_mode1.nml")
    for table in sorted(out.glob("*.csv")):
        header = table.read_text().splitlines()[0]
        assert not any(word in header for word in FLUID_COLUMNS), table.name
    assert "&fluid" not in (out / "scene.nml").read_text()
    assert record(out)["status"] == "finished"
    again = bare(tmp_path, "run", "out/scene.nml", "--out", "again", "--quiet")
    assert (again.returncode, again.stdout, again.stderr) == (0, "", "")
    for name in ("tips.csv", "history.csv", "fractures.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (out / name).read_bytes()


def test_load_factor_scales_everything(tmp_path: Path) -> None:
    """Open faces: the response is linear in the load factor, in all steps of the programme."""
    out = run_input(
        tmp_path,
        "paper_b/edge_mode1.nml",
        ("&growth", "&load from = 1.0, to = 3.0, steps = 4 /\n&growth"),
    )
    factors = numbers(out / "history.csv", "load_factor")
    assert factors == [1.5, 2.0, 2.5, 3.0]
    assert numbers(out / "tips.csv", "load_factor") == factors
    assert set(numbers(out / "fractures.csv", "load_factor")) == set(factors)
    for table in sorted(out.glob("*.csv")):
        assert "time_s" not in table.read_text().splitlines()[0], table.name
    network = json.loads((out / "network.json").read_text())
    assert [step["load_factor"] for step in network["steps"]] == [1.0]
    times = re.findall(r'timestep="([^"]*)"', (out / "matrix.pvd").read_text())
    assert [float(time) for time in times] == factors
    intensities = numbers(out / "tips.csv", "k1_pa_sqrtm")
    energies = numbers(out / "history.csv", "strain_energy_j")
    for factor, k1, energy in zip(factors, intensities, energies, strict=True):
        assert k1 / intensities[0] == pytest.approx(factor / 1.5, rel=1e-9)
        assert energy / energies[0] == pytest.approx((factor / 1.5) ** 2, rel=1e-9)


def test_wings_of_a_disc(tmp_path: Path) -> None:
    """Closed faces: K_I = 0, a kink of 70.5 degrees at K_eq = K_IC; mirrored wings to the loads."""
    out = run_input(tmp_path, "paper_b/disc_path_45.nml")
    tips = rows(out / "tips.csv")
    first = tips[:2]
    for tip in first:
        assert abs(float(tip["k1_pa_sqrtm"])) < 1e-8 * abs(float(tip["k2_pa_sqrtm"]))
        assert abs(float(tip["angle_deg"])) == pytest.approx(70.528779, abs=1e-5)
    assert max(float(tip["keq_pa_sqrtm"]) for tip in first) == pytest.approx(2.0e6, rel=1e-8)
    factors = numbers(out / "history.csv", "load_factor")
    assert factors == sorted(factors)
    (fracture,) = json.loads((out / "network.json").read_text())["fractures"]
    vertices = list(zip(fracture["x_m"], fracture["y_m"], strict=True))
    length = 2 * 0.026 + 0.01
    for (x, y), (u, v) in zip(vertices, reversed(vertices), strict=True):
        assert math.hypot(x + u, y + v) < 5e-3 * length
    assert abs(vertices[0][0]) < 1e-3 and vertices[0][1] < -0.025
    record_of_run = record(out)
    residual = record_of_run["contact_residual"]
    assert isinstance(residual, float)
    assert residual < 1e-9


# A crack 0.2 m long at 45 degrees in a body 40 times as wide, under pressure along y.
CLOSED = """\
&domain x_min = -4.0, x_max = 4.0, y_min = -4.0, y_max = 4.0 /
&material young = 40.0e9, poisson = 0.2 /
&fracture
  name = 'crack'
  x = -0.07071067811865475, 0.07071067811865475
  y = -0.07071067811865475, 0.07071067811865475
  friction = 0.3
/
&side name = 'top', y_traction = -10.0e6 /
&side name = 'bottom', y_traction = 10.0e6 /
&restraint x = -4.0, y = -4.0, x_displacement = 0.0, y_displacement = 0.0 /
&restraint x = 4.0, y = -4.0, y_displacement = 0.0 /
&fe size_fracture = 0.005, size_boundary = 1.0 /
&growth intensities = .true. /
"""


def test_frictional_crack_grows(tmp_path: Path) -> None:
    """Onset at 1.1547 K_II = K_IC; its slip is an ellipse, and so is its seismic moment."""
    text = CLOSED.replace("poisson = 0.2", "poisson = 0.2, toughness = 1.0e6")
    text = text.replace("&growth intensities = .true. /", "&load to = 2.0, steps = 4 /")
    out = run(tmp_path, text + "&growth enabled = .true., increment = 0.01, stop_gain = 0.04 /")
    history = rows(out / "history.csv")
    exact = 1.0e6 / (1.1547005 * 3.5e6 * math.sqrt(math.pi * 0.1))
    assert float(history[0]["load_factor"]) == pytest.approx(exact, rel=5e-3)
    shear_modulus = 40.0e9 / 2.4
    moment = shear_modulus * math.pi / 4 * 0.2 * float(history[0]["max_slip_m"])
    assert float(history[0]["seismic_moment_nm"]) == pytest.approx(moment, rel=1e-2)
    moments = [float(row["seismic_moment_nm"]) for row in history]
    assert moments == sorted(moments)
    kinds = [event["kind"] for event in rows(out / "events.csv")]
    assert kinds[0] == "slip_onset"
    assert "opening" in kinds
    reason = record(out)["reason"]
    assert reason == "fracture crack has gained stop_gain"


def test_stress_in_situ_is_in_equilibrium(tmp_path: Path) -> None:
    """Closed faces carry the stress in situ, and nothing moves without a load."""
    text = CLOSED.replace("friction = 0.3", "law = 'frictionless'")
    text = text.replace("y_traction = -10.0e6", "y_traction = 0.0")
    text = text.replace("y_traction = 10.0e6", "y_traction = 0.0")
    text += "&in_situ sxx = -7.0e6, syy = -7.0e6 /\n&probe name = 'p', x = 2.0, y = 1.0 /\n"
    out = run(tmp_path, text)
    assert numbers(out / "history.csv", "strain_energy_j")[0] < 1e-12
    for traction in numbers(out / "fractures.csv", "traction_n_pa"):
        assert traction == pytest.approx(-7.0e6, rel=1e-9)
    (probe,) = rows(out / "probes.csv")
    assert float(probe["p_sxx_pa"]) == pytest.approx(-7.0e6, rel=1e-9)
    assert float(probe["p_sxy_pa"]) == pytest.approx(0.0, abs=1.0)


def test_fields_hold_the_elements(tmp_path: Path) -> None:
    """The VTU file has six-node triangles, and displacements at their nodes."""
    out = run_input(
        tmp_path,
        "paper_b/edge_mode1.nml",
        ("&growth", "&probe name = 'corner', x = 0.0, y = 1.0 /\n&growth"),
    )
    content = (out / "vtu" / "matrix_000000.vtu").read_bytes()
    header, raw = content.split(b'encoding="raw">\n   _', 1)
    text = header.decode()
    assert "<PointData>" in text

    def values(name: str, letter: str, size: int) -> tuple[float, ...]:
        found = re.search(f'Name="{name}".*offset="([0-9]+)"', text)
        assert found is not None, name
        start = int(found.group(1))
        (n_bytes,) = struct.unpack_from("<Q", raw, start)
        return struct.unpack_from(f"<{n_bytes // size}{letter}", raw, start + 8)

    points = values("Points", "d", 8)
    displacement = values("nodal_displacement", "d", 8)
    assert len(displacement) == len(points)
    assert set(values("types", "B", 1)) == {22}
    assert len(values("connectivity", "i", 4)) == 6 * len(values("types", "B", 1))
    corner = next(i for i in range(0, len(points), 3) if points[i : i + 2] == (0.0, 1.0))
    (probe,) = rows(out / "probes.csv")
    expected = [float(probe["corner_ux_m"]), float(probe["corner_uy_m"]), 0.0]
    assert displacement[corner : corner + 3] == pytest.approx(expected, rel=1e-12)


def test_a_traction_of_minus_zero_reads_back(tmp_path: Path) -> None:
    """The scene that a run writes can be checked and run again."""
    text = (TOP / "inputs" / "paper_b" / "edge_mode1.nml").read_text()
    side = "&side name = 'left', normal_traction = -0.0, shear_traction = 0.0 /\n&fe"
    assert "'left'" not in text
    out = run(tmp_path, text.replace("&fe", side, 1))
    done = bare(tmp_path, "check", out / "scene.nml")
    assert (done.returncode, done.stderr) == (0, "")


def test_nearly_incompressible_rock_is_warned_of(tmp_path: Path) -> None:
    """The tips' elements are too stiff then; the estimated error says so too, and covers it."""
    changes = (("poisson = 0.3", "poisson = 0.4999"), ("plane = 'stress'", "plane = 'strain'"))
    out = run_input(tmp_path, "paper_b/edge_mode1.nml", *changes)
    warnings = record(out)["warnings"]
    assert isinstance(warnings, list)
    assert "&adaptive" in str(warnings[0])
    exact = 2.825457622e6 * math.sqrt(math.pi * 0.5)
    (tip,) = rows(out / "tips.csv")
    error = abs(float(tip["k1_pa_sqrtm"]) - exact)
    assert error < float(tip["k1_error_pa_sqrtm"])
    assert error < 0.02 * exact


# A closed crack that slides under a shear of 10 MPa and a pressure of 5 MPa, in a body 15 times its
# length.
SLIDING = """\
&domain x_min = -1.5, x_max = 1.5, y_min = -1.5, y_max = 1.5 /
&material young = 20e9, poisson = NU /
&fracture name = 'f', x = -0.1, 0.1, y = 0, 0, friction = 0.6 /
&side name = 'left', y_traction = -10e6 /
&side name = 'right', y_traction = 10e6 /
&side name = 'top', x_traction = 10e6, y_traction = -5e6 /
&side name = 'bottom', x_traction = -10e6, y_traction = 5e6 /
&restraint x = -1.5, y = -1.5, x_displacement = 0, y_displacement = 0 /
&restraint x = 1.5, y = -1.5, y_displacement = 0 /
&fe size_fracture = SIZE, size_boundary = 0.3 /
&growth intensities = .true. /
&output vtu = .false. /
"""


@pytest.mark.parametrize("size", [0.01, 0.005])
@pytest.mark.parametrize("mesh", ["", "&adaptive enabled = .true., tolerance = 0.003 /\n"])
def test_nearly_incompressible_rock_with_friction(tmp_path: Path, size: float, mesh: str) -> None:
    """Friction follows wrong normal tractions: warned of, and the stated errors cover it."""
    scene = SLIDING.replace("SIZE", str(size)) + mesh
    exact = (10e6 - 0.6 * 5e6) * math.sqrt(math.pi * 0.1)
    usual = rows(run(tmp_path, scene.replace("NU", "0.3")) / "tips.csv")[-1]
    in_body = abs(float(usual["k2_pa_sqrtm"]))  # plane strain: the same for all ratios of Poisson
    assert in_body == pytest.approx(exact, rel=5e-3)
    assert float(usual["k2_error_pa_sqrtm"]) < 1e-3 * exact
    out = run(tmp_path, scene.replace("NU", "0.4999"))
    assert "several per cent" in str(record(out)["warnings"])
    for tip in rows(out / "tips.csv"):
        error = abs(abs(float(tip["k2_pa_sqrtm"])) - in_body)
        assert error < float(tip["k2_error_pa_sqrtm"]) + 1e-3 * exact
        assert error < 0.1 * exact


def test_a_crack_crosses_a_polygon(tmp_path: Path) -> None:
    """From the re-entrant corner of an L-shaped panel to the side across, which breaks it."""
    out = run_input(
        tmp_path,
        "examples/l_panel.nml",
        ("stop_gain = 0.2", "stop_gain = 2.0"),
        ("to = 4.0", "to = 40.0"),
    )
    assert record(out)["reason"] == "a part of the body has separated"
    (joint,) = [row for row in rows(out / "events.csv") if row["kind"] == "joint"]
    assert joint["detail"] == "joins the outer boundary"
    assert float(joint["x_m"]) == 0.0
    assert 0.25 < float(joint["y_m"]) < 0.35


def test_point_load_on_a_fracture(tmp_path: Path) -> None:
    """A load there would act on one face: refused with the names and lines of both."""
    text = (TOP / "inputs" / "paper_b" / "disc_sif.nml").read_text()
    scene = tmp_path / "scene.nml"
    scene.write_text(text + "&point_load x = 0.0, y = 0.0, x_force = 1.0 /\n")
    done = bare(tmp_path, "run", scene.name, "--out", "out")
    assert done.returncode == 2
    assert "where it would act on one of its two faces only" in done.stderr
    assert not (tmp_path / "out").exists()
