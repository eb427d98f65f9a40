"""Load cycles without a fluid, against the loop of a crack with friction in closed form.

A closed crack of half-length a in an infinite body, pressed so that far away, times the load factor
f, it has the shear tau and the pressure p: its slip relieves a uniform shear D,

    slip = 4 D/E' sqrt(a^2 - x^2),   K_II = D sqrt(pi a),   shear on the faces = f tau - D,

and friction bounds the last of these by mu f p. So D follows f as little as it can: with Q = mu p,
it is the nearest value to the one before within f (tau - Q) and f (tau + Q).
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import pytest
from system_scene import TOP, numbers, record, rows, run

from wingcrack.figures import read_run

pytestmark = pytest.mark.usefixtures("program")

LOOP = (TOP / "verification/load_cycle/load_cycle.nml").read_text()
TABLE = LOOP.partition("factors = ")[2].partition(" /")[0]
WINGS = (TOP / "inputs/examples/load_cycle.nml").read_text()
FACTORS = [float(word) for word in TABLE.split(",")]
HALF_LENGTH, MODULUS = 0.1, 40.0e9 / (1 - 0.2**2)  # a [m], E' [Pa]
SHEAR, FRICTION = 10.0e6, 10.0e6 / 3  # tau and mu p at factor 1 [Pa]

# A beam that two grips pull open at its end, which takes more the longer the crack: K falls as
# 1/a^2, and growth is stable.
CLEAVED = """\
&domain x_min = 0.0, x_max = 4.0, y_min = -0.5, y_max = 0.5 /
&material young = 1.0e9, poisson = 0.25, toughness = 1.0e5 /
&fracture name = 'crack', x = 0.0, 1.0, y = 0.0, 0.0, law = 'open' /
&restraint x = 0.0, y = 0.5, y_displacement = 1.0e-3 /
&restraint x = 0.0, y = -0.5, y_displacement = -1.0e-3, x_displacement = 0.0 /
&restraint x = 4.0, y = 0.0, y_displacement = 0.0 /
&load factors = 1.0 /
&fe size_fracture = 0.1, size_boundary = 0.25 /
&growth enabled = .true., increment = 0.1 /
&output vtu = .false. /
"""

# An open crack along x under tension times the load factor.
OPEN = """\
&domain x_min = -2.0, x_max = 2.0, y_min = -2.0, y_max = 2.0 /
&material young = 40.0e9, poisson = 0.2 /
&fracture name = 'crack', law = 'frictionless', x = -0.1, 0.1, y = 0.0, 0.0 /
&side name = 'top', y_traction = 1.0e6 /
&side name = 'bottom', y_traction = -1.0e6 /
&restraint x = -2.0, y = -2.0, x_displacement = 0.0, y_displacement = 0.0 /
&restraint x = 2.0, y = -2.0, y_displacement = 0.0 /
&load factors = 1.0, 0.3, -0.5, 0.3, 1.0 /
&fe size_fracture = 0.02, size_boundary = 1.0 /
&growth intensities = .true. /
"""


def changed(text: str, *changes: tuple[str, str]) -> str:
    """Give a text with pieces replaced, each of which must stand in it."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


def relieved(factors: list[float]) -> list[float]:
    """Shear D that slip has relieved at each of the factors, none of them negative [Pa]."""
    found, last = [], 0.0
    for factor in factors:
        last = min(max(last, factor * (SHEAR - FRICTION)), factor * (SHEAR + FRICTION))
        found.append(last)
    return found


def states(out: Path) -> list[list[dict[str, str]]]:
    """Rows of fractures.csv of each state, which has the number of its row of history.csv."""
    found: dict[int, list[dict[str, str]]] = {}
    for row in rows(out / "fractures.csv"):
        found.setdefault(int(row["history_row"]), []).append(row)
    assert list(found) == list(range(1, len(found) + 1))
    return list(found.values())


def intensities(out: Path, name: str = "k2_pa_sqrtm") -> list[list[float]]:
    """Stress intensity factor of both tips at each state [Pa m^1/2]."""
    table = rows(out / "tips.csv")
    return [[float(row[name]) for row in table[at : at + 2]] for at in range(0, len(table), 2)]


