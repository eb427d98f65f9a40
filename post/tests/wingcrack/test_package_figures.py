"""Each figure function in a script of five lines, and what its axes show then."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.image import imread

import wingcrack
from synthetic_run import (
    GROWTH_STEP,
    LAST_WING,
    LENGTH,
    STEPS,
    fracture_cells,
    polyline,
    square,
    times,
    well_pressure,
    wing_length,
)

POST = Path(__file__).resolve().parents[2]
SCRIPT = """\
import matplotlib, wingcrack; matplotlib.use("agg")
run = wingcrack.open({run!r})
ax = {call}
ax.figure.savefig("figure.png")
print(len(ax.lines) + len(ax.collections))
"""


CALLS = (
    "run.plot_history()",
    "run.plot_history('max_slip_m', color='red')",
    "run.plot_tips('k1')",
    "run.plot_map('pressure', 3600, close=True)",
    "run.plot_map('displacement.x')",
    "run.plot_profile('jump_t_m', 'flaw')",
    "run.plot_states()",
    "run.plot_network()",
    "run.plot_network('state')",
    "run.plot_wells('flow')",
    "run.plot_load()",
    "run.plot_equilibrium()",
    "run.figure('balance').axes[0]",
    "wingcrack.compare([run, run], 'fracture_length_m', labels=['a', 'b'])",
)


@pytest.fixture(scope="module")
def full_run(wet_run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Add what not every run has: how the network has grown, and a well."""
    folder = tmp_path_factory.mktemp("full") / "run"
    shutil.copytree(wet_run, folder, ignore=shutil.ignore_patterns("figures"))
    steps = []
    for step in (0, STEPS - 1):
        (x, y), wing = polyline(step).T.tolist(), wing_length(step)
        fracture = {"fracture": 1, "name": "flaw", "x_m": x, "y_m": y, "s_start_m": -wing}
        steps.append({"time_s": times()[step], "fractures": [fracture]})
    network = {**steps[-1], "joints": [], "steps": steps}
    (folder / "network.json").write_text(json.dumps(network), encoding="utf-8")
    rows = [f"{t},inner,1e-9,1e-9,{well_pressure(k)}" for k, t in enumerate(times())]
    head = "time_s,well,rate_m2_s,flow_m2_s,pressure_pa"
    (folder / "wells.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def load_run(dry_run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Let a load drive the run without a fluid."""
    folder = tmp_path_factory.mktemp("load") / "run"
    shutil.copytree(dry_run, folder, ignore=shutil.ignore_patterns("figures"))
    for table in folder.glob("*.csv"):
        text = table.read_text(encoding="utf-8")
        table.write_text(text.replace("time_s", "load_factor", 1), encoding="utf-8")
    history = folder / "history.csv"
    head, *lines = history.read_text(encoding="utf-8").splitlines()
    lines = [f"{head},fracture_volume_m2,strain_energy_j", *(f"{line},1e-6,1.0" for line in lines)]
    history.write_text("\n".join([*lines, ""]), encoding="utf-8")
    with (folder / "scene.nml").open("a", encoding="utf-8") as scene:
        scene.write("&growth enabled = .true., law = 'equilibrium' /\n")
    return folder


def test_every_figure_function_has_a_script() -> None:
    functions = {f"run.{name}" for name in dir(wingcrack.Run) if name.startswith("plot_")}
    assert functions <= {call.partition("(")[0] for call in CALLS}


@pytest.mark.parametrize("call", CALLS)
def test_five_lines_make_a_figure(
    full_run: Path,
    load_run: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    call: str,
) -> None:
    run = load_run if "plot_load" in call or "equilibrium" in call else full_run
    code = SCRIPT.format(run=str(run), call=call)
    assert code.count("\n") == 5
    monkeypatch.chdir(tmp_path)
    exec(compile(code, call, "exec"), {})
    assert int(capsys.readouterr().out) > 0
    assert float(imread("figure.png").std()) > 0.02


def test_five_lines_are_a_script(full_run: Path, tmp_path: Path) -> None:
    """In a process of their own, where no warning is given."""
    code = SCRIPT.format(run=str(full_run), call=CALLS[0])
    environment = {**os.environ, "PYTHONPATH": str(POST)}
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.fixture(autouse=True)
def _without_windows() -> None:
    matplotlib.use("agg")
    pyplot.close("all")


def test_axes_of_the_user_are_used(wet_run: Path) -> None:
    run = wingcrack.open(wet_run)
    mine = Figure().subplots()
    assert run.plot_history("well_pressure_pa", mine, label="mine") is mine
    assert pyplot.get_fignums() == []
    (line,) = mine.lines
    assert np.allclose(line.get_xdata(), times() / 3600.0)
    assert np.allclose(line.get_ydata(), [well_pressure(k) / 1e6 for k in range(STEPS)])
    assert (mine.get_ylabel(), line.get_label()) == ("well pressure [MPa]", "mine")


def test_runs_in_one_figure(wet_run: Path, own_run: Path) -> None:
    path = own_run / "history.csv"
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(lines[:2]), encoding="utf-8")  # 5 h: by itself it would have hours too
    runs = [wingcrack.open(wet_run), wingcrack.open(own_run)]
    axes = wingcrack.compare(runs, "fracture_length_m")
    length = np.asarray(axes.lines[0].get_ydata())[-1]
    assert length == pytest.approx(1e3 * (LENGTH + 2 * LAST_WING))  # [mm]
    assert np.asarray(axes.lines[1].get_xdata())[-1] == pytest.approx(5.0)
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [
        f"synthetic ({folder.name})" for folder in (wet_run, own_run)
    ]


