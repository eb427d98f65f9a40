"""Growth in equilibrium without a fluid, against energy balances and closed forms."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from system_scene import TOP, changed, numbers, record, rows, run

from wingcrack.figures import read_run
from wingcrack.figures.equilibrium import equilibrium_path

pytestmark = pytest.mark.usefixtures("program")

CASE = TOP / "verification/length_control"
BEND = (CASE / "bend.nml").read_text()
DISC = (TOP / "inputs/paper_b/disc_path_45.nml").read_text().replace("'paris'", "'equilibrium'")

# K_I of the beam at f = 1 and a/W from 0.1 to 0.6 (Kaya and Erdogan 1987) [MPa m^1/2].
BENDING = (3.521728, 5.018999, 6.547745, 8.478782, 11.258772, 15.766807)


def check_complementarity(out: Path, toughness: float) -> None:
    """No state has a tip above K_IC, and tips that have grown are at it within 1 %."""
    grown = 0
    for tip in rows(out / "tips.csv"):
        ratio = float(tip["keq_pa_sqrtm"]) / toughness
        assert ratio < 1 + 1e-6
        if float(tip["advance_m"]) > 0:
            assert ratio > 0.99
            grown += 1
    assert grown > 0


def test_a_beam_snaps_back(tmp_path: Path) -> None:
    """The factor falls with the length as K_IC/K_I (closed form)."""
    out = run(tmp_path, BEND)
    factors = numbers(out / "history.csv", "load_factor")
    assert factors == pytest.approx([1 / k for k in BENDING], rel=3e-3)
    check_complementarity(out, 1.0e6)
    for table in ("tips.csv", "fractures.csv"):
        for row in rows(out / table):
            assert float(row["load_factor"]) == factors[int(row["history_row"]) - 1]
    assert record(out)["warnings"] == []


def test_energy_of_curved_wings(tmp_path: Path) -> None:
    """G_c dL is half f^2 dC: the compliance knows nothing of stress intensity factors.

    The load factor rises first and then snaps back; both wings open and curve on the way. The
    midpoint rule is of second order in the increment: 0.3 % here.
    """
    out = run(tmp_path, changed(DISC, ("stop_gain = 0.026", "stop_gain = 0.0195")))
    check_complementarity(out, 2.0e6)
    factors = numbers(out / "history.csv", "load_factor")
    assert factors[0] < max(factors) > factors[-1]
    energies = numbers(out / "history.csv", "strain_energy_j")
    lengths = numbers(out / "history.csv", "fracture_length_m")
    toughness = (2.0e6) ** 2 * (1 - 0.21**2) / 15.0e9
    states = list(zip(factors, energies, lengths, strict=True))[4:]
    for (f, energy, length), (g, later, longer) in pairwise(states):
        released = 0.5 * f * g * (2 * later / g**2 - 2 * energy / f**2)
        assert released == pytest.approx(toughness * (longer - length), rel=0.02)


def test_the_area_beside_the_path_is_what_a_dead_load_releases(tmp_path: Path) -> None:
    """Compliances of length control, the integral of G - G_c of a dead load, the closed form."""
    text = changed(BEND, ("increment = 0.1", "increment = 0.025"))
    path = equilibrium_path(read_run(run(tmp_path, text, "length")))
    (release,) = path.releases
    assert path.unstable.all()
    assert path.under_forces
    assert not release.arrests
    assert release.length_m == pytest.approx(0.5)
    assert release.energy_j_m is not None
    dead = run(tmp_path, f"{text}\n&load control = 'dead' /\n", "dead")
    factors = numbers(dead / "history.csv", "load_factor")
    assert factors == pytest.approx([1 / BENDING[0]] * len(factors), rel=3e-3)
    begins, ends = (row for row in rows(dead / "events.csv") if row["kind"] == "unstable_growth")
    assert begins["detail"] == "unstable growth begins"
    found = re.search(r"([0-9.e+-]+) m in all, ([0-9.e+-]+) J/m released", ends["detail"])
    assert found is not None
    assert float(found[1]) == pytest.approx(0.5, rel=1e-9)
    assert release.energy_j_m == pytest.approx(float(found[2]), rel=0.01)
    new_faces = 1.0e12 * (1 - 0.3**2) / 10.0e9
    surplus = [new_faces * ((k / BENDING[0]) ** 2 - 1) for k in BENDING]
    # Five intervals: Simpson on two, 3/8 on three; 1 % by the trapezoids of either.
    exact = 0.1 / 3 * (surplus[0] + 4 * surplus[1] + surplus[2])
    exact += 0.3 / 8 * (surplus[2] + 3 * surplus[3] + 3 * surplus[4] + surplus[5])
    assert release.energy_j_m == pytest.approx(exact, rel=0.01)
    assert float(found[2]) == pytest.approx(exact, rel=0.02)


def test_equal_cracks_go_together(tmp_path: Path) -> None:
    """The outer ones grow alike, and the branch is named unstable; the middle one stays."""
    out = run(tmp_path, (CASE / "three_cracks.nml").read_text())
    check_complementarity(out, 1.0e6)
    gain = dict.fromkeys(range(1, 7), 0.0)
    for tip in rows(out / "tips.csv"):
        gain[int(tip["tip"])] += float(tip["advance_m"])
    assert gain[3] == gain[4] == 0.0
    assert gain[1] == pytest.approx(0.28, rel=1e-9)
    for other in (2, 5, 6):
        assert gain[other] == pytest.approx(gain[1], rel=1e-6)
    kinds = [row["kind"] for row in rows(out / "events.csv")]
    assert "bifurcation" in kinds


def test_the_longer_crack_wins(tmp_path: Path) -> None:
    """One per cent decides, whichever crack has it and wherever it stands in the input."""
    text = (CASE / "three_cracks.nml").read_text()
    for name, number in (("lower", 1), ("upper", 3)):
        place = text.index(f"'{name}'")
        longer = text[:place] + text[place:].replace("-0.15, 0.15", "-0.15, 0.153", 1)
        out = run(tmp_path, longer, name)
        grown = {
            int(tip["fracture"]) for tip in rows(out / "tips.csv") if float(tip["advance_m"]) > 0
        }
        assert grown == {number}


def test_a_stable_crack_takes_more_and_more(tmp_path: Path) -> None:
    """A frictional crack's wings need a rising load; the run ends where the load does."""
    text = (TOP / "inputs/paper_a/single_flaw.nml").read_text().replace("'paris'", "'equilibrium'")
    out = run(tmp_path, text)
    factors = numbers(out / "history.csv", "load_factor")
    assert factors == sorted(factors)
    grown = [float(tip["advance_m"]) for tip in rows(out / "tips.csv")]
    assert math.isclose(sum(grown[::2]), sum(grown[1::2]), rel_tol=1e-3)


