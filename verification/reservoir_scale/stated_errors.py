"""Shares of states of known truth in which the stated errors of length, pressure and onset hold.

    .venv/bin/python verification/reservoir_scale/stated_errors.py [SOLVER] [PART ...]

Truth is a closed form (across.nml, without viscosity and leak-off), a self-similar solution (the
KGD crack of ../kgd) or the same scene with cells, increments, elements of windows and the tolerance
of time steps a quarter as large. Such a run has errors of its own, about a quarter of those of the
other one, so that a stated error that just holds may miss it by that. The runs are kept in
build/stated_errors.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

HERE = Path(__file__).resolve().parent
TOP = HERE.parents[1]
STORE = TOP / "build/stated_errors"
SOLVER = TOP / "build/release/fortran/app/wingcrack-solver"
Array = npt.NDArray[np.float64]

# A fracture at 45 degrees that slips, opens and leaks.
INCLINED = """\
&scene name = 'inclined' /
&domain x_min = 0.0, x_max = {side}, y_min = 0.0, y_max = {side} /
&material
  young = 40.0e9, poisson = 0.2, biot = {biot}, porosity = 0.01, permeability = {permeability}
  toughness = {toughness}
/
&fluid compressibility = 4.0e-10, viscosity = 3.0e-4 /
&fracture
  name = 'f1', friction = 0.5, dilation_deg = 1.0, aperture = 2.0e-4
  x = {low}, {high}
  y = {low}, {high}
/
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&side name = 'top', y_traction = -10.0e6 /
&injection fracture = 'f1', rate = {rate} /
&initial fracture_pressure = 'equilibrated' /
&time end = 1.0e7, tolerance = {tolerance} /
&coarse size_fracture = {cell}, size_boundary = {boundary} /
&fine window = {window} /
&growth enabled = .true., stop_gain = {gain}, increment = {increment} /
&output vtu = .false. /
"""


@dataclass
class States:
    """Length, pressure and onset of a run or of the truth, and their stated errors."""

    length: Array
    pressure: Array
    onset: float
    length_error: Array = field(default_factory=lambda: np.zeros(0))
    pressure_error: Array = field(default_factory=lambda: np.zeros(0))
    onset_error: float = math.nan


@dataclass
class Case:
    """A run whose truth is known: its name, its times, and both."""

    name: str
    stated: States
    truth: States


def run(solver: Path, scene: str) -> Path:
    """Run a scene, unless this has been done with this solver."""
    key = hashlib.sha256(scene.encode() + solver.read_bytes()).hexdigest()[:16]
    out = STORE / key
    record = out / "run.json"
    if not (record.exists() and json.loads(record.read_text())["status"] == "finished"):
        STORE.mkdir(parents=True, exist_ok=True)
        text = STORE / f"{key}.nml"
        text.write_text(scene)
        subprocess.run([solver, "run", text, "--out", out, "--quiet"], check=True)
    return out


def rows(path: Path) -> list[dict[str, str]]:
    """Read a table."""
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def columns(out: Path) -> dict[str, Array]:
    """Columns of history.csv that are needed."""
    table = rows(out / "history.csv")
    names = {
        "time": "time_s",
        "length": "fracture_length_m",
        "pressure": "well_pressure_pa",
        "length_error": "fracture_length_error_m",
        "pressure_error": "well_pressure_error_pa",
    }
    return {key: np.array([float(row[name]) for row in table]) for key, name in names.items()}


def onset(out: Path) -> tuple[float, float]:
    """First onset of growth and its stated error [s]."""
    events = [row for row in rows(out / "events.csv") if row["kind"] == "growth_onset"]
    first = min(events, key=lambda row: float(row["time_s"]))
    found = re.search(r"known to ([^ ]*) s", first["detail"])
    return float(first["time_s"]), float(found.group(1)) if found else math.inf


def states(out: Path, times: Array) -> States:
    """States of a run at some times, between its rows."""
    table = columns(out)
    at = {key: np.interp(times, table["time"], values) for key, values in table.items()}
    begins, error = onset(out)
    return States(
        at["length"], at["pressure"], begins, at["length_error"], at["pressure_error"], error
    )


def times_at(out: Path, lengths: Array) -> Array:
    """Times at which a run reaches these lengths [s]."""
    table = columns(out)
    return np.interp(lengths, table["length"], table["time"])


def scene_of(path: Path, changes: dict[str, str]) -> str:
    """Read a scene, with some texts replaced."""
    text = path.read_text()
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


def closed_form(solver: Path) -> Iterator[Case]:
    """A fracture of the volume 2 sqrt(pi) a^(3/2) K_IC/E', at sigma + K_IC/sqrt(pi a)."""
    for half, rate, toughness, share in [
        (10.0, 1.0e-5, 2.0e6, 5),
        (10.0, 1.0e-5, 2.0e6, 10),
        (50.0, 1.0e-4, 2.0e6, 5),
        (50.0, 1.0e-4, 2.0e6, 10),
        (1.0, 1.0e-6, 2.0e6, 10),
        (10.0, 1.0e-5, 0.5e6, 10),
    ]:
        scale = half / 10.0
        text = scene_of(
            HERE / "across.nml",
            {
                "200.0": f"{200 * scale:g}",
                "-10.0, 10.0": f"{-half:g}, {half:g}",
                "toughness = 2.0e6": f"toughness = {toughness:g}",
                "rate = 1.0e-5": f"rate = {rate:g}",
                "size_fracture = 1.0": f"size_fracture = {half / share:g}",
                "size_boundary = 20.0": f"size_boundary = {2 * half:g}",
                "window = 100.0": f"window = {10 * half:g}",
                "stop_gain = 10.0": f"stop_gain = {half:g}",
            },
        )
        out = run(solver, text)
        factor = 2 * math.sqrt(math.pi) * toughness / 41.666666667e9 / rate
        lengths = 2 * half * np.array([1.1, 1.2, 1.35, 1.5, 1.65, 1.8, 1.95])
        times = factor * (lengths / 2) ** 1.5
        truth = States(
            lengths, 10.0e6 + toughness / np.sqrt(math.pi * lengths / 2), factor * half**1.5
        )
        name = f"across, {2 * half:g} m, K_IC {toughness / 1e6:g}, a/{share}"
        yield Case(name, states(out, times), truth)


