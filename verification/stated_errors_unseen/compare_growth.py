"""Run drawn wings as they are and with three times the resolution, and compare at six times.

    .venv/bin/python verification/stated_errors_unseen/compare_growth.py FIRST LAST [SOLVER]

Each number from FIRST to LAST is the seed of one scene. The share of values in which the stated
error holds, and the median of stated over true error, are printed by column of history.csv: first
of scenes whose growth the wells drive, then of those whose tips exceed their toughness before the
first step, of which the program warns.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from verification.stated_errors_unseen.compare_states import (
    SOLVER,
    Pairs,
    Rows,
    finer,
    print_table,
    rows_of,
    solve,
)
from verification.stated_errors_unseen.draw_states import Draw, driven

TIMES = (0.1, 0.3, 0.5, 0.7, 0.85, 0.95)  # of the duration
FINER = 3.0
COLUMNS = (
    "fracture_length_m",
    "well_pressure_pa",
    "fracture_volume_m2",
    "leakoff_m2",
    "max_slip_m",
    "max_opening_m",
)
CPU_S = {"coarse": 12.0, "fine": 120.0}  # of a run at most
FEWEST = 10  # states of a run


def at(rows: Rows, times: np.ndarray, column: str) -> np.ndarray:
    """Values of a column, linear in time between its rows."""
    known = [np.array([float(row[name]) for row in rows]) for name in ("time_s", column)]
    values: np.ndarray = np.interp(times, known[0], known[1])
    return values


def compare(coarse: Rows, fine: Rows, column: str) -> Pairs:
    """Errors at the times of a run that differ by more than rounding."""
    times = np.array(TIMES) * float(coarse[-1]["time_s"])
    name = "_error_".join(column.rsplit("_", 1))
    values = at(coarse, times, column)
    true = np.abs(values - at(fine, times, column))
    largest = max(abs(float(row[column])) for row in coarse)
    counts = true > max(1e-7 * largest, 1e-12)
    return [*zip(at(coarse, times, name)[counts], true[counts], strict=True)]


def main() -> None:
    """Print the tables."""
    solver = Path(sys.argv[3]) if len(sys.argv) > 3 else SOLVER
    tables: dict[bool, dict[str, Pairs]] = {False: defaultdict(list), True: defaultdict(list)}
    scenes = {False: 0, True: 0}
    for seed in range(int(sys.argv[1]), int(sys.argv[2]) + 1):
        scene = driven(Draw(f"fz{seed}"))
        coarse = solve(solver, scene, CPU_S["coarse"])
        if coarse is None or len(rows_of(coarse, "history.csv")) < FEWEST:
            continue
        rows = rows_of(coarse, "history.csv")
        fine_scene = finer(scene, FINER)
        fine_scene["time"]["end"] = float(rows[-1]["time_s"])
        fine = solve(solver, fine_scene, CPU_S["fine"])
        if fine is None:
            continue
        is_early = any(
            row["kind"] == "unstable_growth" and "initial state" in row["detail"]
            for row in rows_of(coarse, "events.csv")
        )
        scenes[is_early] += 1
        for column in COLUMNS:
            tables[is_early][column] += compare(rows, rows_of(fine, "history.csv"), column)
    for is_early, table in tables.items():
        kind = "unstable at first" if is_early else "driven"
        print_table(f"{scenes[is_early]} scenes, {kind}", {k: v for k, v in table.items() if v})


if __name__ == "__main__":
    main()
