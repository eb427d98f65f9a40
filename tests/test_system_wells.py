"""Wells under limits, conflicting wells, wells with storage: what each does, and its sums."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from system_scene import bare, numbers, record, rows, run

from wingcrack.figures.facts import gather_facts
from wingcrack.figures.read import read_run
from wingcrack.figures.story import story

pytestmark = pytest.mark.usefixtures("program")

# A closed fracture in a rock at 20 MPa; its fluid flows off through two sides.
BODY = """\
&domain x_min = -10, x_max = 10, y_min = -10, y_max = 10 /
&material young = 30e9, poisson = 0.25, biot = 0.6, porosity = 0.05, permeability = 1e-16 /
&fluid compressibility = 4.5e-10, viscosity = 1e-3 /
&fracture name = 'c', x = -1, 1, y = 0, 0, friction = 0.6, aperture = 1e-4 /
&in_situ sxx = -70e6, syy = -60e6 /
&initial pressure = 20e6 /
&side name = 'left', x_displacement = 0, pressure = 20e6 /
&side name = 'right', pressure = 20e6 /
&side name = 'bottom', y_displacement = 0 /
&coarse size_fracture = 0.2, size_boundary = 3 /
&output vtu = .false. /
"""

# A fracture of four cells from side to side of a stiff body that takes up no fluid, with the
# pressure 0 at both of its ends: what a well in its middle gives flows through half of it each way.
PIPE = """\
&domain x_min = -1.0, x_max = 1.0, y_min = -1.0, y_max = 1.0 /
&material young = 40.0e9, poisson = 0.2, biot = 1e-6, porosity = 1e-6, permeability = 1e-30 /
&fluid compressibility = 4.0e-10, viscosity = 1.0e-3 /
&fracture name = 'f', x = -1.0, 1.0, y = 0.0, 0.0, friction = 1.0, aperture = 1.0e-4 /
&side name = 'left', x_displacement = 0.0, pressure = 0.0 /
&side name = 'right', x_displacement = 0.0, pressure = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'top', y_traction = -40.0e6 /
&time end = 100.0 /
&coarse size_fracture = 0.5, size_boundary = 0.5 /
&output vtu = .false. /
"""

# Rock alone, its sides at the pressure 0.
ROCK = """\
&domain x_min = -1.0, x_max = 1.0, y_min = -1.0, y_max = 1.0 /
&material young = 40.0e9, poisson = 0.2, biot = 0.8, porosity = 0.1, permeability = 1.0e-18 /
&fluid compressibility = 4.0e-10, viscosity = 1.0e-3 /
&side name = 'left', x_displacement = 0.0, pressure = 0.0 /
&side name = 'bottom', y_displacement = 0.0, pressure = 0.0 /
&side name = 'right', pressure = 0.0 /
&side name = 'top', pressure = 0.0 /
&time end = 1.0e5 /
&coarse size_boundary = 0.2 /
&output vtu = .false. /
"""


def of_well(out: Path, name: str) -> list[dict[str, str]]:
    """Give the rows of a well."""
    return [row for row in rows(out / "wells.csv") if row["well"] == name]


def sums_agree(out: Path) -> None:
    """What history.csv says was injected is what the wells have taken, in every state."""
    taken: dict[str, float] = {}
    for row in rows(out / "wells.csv"):
        taken[row["time_s"]] = taken.get(row["time_s"], 0.0) + float(row["injected_m2"])
    history = {row["time_s"]: float(row["injected_m2"]) for row in rows(out / "history.csv")}
    assert history == pytest.approx(taken, rel=1e-12, abs=1e-30)


@pytest.mark.parametrize(
    "well",
    [
        "rate = 1e-6, pressure = 10e6",
        "rate = -1e-6, pressure = 30e6",
        "rate = 1e-6, pressure = 10e6, storage = 1e-12",
        "rate = 1e-6, pressure = 10e6, x = 0.3, y = 0, friction = 1e10, turbulence = 1e16",
    ],
)
def test_a_limit_on_the_wrong_side_of_the_pressure_shuts_the_well(
    well: str, tmp_path: Path
) -> None:
    """Its flow was rounding, which was followed in time: steps fell to 1e-18 s and below."""
    out = run(tmp_path, f"{BODY}&time end = 36000 /\n&injection name='w', fracture='c', {well} /\n")
    table = of_well(out, "w")[1:]
    assert {row["control"] for row in table} == {"limit"}
    assert {float(row["rate_m2_s"]) for row in table} == {0.0}
    assert max(abs(float(row["flow_m2_s"])) for row in table) < 1e-18
    assert numbers(out / "history.csv", "time_s")[-1] == 36000.0
    assert len(table) < 60


def test_a_limit_that_is_the_pressure_there_already(tmp_path: Path) -> None:
    well = "&injection name = 'w', fracture = 'c', rate = 1e-6, pressure = 20e6 /\n"
    out = run(tmp_path, f"{BODY}&time end = 36000 /\n{well}")
    table = of_well(out, "w")[1:]
    assert {row["control"] for row in table} == {"limit"}
    assert {float(row["asked_m2_s"]) for row in table} == {1e-6}
    assert max(abs(float(row["rate_m2_s"])) for row in table) < 1e-15
    assert len(table) < 60


def test_two_wells_that_conflict(tmp_path: Path) -> None:
    wells = """\
