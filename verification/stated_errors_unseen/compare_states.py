"""Run drawn states as they are and with four times the resolution in everything, and compare.

    .venv/bin/python verification/stated_errors_unseen/compare_states.py [SOLVER] [FAMILY] [SEED]

The share of values in which the stated error holds, the median of stated over true error, the true
over the stated error in 95 % and at worst are printed by quantity. States whose runs take more CPU
than CPU_S are left out. The runs are kept in build/stated_errors_unseen. `write` writes check.toml.

The windows of the finer run are as large as those of the other one, and so is the error of their
edges: K is compared with the corrected K of the finer run, K_eq, energy and angle with theirs.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import os
import resource
import statistics
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wingcrack.scenes.namelist import group_text

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from verification.stated_errors_unseen.draw_states import FAMILIES, Draw, Scene

HERE = Path(__file__).resolve().parent
TOP = HERE.parents[1]
STORE = TOP / "build/stated_errors_unseen"
SOLVER = TOP / "build/release/fortran/app/wingcrack-solver"
STATES = 12  # of each family and seed
FINER = 4.0
ROUNDING = 1e-7  # of the largest value in a table
LEAST = {"_m": 1e-12, "_pa": 1.0, "_sqrtm": 10.0, "_j_m2": 1e-4, "_m2": 1e-12}  # differences
CPU_S = {"coarse": 2.0, "fine": 50.0}  # of a run at most
LEAST_BETWEEN = 2  # cells of the finer run between two wells
Row = dict[str, str]
Rows = list[Row]
Reference = Callable[[str], float]
Pairs = list[tuple[float, float]]  # stated and true error


def items_of(scene: Scene) -> Iterator[tuple[str, int, Mapping[str, Any]]]:
    """Groups of a scene: name, number of a group that repeats or 0, and entries."""
    for group, items in scene.items():
        if isinstance(items, list):
            yield from ((group, i + 1, item) for i, item in enumerate(items))
        else:
            yield group, 0, items


def finer(scene: Scene, times: float = FINER) -> Scene:
    """The scene with several times the resolution."""
    fine: Scene = json.loads(json.dumps(scene))
    for group in ("fe", "coarse"):
        if group in fine:
            for size in ("size_fracture", "size_boundary"):
                fine[group][size] /= times
    if "load" in fine:
        fine["load"]["steps"] *= int(times)
    if "time" in fine:
        fine["time"]["tolerance"] /= times
        if "step" in fine["time"]:
            fine["time"]["step"] /= times
    if "increment" in fine.get("growth", {}):
        fine["growth"]["increment"] /= times
    fine.get("growth", {}).pop("stop_gain", None)
    return fine


def solve(solver: Path, scene: Scene, limit: float, *, again: bool = True) -> Path | None:
    """Folder of a finished run, or None; `again` with another solver."""
    text = "".join(group_text(group, item) for group, _, item in items_of(scene))
    return solve_text(solver, text, limit, again=again)


def solve_text(solver: Path, text: str, limit: float, *, again: bool = True) -> Path | None:
    """Folder of a finished run of a scene file's text, or None; `again` with another solver."""
    key = text + (str(solver.stat().st_mtime_ns) if again else "")
    key = hashlib.sha256(key.encode()).hexdigest()[:16]
    folder = STORE / key
    if not (folder / "done").exists():
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "state.nml").write_text(text)
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        command = ["nice", str(solver), "run", str(folder / "state.nml"), "--out", str(folder)]
        cpu = math.ceil(limit)
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            env=environment,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (cpu, cpu)),
        )
        (folder / "done").write_text(f"{done.returncode}\n{done.stdout}{done.stderr}")
    return folder if (folder / "done").read_text().startswith("0") else None


def rows_of(folder: Path, name: str) -> Rows:
    """Rows of a table of a run."""
    try:
        with (folder / name).open() as file:
            return list(csv.DictReader(file))
    except FileNotFoundError:
        return []


def error_name(column: str, columns: Mapping[str, str]) -> str | None:
    """Name of the column with the error of another one."""
    own = {"ux_m": "u_error_m", "uy_m": "u_error_m"}
    own.update({f"s{c}_pa": "s_error_pa" for c in ("xx", "yy", "xy")})
    for end, error in own.items():
        if column.endswith("_" + end) and column.startswith("p"):
            return column[: -len(end)] + error
    if column.startswith(("k1_corrected", "k2_corrected")):
        return column[:2] + "_error_pa_sqrtm"
    parts = column.split("_")
    for i in range(len(parts), 0, -1):
        name = "_".join([*parts[:i], "error", *parts[i:]])
        if name in columns and name != column:
            return name
    return None


