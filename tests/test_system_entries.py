"""Wells with several entries: sums, order, losses, limits, cross-flow after shut-in."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from system_scene import SOLVER, call, numbers, rows, run

pytestmark = pytest.mark.usefixtures("program")

# Three fractures of different lengths, open under a low stress, in rock that takes up no fluid.
BODY = """\
&domain x_min = -20, x_max = 20, y_min = -20, y_max = 20 /
&material young = 30e9, poisson = 0.25, biot = 1e-5, porosity = 1e-6, permeability = 1e-30 /
&fluid compressibility = 4.5e-10, viscosity = 1e-3 /
&fracture name = 'a', x = -3, 3, y = -3, -3, friction = 0.6, aperture = 2e-4 /
&fracture name = 'b', x = -2, 2, y = 0, 0, friction = 0.6, aperture = 1e-4 /
&fracture name = 'c', x = -1, 1, y = 3, 3, friction = 0.6, aperture = 1e-4 /
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&coarse size_fracture = 0.5, size_boundary = 5 /
&output vtu = .false. /
"""
LIST = "fracture = 'a', 'b', 'c'"


def flows(out: Path) -> dict[str, np.ndarray]:
    """Give the flow of each entry in time, by the number of its fracture."""
    table = rows(out / "entries.csv")
    return {
        name: np.array([float(row["flow_m2_s"]) for row in table if row["fracture"] == name])
        for name in sorted({row["fracture"] for row in table})
    }


def run_in(folder: Path, scene: str) -> Path:
    """Run in a new folder."""
    folder.mkdir()
    return run(folder, scene)


@pytest.mark.parametrize(
    "well",
    [
        "rate = 1e-5",
        "rate = 1e-5, entry_loss = 1e16",
        "rate = 1e-5, entry_loss = 1e16, 0, 2e16, x = 0, 0.3, 0, y = -3, 0, 3, friction = 1e10",
        "rate = 1e-5, storage = 1e-10, entry_loss = 1e16",
        "pressure = 1e6, entry_loss = 1e16, turbulence = 1e15",
        "rate = 3e-5, pressure = 1e6, entry_loss = 1e16",
        "rate = -1e-7, pressure = -1e5, entry_loss = 1e16",
    ],
)
def test_flows_add_up_and_pressures_agree(well: str, tmp_path: Path) -> None:
    """Each step: the sum of the flows is that of the well, and all entries have its pressure."""
    out = run(
        tmp_path,
        f"{BODY}&time end = 20 /\n&injection {LIST}, {well}, end = 10 /\n",
    )
    wells = rows(out / "wells.csv")[1:]
    sums = np.sum(list(flows(out).values()), axis=0)[1:]
    expected = np.array([float(row["flow_m2_s"]) for row in wells])
    largest = np.max(np.abs(list(flows(out).values())))
    assert sums == pytest.approx(expected, rel=1e-12, abs=1e-12 * largest)
    # what wells.csv states as injected is what the fractures hold
    history = rows(out / "history.csv")[-1]
    held = float(history["fracture_fluid_m2"])
    stored = sum(
        float(row["flow_m2_s"]) * (float(row["time_s"]) - before)
        for row, before in zip(wells, [0.0, *(float(row["time_s"]) for row in wells)], strict=False)
    )
    assert held == pytest.approx(stored, rel=1e-6)
    losses = {"1": 0.0, "2": 0.0, "3": 0.0}
    if "1e16, 0, 2e16" in well:
        losses = {"1": 1e16, "2": 0.0, "3": 2e16}
    elif "entry_loss" in well:
        losses = dict.fromkeys(losses, 1e16)
    for row in rows(out / "entries.csv")[3:]:
        flow = float(row["flow_m2_s"])
        in_well = float(row["pressure_pa"]) + losses[row["fracture"]] * abs(flow) * flow
        of_well = next(one for one in wells if one["time_s"] == row["time_s"])
        assert in_well == pytest.approx(float(of_well["pressure_pa"]), rel=1e-6, abs=1.0)


def test_the_order_of_entries_does_not_matter(tmp_path: Path) -> None:
    given = "&time end = 20 /\n&injection fracture = {}, entry_loss = {}, rate = 1e-5, end = 10 /\n"
    one = run_in(tmp_path / "one", BODY + given.format("'a', 'b', 'c'", "1e15, 2e15, 3e15"))
    other = run_in(tmp_path / "other", BODY + given.format("'c', 'a', 'b'", "3e15, 1e15, 2e15"))
    for name, flow in flows(one).items():
        assert flows(other)[name] == pytest.approx(flow, rel=1e-6, abs=1e-13)


def test_a_list_of_one_name_and_no_loss_is_a_plain_well(tmp_path: Path) -> None:
    """The tables are equal byte for byte, and there is none of entries."""
    texts = []
    for name, well in (("plain", "fracture = 'a'"), ("list", "fracture = 'a', entry_loss = 0")):
        out = run_in(tmp_path / name, f"{BODY}&time end = 5 /\n&injection {well}, rate = 1e-5 /\n")
        assert not (out / "entries.csv").exists()
        texts.append([(out / file).read_bytes() for file in ("history.csv", "wells.csv")])
    assert texts[0] == texts[1]


def test_a_loss_at_one_entry_is_that_of_a_turbulent_well(tmp_path: Path) -> None:
    """The head has the same pressure, and the fracture the same fluid."""
    runs = [
        run_in(
            tmp_path / name,
            f"{BODY}&time end = 5, step = 0.5 /\n&injection fracture = 'a', {loss} = 1e16, "
            "rate = 1e-5, storage = 1e-12 /\n",
        )
        for name, loss in (("well", "turbulence"), ("entry", "entry_loss"))
    ]
    heads = [numbers(out / "wells.csv", "head_pressure_pa")[1:] for out in runs]
    assert heads[1] == pytest.approx(heads[0], rel=1e-8)
    assert flows(runs[1])["1"][1:] == pytest.approx(numbers(runs[0] / "wells.csv", "flow_m2_s")[1:])


def test_fluid_flows_between_fractures_after_shut_in(tmp_path: Path) -> None:
    """Losses hold pressures apart while the well flows; afterwards they become equal."""
    out = run(
        tmp_path,
        f"{BODY}&time end = 2000 /\n&injection {LIST}, rate = 1e-5, entry_loss = 1e17, "
        "end = 10 /\n",
    )
    table = rows(out / "entries.csv")
    after = [row for row in table if float(row["time_s"]) > 10.0]
    assert max(abs(float(row["flow_m2_s"])) for row in after) > 1e-8
    assert {row["share"] for row in after} == {"0.0"}
    pressures = [float(row["pressure_pa"]) for row in table[-3:]]
    assert max(pressures) - min(pressures) < 0.02 * max(pressures)
    history = rows(out / "history.csv")
    end = [row for row in history if float(row["time_s"]) >= 10.0]
    held = [float(row["fracture_fluid_m2"]) for row in end]
    assert held == pytest.approx([1e-4] * len(held), rel=1e-6)


@pytest.mark.parametrize(
    "others",
    [
        "&injection name = 'B', fracture = 'a', 'b', rate = 1e-5 /",
        "&injection name = 'B', fracture = 'a', 'c', pressure = 2e6 /",
        "&injection name = 'B', fracture = 'a', pressure = 1e6 /",
        "&injection name = 'B', fracture = 'b', 'c', rate = 1e-5 /\n"
        "&injection name = 'C', fracture = 'c', 'a', rate = 1e-5 /",
    ],
)
def test_meeting_entries_without_losses_are_refused(others: str, tmp_path: Path) -> None:
    """Flow round through wells is not determined; with a loss in each loop it is."""
    control = "pressure = 1e6" if "pressure" in others else "rate = 1e-5"
    first = f"&injection name = 'A', fracture = 'a', 'b', {control} /"
    (tmp_path / "meet.nml").write_text(f"{BODY}&time end = 1 /\n{first}\n{others}\n")
    words = [str(SOLVER), "check", str(tmp_path / "meet.nml")]
    told = subprocess.run(words, capture_output=True, text=True, check=False)
    assert told.returncode == 2
    # the well with entries; of several the last one
    last = 12 if "fracture = 'a', pressure" in others else 12 + len(others.splitlines())
    assert f"meet.nml:{last}: &injection: fracture '" in told.stderr
    assert "give entry_loss, or other points" in told.stderr
    lossy = first.replace(" /", ", entry_loss = 1e16 /")
    if "pressure" in others:
        lossy = lossy.replace("pressure", "friction = 1e9, pressure")
    run(tmp_path, f"{BODY}&time end = 1 /\n{lossy}\n{others}\n")


POINTS = {"a": (1.1, -3.0), "b": (-0.3, 0.0), "c": (0.4, 3.0)}
LOSSES = {"a": 1e16, "b": 3e15, "c": 2e16}
HALF = {"a": 3.0, "b": 2.0, "c": 1.0}
TURNS: dict[str, Callable[[float, float], tuple[float, float]]] = {
    "as it is": lambda x, y: (x, y),
    "mirrored": lambda x, y: (-x, y),
    "upside down": lambda x, y: (x, -y),
    "turned by 90 degrees": lambda x, y: (-y, x),
}


def placed(turn: str, order: str = "abc", thickness: float = 0.0) -> str:
    """Give a scene with a well of three entries in another place, order or unit."""
    move = TURNS[turn]
    lines = [line for line in BODY.splitlines() if not line.startswith("&fracture")]
    for name in order:
        y = POINTS[name][1]
        ends = [move(x, y) for x in (-HALF[name], HALF[name])]
        listed = ", ".join(f"{x}" for x, _ in ends), ", ".join(f"{y}" for _, y in ends)
        aperture = "2e-4" if name == "a" else "1e-4"
        lines.append(
            f"&fracture name = '{name}', x = {listed[0]}, y = {listed[1]}, friction = 0.6,"
            f" aperture = {aperture} /"
        )
    points = [move(*POINTS[name]) for name in order]
    rate = f"rate_l_s = {1e-5 * thickness * 1e3!r}" if thickness else "rate = 1e-5"
    names = ", ".join(f"'{name}'" for name in order)
    losses = ", ".join(f"{LOSSES[name]}" for name in order)
    xs, ys = (", ".join(f"{point[k]}" for point in points) for k in (0, 1))
    lines.append(f"&injection fracture = {names}, x = {xs}, y = {ys}, entry_loss = {losses},")
    lines.append(f"  {rate}, end = 10 /")
    lines.append("&time end = 20, step = 1 /")
    if thickness:
        lines.append(f"&scene thickness = {thickness} /")
    return "\n".join(lines) + "\n"


def shares(out: Path, order: str = "abc") -> dict[str, np.ndarray]:
    return {order[int(number) - 1]: flow for number, flow in flows(out).items()}


@pytest.fixture(scope="module")
def as_it_is(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("as_it_is"), placed("as it is"))


@pytest.mark.parametrize(
    ("turn", "order"),
    [
        ("mirrored", "abc"),
        ("upside down", "abc"),
        ("turned by 90 degrees", "abc"),
        ("as it is", "cab"),
        ("mirrored", "bca"),
    ],
)
def test_place_and_order_do_not_matter(
    turn: str, order: str, as_it_is: Path, tmp_path: Path
) -> None:
    """Other meshes: 2 % of the largest flow, that of volumes of cracks (verification/clusters)."""
    expected = shares(as_it_is)
    found = shares(run(tmp_path, placed(turn, order)), order)
    for name, flow in expected.items():
        assert found[name] == pytest.approx(flow, abs=0.02 * 1e-5), name


def test_thickness_and_units_do_not_matter(as_it_is: Path, tmp_path: Path) -> None:
    expected = shares(as_it_is)
    found = shares(run(tmp_path, placed("as it is", thickness=30.0)))
    for name, flow in expected.items():
        assert found[name] == pytest.approx(flow, rel=1e-9, abs=1e-9 * 1e-5)


def test_threads_do_not_matter(as_it_is: Path, tmp_path: Path) -> None:
    (tmp_path / "small.nml").write_text(placed("as it is"))
    done = call(tmp_path, "run", "small.nml", "--threads", "2", "--out", "out", "--no-plot")
    assert done.returncode == 0
    expected, found = shares(as_it_is), shares(tmp_path / "out")
    for name, flow in expected.items():
        assert found[name] == pytest.approx(flow, rel=1e-9, abs=1e-9 * 1e-5)


JOINT = """\
&fracture name = 'd', x = {0}, {0}, y = -6, 0, friction = 0.6, aperture = 1e-4 /
&injection fracture = 'a', 'b', x = {0}, {1}, y = -3, 0, entry_loss = 1e16, rate = 1e-5 /
&time end = 10, step = 1 /
"""


@pytest.mark.parametrize("x", [0.0, 0.25, 0.1])
def test_an_entry_where_fractures_cross(x: float, tmp_path: Path) -> None:
    """'d' crosses 'a' and ends at 'b': at an entry, or in its cell; fluid is kept, flows add up."""
    out = run(tmp_path, BODY + JOINT.format(x, x))
    total = np.sum(list(flows(out).values()), axis=0)[1:]
    assert total == pytest.approx(1e-5, rel=1e-12)
    history = rows(out / "history.csv")[-1]
    assert float(history["fracture_fluid_m2"]) == pytest.approx(1e-4, rel=1e-6)
    assert all(np.all(flow[1:] > 0.0) for flow in flows(out).values())
