"""The real program on a small scene: files, numbers known in closed form, reproducibility."""

from __future__ import annotations

import json
import math
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest
import pyvista
from system_scene import (
    GROWING,
    SCENE,
    SOLVER,
    TOP,
    bare,
    call,
    numbers,
    record,
    rows,
    run,
    start,
    varied,
)

# The columns that users may rely on, in their order; docs/output.md may have more among them.
HISTORY = [
    "time_s", "dt_s", "newton_iterations", "well_pressure_pa", "injected_m2", "leakoff_m2",
    "prefilled_m2", "outflow_m2", "fracture_volume_m2", "mass_error_relative", "max_slip_m",
    "max_opening_m", "n_stick", "n_slip", "n_open", "fracture_length_m", "n_tips",
    "n_intersections", "seismic_moment_nm",
]  # fmt: skip
TIPS = [
    "time_s", "tip", "fracture", "x_m", "y_m", "k1_pa_sqrtm", "k2_pa_sqrtm", "k1_dc_pa_sqrtm",
    "k2_dc_pa_sqrtm", "keq_pa_sqrtm", "g_j_m2", "angle_deg", "advance_m", "k1_error_pa_sqrtm",
    "k2_error_pa_sqrtm", "g_ahead_j_m2", "g_ahead_error_j_m2", "k1_dc_error_pa_sqrtm",
    "k2_dc_error_pa_sqrtm", "k1_corrected_pa_sqrtm", "k2_corrected_pa_sqrtm", "history_row",
]  # fmt: skip
FRACTURES = [
    "time_s", "fracture", "s_m", "x_m", "y_m", "aperture_m", "jump_n_m", "jump_t_m",
    "traction_n_pa", "traction_t_pa", "pressure_pa", "void_m", "flow_m2_s", "state",
    "history_row",
]  # fmt: skip
PROBES = [
    "time_s",
    *(
        f"{name}_{quantity}"
        for name in ("inside", "corner")
        for quantity in ("p_pa", "ux_m", "uy_m", "sxx_pa", "syy_pa", "sxy_pa")
    ),
]
EVENTS = ["time_s", "kind", "fracture", "x_m", "y_m", "detail"]
PHASES = [
    "mesh", "discretize", "assemble", "factorize", "solve", "contact", "tips", "remesh",
    "transfer", "output",
]  # fmt: skip

# The scene's rock and load, and what follows for a body without a fracture: stress is that of the
# load; pressure from alpha eps + S p = 0, where nothing has flowed; plane strain.
YOUNG, POISSON, BIOT, POROSITY, COMPRESSIBILITY = 40.0e9, 0.2, 0.8, 0.01, 4.0e-10
STRESS = (-20.0e6, -10.0e6)
STORAGE = POROSITY * COMPRESSIBILITY + (BIOT - POROSITY) * 3 * (1 - 2 * POISSON) / YOUNG
PLANE_COMPLIANCE = (1 + POISSON) * (1 - 2 * POISSON) / YOUNG
UNDRAINED_PRESSURE = -BIOT * PLANE_COMPLIANCE * sum(STRESS)
UNDRAINED_PRESSURE /= STORAGE + 2 * BIOT**2 * PLANE_COMPLIANCE
_EFFECTIVE = [stress + BIOT * UNDRAINED_PRESSURE for stress in STRESS]
STRAIN = [(1 + POISSON) / YOUNG * (_EFFECTIVE[i] - POISSON * sum(_EFFECTIVE)) for i in range(2)]


pytestmark = pytest.mark.usefixtures("program")


def header(path: Path) -> list[str]:
    return path.read_text().split("\n", 1)[0].split(",")