def last_time(rows: Rows) -> Rows:
    """Rows of the last state."""
    key = "time_s" if "time_s" in rows[0] else "load_factor"
    last = rows[-1][key]
    return [row for row in rows if row[key] == last]


# Columns that are means over the last step, and those of which they are the rates.
MEANS = {
    "history.csv": {
        "injection_rate_m2_s": "injected_m2",
    },
    "wells.csv": {"rate_m2_s": "injected_m2", "flow_m2_s": "injected_m2"},
}


def mean_over_step(coarse: Rows, fine: Rows, i: int, n: int, means: Mapping[str, str]) -> Reference:
    """Values of the finer run, those of rates over the last step of the other one."""
    start = float(coarse[i - 2 * n]["time_s"]) if len(coarse) > n else 0.0
    end = float(coarse[i - n]["time_s"])
    rows = fine[i::n]
    times = [float(row["time_s"]) for row in rows]

    def value(column: str) -> float:
        if column not in means or not end > start:
            return float(rows[-1][column])
        amounts = [float(row[means[column]]) for row in rows]
        change = np.interp(end, times, amounts) - np.interp(start, times, amounts)
        return float(change) / (end - start)

    return value


def criterion(k1: float, k2: float) -> tuple[float, float]:
    """K_eq and kink angle [degree] of the largest circumferential stress."""
    angle = 2.0 * math.atan2(-2.0 * k2, k1 + math.hypot(k1, math.sqrt(8.0) * k2))
    half = math.cos(0.5 * angle)
    return half * (k1 * half**2 - 1.5 * k2 * math.sin(angle)), math.degrees(angle)


def of_tip(row: Row) -> Reference:
    """Values of a tip of the finer run by its corrected K."""
    keq, g = float(row["keq_pa_sqrtm"]), float(row["g_j_m2"])
    k = [float(row[f"k{i}_corrected_pa_sqrtm"]) for i in (1, 2)]
    equivalent, angle = criterion(max(0.0, k[0]), k[1])
    compliance = g / keq**2 if keq > 0.0 else 0.0
    found = {
        "keq_pa_sqrtm": equivalent,
        "angle_deg": angle,
        "g_j_m2": compliance * equivalent**2,
        "g_ahead_j_m2": compliance * math.hypot(*k) ** 2,
    }
    for i in (1, 2):
        for name in ("", "_dc", "_corrected"):
            found[f"k{i}{name}_pa_sqrtm"] = k[i - 1]
    return lambda column: found.get(column, float(row[column]))


def of_row(row: Row) -> Reference:
    """Values of a row as they are."""
    return lambda column: float(row[column])


def at_place(rows: Rows, place: float, wells: Sequence[float]) -> Reference:
    """Values at a place of a fracture, between those of its cells, also of wells at its points."""
    s = np.array([float(row["s_m"]) for row in rows])
    length = s[-1] + s[0]
    start = max([w for w in wells if w <= place], default=0.0)
    end = min([w for w in wells if w > place], default=length)
    near = (s >= start) & (s <= end)

    def value(column: str) -> float:
        values = np.array([float(row[column] or "nan") for row in rows])
        if column in ("pressure_pa", "flow_m2_s") and len(wells) > 0:
            if np.count_nonzero(near) < LEAST_BETWEEN:
                return math.nan
            first = np.clip(np.searchsorted(s[near], place) - 1, 0, np.count_nonzero(near) - 2)
            a, b = s[near][first : first + 2]
            u, v = values[near][first : first + 2]
            return float(u + (v - u) * (place - a) / (b - a))
        if not column.startswith("jump"):
            return float(np.interp(place, s, values))
        # Jumps fall with the root of the distance from an end.
        root = np.sqrt(np.abs(s * (length - s)))
        share = np.interp(place, s, values / root)
        return float(share) * math.sqrt(abs(place * (length - place)))

    return value


def well_places(scene: Scene | None, fracture: str) -> list[float]:
    """Arc lengths of the wells at points of a fracture."""
    places = []
    for well in (scene or {}).get("injection", []):
        line = (scene or {})["fracture"][int(fracture) - 1]
        if well.get("fracture") != line["name"] or "x" not in well:
            continue
        first = np.array([line["x"][0], line["y"][0]])
        places.append(float(np.linalg.norm(np.array([well["x"], well["y"]]) - first)))
    return places


