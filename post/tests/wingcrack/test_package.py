"""The Python package: runs that are whole, going on, failed or damaged, as frames and arrays."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import wingcrack
from synthetic_run import GROWTH_STEP, HOUR, STEPS, times, well_pressure
from wingcrack.names import columns
from wingcrack.runs.units import column_unit, column_words, field_unit
from wingcrack.view.content import Content

TOP = Path(__file__).resolve().parents[3]


def described() -> list[tuple[str, str, str]]:
    """File, name and unit of every column and field, as the solver describes its output."""
    return [
        (file, name, row["unit"]) for file, rows in columns().items() for name, row in rows.items()
    ]


def test_units_are_those_of_the_solver() -> None:
    columns = [(file, name, unit) for file, name, unit in described() if file.endswith(".csv")]
    fields = [(name, unit) for file, name, unit in described() if file.endswith(".vtu")]
    assert len(columns) > 80
    assert len(fields) > 10
    assert field_unit("stress") == "Pa"
    assert field_unit("state") == "-"
    for file, name, unit in columns:
        assert column_unit(name) == unit, (file, name)
    for name, unit in fields:
        assert field_unit(name) == unit


def test_a_column_in_words() -> None:
    assert column_words("well_pressure_pa") == "well pressure"
    assert column_words("n_open") == "n open"


def test_frames_have_units_and_values(wet_run: Path) -> None:
    run = wingcrack.open(wet_run)
    assert run.history.attrs["units"]["well_pressure_pa"] == "Pa"
    assert run.history.well_pressure_pa.iloc[3] == well_pressure(3)
    assert run.history.n_tips.dtype == np.int64
    assert len(run.tips) == 2 * STEPS
    assert set(run.fractures.state) == {"stick", "slip", "open"}
    assert run.events.kind.tolist() == ["growth"]
    assert run.events.time_s.iloc[0] == times()[GROWTH_STEP - 1]
    assert run.network["fractures"][0]["name"] == "flaw"
    assert run.scene["material.young"] == 40e9
    assert (run.name, run.status, run.warnings) == ("synthetic", "finished", [])


def test_a_column_without_pandas(wet_run: Path) -> None:
    code = (
        "import sys, wingcrack\n"
        f"run = wingcrack.open({str(wet_run)!r})\n"
        "print(run.column('well_pressure_pa')[0])\n"
        "assert not {'pandas', 'matplotlib', 'pyvista'} & set(sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=TOP / "post", capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("7000000.0\n", "")


def test_fields_are_those_of_the_nearest_state(wet_run: Path) -> None:
    run = wingcrack.open(wet_run)
    assert run.field_moments == pytest.approx(times())
    found = run.fields(11.0 * HOUR)
    assert found.moment == 10.0 * HOUR
    assert found.triangles.shape == (288, 3)
    assert found.of_rock("stress.yy") == pytest.approx(-10e6)
    assert found.units["pressure"] == "Pa"
    assert len(found.segments) == len(found.fractures["state"])
    assert run.fields().moment == times()[-1]
    with pytest.raises(wingcrack.AbsentError, match="no field 'temperature' here"):
        found.of_rock("temperature")
    with pytest.raises(wingcrack.AbsentError, match=r"needs one of stress\.xx, stress\.yy"):
        found.of_rock("stress")
    for wanted in (float("nan"), float("inf"), "24h", [1.0], 1j):
        with pytest.raises(wingcrack.RunError, match="is no time: a number is needed"):
            run.fields(wanted)  # type: ignore[arg-type]


def test_what_is_no_run(tmp_path: Path) -> None:
    with pytest.raises(wingcrack.RunError, match="there is no such folder"):
        wingcrack.open(tmp_path / "nowhere")
    with pytest.raises(wingcrack.RunError, match="this folder contains no run"):
        wingcrack.open(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(wingcrack.RunError, match="it is a file"):
        wingcrack.open(tmp_path / "file")


def test_an_unknown_column_names_the_nearest(wet_run: Path) -> None:
    run = wingcrack.open(wet_run)
    with pytest.raises(wingcrack.RunError, match="did you mean 'well_pressure_pa'"):
        run.column("well_presure_pa")
    with pytest.raises(wingcrack.RunError, match="there is no table 'histories'"):
        run.column("time_s", "histories")


def test_a_run_that_failed_before_its_first_step(tmp_path: Path) -> None:
    record = {"scene": "s", "status": "failed", "reason": "no convergence", "warnings": ["w"]}
    (tmp_path / "run.json").write_text(json.dumps(record), encoding="utf-8")
    run = wingcrack.open(tmp_path)
    assert (run.status, run.reason, run.warnings) == ("failed", "no convergence", ["w"])
    with pytest.raises(wingcrack.AbsentError, match=r"no history.csv \(run failed: no converg"):
        _ = run.history
    with pytest.raises(wingcrack.AbsentError, match="no fields"):
        run.fields()
    with pytest.raises(wingcrack.AbsentError, match=r"no scene.nml"):
        _ = run.scene


def test_a_run_that_goes_on(own_run: Path) -> None:
    (own_run / "run.json").unlink()
    path = own_run / "history.csv"
    whole = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(whole[:4]) + whole[4][:10], encoding="utf-8")  # cut within a row
    run = wingcrack.open(own_run)
    assert (run.status, len(run.history)) == ("running", 3)
    path.write_text("".join(whole), encoding="utf-8")
    assert len(run.history) == 3
    assert len(run.refresh().history) == STEPS


@pytest.mark.parametrize("name", ["run.json", "network.json"])
def test_json_that_is_cut_off(own_run: Path, name: str) -> None:
    path = own_run / name
    path.write_bytes(path.read_bytes()[:-5])
    run = wingcrack.open(own_run)
    with pytest.raises(wingcrack.RunError, match=f"{name}: the file is no valid JSON"):
        _ = (run.status, run.network)


def test_fields_that_are_cut_off(own_run: Path) -> None:
    path = own_run / "matrix_0012.vtu"
    path.write_bytes(path.read_bytes()[:-2000])
    with pytest.raises(wingcrack.RunError, match=r"matrix_0012.vtu: the file is damaged"):
        wingcrack.open(own_run).fields()


def test_words_where_numbers_belong(own_run: Path) -> None:
    path = own_run / "history.csv"
    path.write_text(path.read_text(encoding="utf-8").replace("7000000.0", "much"), encoding="utf-8")
    with pytest.raises(wingcrack.RunError, match="'much' in column 'well_pressure_pa' is no numb"):
        _ = wingcrack.open(own_run).history


def test_a_whole_number_of_any_length_is_a_number(own_run: Path) -> None:
    history = own_run / "history.csv"
    head, *rows = history.read_text().splitlines()
    history.write_text("\n".join([f"{head},many", *(f"{row},{'9' * 30}" for row in rows), ""]))
    assert wingcrack.open(own_run).history["many"].max() == 1e30


def test_a_network_that_lacks_what_wells_need(own_run: Path) -> None:
    network = own_run / "network.json"
    content = json.loads(network.read_text())
    content["fractures"] = [{"fracture": 1}]
    network.write_text(json.dumps(content))
    with pytest.raises(wingcrack.RunError, match="the network is damaged"):
        Content(own_run).overview()


def test_a_table_without_rows(own_run: Path) -> None:
    path = own_run / "tips.csv"
    path.write_text(path.read_text(encoding="utf-8").splitlines()[0] + "\n", encoding="utf-8")
    run = wingcrack.open(own_run)
    assert (len(run.tips), run.tips.attrs["units"]["keq_pa_sqrtm"]) == (0, "Pa m^1/2")
    with pytest.raises(wingcrack.AbsentError, match=r"tips.csv has no rows"):
        run.plot_tips()


def test_figures_by_name_and_all(own_run: Path) -> None:
    run = wingcrack.open(own_run)
    assert run.figure("fracture_1").get_suptitle() == "flaw"
    with pytest.raises(wingcrack.RunError, match="there is no figure 'fracture_7'"):
        run.figure("fracture_7")
    drawn = run.draw(only=("summary", "tips"), formats=("png",))
    names = [file.name for file in drawn]
    assert names == [
        "summary.png",
        "intensities.png",
        "development.png",
        "balance.png",
        "captions.txt",
        "index.html",
    ]
    assert all(file.is_file() for file in drawn)


def test_importing_brings_nothing_else() -> None:
    code = "import wingcrack, sys; assert not {'numpy', 'pandas', 'f90nml'} & set(sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], cwd=TOP / "post", check=False)
    assert done.returncode == 0
    with pytest.raises(AttributeError, match="no attribute 'opens'"):
        _ = wingcrack.opens


def test_a_run_shows_itself_in_a_notebook(wet_run: Path) -> None:
    text = wingcrack.open(wet_run)._repr_html_()
    assert text.startswith("<table>")
    assert "status" in text
    assert str(wet_run) in text


def test_histories_as_a_dataset(wet_run: Path) -> None:
    pytest.importorskip("xarray")
    run = wingcrack.open(wet_run)
    data = run.to_xarray()
    assert data["time_s"].values.tolist() == run.moments.tolist()
    assert data["injected_m2"].attrs["units"] == "m2"
    assert data["injected_m2"].values.tolist() == run.column("injected_m2").tolist()


def test_rock_as_a_mesh(own_run: Path) -> None:
    pytest.importorskip("pyvista")
    run = wingcrack.open(own_run)
    fields = run.fields(0.0)
    mesh = run.mesh(0.0)
    assert mesh.n_cells == len(fields.triangles)
    assert mesh.cell_data["pressure"] == pytest.approx(fields.rock["pressure"])