def cell_lengths(cells: list[dict[str, str]]) -> list[float]:
    """Lengths of a fracture's cells, from their middles and its start [m]."""
    found, end = [], 0.0
    for cell in cells:
        found.append(2 * (float(cell["s_m"]) - end))
        end += found[-1]
    assert end == pytest.approx(2 * HALF_LENGTH, rel=1e-9)
    return found


def friction_work(out: Path) -> list[float]:
    """Work of friction from each state to the next, by the mean traction of both [J/m]."""
    found = []
    for before, after in pairwise(states(out)):
        found.append(0.0)
        for a, b, length in zip(before, after, cell_lengths(before), strict=True):
            mean = 0.5 * (float(a["traction_t_pa"]) + float(b["traction_t_pa"]))
            found[-1] += mean * (float(b["jump_t_m"]) - float(a["jump_t_m"])) * length
    return found


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the run of the loop."""
    return run(tmp_path_factory.mktemp("loop"), LOOP)


def test_a_row_per_factor(loop: Path) -> None:
    assert numbers(loop / "history.csv", "load_factor") == FACTORS
    assert record(loop)["status"] == "finished"
    assert record(loop)["reason"] == "the scene's last load factor"
    assert len(states(loop)) == len(FACTORS)


def test_friction_takes_the_work_of_the_loop(loop: Path) -> None:
    """What it takes is the loop's area: the sums are exact, for slip begins and ends at states."""
    least, back, forth, most = 0.1, 0.5, 0.2, 1.0
    whole = 2 * math.pi * HALF_LENGTH**2 / MODULUS * FRICTION
    exact = 0.5 * whole * (SHEAR + FRICTION) * (back**2 - least**2)
    exact += 0.5 * whole * (SHEAR - FRICTION) * (most**2 - forth**2)
    work = friction_work(loop)
    first, second = sum(work[0:8]), sum(work[8:12])
    assert first == pytest.approx(exact, rel=0.01)
    assert second == pytest.approx(first, rel=1e-3)


def test_the_loop_mirrored_and_in_other_units(loop: Path, tmp_path: Path) -> None:
    """All lengths a thousand times, all stresses ten times: K grows by ten times sqrt(1000)."""
    x, mirrored = "x = -0.07071067811865475, 0.07", "x = 0.07071067811865475, -0.07"
    out = run(tmp_path, changed(LOOP, (x, mirrored)), "mirrored")
    for here, there in zip(intensities(loop), intensities(out), strict=True):
        assert sorted(-k for k in there) == pytest.approx(sorted(here), rel=3e-3)
    text = changed(
        LOOP,
        ("0.07071067811865475", "70.71067811865475"),
        ("= -2.5", "= -2500.0"),
        ("= 2.5", "= 2500.0"),
        ("20.0e6", "200.0e6"),
        ("young = 40.0e9", "young = 400.0e9"),
        (
            "size_fracture = 0.01, size_boundary = 1.0",
            "size_fracture = 10.0, size_boundary = 1.0e3",
        ),
    )
    out = run(tmp_path, text, "large")
    for here, there in zip(intensities(loop), intensities(out), strict=True):
        assert there == pytest.approx([10 * math.sqrt(1000) * k for k in here], rel=1e-3)


def test_the_order_of_fractures_has_no_part(tmp_path: Path) -> None:
    """Two cracks that feel each other, either of them first: the same loop for each."""
    begin = LOOP.index("&fracture")
    end = LOOP.index("&side")
    one = LOOP[begin:end]
    two = changed(one, ("'crack'", "'other'"), ("x = -0.07", "x = 0.13"), (", 0.07", ", 0.27"))
    two = two.replace("y = -0.07071067811865475, 0.27", "y = -0.07071067811865475, 0.07")
    table = ("factors = " + TABLE, "factors = 1.0, 0.6, 0.4, 0.1, 1.0")
    found = []
    for name, pair in (("given", (one, two)), ("swapped", (two, one))):
        out = run(tmp_path, changed(LOOP[:begin] + "".join(pair) + LOOP[end:], table), name)
        tips = rows(out / "tips.csv")
        mine = "1" if name == "given" else "2"
        found.append([float(tip["k2_pa_sqrtm"]) for tip in tips if tip["fracture"] == mine])
    assert found[0] == pytest.approx(found[1], rel=3e-3, abs=1.0)
    assert len(found[0]) == 10


