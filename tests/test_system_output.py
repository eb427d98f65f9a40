"""The table of names against files of real runs: what is written is described, and vice versa."""

from __future__ import annotations

import csv
import json
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
import pytest
import pyvista
from system_scene import SCENE, TOP, changed, rows, run, varied, with_heat
from vtkmodules.vtkCommonCore import vtkDataArray

from wingcrack.names import NAMES, columns
from wingcrack.names import table as names_of_all

pytestmark = pytest.mark.usefixtures("program")

PROBES = ("inside", "corner")
TWO_WELLS = ("well_1", "well_2")
ANY_FLUID = {
    "always",
    "with a fluid",
    "with a fluid and fractures",
    "with a fluid and wells",
    "with tips and a toughness",
}
FLUID = ANY_FLUID | {"with a fluid and one well", "with a fluid and at most one well"}
GROWING = FLUID | {"with a fluid and growth", "with a fluid, wells and growth"}
SEVERAL = ANY_FLUID | {"with a fluid and several wells"}
JOINTS = FLUID | {"with a fluid and joints"}
ENTRIES = JOINTS | {"with a fluid and wells with entries"}
HEAT = FLUID | {"with &heat", "with &heat and fractures", "with &heat and wells"}
MECHANICS = {
    "always",
    "with tips and a toughness",
    "without a fluid",
    "without a fluid, with growth",
    "with &adaptive",
}
SLIP, WELLS = "slip_events.csv", "wells.csv"  # with a fluid only
TABLES = ("history.csv", "tips.csv", "fractures.csv", "probes.csv", "events.csv", SLIP, WELLS)
OF_ENTRIES = "entries.csv"

# An edge crack that grows once on meshes that follow the error: all that mechanics can write.
EDGE_CRACK = changed(
    (TOP / "inputs/paper_b/edge_mode1.nml").read_text(),
    ("poisson = 0.3", "poisson = 0.3, toughness = 1.0e6"),
    ("intensities = .true.", "enabled = .true., increment = 0.02, stop_gain = 0.01"),
)
EDGE_CRACK += """
&adaptive enabled = .true., tolerance = 0.05 /
&probe name = 'inside', x = 0.75, y = 0.5 /
&probe name = 'corner', x = 1.0, y = 1.0 /
"""

# Two fractures that cross.
CROSSING = varied(
    (
        "&injection",
        "&fracture name = 'f2', x = 0.96, 1.04, y = 1.04, 0.96, friction = 0.5, "
        "aperture = 1.0e-3 /\n&injection",
    )
)


# One well with an entry into each of both.
TWO_ENTRIES = CROSSING.replace("fracture = 'f1'", "fracture = 'f1', 'f2'", 1)

# Two wells in one fracture.
SEVERAL_WELLS = varied(("&time", "&injection fracture = 'f1', rate = -1.0e-9 /\n&time"))


@dataclass(frozen=True)
class Entry:
    """A column, key or field as the table of names describes it."""

    name: str
    unit: str
    runs: str


@pytest.fixture(scope="module")
def described() -> dict[str, list[Entry]]:
    """Columns, keys and fields of each file, in order."""
    return {
        file: [Entry(row["name"], row["unit"], row["runs"]) for row in rows.values()]
        for file, rows in columns().items()
    }