&time end = 36000 /
&injection name = 'A', fracture = 'c', x = -0.8, y = 0, rate = 1e-6 /
&injection name = 'B', fracture = 'c', x = 0.8, y = 0, pressure = 30e6, start = 600 /
"""
    out = run(tmp_path, BODY + wells)
    assert {float(row["rate_m2_s"]) for row in of_well(out, "A")[1:]} == {1e-6}
    late = [row for row in of_well(out, "B") if float(row["time_s"]) > 600.0]
    assert {row["control"] for row in late} == {"pressure"}
    assert [float(row["pressure_pa"]) for row in late] == pytest.approx(len(late) * [30e6])
    early = [row for row in of_well(out, "B") if float(row["time_s"]) <= 600.0]
    assert {float(row["flow_m2_s"]) for row in early} == {0.0}
    assert numbers(out / "history.csv", "time_s")[-1] == 36000.0
    assert len(late) < 200
    sums_agree(out)


@pytest.mark.parametrize(
    ("one", "other", "controls"),
    [
        ("rate = 1e-6, pressure = 25e6", "rate = 2e-6, pressure = 25e6", ["limit", "limit"]),
        ("rate = 1e-6, pressure = 25e6", "rate = 2e-6, pressure = 30e6", ["limit", "rate"]),
        ("rate = 1e-6, pressure = 25e6", "rate = -2e-6, pressure = 24e6", ["rate", "limit"]),
        ("rate = 1e-6, pressure = 25e6", "pressure = 23e6", ["rate", "pressure"]),
        ("pressure = 25e6", "pressure = 25e6", ["pressure", "pressure"]),
    ],
)
def test_two_wells_that_feed_the_same_place(
    one: str, other: str, controls: list[str], tmp_path: Path
) -> None:
    """Nothing said which of them gives what: a singular matrix, or steps of 1e-6 s."""
    wells = "".join(f"&injection fracture = 'c', {well} /\n" for well in (one, other))
    out = run(tmp_path, f"{BODY}&time end = 36000 /\n{wells}")
    last = rows(out / "wells.csv")[-2:]
    assert [row["control"] for row in last] == controls
    assert float(last[0]["pressure_pa"]) == pytest.approx(float(last[1]["pressure_pa"]))
    assert len(of_well(out, "well_1")) < 250
    sums_agree(out)


def test_a_rate_up_to_a_pressure_in_short_steps(tmp_path: Path) -> None:
    """The iteration went from the rate to no flow and back, never to the limit between."""
    text = """\
