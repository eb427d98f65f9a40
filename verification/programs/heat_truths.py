"""Scenes of heat_sweeps as they are and with a third of the cells and tolerances, compared.

    .venv/bin/python verification/programs/heat_truths.py FIRST LAST

Each number is the seed of a scene. Printed are the shares of values in which stated errors hold,
their median factor and the worst by quantity, and for each scene the error of the balance of heat.
"""

from __future__ import annotations

import json
import random
import re
import sys
from collections import defaultdict
from collections.abc import Iterator
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
CPU_S = {"coarse": 60.0, "fine": 300.0}  # of a run at most
NUMBER = r"[-+0-9.eE]+"
SAME_LENGTH = 1e-3  # of fractures that have not grown
LEAST_SHARE = 1e-5  # of the range, of differences that count
ROWS = 6  # of wells.csv
Value = tuple[str, float, float, float]


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


def rises(rows: Rows, slope: float) -> np.ndarray:
    """Temperatures of fracture cells less a geotherm: paths that have grown lie elsewhere."""
    return numbers(rows, "temperature_k") - slope * numbers(rows, "y_m")


def of_fractures(coarse: Path, fine: Path, slope: float) -> Iterator[Value]:
    """Means over cells of fractures, and values in their middles."""
    tables = [rows_of(folder, "fractures.csv") for folder in (coarse, fine)]
    if not all(tables):
        return
    ours, theirs = (last_time(rows) for rows in tables)
    for fracture in {row["fracture"] for row in ours}:
        a, b = ([r for r in rows if r["fracture"] == fracture] for rows in (ours, theirs))
        at, places = ends(numbers(a, "s_m")), ends(numbers(b, "s_m"))
        values, errors = rises(a, slope), numbers(a, "temperature_error_k")
        true = np.interp(numbers(a, "s_m"), numbers(b, "s_m"), rises(b, slope))
        for row in zip(values, errors, np.abs(values - true), strict=True):
            yield "fractures: temperature, middle", *row
        if abs(at[-1] - places[-1]) > SAME_LENGTH * at[-1]:
            continue  # has grown
        whole = np.cumsum(rises(b, slope) * np.diff(places))
        means = np.diff(np.interp(at, places, np.concatenate([[0.0], whole]))) / np.diff(at)
        for row in zip(values, errors, np.abs(values - means), strict=True):
            yield "fractures: temperature, mean", *row


def of_wells(coarse: Path, fine: Path) -> Iterator[Value]:
    """What wells take out in steps of the coarser run."""
    tables = [rows_of(folder, "wells.csv") for folder in (coarse, fine)]
    for well in {row["well"] for row in tables[0]}:
        a, b = ([row for row in rows if row["well"] == well] for rows in tables)
        times, flow = numbers(b, "time_s"), -np.minimum(numbers(b, "flow_m2_s"), 0.0)
        out = flow * np.diff(times, prepend=0.0)
        heat = np.cumsum(out * (numbers(b, "temperature_k") - DATUM))
        at = numbers(a, "time_s")
        whole = np.diff(np.interp(at, times, np.cumsum(out)), prepend=0.0)
        carried = np.diff(np.interp(at, times, heat), prepend=0.0)
        for i in np.unique(np.linspace(1, len(a) - 1, ROWS).astype(int)):
            if float(a[i]["flow_m2_s"]) < 0.0 < whole[i]:
                value, error = (float(a[i][f"temperature{name}_k"]) for name in ("", "_error"))
                yield "wells: temperature", value, error, abs(value - DATUM - carried[i] / whole[i])


def of_temperature(coarse: Path, fine: Path, text: str) -> list[Value]:
    """Temperatures that differ, and their stated and true errors [K]."""
    slope = re.search(rf"temperature_per_y = ({NUMBER})", text)
    per_y = float(slope.group(1)) if slope else 0.0
    values = [*of_fractures(coarse, fine, per_y), *of_wells(coarse, fine)]
    given = re.findall(r"[ ,]temperature = ([-+0-9.eE, ]+)", text)
    every = [float(number) for entry in given for number in entry.strip(", ").split(",")]
    every += [float(row["temperature_k"]) for row in rows_of(coarse, "fractures.csv")]
    spread = max([abs(t - DATUM) for t in every], default=0.0)
    return [value for value in values if value[-1] > LEAST_SHARE * spread]


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
        values = [v for v in compare(coarse, fine) if "temperature" not in v[0]]
        values += of_temperature(coarse, fine, text)
        held = sum(true <= stated for *_, stated, true in values)
        record = json.loads((coarse / "run.json").read_text())
        print(
            f"{number}: {held} of {len(values)} hold, heat conserved to"
            f" {record['heat_error_relative']:.0e}, beyond its range by"
            f" {record['heat_beyond_range_k']:.1g} K",
            flush=True,
        )
        for what, _, stated, true in values:
            pairs[what].append((stated, true))
    print_table("with three times the resolution", pairs)


if __name__ == "__main__":
    main()