def test_each_tip_has_its_lines_and_its_colour_in_the_legend(wet_run: Path) -> None:
    axes = wingcrack.open(wet_run).plot_tips("k1")
    legend = axes.get_legend()
    assert legend is not None
    words = [text.get_text() for text in legend.get_texts()]
    colours = dict(zip(words, [line.get_color() for line in legend.get_lines()], strict=True))
    assert words[2:] == ["lines: interaction integral", "circles: displacement correlation"]
    steps = np.arange(STEPS)
    for tip in (1, 2):
        k1 = 0.02 * steps + np.where(steps > GROWTH_STEP, 0.35, 0.0) + 0.01 * tip  # [MPa m^1/2]
        colour = colours[f"tip {tip} (flaw)"]
        lines, circles = (one for one in axes.lines if one.get_markeredgecolor() == colour)
        assert (circles.get_linestyle(), circles.get_marker()) == ("None", "o")
        assert lines.get_ydata() == pytest.approx(k1)
        assert circles.get_ydata() == pytest.approx(1.02 * k1)
        assert lines.get_xdata() == pytest.approx(times() / 3600.0)


def test_a_profile_shows_the_cells(wet_run: Path) -> None:
    axes = wingcrack.open(wet_run).plot_profile("jump_n_m", 1, times=[times()[-1]])
    cells = fracture_cells(STEPS - 1)
    drawn = next(line for line in axes.lines if np.size(line.get_xdata()) == cells.s.size)
    assert np.max(drawn.get_ydata()) == pytest.approx(1e6 * cells.jump_n.max())


def test_a_map_has_its_colours_in_mpa(wet_run: Path) -> None:
    axes = wingcrack.open(wet_run).plot_map()
    values = axes.collections[0].get_array()
    assert values is not None
    assert 6.8 <= values.min() < values.max() <= well_pressure(STEPS - 1) / 1e6
    assert "pore pressure [MPa]" in [other.get_ylabel() for other in axes.figure.axes]


@pytest.mark.parametrize(
    ("field", "label", "slope", "value"),
    [
        ("stress.mean", "mean in-plane stress [MPa]", 0.0, -15.0),  # of -20 and -10
        ("stress.yy", "stress, yy [MPa]", 0.0, -10.0),
        ("displacement.x", "displacement, x [mm]", -0.4, 0.0),  # by the strain
    ],
)
def test_a_map_has_the_values_of_the_cells(
    wet_run: Path, field: str, label: str, slope: float, value: float
) -> None:
    axes = wingcrack.open(wet_run).plot_map(field, times()[-1])
    assert label in [other.get_ylabel() for other in axes.figure.axes]
    points, triangles = square(12)
    x = points[triangles].mean(axis=1)[:, 0]
    drawn = axes.collections[0].get_array()
    assert np.asarray(drawn) == pytest.approx(value + slope * x, rel=1e-6)