&domain x_min = -0.3, x_max = 0.3, y_min = -0.3, y_max = 0.3 /
&material young = 6072777203.8, poisson = 0.1, biot = 1.0, porosity = 0.001, permeability = 2.25e-14
/
&fluid compressibility = 1e-11, viscosity = 0.00030895 /
&fracture
  name = 'f0', x = 0.053085524777226674, -0.11616727410561349
  y = 0.017478860005367008, 0.08857521405655598, friction = 0.0, aperture = 3e-07
/
&in_situ sxx = -4241461.644189727, syy = -8678864.286832409 /
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&injection fracture = 'f0', rate = 0.06918043, pressure = 7582954.0 /
&time end = 0.012994 /
&coarse size_fracture = 0.0131, size_boundary = 0.06 /
&output vtu = .false. /
"""
    out = run(tmp_path, text)
    last = of_well(out, "well_1")[-1]
    assert last["control"] == "limit"
    assert float(last["head_pressure_pa"]) == pytest.approx(7582954.0, rel=1e-6)
    assert 0.0 < float(last["rate_m2_s"]) < 0.06918043
    cuts = [row for row in rows(out / "events.csv") if row["kind"] == "step_cut"]
    assert len(cuts) < 30
    sums_agree(out)


@pytest.mark.parametrize("step", ["", ", step = 500.0"])
def test_sums_agree_after_a_switch_at_a_limit(step: str, tmp_path: Path) -> None:
    """The try that finds the time of the switch left its sources behind."""
    wells = "".join(
        f"&injection x = {x}, y = 0.0, radius = 0.004, rate = {rate}, pressure = 3.0e5 /\n"
        for x, rate in ((0.0, 1.0e-9), (0.5, 1.5e-9))
    )
    out = run(tmp_path, ROCK.replace("1.0e5 /", f"1.0e5{step} /") + wells)
    assert {row["control"] for row in of_well(out, "well_1")} == {"shut", "rate", "limit"}
    sums_agree(out)


def test_wells_in_the_rock_that_conflict(tmp_path: Path) -> None:
    """One takes more than its limit lets it while the others are at theirs."""
    wells = """\