def matched(
    name: str, coarse: Rows, fine: Rows, scene: Scene | None = None
) -> Iterator[tuple[Row, Reference]]:
    """Rows of the last state, and values of the finer run at the same places."""
    ours, theirs = last_time(coarse), last_time(fine)
    if name in MEANS and "time_s" in ours[0]:
        for i, a in enumerate(ours):
            yield a, mean_over_step(coarse, fine, i, len(ours), MEANS[name])
    elif name != "fractures.csv":
        if len(ours) == len(theirs):
            for a, b in zip(ours, theirs, strict=True):
                yield a, of_tip(b) if name == "tips.csv" else of_row(b)
    else:
        for f in sorted({row["fracture"] for row in ours}):
            own, other = ([row for row in rows if row["fracture"] == f] for rows in (ours, theirs))
            for row in own[:: max(1, len(own) // 6)]:
                yield row, at_place(other, float(row["s_m"]), well_places(scene, f))


def _size(text: str) -> float:
    """Magnitude of a number of a table."""
    try:
        return abs(float(text))
    except ValueError:
        return 0.0


def compare(
    coarse: Path, fine: Path, scene: Scene | None = None
) -> Iterator[tuple[str, float, float, float]]:
    """Quantity, value, stated error and true error."""
    for name in ("history.csv", "tips.csv", "wells.csv", "probes.csv", "fractures.csv"):
        ours, theirs = rows_of(coarse, name), rows_of(fine, name)
        if not ours or not theirs:
            continue
        largest = {c: max(_size(row[c]) for row in ours) for c in ours[0]}
        for c, other in (("k1", "k2"), ("k2", "k1"), ("ux", "uy"), ("uy", "ux")):
            for column in [k for k in largest if c in k]:
                pair = largest.get(column.replace(c, other), 0.0)
                largest[column] = max(largest[column], pair)
        for row, reference in matched(name, ours, theirs, scene):
            for column in row:
                error = error_name(column, row)
                if error is None or "_error" in column or not row[column] or not row[error]:
                    continue
                value, stated, true = float(row[column]), float(row[error]), reference(column)
                if stated < 0.0 or not math.isfinite(true):
                    continue
                least = next((v for k, v in LEAST.items() if column.endswith(k)), 0.0)
                if abs(value - true) <= max(least, ROUNDING * max(largest[column], abs(value))):
                    continue  # equal, as in cells at rest: says nothing
                what = column[3:] if name == "probes.csv" else column
                yield f"{name[:-4]}: {what}", value, stated, abs(value - true)


def state_of(family: str, seed: str, i: int, solver: Path) -> Scene | None:
    """The scene of a state; growth ends where a first run has nearly reached its gain."""
    scene = FAMILIES[family](Draw(f"{seed} {family} {i}"))
    if family == "growing":
        pilot = solve(solver, scene, 1.5 * CPU_S["coarse"])
        if pilot is None:
            return None
        end = 0.9 * float(rows_of(pilot, "history.csv")[-1]["time_s"])
        scene["time"]["end"] = float(f"{end:.4g}")
        scene["growth"].pop("stop_gain")
    return scene


def state(family: str, seed: str, i: int, solver: Path) -> list[tuple[str, float, float, float]]:
    """Compare one state."""
    scene = state_of(family, seed, i, solver)
    label = f"{family} {seed} {i}"
    if scene is None:
        print(label, "did not end", flush=True)
        return []
    coarse = solve(solver, scene, CPU_S["coarse"])
    fine = coarse and solve(solver, finer(scene), CPU_S["fine"], again=False)
    if coarse is None or fine is None:
        print(label, "not run", coarse and coarse.name, fine, flush=True)
        return []
    values = list(compare(coarse, fine, scene))
    missed = defaultdict(list)
    for what, value, stated, true in values:
        if true > stated:
            missed[what].append(f"{value:.4g}+-{stated:.2g} true {true:.2g}")
    cpu = [json.loads((f / "run.json").read_text())["cpu_s"] for f in (coarse, fine)]
    print(label, coarse.name, fine.name, f"{len(values)} values, CPU {cpu[0]:.1f} {cpu[1]:.1f} s")
    for what, texts in missed.items():
        print("   ", what, len(texts), "; ".join(texts[:3]), flush=True)
    return values


def settings(scene: Scene) -> str:
    """The scene as changes of an empty one."""
    addresses = {
        f"{group}.{place}.{name}" if place else f"{group}.{name}": value
        for group, place, item in items_of(scene)
        for name, value in item.items()
    }
    return "{ " + ", ".join(f'"{k}" = {json.dumps(v)}' for k, v in addresses.items()) + " }"


def floor(column: str) -> float:
    """Least error that counts, as in `compare`."""
    return next((v for k, v in LEAST.items() if column.endswith(k)), 0.0) or 1e-200


def known(name: str, rows: Rows) -> dict[str, str]:
    """Columns of a table that have errors, and the columns of these."""
    errors = {c: error_name(c, rows[0]) for c in rows[0] if "_error" not in c}
    return {c: e for c, e in errors.items() if e is not None and last_time(rows)[0][e] != ""}


def write_case(families: list[str], seeds: list[str], solver: Path, limit: float) -> None:
    """Write check.toml with the references of the finer runs."""
    parts = [(HERE / "head.toml").read_text()]
    gaps = json.loads((HERE / "gaps.json").read_text())
    for family in families:
        columns: dict[str, dict[str, str]] = {}
        runs = []
        for seed, i in ((s, i) for s in seeds for i in range(STATES)):
            scene = state_of(family, seed, i, solver)
            if scene is None or "load" in scene:  # "last" is the largest load factor in a check
                continue
            coarse = solve(solver, scene, 60.0)
            fine = solve(solver, finer(scene), 240.0, again=False)
            if coarse is None or fine is None:
                continue
            if json.loads((coarse / "run.json").read_text())["cpu_s"] > limit:
                continue
            exact: dict[str, float] = {}
            for name in ("history", "tips", "wells", "probes"):
                ours, theirs = rows_of(coarse, name + ".csv"), rows_of(fine, name + ".csv")
                if not ours:
                    continue
                found = known(name + ".csv", ours)
                before = columns.get(name, found)
                columns[name] = {c: e for c, e in found.items() if c in before}
                for k, (_, reference) in enumerate(matched(name + ".csv", ours, theirs)):
                    if k < (2 if name == "tips" else 1):
                        exact.update({f"{name}_{c}_{k + 1}": reference(c) for c in found})
            runs.append((f"{family}, {seed} {i}", scene, exact))
        for label, scene, exact in runs:
            used = {
                k: v
                for k, v in exact.items()
                if k.partition("_")[2][:-2] in columns[k.partition("_")[0]]
            }
            constants = ", ".join(f'"{k}" = {v!r}' for k, v in used.items())
            parts.append(
                f'[[run]]\nname = "{label}"\nmethod = "{family}"\nscene = "empty.nml"\n'
                f"set = {settings(scene)}\nconstants = {{ {constants} }}\n"
            )
        parts += checks(family, columns, gaps)
    (HERE / "check.toml").write_text("\n".join(parts))


def checks(
    family: str, columns: Mapping[str, Mapping[str, str]], gaps: Mapping[str, str]
) -> Iterator[str]:
    """Checks of the quantities of a family."""
    for name, errors in columns.items():
        for c, error in errors.items():
            first, second = f"{name}_{c}_1", f"{name}_{c}_2"
            how = 'take = "last"'
            exact = first
            if name == "tips":
                exact = f"({first}*(2 - tip) + {second}*(tip - 1))"
                time = "load_factor" if family == "body" else "time_s"
                how = f'x = "tip", where = {{ tip = {{ min = 1, max = 2 }}, {time} = "last" }}'
            elif name == "wells":
                how = 'take = "last", where = { well = 1 }'
            what = f"{family}, {name}: {c}"
            column = f"({c} - {exact})/maximum({error}, {floor(c)!r})"
            gap = f'known_gap = "{gaps[what]}"\n' if what in gaps else ""
            yield (
                f'[[check]]\nquantity = "{what}"\nruns = ["{family}, *"]\n'
                f'result = {{ file = "{name}.csv", column = "{column}", {how} }}\n{gap}'
            )


def print_table(title: str, table: Mapping[str, Pairs]) -> None:
    """How many stated errors hold by quantity, their median factor, and the worst."""
    print(f"\n{title}\n{'quantity':52} values held  factor  95 %  worst")
    for what, pairs in sorted(table.items()):
        held = 100.0 * sum(t <= s for s, t in pairs) / len(pairs)
        factor = statistics.median(s / max(t, 1e-300) for s, t in pairs)
        shares = [t / max(s, 1e-300) for s, t in pairs]
        need = f"{np.quantile(shares, 0.95):.3g} {max(shares):.3g}"
        print(f"{what:52} {len(pairs):6d} {held:5.1f} {factor:7.2f}  {need}")


def main() -> None:
    """Print the table by quantity, or write check.toml."""
    solver = SOLVER
    if sys.argv[1:2] == ["write"]:
        write_case(["body"], ["10", "11", "12"], solver, 2.0)
        return
    if len(sys.argv) > 1 and Path(sys.argv[1]).exists():
        solver = Path(sys.argv.pop(1))
    families = [a for a in sys.argv[1:] if a in FAMILIES] or list(FAMILIES)
    seeds = [a for a in sys.argv[1:] if a not in FAMILIES] or ["1"]
    for family in families:
        table: dict[str, Pairs] = defaultdict(list)
        for seed, i in ((seed, i) for seed in seeds for i in range(STATES)):
            for what, _, stated, true in state(family, seed, i, solver):
                table[what].append((stated, true))
        print_table(family, table)


if __name__ == "__main__":
    main()
