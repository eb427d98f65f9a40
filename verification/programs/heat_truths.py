"""Scenes of heat_sweeps as they are and with a third of the cells and tolerances, compared.

    .venv/bin/python verification/programs/heat_truths.py FIRST LAST

Each number is the seed of a scene. Printed are the shares of values in which stated errors hold,
their median factor and the worst by quantity, and for each scene the difference of temperatures in
fractures over their range, which no error is stated for, and of the balance of heat.
"""

from __future__ import annotations

import json
import random
import re
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
from heat_sweeps import DATUM, scene_text

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from verification.stated_errors_unseen.compare_states import (
    SOLVER,
    Pairs,
    Rows,
    compare,
    last_time,
    print_table,
    rows_of,
    solve_text,
)

FINER = 3.0
CPU_S = {"coarse": 15.0, "fine": 120.0}  # of a run at most
NUMBER = r"[-+0-9.eE]+"


def with_probes(number: int) -> str:
    """The scene of a seed, with two probes."""
    text = scene_text(number)
    found = re.search(rf"x_max = ({NUMBER})", text)
    half = float(found.group(1)) if found else 1.0
    draw = random.Random(f"probe {number}")
    for i in (1, 2):
        x, y = (half * draw.uniform(-0.8, 0.8) for _ in range(2))
        text += f"&probe name = 'p{i}', x = {x!r}, y = {y!r} /\n"
    return text


def finer(text: str, end: float) -> str:
    """The scene with more cells and smaller tolerances, which ends where the other has ended."""
    lines = []
    for line in re.sub(rf", stop_gain = {NUMBER}", "", text).splitlines():
        changed = line
        for key in ("size_fracture", "size_boundary", "step"):
            found = re.search(rf"\b{key} = ({NUMBER})", changed)
            if found:
                smaller = min(float(found.group(1)) / FINER, end)
                changed = changed.replace(found.group(), f"{key} = {smaller!r}")
        for title, tolerance in (("time", 1e-2), ("heat", 1e-3)):
            if changed.startswith(f"&{title} "):
                changed = f"{changed.rstrip(' /')}, tolerance = {tolerance / FINER!r} /"
        if changed.startswith("&time"):
            changed = re.sub(rf"\bend = {NUMBER}", f"end = {end!r}", changed)
        lines.append(changed)
    return "\n".join(lines) + "\n"


def numbers(rows: Rows, column: str) -> np.ndarray:
    """A column."""
    return np.array([float(row[column]) for row in rows])


def ends(middles: np.ndarray) -> np.ndarray:
    """Ends of cells by their middles."""
    found = [0.0]
    for middle in middles:
        found.append(2.0 * middle - found[-1])
    return np.array(found)


def of_temperature(coarse: Path, fine: Path) -> float:
    """Largest difference of means over cells of fractures, over the range [-]."""
    tables = [rows_of(folder, "fractures.csv") for folder in (coarse, fine)]
    if not all(tables):
        return 0.0
    ours, theirs = (last_time(rows) for rows in tables)
    spread = max(abs(numbers(theirs, "temperature_k") - DATUM)) or 1.0
    worst = 0.0
    for fracture in {row["fracture"] for row in ours}:
        a, b = ([r for r in rows if r["fracture"] == fracture] for rows in (ours, theirs))
        at, places = ends(numbers(a, "s_m")), ends(numbers(b, "s_m"))
        whole = np.cumsum(numbers(b, "temperature_k") * np.diff(places))
        means = np.diff(np.interp(at, places, np.concatenate([[0.0], whole]))) / np.diff(at)
        worst = max(worst, float(np.max(np.abs(numbers(a, "temperature_k") - means))))
    return worst / spread


def main() -> None:
    """Print the tables."""
    pairs: dict[str, Pairs] = defaultdict(list)
    for number in range(int(sys.argv[1]), int(sys.argv[2]) + 1):
        text = with_probes(number)
        coarse = solve_text(SOLVER, text, CPU_S["coarse"])
        if coarse is None:
            print(number, "not run, or stopped", flush=True)
            continue
        end = float(rows_of(coarse, "history.csv")[-1]["time_s"])
        fine = solve_text(SOLVER, finer(text, end), CPU_S["fine"])
        if fine is None:
            print(number, "finer run not ended", flush=True)
            continue
        values = list(compare(coarse, fine))
        held = sum(true <= stated for *_, stated, true in values)
        record = json.loads((coarse / "run.json").read_text())
        grows = "&growth enabled" in text
        print(
            f"{number}: {held} of {len(values)} hold, heat conserved to"
            f" {record['heat_error_relative']:.0e}, beyond its range by"
            f" {record['heat_beyond_range_k']:.1g} K, temperatures"
            f" {'of other cells' if grows else f'{of_temperature(coarse, fine):.2g} of it off'}",
            flush=True,
        )
        for what, _, stated, true in values:
            pairs[what].append((stated, true))
    print_table("with three times the resolution", pairs)


if __name__ == "__main__":
    main()