def test_what_a_lead_is_worth(tmp_path: Path) -> None:
    """Setting back one tip after the other in scenes without growth tells the same."""
    text = (CASE / "three_cracks.nml").read_text()
    out = run(tmp_path, changed(text, ("stop_gain = 0.28", "stop_gain = 0.03")), "grown")
    (event,) = (row for row in rows(out / "events.csv") if row["kind"] == "bifurcation")
    found = re.search(r"changes K_eq by ([0-9.]+) %", event["detail"])
    assert found is not None
    tips = rows(out / "tips.csv")[-6:]
    still = changed(text, ("enabled = .true.", "intensities = .true."), ("to = 10.0", "to = 1.0"))
    still = re.sub(r"(increment|stop_gain) = [0-9.]+\n", "", still)
    share = 0.4
    growing = (0, 1, 4, 5)

    def intensities(name: str, set_back: int | None) -> list[float]:
        changes = []
        for crack, y in enumerate(("-0.15", "0.0", "0.15")):
            if y == "0.0":
                continue
            places = []
            for end, x in enumerate((-0.15, 0.15)):
                tip = 2 * crack + end
                left = share if tip == set_back else 0.0
                places.append(x + (1 - left) * (float(tips[tip]["x_m"]) - x))
                places.append(float(y) + (1 - left) * (float(tips[tip]["y_m"]) - float(y)))
            x0, y0, x1, y1 = places
            old = f"  x = -0.15, 0.15\n  y = {y}, {y}\n"
            new = f"  x = {x0}, -0.15, 0.15, {x1}\n  y = {y0}, {y}, {y}, {y1}\n"
            changes.append((old, new))
        found = rows(run(tmp_path, changed(still, *changes), name) / "tips.csv")
        return [float(found[tip]["keq_pa_sqrtm"]) for tip in growing]

    ends = np.array(intensities("ends", None))
    columns = [ends - intensities(f"back_{tip}", tip) for tip in growing]
    matrix = np.array(columns).T / (share * 0.03) / ends.mean()
    matrix = 0.5 * (matrix + matrix.T)
    leads = np.linalg.svd(np.ones((1, 4)))[2][1:]  # that leave the sum of the lengths
    worth = 100 * 0.03 * np.linalg.eigvalsh(leads @ matrix @ leads.T).max()
    assert float(found.group(1)) == pytest.approx(worth, rel=0.1)