def self_similar(solver: Path) -> Iterator[Case]:
    """The KGD crack with viscosity, of ../kgd; its starter crack has no onset of its own."""
    for name, viscosity, end, gamma, net in [
        ("K_m = 4", 1.0306923793741721e-4, 20.0, 0.3660035934, 1.204788485),
        ("K_m = 1", 2.6385724906858806e-2, 40.0, 0.5992540886, 0.5558339183),
        ("K_m = 0.5", 0.42217159854, 80.0, 0.61337, 0.546019),
    ]:
        text = scene_of(
            HERE.parent / "kgd/kgd.nml",
            {
                "viscosity = 1.0306923793741721e-4": f"viscosity = {viscosity}",
                "end = 20.0, step = 0.25": f"end = {end}, step = {end / 80}",
                "window = 0.9": "window = 0.9" if end < 30.0 else "window = 0.3",
            },
        )
        out = run(solver, text)
        times = end * np.array([0.5, 0.6, 0.7, 0.8, 0.9, 0.99])
        modulus, rate, thick = 32.0e9, 1.0e-5, 12 * viscosity
        size = (modulus * rate**3 * times**4 / thick) ** (1 / 6)
        truth = States(
            2 * gamma * size, net * modulus * (thick / (modulus * times)) ** (1 / 3), math.nan
        )
        yield Case(f"KGD, {name}", states(out, times), truth)


def inclined(half: float, finer: int, **values: object) -> str:
    """Write the inclined fracture, with lengths over `finer`."""
    along = half * math.sqrt(0.5)
    usual = {
        "side": 40 * half,
        "low": 20 * half - along,
        "high": 20 * half + along,
        "biot": 0.8,
        "permeability": 1.0e-18,
        "toughness": 1.5e6,
        "rate": 1.0e-6 * half,
        "tolerance": 0.01 / finer,
        "cell": 0.1 * half / finer,
        "boundary": 2 * half,
        "window": 10 * half,
        "increment": 0.1 * half / finer,
        "gain": 0.5 * half,
    }
    return INCLINED.format(**{**usual, **values})


def refined(solver: Path) -> Iterator[Case]:
    """The inclined fracture, leaking or in tight rock, and itself with a quarter of all sizes."""
    tight = {"permeability": 1.0e-23, "biot": 0.01}
    for name, half, values in [
        ("20 m, tight", 10.0, tight),
        ("20 m, leaking", 10.0, {}),
        ("2 m, leaking", 1.0, {}),
        ("2 m, tight", 1.0, tight),
        ("100 m, leaking", 50.0, {}),
    ]:
        fine = run(solver, inclined(half, 4, **values))
        out = run(solver, inclined(half, 1, **values))
        times = times_at(fine, 2 * half * np.array([1.05, 1.1, 1.15, 1.2, 1.25, 1.3, 1.38, 1.45]))
        yield Case(f"inclined, {name}", states(out, times), states(fine, times))


PARTS = {"closed": closed_form, "viscous": self_similar, "refined": refined}


def summary(ratios: Array) -> str:
    """States in which the error holds, and the median of stated over true."""
    if ratios.size == 0:
        return "  -"
    hold = f"{np.sum(ratios >= 1.0):3d} of {ratios.size:3d}"
    return f"{hold}, x{np.median(ratios):6.2f}, least{np.min(ratios):6.2f}"


def ratios(stated: Array, found: Array, truth: Array) -> Array:
    """Stated error over the true one, at most 1000."""
    return np.minimum(1.0e3, stated / np.maximum(np.abs(found - truth), 1.0e-300))


def main() -> int:
    """Write the table."""
    words = sys.argv[1:]
    solver = Path(words.pop(0)) if words and words[0] not in PARTS else SOLVER
    total: dict[str, list[Array]] = {"length": [], "pressure": [], "onset": []}
    print(f"{'':28s}{'length':>32s}{'pressure':>34s}{'onset':>34s}")
    for part in words or PARTS:
        for case in PARTS[part](solver.resolve()):
            stated, truth = case.stated, case.truth
            now = {
                "length": ratios(stated.length_error, stated.length, truth.length),
                "pressure": ratios(stated.pressure_error, stated.pressure, truth.pressure),
                "onset": ratios(
                    np.array([stated.onset_error]),
                    np.array([stated.onset]),
                    np.array([truth.onset]),
                )[: 0 if math.isnan(truth.onset) else 1],
            }
            line = "".join(f"{summary(now[key]):>34s}" for key in now)
            print(f"{case.name:28s}{line}", flush=True)
            for key, values in now.items():
                total[key].append(values)
    print(f"{'all':28s}" + "".join(f"{summary(np.concatenate(v)):>34s}" for v in total.values()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