def test_a_run_ends_with_what_it_was(tmp_path: Path) -> None:
    """Without --quiet the end says why it came, how far the run got, and where the results are."""
    (tmp_path / "small.nml").write_text(SCENE)
    done = call(tmp_path, "run", "small.nml", "--out", "out", "--no-plot")
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0] == "finished: the scene's end time"
    assert lines[1].startswith("reached 18000 s in 5 steps, ")
    assert lines[2] == "fractures are 0.1 m long; nothing has grown"
    assert "results in out" in lines
    assert lines[-1] == "events: 1 fracture slips"
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    keq = max(numbers(tmp_path / "out" / "tips.csv", "keq_pa_sqrtm"))
    assert record["keq_over_kic"] == pytest.approx(keq / 0.3e6, rel=1e-12)
    assert lines[3] == f"largest K_eq/K_IC {record['keq_over_kic']:.4g}"
    fracture = min(numbers(tmp_path / "out" / "fractures.csv", "pressure_pa"))
    assert record["lowest_pressure_pa"] <= fracture


@pytest.mark.parametrize("which", ["resting", "growing"])
def test_tables_have_their_columns_and_finite_numbers(
    which: str, request: pytest.FixtureRequest
) -> None:
    out: Path = request.getfixturevalue(which)
    for name, columns in (
        ("history", HISTORY),
        ("tips", TIPS),
        ("fractures", FRACTURES),
        ("probes", PROBES),
        ("events", EVENTS),
    ):
        path = out / f"{name}.csv"
        assert [name for name in header(path) if name in columns] == columns
        table = rows(path)
        assert table
        texts = {"state", "kind", "detail"}
        if name == "events":
            texts |= {"fracture", "x_m", "y_m"}  # empty where an event has no place
        for row in table:
            assert all(math.isfinite(float(row[c])) for c in columns if c not in texts)
    assert {row["state"] for row in rows(out / "fractures.csv")} <= {"stick", "slip", "open"}


@pytest.mark.parametrize("which", ["resting", "growing"])
def test_the_record_of_a_run(which: str, request: pytest.FixtureRequest) -> None:
    out: Path = request.getfixturevalue(which)
    record = json.loads((out / "run.json").read_text())
    history = rows(out / "history.csv")
    assert record["scene"] == "small"
    assert record["status"] == "finished"
    assert record["reason"]
    assert record["steps"] == len(history) - 1  # the first row is the initial state
    assert record["cells"] > 300
    assert all(count > 0 for count in record["dofs"].values())
    assert record["used"]
    assert record["left_out"]
    assert list(record["timers_s"]) == PHASES
    assert all(seconds >= 0 for seconds in record["timers_s"].values())
    assert record["cpu_s"] > 0
    assert record["wall_s"] > 0
    assert record["peak_memory_mb"] > 1
    if which == "resting":
        assert record["warnings"] == []
    else:  # little friction, few cells and long steps, and the run says so
        doubts = (
            "K_eq over K_IC in the initial state",
            "estimated error of a stress intensity factor",
            "error of growth by the error of K",
            "K_eq over K_IC after growth",
        )
        assert all(warning.startswith(doubts) for warning in record["warnings"])
    assert record["newton_iterations"]["total"] >= sum(int(r["newton_iterations"]) for r in history)
    assert record["newton_iterations"]["max"] <= 30
    assert record["step_cuts"] == len(
        [e for e in rows(out / "events.csv") if e["kind"] == "step_cut"]
    )
    errors = numbers(out / "history.csv", "mass_error_relative")
    assert all(error < 1.0e-9 for error in errors)
    assert record["mass_error_relative"] == max(errors)
    assert record["contact_residual"] < 1.0e-8


def test_fields_can_be_read(resting: Path) -> None:
    record = json.loads((resting / "run.json").read_text())
    for dimension, cells in (("matrix", record["cells"]), ("fractures", record["fracture_cells"])):
        series = ElementTree.parse(resting / f"{dimension}.pvd").iter("DataSet")
        files = {float(entry.attrib["timestep"]): entry.attrib["file"] for entry in series}
        assert list(files) == numbers(resting / "history.csv", "time_s")
        for file in files.values():
            assert pyvista.read(resting / file).n_cells == cells