&injection name = 'a', x = -0.2, y = 0.0, radius = 0.004, rate = 1e-9, pressure = 3e5 /
&injection name = 'b', x = 0.2, y = 0.0, radius = 0.004, rate = -1e-9, pressure = 2e5 /
&injection name = 'c', x = 0.0, y = 0.3, radius = 0.004, rate = 1e-9, pressure = -1e5 /
&injection name = 'd', x = 0.0, y = -0.3, radius = 0.004, pressure = 1e5 /
"""
    out = run(tmp_path, ROCK + wells)
    assert numbers(out / "history.csv", "time_s")[-1] == 1.0e5
    assert {float(row["rate_m2_s"]) for row in of_well(out, "b")} == {0.0}
    assert {float(row["rate_m2_s"]) for row in of_well(out, "c")} == {0.0}
    assert float(of_well(out, "d")[-1]["pressure_pa"]) == pytest.approx(1e5)
    sums_agree(out)


@pytest.mark.parametrize(
    ("body", "well"),
    [
        (BODY, "name = 'w', fracture = 'c', storage = 1e-11"),
        (
            ROCK.replace("1.0e5 /", "3600 /"),
            "name = 'w', x = 0, y = 0, radius = 0.004, storage = 1e-14",
        ),
    ],
)
def test_the_end_of_a_well_with_storage_shuts_it_in(body: str, well: str, tmp_path: Path) -> None:
    """As a stage of rate 0 does: what it holds flows on, and its head falls without a jump."""
    if "&time" not in body:
        body += "&time end = 3600 /\n"
    rate = "1e-6" if "fracture" in well else "1e-9"
    ended = run(tmp_path, f"{body}&injection {well}, rate = {rate}, end = 1200 /\n", "ended")
    stages = f"&injection {well}, rate = {rate}, 0.0, time = 0.0, 1200 /\n"
    staged = run(tmp_path, body + stages, "staged")
    for column in ("time_s", "rate_m2_s", "flow_m2_s", "head_pressure_pa", "injected_m2"):
        expected = numbers(staged / "wells.csv", column)
        assert numbers(ended / "wells.csv", column) == pytest.approx(expected, rel=1e-12, abs=1e-30)
    after = [row for row in of_well(ended, "w") if float(row["time_s"]) > 1200.0]
    assert {(row["stage"], row["control"]) for row in after} == {("0", "shut")}
    assert float(after[0]["flow_m2_s"]) > 0.0


@pytest.mark.parametrize("place", [0.0, 0.25, 0.4])
def test_the_pressure_that_a_well_needs(place: float, tmp_path: Path) -> None:
    """By the cubic law: at 0 the well stands between two cells, with half of each on its way."""
    at = f"name = 'w', fracture = 'f', x = {place}, y = 0.0"
    out = run(tmp_path, f"{PIPE}&injection {at}, pressure = 1.0e5 /\n", "by_pressure")
    per_pressure = (1.0e-4) ** 3 / (12.0 * 1.0e-3) * (1.0 / (1.0 - place) + 1.0 / (1.0 + place))
    flow = float(of_well(out, "w")[-1]["flow_m2_s"])
    assert flow == pytest.approx(1.0e5 * per_pressure, rel=1e-4)
    out = run(tmp_path, f"{PIPE}&injection {at}, rate = {flow!r} /\n", "by_rate")
    pressures = [
        float(of_well(out, "w")[-1]["pressure_pa"]),
        float(of_well(out, "w")[-1]["head_pressure_pa"]),
        numbers(out / "history.csv", "well_pressure_pa")[-1],
    ]
    assert pressures == pytest.approx(3 * [1.0e5], rel=1e-4)


def test_a_run_without_headway_ends_with_the_reason(tmp_path: Path) -> None:
    """A tolerance that no step can keep: all of them are cut to the shortest one."""
    time = "&time end = 36000, tolerance = 1e-14 /\n"
    text = f"{BODY}{time}&injection name = 'w', fracture = 'c', rate = 1e-6 /\n"
    (tmp_path / "small.nml").write_text(text)
    done = bare(tmp_path, "run", "small.nml", "--out", "out", "--quiet")
    assert done.returncode == 1
    assert "no progress in time" in done.stderr
    assert "its time error is too large" in done.stderr
    assert record(tmp_path / "out")["status"] == "failed"
    shortest = min(numbers(tmp_path / "out" / "history.csv", "dt_s")[1:])
    assert shortest >= 0.999e-9 * 36000 / 64


def test_several_wells_are_told_apart(tmp_path: Path) -> None:
    """No number is a mean over wells; what is produced stands beside what is injected."""
    wells = """\
