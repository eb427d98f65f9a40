"""Sweeps with a fluid: small scenes from all over the ranges of the parameters, each judged.

    .venv/bin/python verification/programs/fluid_sweeps.py --folder /tmp/sweeps
    .venv/bin/python verification/programs/fluid_sweeps.py --folder /tmp/sweeps --only 17 42

The scenes are a Latin hypercube (McKay, Beckman and Conover 1979) of a fixed seed. Each run is
judged by wingcrack_verify.recompute, which reads its files alone (docs/sweeps.md).
"""

from __future__ import annotations

import argparse
import collections
import json
import math
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "post"))

from wingcrack_verify.recompute import judge  # noqa: E402

SOLVER = TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver"
SEED = 20231101
RUN_LIMIT_S = 120.0
# Fields are written in every accepted state, however much steps are cut; `check` doubts that.
# what these small bodies with sealed sides and apertures of all sizes are warned of
EXPECTED_DOUBT = (
    "&output: interval",
    "&injection: reach is ",
    *(f"&fracture '{name}': aperture is " for name in ("f1", "f2")),
)

DIMENSIONS = (
    "permeability",
    "step",
    "compressibility",
    "biot",
    "porosity",
    "poisson",
    "young",
    "friction",
    "dilation",
    "aperture",
    "load",
    "ratio",
    "rate",
    "direction",
    "angle",
    "length",
    "second",
    "viscosity",
    "pressure",
    "kind",
    "point",
    "storage",
)


@dataclass(frozen=True)
class Verdict:
    """What became of a scene."""

    word: str  # right, warned, refused, stopped, WRONG
    detail: str
    seconds: float


def design(runs: int) -> npt.NDArray[np.float64]:
    """Give (runs, dimensions) places in the unit cube."""
    random = np.random.default_rng(SEED)
    columns = [
        (random.permutation(runs) + random.random(runs)) / runs for _ in range(len(DIMENSIONS))
    ]
    return np.stack(columns, axis=1)


def log(share: float, low: float, high: float) -> float:
    """Give 10 to a power between low and high."""
    return float(10.0 ** (low + share * (high - low)))


def scene_text(place: npt.NDArray[np.float64]) -> str:
    """The scene at a place in the unit cube."""
    u = dict(zip(DIMENSIONS, (float(share) for share in place), strict=True))
    porosity = log(u["porosity"], -4.0, -0.5)
    biot = porosity + (1.0 - porosity) * min(1.0, u["biot"] / 0.95)
    # One half below 0.45, the other one towards 0.499.
    poisson = 0.9 * u["poisson"] if u["poisson"] < 0.5 else 0.5 - log(u["poisson"], 0.4, -3.0)
    load = log(u["load"], 5.0, 8.0)
    loads = [load, load / log(u["ratio"], 0.0, 2.0)]
    if u["direction"] > 0.5:
        loads.reverse()
    rate = log(u["rate"], -14.0, -2.0) * (-1.0 if u["direction"] * 10.0 % 1.0 < 0.1 else 1.0)
    step = log(u["step"], -3.0, 6.0)
    length = 0.1 + 0.4 * u["length"]
    fractures = [(0.7, 1.0, math.pi * u["angle"])]
    if u["second"] > 0.5:
        fractures.append((1.4, 1.0, 2.0 * math.pi * u["second"]))
    text = f"""\
&domain x_min = 0.0, x_max = 2.0, y_min = 0.0, y_max = 2.0 /
&material
  young = {log(u["young"], 9.0, 11.0)!r}, poisson = {poisson!r}
  biot = {biot!r}, porosity = {porosity!r}, permeability = {log(u["permeability"], -24, -10)!r}
  toughness = 0.7e6, storage = '{"textbook" if u["storage"] < 0.2 else "thesis"}'
/
&fluid
  compressibility = {0.0 if u["compressibility"] < 0.15 else log(u["compressibility"], -13, -8)!r}
  viscosity = {log(u["viscosity"], -4.0, -2.0)!r}
/
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = {-loads[0]!r} /
&side name = 'top', y_traction = {-loads[1]!r} /
&initial
  fracture_pressure = '{"undrained" if u["pressure"] * 10.0 % 1.0 < 0.3 else "equilibrated"}'
  pressure = {0.0 if u["pressure"] < 0.5 else log(u["pressure"], 2.0, 7.0)!r}
/
&time end = {6.0 * step!r}, step = {step!r} /
&coarse size_fracture = {length / 6.0!r}, size_boundary = 0.35 /
&output interval = {1e-9 * step!r} /
"""
    for number, (x, y, angle) in enumerate(fractures, start=1):
        dx, dy = 0.5 * length * math.cos(angle), 0.5 * length * math.sin(angle)
        text += f"""\
&fracture
  name = 'f{number}', x = {x - dx!r}, {x + dx!r}, y = {y - dy!r}, {y + dy!r}
  friction = {0.0 if u["friction"] < 0.05 else 2.0 * u["friction"]!r}
  dilation_deg = {0.0 if u["dilation"] < 0.2 else 30.0 * u["dilation"]!r}
  aperture = {log(u["aperture"], -6.0, -1.0)!r}
/
"""
    well = f"fracture = 'f1', rate = {rate!r}, start = {step!r}, end = {4.0 * step!r}"
    text += f"&injection {well}{', x = 0.7, y = 1.0' if u['point'] < 0.5 else ''} /\n"
    if u["kind"] > 0.8:
        text += f"&growth enabled = .true., stop_gain = {0.3 * length!r} /\n"
    elif u["kind"] > 0.6:
        text += "&growth intensities = .true. /\n"
    if u["kind"] > 0.6:
        text += "&fine window = 0.4 /\n"
    return text