def test_without_a_fluid(dry_run: Path) -> None:
    run = wingcrack.open(dry_run)
    assert run.plot_history().get_ylabel().startswith("fracture length")
    assert run.plot_map("stress.mean").collections
    with pytest.raises(wingcrack.AbsentError, match="no field 'pressure' here"):
        run.plot_map()


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        ("run.plot_tips('k3')", "RunError", "quantity 'k3' cannot be drawn; there are k1, k2"),
        ("run.plot_profile('state')", "RunError", "column 'state' cannot be drawn"),
        ("run.plot_profile(fracture=7)", "RunError", "there is no fracture '7'; the run has flaw"),
        ("run.plot_network('depth')", "RunError", "colour 'depth' cannot be drawn"),
        ("run.plot_network()", "AbsentError", "does not tell how the network has grown"),
        ("run.plot_wells()", "AbsentError", "the run has no wells.csv"),
        ("run.plot_load()", "AbsentError", "no load factor drives the run"),
        ("wingcrack.compare([])", "RunError", "at least one run"),
        ("wingcrack.compare([run], labels=['a', 'b'])", "RunError", "1 runs and 2 labels"),
        ("run.movie('a.avi')", "RunError", "a movie's name ends with .gif or .mp4"),
        ("run.movie('no/where.gif')", "RunError", "there is no folder no"),
        ("run.movie('a.gif', frames_per_second=0)", "RunError", "0 states per second"),
        ("run.movie('a.gif', size=(10, 10))", "RunError", "64 to 4096 pixels"),
    ],
)
def test_refusals_are_a_sentence_and_leave_no_figure(
    wet_run: Path, call: str, error: str, message: str
) -> None:
    run = wingcrack.open(wet_run)
    with pytest.raises(getattr(wingcrack, error), match=message.replace(".", r"\.")) as caught:
        eval(call, {"run": run, "wingcrack": wingcrack})
    assert "\n" not in str(caught.value)
    assert pyplot.get_fignums() == []


def test_a_movie_without_a_display(own_run: Path, tmp_path: Path) -> None:
    from PIL import Image

    for name in ("matrix", "fractures"):  # three states are enough
        path = own_run / f"{name}.pvd"
        lines = path.read_text(encoding="utf-8").splitlines()
        path.write_text("\n".join(lines[:6] + lines[-2:]), encoding="utf-8")
    code = (
        "import wingcrack\n"
        f"run = wingcrack.open({str(own_run)!r})\n"
        "run.movie('movie.gif', size=(200, 150), progress=False)\n"
        "run.scene3d(time=0.0).screenshot('scene.png')\n"
    )
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=tmp_path,
        env={**environment, "PYTHONPATH": str(POST)},
        capture_output=True,
        text=True,
        check=False,
    )
    if "drawing without a display needs" in done.stderr:
        pytest.skip("no EGL here")
    assert (done.returncode, done.stderr) == (0, "")
    with Image.open(tmp_path / "movie.gif") as movie:
        assert (movie.n_frames, movie.size) == (3, (200, 150))  # type: ignore[attr-defined]
        movie.seek(2)
        last = np.asarray(movie.convert("RGB"), dtype=float)
    assert last.std() > 20.0
    assert imread(tmp_path / "scene.png").shape[:2] == (720, 960)
    assert sorted(path.name for path in tmp_path.glob("*")) != []
    assert not list(tmp_path.glob(".movie*"))


def test_fractures_of_a_map_by_slip(wet_run: Path) -> None:
    run = wingcrack.open(wet_run)
    axes = run.plot_map(fractures_by="slip")
    fields = run.fields()
    lines = next(
        item
        for item in axes.collections
        if isinstance(item, LineCollection) and item.get_array() is not None
    )
    slip = np.abs(fields.fractures["jump"][:, 1])
    drawn = np.asarray(lines.get_array())
    assert np.all(np.diff(drawn) >= 0.0)  # the largest on top
    assert drawn.max() / drawn.sum() == pytest.approx(slip.max() / slip.sum())
    with pytest.raises(wingcrack.RunError, match="fractures_by 'colour' cannot be drawn"):
        run.plot_map(fractures_by="colour")