&time end = 36000 /
&injection name = 'in', fracture = 'c', x = -0.8, y = 0, rate = 1e-6 /
&injection name = 'out', fracture = 'c', x = 0.8, y = 0, rate = -4e-7 /
"""
    out = run(tmp_path, BODY + wells)
    history = rows(out / "history.csv")
    assert not {"well_pressure_pa", "injectivity_m2_s_pa"} & set(history[0])
    for name in ("in", "out"):
        expected = [float(row["pressure_pa"]) for row in of_well(out, name)]
        assert numbers(out / "history.csv", f"{name}_well_pressure_pa") == pytest.approx(expected)
    produced = [-float(row["injected_m2"]) for row in of_well(out, "out")]
    assert numbers(out / "history.csv", "produced_m2") == pytest.approx(
        produced, rel=1e-12, abs=1e-30
    )
    assert float(history[-1]["injected_m2"]) == pytest.approx(6e-7 * 36000)
    sums_agree(out)
    results = gather_facts(read_run(out)).results
    highest = max(float(row["pressure_pa"]) for row in of_well(out, "in"))
    assert any(
        line.startswith(f"highest pressure of in: {1e-6 * highest:.4g} MPa") for line in results
    )
    assert "injected: 360 cm², produced: 144 cm²" in results
    panel = next(
        axes for axes in story(read_run(out)).axes if "injectivity" in axes.get_title("left")
    )
    assert [line.get_label() for line in panel.lines][:1] == ["in"]
    answer = [float(row["injectivity_m2_s_pa"]) for row in of_well(out, "in")]
    assert np.asarray(panel.lines[0].get_ydata())[-1] == pytest.approx(answer[-1])


def test_the_pressure_of_a_well_in_the_rock(tmp_path: Path) -> None:
    """history.csv said 0 for it."""
    out = run(tmp_path, f"{ROCK}&injection x = 0, y = 0, radius = 0.004, rate = 1e-9 /\n")
    expected = [float(row["pressure_pa"]) for row in of_well(out, "well_1")]
    assert numbers(out / "history.csv", "well_pressure_pa") == pytest.approx(expected)
    assert expected[-1] > 1e5
    assert numbers(out / "history.csv", "injection_rate_m2_s")[-1] == pytest.approx(1e-9)


def test_a_limited_well_with_storage_far_below_its_limit_takes_few_iterations(
    tmp_path: Path,
) -> None:
    """3 in a step; 66 when the rate was given up below the limit (random scene 9)."""
    out = run(
        tmp_path,
        """\
&domain x_min = -200, x_max = 200, y_min = -200, y_max = 200 /
&material young = 6.01e9, poisson = 0.27, biot = 0.4, porosity = 0.0105, permeability = 4e-20 /
&fluid compressibility = 4.02e-10, viscosity = 4.66e-4 /
&in_situ sxx = -56.8e6, syy = -45e6 /
&initial pressure = 6.83e6 /
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&fracture name = 'f', x = 23, 79, y = 0, 1.5, friction = 0.74, aperture = 3.11e-4 /
&injection name = 'a', fracture = 'f', rate = 9.64e-8, pressure = 30e6, storage = 5e-11,
  turbulence = 9.6e14, end = 0.9 /
&injection name = 'b', fracture = 'f', rate = -3.2e-9, pressure = 5e6, storage = 1.1e-9,
  start = 0.5 /