def call_solver(folder: Path, solver: Path, limit_s: float) -> tuple[Verdict | None, str, float]:
    """Run scene.nml of a folder: the verdict if its files need not be judged, reason, seconds."""
    out = folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    began = time.monotonic()
    try:
        done = subprocess.run(
            [solver, "run", "scene.nml", "--out", "out", "--quiet"],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=limit_s,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Verdict("WRONG", f"still at work after {limit_s:g} s", limit_s), "", limit_s
    seconds = time.monotonic() - began
    reason = done.stderr.strip() if done.returncode else ""
    if done.returncode not in (0, 1, 2) or (done.returncode > 0 and len(reason.splitlines()) != 1):
        detail = f"status {done.returncode}: {done.stderr.strip()[-300:]}"
        return Verdict("WRONG", detail, seconds), reason, seconds
    if done.returncode == 2:
        return Verdict("WRONG" if out.exists() else "refused", reason, seconds), reason, seconds
    return None, reason, seconds


def run_scene(folder: Path) -> Verdict:
    """Run scene.nml of a folder and judge its files."""
    verdict, reason, seconds = call_solver(folder, SOLVER, RUN_LIMIT_S)
    if verdict is not None:
        return verdict
    out = folder / "out"
    findings = judge(out)
    if findings.wrong:
        wrong = "; ".join(list(dict.fromkeys(findings.wrong))[:4])
        return Verdict("WRONG", f"{wrong} ({len(findings.wrong)}) {reason}", seconds)
    if reason:
        return Verdict("stopped", reason, seconds)
    warnings = [text for text in warnings_of(out) if not text.startswith(EXPECTED_DOUBT)]
    if warnings:
        return Verdict("warned", "; ".join(text.split(":")[0][:60] for text in warnings), seconds)
    worst = max(findings.worst, key=lambda name: findings.worst[name])
    return Verdict("right", f"{worst} {findings.worst[worst]:.1e}", seconds)


def warnings_of(out: Path) -> list[str]:
    """The warnings of a run."""
    warnings = json.loads((out / "run.json").read_text())["warnings"]
    return [str(text) for text in warnings]


def sweep(folder: Path, runs: int, only: list[int]) -> collections.Counter[str]:
    """Run the scenes, tell each verdict, and keep the files of those that are wrong."""
    tally: collections.Counter[str] = collections.Counter()
    places = design(runs)
    for number in only or range(1, runs + 1):
        place = folder / f"sweep_{number:03d}"
        place.mkdir(parents=True, exist_ok=True)
        (place / "scene.nml").write_text(scene_text(places[number - 1]))
        verdict = run_scene(place)
        tally[verdict.word] += 1
        print(f"{number}: {verdict.word} ({verdict.seconds:.1f} s) {verdict.detail}", flush=True)
        if verdict.word != "WRONG" and not only:
            shutil.rmtree(place)
    return tally


def main() -> int:
    """Do what the command line asks for; 1 if a run is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=300, help="scenes of the design")
    parser.add_argument("--only", type=int, nargs="+", default=[], help="numbers of some of them")
    parser.add_argument("--folder", type=Path, help="where runs are kept that are wrong")
    arguments = parser.parse_args()
    folder = arguments.folder or Path(tempfile.mkdtemp(prefix="sweeps"))
    tally = sweep(folder, arguments.runs, arguments.only)
    print(f"{sum(tally.values())} runs: {dict(tally)}; those that are wrong are in {folder}")
    return 1 if tally["WRONG"] else 0


if __name__ == "__main__":
    sys.exit(main())