def test_known_state_of_the_body(resting: Path) -> None:
    # The values of the scene's description are those of the closed form above.
    assert pytest.approx(6.902061e6, rel=1.0e-6) == UNDRAINED_PRESSURE
    assert 2.0 * math.hypot(*STRAIN) == pytest.approx(0.6425442e-3, rel=1.0e-6)
    # The slipping fracture, 1/20 of the body, disturbs it little.
    first = {name: float(value) for name, value in rows(resting / "probes.csv")[0].items()}
    assert first["time_s"] == 0.0
    assert first["inside_p_pa"] == pytest.approx(UNDRAINED_PRESSURE, rel=5.0e-3)
    norm = math.hypot(first["corner_ux_m"], first["corner_uy_m"])
    assert norm == pytest.approx(2.0 * math.hypot(*STRAIN), rel=5.0e-3)


def test_a_fracture_that_sticks_leaves_the_exact_state(tmp_path: Path) -> None:
    scene = varied(("friction = 0.5", "friction = 5.0"), ("rate = 5.0e-9", "rate = 0.0"))
    out = run(tmp_path, scene)
    for row in rows(out / "probes.csv"):
        for name, x in (("inside", 1.5), ("corner", 2.0)):
            exact = {
                "p_pa": UNDRAINED_PRESSURE,
                "ux_m": STRAIN[0] * x,
                "uy_m": STRAIN[1] * x,
                "sxx_pa": STRESS[0],
                "syy_pa": STRESS[1],
            }
            for quantity, value in exact.items():
                assert float(row[f"{name}_{quantity}"]) == pytest.approx(value, rel=1.0e-9)
    # Normal and tangent of the fracture are (-1, 1) and (1, 1) over sqrt(2).
    for row in rows(out / "fractures.csv"):
        assert row["state"] == "stick"
        normal = 0.5 * sum(STRESS) + UNDRAINED_PRESSURE
        assert float(row["traction_n_pa"]) == pytest.approx(normal, rel=1.0e-9)
        shear = 0.5 * (STRESS[1] - STRESS[0])
        assert float(row["traction_t_pa"]) == pytest.approx(shear, rel=1.0e-9)
        assert float(row["pressure_pa"]) == pytest.approx(UNDRAINED_PRESSURE, rel=1.0e-9)


def test_contact_obeys_coulomb_and_dilation(resting: Path) -> None:
    for row in rows(resting / "fractures.csv"):
        pressing, shear = -float(row["traction_n_pa"]), abs(float(row["traction_t_pa"]))
        assert pressing > 0.0
        assert shear <= 0.5 * pressing * (1 + 1.0e-8)
        gap = math.tan(math.radians(1.0)) * abs(float(row["jump_t_m"]))
        assert float(row["jump_n_m"]) == pytest.approx(gap, rel=1.0e-8)
        assert float(row["aperture_m"]) == pytest.approx(1.0e-3 + gap, rel=1.0e-12)
    slipping = [row for row in rows(resting / "fractures.csv") if row["state"] == "slip"]
    assert slipping
    for row in slipping:
        bound = -0.5 * float(row["traction_n_pa"])
        assert abs(float(row["traction_t_pa"])) == pytest.approx(bound, rel=1.0e-8)


def test_fluid_is_injected_as_asked(resting: Path, growing: Path) -> None:
    for out in (resting, growing):
        for row in rows(out / "history.csv"):
            pumped = 5.0e-9 * (min(float(row["time_s"]), 14400.0) - 3600.0)
            assert float(row["injected_m2"]) == pytest.approx(max(pumped, 0.0), rel=1.0e-12)
            assert float(row["prefilled_m2"]) == 0.0