&injection name = 'c', fracture = 'f', x = 76, y = 1.4, pressure = 12.6e6, friction = 2.9e9 /
&time end = 1 /
&coarse size_boundary = 40 /
&output vtu = .false. /
""",
    )
    assert max(int(row["newton_iterations"]) for row in rows(out / "history.csv")) <= 8


LOSSES = """\
&domain x_min = -50, x_max = 50, y_min = -50, y_max = 50 /
&material young = 1e10, poisson = 0.25, biot = 0.5, porosity = 0.02, permeability = 1e-18 /
&fluid compressibility = 4e-10, viscosity = 1e-3 /
&in_situ sxx = -20e6, syy = -20e6 /
&initial pressure = 10e6 /
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&fracture name = 'f', x = -10, 10, y = 0, 0, friction = 0.6, aperture = 1e-4 /
&fracture name = 'g', x = -10, 10, y = 20, 20, friction = 0.6, aperture = 1e-4 /
&coarse size_fracture = 2.5, size_boundary = 20 /
&output vtu = .false. /
"""


@pytest.mark.parametrize("end", ["1e3", "1e-3"])
@pytest.mark.parametrize("storage", ["0", "1e-12"])
@pytest.mark.parametrize(("rate", "limit"), [(1e-4, 11e6), (-1e-4, 9e6)])
def test_a_limit_that_the_losses_exceed_at_once(
    tmp_path: Path, rate: float, limit: float, storage: str, end: str
) -> None:
    """R Q^2 is a hundred times the distance of the limit: at most a tenth of the rate flows.

    Such wells were found shut far beyond their limit, in ever shorter steps (random scene 204), or
    not solved at all (scene 1). The loss is the difference of
    the pressures at the head and in the fracture.
    """
    for entries, loss in (
        ("fracture = 'f', x = 0.3, y = 0, turbulence = 1e16", 1e16),
        ("fracture = 'f', 'g', entry_loss = 4e16", 0.0),
    ):
        out = run(
            tmp_path,
            f"{LOSSES}&injection name = 'w', {entries}, rate = {rate}, pressure = {limit},"
            f" storage = {storage} /\n&time end = {end} /\n",
        )
        assert max(int(row["newton_iterations"]) for row in rows(out / "history.csv")) <= 12
        for row in of_well(out, "w")[2:]:
            head, flow = float(row["head_pressure_pa"]), float(row["flow_m2_s"])
            assert abs(head - 10e6) <= abs(limit - 10e6) * (1 + 1e-6)
            lost = head - float(row["pressure_pa"])
            assert loss * abs(flow) * flow == pytest.approx(lost, rel=1e-6, abs=1e-3)
            if storage == "0":
                assert row["control"] == "limit"
                assert head == pytest.approx(limit)


def test_pressures_that_differ_in_one_cell(tmp_path: Path) -> None:
    """At rest losses by the square of the flow have no slope: the equations were singular."""
    out = run(
        tmp_path,
        f"{LOSSES}&injection name = 'a', fracture = 'f', x = 0.3, y = 0, pressure = 12e6,"
        " turbulence = 1e14 /\n&injection name = 'b', fracture = 'f', x = 0.3, y = 0,"
        " pressure = 9e6, turbulence = 1e14 /\n&time end = 100 /\n",
    )
    for name, head in (("a", 12e6), ("b", 9e6)):
        for row in of_well(out, name)[2:]:
            loss = head - float(row["pressure_pa"])
            flow = float(row["flow_m2_s"])
            assert 1e14 * abs(flow) * flow == pytest.approx(loss, rel=1e-6)


@pytest.mark.parametrize("control", ["rate = -2e-8", "pressure = 5e6"])
@pytest.mark.parametrize(
    ("injector", "producer", "distance"),
    [
        ((-0.32, 0.0), (0.23, 0.0), 0.55),  # cells of 0.1
        ((-0.5, 0.0), (0.5, 0.0), 1.0),  # at both tips
        ((-0.03, 0.0), (0.0, 0.02), 0.05),  # in two fractures, next to their crossing
        ((0.0, 0.0), (0.0, 0.31), 0.31),  # from the crossing
    ],
)
def test_wells_lie_at_their_exact_places(
    tmp_path: Path,
    control: str,
    injector: tuple[float, float],
    producer: tuple[float, float],
    distance: float,
) -> None:
    """Between two wells the pressure falls by 12 mu q over their distance, wherever they lie."""
    text = PIPE.replace("x = -1.0, 1.0, y = 0.0, 0.0", "x = -0.5, 0.5, y = 0.0, 0.0")
    text = text.replace("size_fracture = 0.5", "size_fracture = 0.1").replace("1.0e-4", "3.0e-5")
    text = text.replace(", pressure = 0.0 /", " /")
    text += "&fracture name = 'g', x = 0, 0, y = -0.5, 0.5, friction = 1.0, aperture = 3e-5 /\n"
    other = "f" if producer[1] == 0.0 else "g"
    text += f"&injection fracture = 'f', x = {injector[0]}, y = 0.0, rate = 2e-8 /\n"
    text += f"&injection fracture = '{other}', x = {producer[0]}, y = {producer[1]}, {control} /\n"
    text += "&initial pressure = 5e6 /\n"
    out = run(tmp_path, text)
    first, second = (float(row["pressure_pa"]) for row in rows(out / "wells.csv")[-2:])
    assert first - second == pytest.approx(12e-3 * 2e-8 * distance / 3e-5**3, rel=1e-4)