def test_a_table_of_one_factor_is_a_fixed_load(tmp_path: Path) -> None:
    once = run(tmp_path, changed(LOOP, ("factors = " + TABLE, "factors = 1.0")), "table")
    fixed = run(tmp_path, changed(LOOP, ("factors = " + TABLE, "to = 1.0")), "fixed")
    for name in ("history.csv", "tips.csv", "fractures.csv"):
        assert (once / name).read_text() == (fixed / name).read_text()


def test_a_scene_runs_from_what_is_written_of_it(loop: Path, tmp_path: Path) -> None:
    again = run(tmp_path, (loop / "scene.nml").read_text())
    assert (again / "history.csv").read_text() == (loop / "history.csv").read_text()
    assert (again / "scene.nml").read_text() == (loop / "scene.nml").read_text()


@pytest.fixture(scope="module", params=["open", "frictionless"])
def cycle(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the run of a crack without friction."""
    law: str = request.param
    return run(tmp_path_factory.mktemp(law), changed(OPEN, ("'frictionless'", f"'{law}'")))


def test_a_cycle_without_friction_leaves_no_trace(cycle: Path) -> None:
    out = cycle
    first, *_, last = states(out)
    for before, after in zip(first, last, strict=True):
        for name in ("jump_n_m", "jump_t_m", "traction_n_pa"):
            scale = 1.0e-6 if name.endswith("_m") else 1.0e6
            assert float(after[name]) == pytest.approx(float(before[name]), abs=1e-12 * scale)
    k1 = intensities(out, "k1_pa_sqrtm")
    assert k1[4] == pytest.approx(k1[0], rel=1e-12)
    assert k1[3] == pytest.approx(k1[1], rel=1e-12)


@pytest.mark.parametrize("cycle", ["frictionless"], indirect=True)
def test_an_open_crack_closes_and_opens_again(cycle: Path) -> None:
    out = cycle
    found = states(out)
    assert [{row["state"] == "open" for row in state} for state in found] == [
        {True},
        {True},
        {False},
        {True},
        {True},
    ]
    assert max(abs(float(row["jump_n_m"])) for row in found[2]) < 1e-15
    for row in found[2]:
        assert float(row["traction_n_pa"]) == pytest.approx(-0.5e6, rel=0.02)


def cleaved(tmp_path: Path, table: str, law: str = "equilibrium", out: str = "out") -> Path:
    """Run the beam through a table of factors."""
    text = changed(CLEAVED, ("factors = 1.0", f"factors = {table}"))
    return run(tmp_path, changed(text, ("increment", f"law = '{law}', increment")), out)


@pytest.mark.parametrize("law", ["equilibrium", "paris"])
def test_a_crack_grows_only_beyond_the_largest_load(tmp_path: Path, law: str) -> None:
    """Unloading and loading again up to there changes nothing; beyond, it is as without them."""
    out = cleaved(tmp_path, "1.0, 0.2, 1.0, 1.5", law, "cycle")
    table = rows(out / "history.csv")
    lengths = [float(row["fracture_length_m"]) for row in table]
    assert lengths == sorted(lengths)
    ends = [at for at, row in enumerate(table) if float(row["load_factor"]) in (0.2, 1.0)]
    at_least = next(at for at in ends if float(table[at]["load_factor"]) == 0.2)
    before, back = at_least - 1, at_least + 1
    assert float(table[before]["load_factor"]) == float(table[back]["load_factor"]) == 1.0
    assert lengths[before] == lengths[at_least] == lengths[back]
    assert lengths[before] > 1.1
    assert lengths[-1] > lengths[back] + 0.1
    straight = cleaved(tmp_path, "1.0, 1.5", law, "straight")
    for name, rel in (("fracture_length_m", 2e-3), ("strain_energy_j", 1e-2)):
        assert float(table[-1][name]) == pytest.approx(
            numbers(straight / "history.csv", name)[-1], rel=rel
        )


def test_growth_that_does_not_end_is_the_end(tmp_path: Path) -> None:
    """Forces on the same beam drive the crack through at the first factor that it does not bear."""
    text = changed(
        CLEAVED,
        ("&restraint x = 0.0, y = 0.5, y_displacement = 1.0e-3 /", ""),
        ("y = -0.5, y_displacement = -1.0e-3, x_displacement = 0.0 /", "y = -0.5 X"),
        ("&restraint x = 0.0, y = -0.5 X", ""),
        ("&restraint x = 4.0, y = 0.0, y_displacement = 0.0 /", ""),
        (
            "&load factors = 1.0 /",
            "&side name = 'right', x_displacement = 0.0, y_displacement = 0.0 /\n"
            "&point_load x = 0.0, y = 0.5, y_force = 1.0e5 /\n"
            "&point_load x = 0.0, y = -0.5, y_force = -1.0e5 /\n"
            "&load factors = 0.05, -0.05, 1.0, 0.0 /",
        ),
    )
    out = run(tmp_path, text)
    assert numbers(out / "history.csv", "load_factor")[:2] == [0.05, -0.05]
    events = [row for row in rows(out / "events.csv") if row["kind"] == "unstable_growth"]
    assert events[0]["detail"] == "unstable growth begins"
    assert events[-1]["detail"].startswith("unstable growth continues at the end of the run: ")
    assert record(out)["reason"] == (
        "a part of the body has separated, and 2 of the scene's load factors were not reached"
    )


def test_wings_grow_while_the_load_falls(tmp_path: Path) -> None:
    """The flaw keeps its slip at first, and the wings feel less pressure: they grow meanwhile."""
    out = run(tmp_path, changed(WINGS, ("1.0, 0.1, 1.2, 0.1, 1.4", "0.7, 0.1, 0.7")))
    table = rows(out / "history.csv")
    factors = [float(row["load_factor"]) for row in table]
    lengths = [float(row["fracture_length_m"]) for row in table]
    top = factors.index(max(factors))
    bottom = factors.index(min(factors[top:]))
    assert lengths == sorted(lengths)
    assert lengths[bottom] > lengths[top] + 0.01
    falls = [factors[at] for at in range(top, bottom) if lengths[at + 1] > lengths[at]]
    stuck = [row for row in table[top + 1 : bottom] if row["n_slip"] == "0"]
    assert min(falls) > factors[bottom]
    assert stuck
    for row in stuck:
        assert float(row["max_slip_m"]) == pytest.approx(float(table[top]["max_slip_m"]), rel=1e-9)
    toughness = 1.0e6
    for tip in rows(out / "tips.csv"):
        assert float(tip["keq_pa_sqrtm"]) < 1.005 * toughness
        if float(tip["advance_m"]) > 0.0:
            assert float(tip["keq_pa_sqrtm"]) > 0.98 * toughness


def test_growth_does_not_begin_at_a_turn(tmp_path: Path) -> None:
    """The load turns where the tip is just at its toughness: as it falls, nothing grows."""
    first = cleaved(tmp_path, "1.0", out="onset")
    onset = rows(first / "history.csv")[0]["load_factor"]
    out = cleaved(tmp_path, f"{onset}, 0.2, 0.3", out="turn")
    lengths = numbers(out / "history.csv", "fracture_length_m")
    assert numbers(out / "history.csv", "load_factor")[-2:] == [0.2, 0.3]
    assert lengths[-1] == lengths[1] < 1.01


def test_a_mesh_that_follows_the_error_keeps_the_slip(tmp_path: Path) -> None:
    """It is made at the largest of the factors, though the first one is 0."""
    text = changed(LOOP, ("factors = " + TABLE, "factors = 0.0, 1.0, 0.75, 0.1"))
    out = run(tmp_path, text + "&adaptive enabled = .true., tolerance = 5.0e-3 /\n")
    for pair, relief in zip(intensities(out), relieved([0.0, 1.0, 0.75, 0.1]), strict=True):
        exact = relief * math.sqrt(math.pi * HALF_LENGTH)
        assert [abs(k) for k in pair] == pytest.approx([exact] * 2, rel=0.01, abs=1.0)
    assert states(out)[0][0]["jump_t_m"] == "0.0"


def test_collections_count_states(cycle: Path) -> None:
    """ParaView wants times that rise: a cycle's collections have the rows of the history."""
    out = cycle
    text = (out / "fractures.pvd").read_text()
    assert [part.partition('"')[0] for part in text.split('timestep="')[1:]] == [
        f"{row}.0" for row in range(1, 6)
    ]
    read = read_run(out)
    for series in (read.matrix, read.fracture_fields):
        assert [state.row for state in series] == list(range(5))
        moments = [state.time_s for state in series]
        assert moments == pytest.approx([1.0, 0.3, -0.5, 0.3, 1.0], rel=1e-12)
        assert len(set(moments)) == 5