def test_what_is_derived_from_the_intensities(resting: Path) -> None:
    """Erdogan and Sih 1963: direction, equivalent intensity and energy release rate."""
    tips = [row for row in rows(resting / "tips.csv") if float(row["time_s"]) > 0.0]
    assert tips
    for row in tips:
        k1, k2 = max(float(row["k1_pa_sqrtm"]), 0.0), float(row["k2_pa_sqrtm"])
        angle = 2 * math.atan(-2 * k2 / (k1 + math.sqrt(k1**2 + 8 * k2**2)))
        assert float(row["angle_deg"]) == pytest.approx(math.degrees(angle), rel=1.0e-9)
        half = 0.5 * angle
        keq = k1 * math.cos(half) ** 3 - 1.5 * k2 * math.cos(half) * math.sin(angle)
        assert float(row["keq_pa_sqrtm"]) == pytest.approx(keq, rel=1.0e-9)
        opening = 0.5 * math.cos(half) * (k1 * (1 + math.cos(angle)) - 3 * k2 * math.sin(angle))
        sliding = 0.5 * math.cos(half) * (k1 * math.sin(angle) + k2 * (3 * math.cos(angle) - 1))
        g = (1 - POISSON**2) / YOUNG * (opening**2 + sliding**2)
        assert float(row["g_j_m2"]) == pytest.approx(g, rel=1.0e-9)
        assert float(row["advance_m"]) == 0.0


def test_growth_is_told_the_same_way_by_all_files(growing: Path) -> None:
    grown = sum(numbers(growing / "tips.csv", "advance_m"))
    assert grown > 0.015
    network = json.loads((growing / "network.json").read_text())
    lengths = [fracture["length_m"] for fracture in network["fractures"]]
    assert sum(lengths) == pytest.approx(0.1 + grown, rel=1.0e-9)
    # Growth belongs to the step that leads to its state.
    history = rows(growing / "history.csv")
    when = [(float(row["time_s"]), float(row["advance_m"])) for row in rows(growing / "tips.csv")]
    for row in history:
        before = sum(advance for time_s, advance in when if time_s <= float(row["time_s"]))
        assert float(row["fracture_length_m"]) == pytest.approx(0.1 + before, rel=1.0e-9)
        assert int(row["n_tips"]) == 2
    assert len(network["tips"]) == 2
    events = rows(growing / "events.csv")
    assert {event["kind"] for event in events} >= {"slip_onset", "growth", "remesh"}
    # Sheared under compression, wings turn towards the largest compression, here x.
    first = rows(growing / "tips.csv")[0]
    assert -70.5288 <= float(first["angle_deg"]) < -60.0