def test_the_table_of_names_is_that_of_the_solver(program: None) -> None:
    done = subprocess.run(
        [TOP / "build/release/fortran/app/wingcrack-solver", "--describe", "json"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == NAMES.read_text(encoding="utf-8")


@pytest.fixture(scope="module", params=["fluid", "joints", "wells", "entries", "heat", "mechanics"])
def out_and_runs(
    program: None, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, set[str]]:
    """Files of a run, and the words of the table that hold for it."""
    which: str = request.param
    if which == "fluid":
        return request.getfixturevalue("growing"), GROWING
    scene, words = {
        "joints": (CROSSING, JOINTS),
        "wells": (SEVERAL_WELLS, SEVERAL),
        "entries": (TWO_ENTRIES, ENTRIES),
        "heat": (with_heat(SCENE), HEAT),
        "mechanics": (EDGE_CRACK, MECHANICS),
    }[which]
    return run(tmp_path_factory.mktemp(which), scene), words


def names(entries: list[Entry], runs: set[str]) -> list[str]:
    return [entry.name for entry in entries if entry.runs in runs]


def table(path: Path) -> tuple[list[str], list[list[str]]]:
    header, *lines = csv.reader(path.read_text().splitlines())
    return header, lines


def keys(content: object, above: str = "") -> list[str]:
    """Paths of all keys, each once, in the order of the file."""
    found: list[str] = []
    if isinstance(content, dict):
        for key, value in content.items():
            path = f"{above}.{key}" if above else str(key)
            found += [path, *keys(value, path)]
    elif isinstance(content, list):
        for item in content:
            found += keys(item, above + "[]")
    return list(dict.fromkeys(found))


def test_every_run_that_the_table_names_is_tested(described: dict[str, list[Entry]]) -> None:
    assert {entry.runs for entries in described.values() for entry in entries} == (
        GROWING | ENTRIES | SEVERAL | HEAT | MECHANICS
    )


def test_tables(described: dict[str, list[Entry]], out_and_runs: tuple[Path, set[str]]) -> None:
    out, runs = out_and_runs
    tables = [file for file in TABLES if file not in (SLIP, WELLS) or runs != MECHANICS]
    tables += [OF_ENTRIES] if runs == ENTRIES else []
    assert {path.name for path in out.glob("*.csv")} == set(tables)
    for file in tables:
        expected = names(described[file], runs)
        if file == "probes.csv":
            time, *quantities = expected
            expected = [time, *(q.replace("NAME", p) for p in PROBES for q in quantities)]
        if file == "history.csv":
            each = [
                [c.replace("NAME", w) for w in TWO_WELLS] if "NAME" in c else [c] for c in expected
            ]
            expected = [column for columns in each for column in columns]
        header, lines = table(out / file)
        assert header == expected, file
        assert lines, file


def test_units_end_the_names_of_columns(described: dict[str, list[Entry]]) -> None:
    ending = {
        "Pa m^1/2": "_pa_sqrtm",
        "J/m2": "_j_m2",
        "J/m": "_j",
        "N m/m": "_nm",
        "degree": "_deg",
        "m/s": "_m_s",
        "m2/s": "_m2_s",
        "m2/s/Pa": "_m2_s_pa",
        "N m": "_nm",
        "N m/s": "_nm_s",
    }
    for file in (*TABLES, "run.json", "network.json"):
        for entry in described[file]:
            if entry.unit != "-" and "." not in entry.name:
                assert entry.name.endswith(ending.get(entry.unit, "_" + entry.unit.lower())), entry


def test_keys_of_the_record(
    described: dict[str, list[Entry]], out_and_runs: tuple[Path, set[str]]
) -> None:
    out, runs = out_and_runs
    record = json.loads((out / "run.json").read_text())
    assert keys(record) == names(described["run.json"], runs)


def test_keys_of_the_network(
    described: dict[str, list[Entry]], out_and_runs: tuple[Path, set[str]]
) -> None:
    out, runs = out_and_runs
    network = json.loads((out / "network.json").read_text())
    expected = names(described["network.json"], runs)
    above = [key for key in expected if key.startswith(("fractures[]", "tips[]"))]
    expected += [f"steps[].{key}" for key in above]  # "as above"
    if not network["joints"]:
        expected = [key for key in expected if not key.startswith("joints[]")]
    assert sorted(keys(network)) == sorted(expected)
    assert bool(network["joints"]) == (runs in (JOINTS, ENTRIES, MECHANICS))


def test_fields(described: dict[str, list[Entry]], out_and_runs: tuple[Path, set[str]]) -> None:
    out, runs = out_and_runs
    for dimension in ("matrix", "fractures", "intersections"):
        files = sorted((out / "vtu").glob(f"{dimension}_*.vtu"))
        assert bool(files) == (dimension != "intersections" or runs >= JOINTS)
        for file in files:
            head = file.read_bytes().split(b"<PointData>", 1)[1].split(b"<AppendedData", 1)[0]
            fields = re.findall(r'Name="(\w+)"', head.decode())
            assert fields == names(described[f"{dimension}.vtu"], runs)


def test_a_plain_reader_takes_all_fields(out_and_runs: tuple[Path, set[str]]) -> None:
    out, _ = out_and_runs
    named = {
        f["fracture"]: f["name"]
        for f in json.loads((out / "network.json").read_text())["fractures"]
    }
    assert all(f"name = '{name}'" in (out / "scene.nml").read_text() for name in named.values())
    history = rows(out / "history.csv")
    for file in sorted((out / "vtu").glob("*.vtu")):
        plain, grid = meshio.read(file), pyvista.read(file)
        assert set(plain.cell_data) == set(grid.cell_data.keys())
        for name, (values,) in plain.cell_data.items():
            assert np.array_equal(values, grid.cell_data[name])
        assert plain.field_data["TimeValue"] == grid.field_data["TimeValue"]
        row = history[plain.field_data["history_row"][0] - 1]
        assert (
            float(row["time_s" if "time_s" in row else "load_factor"])
            == grid.field_data["TimeValue"]
        )
        if "fracture" in plain.cell_data:
            assert set(plain.cell_data["fracture"][0]) == set(named)


def test_paraview_finds_units(out_and_runs: tuple[Path, set[str]]) -> None:
    out, _ = out_and_runs
    last = sorted((out / "vtu").glob("fractures_*.vtu"))[-1]
    grid = pyvista.read(last)
    key = vtkDataArray.UNITS_LABEL()
    units = {"traction": "Pa", "jump": "m", "fracture": None}
    for name, unit in units.items():
        information = grid.GetCellData().GetArray(name).GetInformation()
        assert information.Get(key) == unit
    rock = pyvista.read(out / "vtu" / last.name.replace("fractures", "matrix"))
    moved = rock.point_data["nodal_displacement"]
    means = np.array([moved[cell.point_ids[:3]].mean(axis=0) for cell in rock.cell])
    error = np.abs(means - rock.cell_data["displacement"]).max()
    assert error < 0.05 * np.abs(moved).max()


def test_words(out_and_runs: tuple[Path, set[str]]) -> None:
    out, _ = out_and_runs
    words = {
        (entry["file"], entry["name"]): set(entry["words"]) for entry in names_of_all()["words"]
    }
    for file, column in (
        ("fractures.csv", "state"),
        ("events.csv", "kind"),
        (SLIP, "ended_by"),
        (WELLS, "control"),
    ):
        if not (out / file).exists():
            continue
        header, lines = table(out / file)
        assert {line[header.index(column)] for line in lines} <= words[file, column]
    assert json.loads((out / "run.json").read_text())["status"] in words["run.json", "status"]
    for joint in json.loads((out / "network.json").read_text())["joints"]:
        assert joint["kind"] in words["network.json", "joints[].kind"]


# Two layers of other constants under a weight, between smooth walls: nothing moves along x or
# along z, so that the stresses along both are the same.
LAYERS = """\
&domain x_min = 0.0, x_max = 1.0, y_min = 0.0, y_max = 2.0 /
&material young = 40.0e9, poisson = 0.2 {rock} /
&region
  name = 'upper', x = 0.0, 1.0, 1.0, 0.0, y = 1.0, 1.0, 2.0, 2.0
  young = 10.0e9, poisson = 0.35 {upper}
/
&side name = 'left', x_displacement = 0.0 /
&side name = 'right', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'top', y_traction = -10.0e6 /
"""
WET = LAYERS.format(
    rock=", biot = 0.8, porosity = 0.1, permeability = 1e-25",
    upper=", biot = 0.5, porosity = 0.05",
) + (
    "&fluid compressibility = 4e-10, viscosity = 1e-3 /\n"
    "&initial pressure = 3.0e6 /\n"
    "&time end = 10.0, step = 10.0 /\n"
    "&coarse size_fracture = 0.2, size_boundary = 0.2 /\n"
)
DRY = LAYERS.format(rock="", upper="") + "&fe size_fracture = 0.2, size_boundary = 0.2 /\n"


@pytest.mark.parametrize("scene", [WET, DRY], ids=["with a fluid", "without"])
def test_the_stress_out_of_the_plane_in_layers(scene: str, tmp_path: Path) -> None:
    out = run(tmp_path, scene)
    grid = pyvista.read(sorted((out / "vtu").glob("matrix_*.vtu"))[-1])
    height = grid.cell_centers().points[:, 1]
    xx, yy, zz = (grid.cell_data["stress"][:, k] for k in range(3))
    assert np.allclose(yy, -10.0e6, rtol=1e-6)
    assert np.allclose(zz, xx, rtol=1e-6)
    for layer, poisson, biot in ((height < 1.0, 0.2, 0.8), (height > 1.0, 0.35, 0.5)):
        pressure = grid.cell_data["pressure"][layer] if scene == WET else 0.0
        ratio = poisson / (1.0 - poisson)
        effective = yy[layer] + biot * pressure
        assert np.allclose(zz[layer], ratio * effective - biot * pressure, rtol=1e-6)
        assert abs(zz[layer]).max() > 1.0e6