@pytest.mark.parametrize(("which", "scene"), [("resting", SCENE), ("growing", GROWING)])
def test_the_same_scene_gives_the_same_bits(
    which: str, scene: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    one: Path = request.getfixturevalue(which)
    two = run(tmp_path, scene)
    names = sorted(path.relative_to(one) for path in one.rglob("*") if path.is_file())
    assert names == sorted(path.relative_to(two) for path in two.rglob("*") if path.is_file())
    for name in names:
        if name.name in ("run.json", "run.log") or name.match("checkpoint*"):  # they hold times
            continue
        assert (one / name).read_bytes() == (two / name).read_bytes(), name


@pytest.mark.parametrize("which", ["resting", "growing"])
def test_the_scene_as_understood_gives_the_same_run(
    which: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    out: Path = request.getfixturevalue(which)
    again = run(tmp_path, (out / "scene.nml").read_text())
    for name in ("history.csv", "tips.csv", "scene.nml"):
        assert (again / name).read_bytes() == (out / name).read_bytes(), name


def test_a_directory_can_be_used_again(resting: Path, growing: Path, tmp_path: Path) -> None:
    shutil.copytree(growing, tmp_path / "out")
    out = run(tmp_path, SCENE)
    assert sorted(p.name for p in out.rglob("*")) == sorted(p.name for p in resting.rglob("*"))
    assert (out / "history.csv").read_bytes() == (resting / "history.csv").read_bytes()


def test_an_interrupted_run_leaves_whole_files(tmp_path: Path) -> None:
    scene = varied(("end = 18000.0, step = 3600.0", "end = 1.0e9, step = 3600.0"))
    (tmp_path / "small.nml").write_text(scene)
    history = tmp_path / "out" / "history.csv"
    with start(tmp_path, "run", "small.nml", "--out", "out", "--quiet") as process:
        deadline = time.monotonic() + 60
        while not (history.exists() and len(rows(history)) > 2):
            assert time.monotonic() < deadline
            assert process.poll() is None
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        out, error = process.communicate(timeout=60)
    assert process.returncode == 130
    assert out == ""
    assert error.splitlines()[-1] == "wingcrack: interrupted; the last state is in out"
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    assert record["status"] == "stopped"
    assert record["steps"] == len(rows(history)) - 1 >= 2
    for name in ("tips", "fractures", "probes", "events"):
        assert rows(tmp_path / "out" / f"{name}.csv")
    times = numbers(history, "time_s")
    assert numbers(tmp_path / "out" / "probes.csv", "time_s") == times
    for series in (tmp_path / "out").glob("*.pvd"):
        for entry in ElementTree.parse(series).iter("DataSet"):
            assert pyvista.read(series.parent / entry.attrib["file"]).n_cells > 0
    assert not (tmp_path / "out" / "figures").exists()


def test_figures_of_a_run(growing: Path) -> None:
    done = call(growing.parent, "plot", "out")
    assert done.returncode == 0, done.stderr
    pictures = {path.stem for path in (growing / "figures").glob("*.png")}
    assert len(pictures) >= 4
    for path in (growing / "figures").glob("[!.]*"):
        magic = {
            ".png": b"\x89PNG",
            ".html": b"<!DOCTYPE html>",
            ".csv": b"well,stage,",
            ".txt": b"summary",
            ".vtp": b"<VTKFile",
        }
        assert path.read_bytes().startswith(magic[path.suffix])


def test_check_tells_what_decides_about_growth(tmp_path: Path) -> None:
    scene = (TOP / "verification/kgd/kgd.nml").read_text()
    usual = 1.0306923793741721e-4  # K_m = 4
    printed = {}
    for name, factor in (("tough", 1.0), ("between", 16.0), ("viscous", 25.0**4)):
        assert "1.0306923793741721e-4" in scene
        text = scene.replace("1.0306923793741721e-4", repr(factor * usual))
        (tmp_path / f"{name}.nml").write_text(text)
        printed[name] = bare(tmp_path, "check", f"{name}.nml").stdout
    assert "toughness-dominated growth, K_m = 4.000E+00 (well 'well_1')" in printed["tough"]
    assert "growth depends on toughness and viscosity, K_m = 2.000E+00" in printed["between"]
    assert "viscosity-dominated growth, K_m = 1.600E-01" in printed["viscous"]
    warning = "&injection 'well_1': K_m is 0.16: growth is then viscosity-dominated"
    assert [warning in printed[name] for name in printed] == [False, False, True]


def test_a_scene_is_checked_without_running(tmp_path: Path) -> None:
    (tmp_path / "small.nml").write_text(SCENE)
    done = call(tmp_path, "check", "small.nml")
    assert (done.returncode, done.stderr) == (0, "")
    for words in ("small", "poroelastic", "intensities", "cells"):
        assert words in done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["small.nml"]


@pytest.mark.parametrize("rows_of_fractures", [2, 4])
def test_check_foresees_the_cells(rows_of_fractures: int, tmp_path: Path) -> None:
    """Its estimate knows where fractures are only on average: within a quarter of the mesh."""
    tool = TOP / "tools" / "many_fractures.py"
    command = [sys.executable, str(tool), "--rows", str(rows_of_fractures), "--cells", "8"]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    (tmp_path / "many.nml").write_text(text)
    printed = bare(tmp_path, "check", "many.nml").stdout
    foreseen = re.search(r"about: +(\d+) cells", printed)
    assert foreseen, printed
    cells = record(run(tmp_path, text))["cells"]
    assert isinstance(cells, int)
    assert abs(int(foreseen[1]) - cells) < 0.25 * cells


def test_what_speaks_to_the_fortran_library_changes_no_file(tmp_path: Path) -> None:
    (tmp_path / "small.nml").write_text(SCENE)
    spoilt = {
        "GFORTRAN_CONVERT_UNIT": "big_endian",
        "GFORTRAN_DEFAULT_RECL": "20",
        "GFORTRAN_OPTIONAL_PLUS": "y",
        "GFORTRAN_STDOUT_UNIT": "17",
        "GFORTRAN_UNBUFFERED_ALL": "y",
    }
    for out, more in (("plain", {}), ("spoilt", spoilt)):
        done = bare(tmp_path, "run", "small.nml", "--out", out, **more)
        assert (done.returncode, done.stderr) == (0, "")
        assert f"results in {out}" in done.stdout
    files = sorted((tmp_path / "plain").rglob("*.*"))
    assert len(files) > 12
    for file in files:
        clocked = file.name in ("run.json", "run.log") or file.match("checkpoint*")
        if not clocked:  # these have times of the clock
            twin = tmp_path / "spoilt" / file.relative_to(tmp_path / "plain")
            assert twin.read_bytes() == file.read_bytes(), file.name
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plain", "small.nml", "spoilt"]


# Slip in rock of a tenth of the scene's stiffness, of modulus G = 1.6 GPa.
IN_REGION = """\
&domain x_min = -10.0, x_max = 10.0, y_min = -10.0, y_max = 10.0 /
&material
  young = 40.0e9, poisson = 0.25
  biot = 1e-6, porosity = 1e-6, permeability = 1e-30
/
&fluid compressibility = 1e-9, viscosity = 1e-3 /
&region name = 'soft', x = -20.0, 20.0, 20.0, -20.0, y = -20.0, -20.0, 20.0, 20.0, young = 4.0e9 /
&fracture name = 'f', x = -1.0, 1.0, y = 0.0, 0.0, friction = 0.6, aperture = 1e-4 /
&in_situ sxx = -20.0e6, syy = -20.0e6, sxy = 5.0e6 /
&initial pressure = 10.0e6 /
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&injection fracture = 'f', pressure = 10.0e6, 14.0e6, time = 0.0, 10.0 /
&time end = 20.0, step = 1.0 /
&coarse size_fracture = 0.1, size_boundary = 2.0 /
&output vtu = .false. /
"""


@pytest.mark.parametrize("begin", [-20.0, 0.0], ids=["all of it", "half of it"])
def test_the_moment_of_slip_in_a_region_has_its_modulus_in_both_tables(
    begin: float, tmp_path: Path
) -> None:
    outline = "x = -20.0, 20.0, 20.0, -20.0"
    assert outline in IN_REGION
    out = run(tmp_path, IN_REGION.replace(outline, f"x = {begin}, 20.0, 20.0, {begin}"))
    moments = numbers(out / "history.csv", "seismic_moment_nm")
    events = rows(out / "slip_events.csv")
    total = sum(float(event["moment_nm"]) for event in events)
    assert total == pytest.approx(moments[-1] - moments[0], rel=1e-9)
    for event in events:
        moment = float(event["moment_nm"])
        modulus = moment / (float(event["mean_slip_m"]) * float(event["area_m2"]))
        assert modulus == pytest.approx(1.6e9, rel=1e-12) if begin < -1 else 2e9 < modulus < 12e9
        magnitude = (math.log10(moment) - 9.1) / 1.5
        assert float(event["magnitude"]) == pytest.approx(magnitude, rel=1e-12)
    if begin < -1:
        assert total == pytest.approx(3.30e6, rel=0.01)


def test_a_terminal_has_a_line_that_is_renewed_and_a_file_has_none(tmp_path: Path) -> None:
    (tmp_path / "small.nml").write_text(SCENE)
    leader, terminal = pty.openpty()
    with os.fdopen(leader, "rb"), os.fdopen(terminal, "wb") as error:
        command = [str(SOLVER), "run", "small.nml", "--out", "shown"]
        done = subprocess.run(command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=error)
        assert done.returncode == 0
        assert select.select([leader], [], [], 1.0)[0], "nothing is shown"
        words = os.read(leader, 65536).decode()
    assert words.count("\r") >= 2  # it is written, and taken away at the end
    assert re.search(r"\r *[0-9]+ *%", words)
    assert "\r" not in bare(tmp_path, "run", "small.nml", "--out", "printed").stderr
