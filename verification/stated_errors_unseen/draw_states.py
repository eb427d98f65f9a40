"""Draw states by a seed, run them as they are and with four times the resolution in everything.

    .venv/bin/python verification/stated_errors_unseen/draw_states.py [SOLVER] [SEED ...]

Rocks, fractures, loads, wells and steps are drawn. The share of values in which the stated error
holds, and the median of stated over true error, are printed by quantity. The runs are kept in
build/stated_errors_unseen.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import os
import random
import statistics
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
TOP = HERE.parents[1]
STORE = TOP / "build/stated_errors_unseen"
SOLVER = TOP / "build/release/fortran/app/wingcrack-solver"
STATES = 12  # of each family and seed
FINER = 4.0
ROUNDING = 1e-7  # of the largest value in a table
LEAST = {"_m": 1e-12, "_pa": 1.0, "_sqrtm": 10.0, "_j_m2": 1e-4, "_m2": 1e-12}  # differences
Scene = dict[str, Any]
Rows = list[dict[str, str]]


def value_text(value: object) -> str:
    """Text of a value in a scene file."""
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, str):
        return f"'{value}'"
    if isinstance(value, (list, tuple)):
        return ", ".join(map(value_text, value))
    return repr(value)


def scene_text(scene: Scene) -> str:
    """Text of a scene file."""
    lines = []
    for group, items in scene.items():
        for item in items if isinstance(items, list) else [items]:
            names = "\n  ".join(f"{k} = {value_text(v)}" for k, v in item.items())
            lines.append(f"&{group}\n  {names}\n/\n")
    return "".join(lines)


class Draw:
    """Random numbers with few digits."""

    def __init__(self, seed: str) -> None:
        """Start from a seed."""
        self.random = random.Random(seed)

    def among(self, *values: Any) -> Any:
        """Choose one."""
        return self.random.choice(values)

    def between(self, low: float, high: float) -> float:
        """Choose a number."""
        return float(f"{self.random.uniform(low, high):.3g}")

    def decades(self, low: float, high: float) -> float:
        """Choose a positive number by its logarithm."""
        return float(f"{math.exp(self.random.uniform(math.log(low), math.log(high))):.3g}")


def path(draw: Draw, centre: Sequence[float], length: float, bends: int) -> np.ndarray:
    """A fracture that turns by 10 to 60 degrees at each bend."""
    angle = draw.random.uniform(0.0, math.pi)
    points = [np.zeros(2)]
    for _ in range(bends + 1):
        along = np.array([math.cos(angle), math.sin(angle)])
        points.append(points[-1] + along * length / (bends + 1))
        angle += math.radians(draw.random.uniform(10.0, 60.0)) * draw.among(-1, 1)
    all_points = np.array(points)
    middle = 0.5 * (all_points.min(axis=0) + all_points.max(axis=0))
    placed: np.ndarray = np.round((all_points - middle + centre) / length, 4) * length
    return placed


def nearest(a: np.ndarray, b: np.ndarray) -> float:
    """Least distance of two polylines, sampled."""
    share = np.linspace(0.0, 1.0, 40)[:, None]
    first, second = (
        np.concatenate([p[i] + share * (p[i + 1] - p[i]) for i in range(len(p) - 1)])
        for p in (a, b)
    )
    return float(np.min(np.linalg.norm(first[:, None] - second[None], axis=2)))


def network(draw: Draw, n: int, length: float, bends: int) -> list[np.ndarray]:
    """Fractures that do not meet, near the middle of a body ten lengths wide."""
    paths: list[np.ndarray] = []
    while len(paths) < n:
        spread = 0.9 if n > 1 else 0.2
        centre = [draw.random.uniform(-spread, spread) * length for _ in range(2)]
        own = length * (draw.random.uniform(0.6, 1.2) if n > 1 else 1.0)
        new = path(draw, centre, float(f"{own:.3g}"), draw.random.randint(0, bends))
        if all(nearest(new, old) > 0.15 * length for old in paths):
            paths.append(new)
    return paths


def base(draw: Draw, length: float) -> tuple[Scene, tuple[float, float]]:
    """The body, its rock and its load."""
    w = 5.0 * length
    most, least = draw.between(12.0, 30.0) * 1e6, draw.between(6.0, 12.0) * 1e6
    scene: Scene = {
        "scene": {"name": "state"},
        "domain": {"x_min": -w, "x_max": w, "y_min": -w, "y_max": w},
        "material": {"young": draw.between(5.0, 60.0) * 1e9, "poisson": draw.between(0.1, 0.4)},
        "fracture": [],
        "side": [
            {"name": "left", "x_displacement": 0.0},
            {"name": "bottom", "y_displacement": 0.0},
            {"name": "right", "x_traction": -most},
            {"name": "top", "y_traction": -least},
        ],
        "probe": [],
        "output": {"vtu": False},
    }
    for i in range(2):
        place = [draw.between(-2.0, 2.0) * length for _ in range(2)]
        scene["probe"].append({"name": f"p{i + 1}", "x": place[0], "y": place[1]})
    return scene, (most, least)


def add_fractures(draw: Draw, scene: Scene, paths: list[np.ndarray], kind: str) -> None:
    """Fractures of one kind."""
    friction = draw.between(0.2, 0.7)
    joint = {}
    if kind == "joint":
        joint = {"normal_stiffness": draw.decades(3e9, 3e11), "closure": draw.decades(1e-5, 9e-5)}
    for i, p in enumerate(paths):
        scene["fracture"].append(
            {
                "name": f"f{i + 1}",
                "x": [float(f"{v:.6g}") for v in p[:, 0]],
                "y": [float(f"{v:.6g}") for v in p[:, 1]],
                "friction": friction,
                **joint,
            }
        )


def body(draw: Draw) -> Scene:
    """Without a fluid: sliding, opened, bent, joints, several fractures."""
    length = draw.among(0.1, 1.0, 10.0)
    scene, (most, least) = base(draw, length)
    kind = draw.among("slide", "slide", "open", "joint")
    n = draw.among(1, 1, 2, 3, 5)
    add_fractures(draw, scene, network(draw, n, length, 2), kind)
    for fracture in scene["fracture"]:
        share = draw.between(0.1, 0.8) if kind != "open" else draw.between(1.0, 1.6)
        fracture["face_pressure"] = float(f"{share * least:.3g}")
        if kind == "open":
            fracture["face_pressure"] = float(f"{most + 0.3 * share * least:.3g}")
    if kind == "open" and draw.among(True, False):
        scene["load"] = {"factors": [1.0, 0.4], "steps": 2}
    size = float(f"{length / draw.among(8, 10, 15, 20, 30):.3g}")
    scene["growth"] = {"intensities": True}
    scene["fe"] = {"size_fracture": size, "size_boundary": draw.among(0.5, 1.0) * length}
    return scene


def injected(draw: Draw) -> Scene:
    """With a fluid and without growth: wells and stages; slip of a part; joints."""
    length = draw.among(0.3, 1.0, 5.0, 20.0, 50.0)
    scene, (_, least) = base(draw, length)
    kind = draw.among("slide", "slide", "joint")
    n = draw.among(1, 1, 2, 3)
    add_fractures(draw, scene, network(draw, n, length, 1), kind)
    aperture = draw.decades(2e-5, 1e-3)
    for fracture in scene["fracture"]:
        fracture["aperture"] = aperture + fracture.get("closure", 0.0)
        fracture["dilation_deg"] = draw.among(0.0, 1.0, 3.0)
    fluid(draw, scene, least, draw.decades(1e-20, 1e-16))
    end = draw.decades(10.0, 1e5)
    start = scene["initial"]["pressure"]
    wells = []
    for i in range(draw.among(1, 1, 2) if n > 1 else 1):
        well: dict[str, Any] = {"fracture": f"f{i + 1}"}
        if draw.among(True, False):
            held = length**2 * (1e6 / scene["material"]["young"] + aperture / length * 4e-4)
            rate = float(f"{held / end * draw.decades(0.3, 10.0):.3g}")
            well["rate"] = rate
            if draw.among(True, False):
                well["time"], well["rate"] = [0.0, end / 2.0], [rate, rate * draw.between(-0.3, 2)]
        else:
            well["pressure"] = float(f"{start + draw.between(0.2, 1.3) * (least - start):.4g}")
        wells.append(well)
    scene["injection"] = wells
    scene["time"] = {"end": end, "tolerance": 0.01}
    if draw.among(True, False, False):
        scene["time"]["step"] = end / 20.0
    scene["growth"] = {"intensities": True}
    cells(draw, scene, length)
    return scene


def fluid(draw: Draw, scene: Scene, least: float, permeability: float) -> None:
    """Fluid in fractures and rock."""
    porosity = draw.between(0.01, 0.1)
    scene["material"].update(
        {"biot": draw.between(0.4, 1.0), "porosity": porosity, "permeability": permeability}
    )
    scene["fluid"] = {"compressibility": 4.4e-10, "viscosity": draw.decades(1e-4, 1e-3)}
    scene["initial"] = {
        "fracture_pressure": "equilibrated",
        "pressure": float(f"{draw.between(0.1, 0.6) * least:.4g}"),
    }


def cells(draw: Draw, scene: Scene, length: float) -> None:
    """Cells and windows."""
    size = float(f"{length / draw.among(8, 10, 15, 20):.3g}")
    scene["coarse"] = {"size_fracture": size, "size_boundary": length}
    scene["fine"] = {"window": draw.among(5.0, 8.0) * size, "size_ratio": 0.5}


def growing(draw: Draw) -> Scene:
    """Wings that grow by a fraction of their fracture."""
    length = draw.among(0.3, 1.0, 5.0, 20.0)
    scene, (_, least) = base(draw, length)
    add_fractures(draw, scene, network(draw, draw.among(1, 1, 2), length, 1), "slide")
    aperture = draw.decades(5e-5, 1e-3)
    for fracture in scene["fracture"]:
        fracture["aperture"] = aperture
        fracture["dilation_deg"] = draw.among(0.0, 1.0)
    fluid(draw, scene, least, draw.decades(1e-20, 1e-17))
    toughness = float(f"{draw.decades(0.1, 1.0) * 2e6 * math.sqrt(length):.3g}")
    scene["material"]["toughness"] = toughness
    held = length**2 * (2e6 / scene["material"]["young"] + aperture / length * 4e-3)
    scene["injection"] = [{"fracture": "f1", "rate": float(f"{held / draw.decades(100, 1e4):.3g}")}]
    scene["time"] = {"end": 1e6, "tolerance": 0.01}
    cells(draw, scene, length)
    size = scene["coarse"]["size_fracture"]
    gain = float(f"{draw.between(0.1, 0.4) * length:.3g}")
    scene["growth"] = {"enabled": True, "stop_gain": gain, "increment": size / 2.0}
    return scene


FAMILIES = {"body": body, "injected": injected, "growing": growing}


def finer(scene: Scene) -> Scene:
    """The scene with four times the resolution."""
    fine: Scene = json.loads(json.dumps(scene))
    for group in ("fe", "coarse"):
        if group in fine:
            for size in ("size_fracture", "size_boundary"):
                fine[group][size] /= FINER
    if "load" in fine:
        fine["load"]["steps"] *= int(FINER)
    if "time" in fine:
        fine["time"]["tolerance"] /= FINER
        if "step" in fine["time"]:
            fine["time"]["step"] /= FINER
    if "increment" in fine.get("growth", {}):
        fine["growth"]["increment"] /= FINER
    fine.get("growth", {}).pop("stop_gain", None)
    return fine


def solve(solver: Path, scene: Scene, limit: float, *, again: bool = True) -> Path | None:
    """Folder of a finished run, or None; `again` with another solver."""
    text = scene_text(scene)
    key = text + (str(solver.stat().st_mtime_ns) if again else "")
    key = hashlib.sha256(key.encode()).hexdigest()[:16]
    folder = STORE / key
    if not (folder / "done").exists():
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "state.nml").write_text(text)
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        command = ["nice", str(solver), "run", str(folder / "state.nml"), "--out", str(folder)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=limit, env=environment, check=False
            )
            (folder / "done").write_text(f"{done.returncode}\n{done.stdout}{done.stderr}")
        except subprocess.TimeoutExpired:
            (folder / "done").write_text("late\n")
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


def mean_over_step(
    coarse: Rows, fine: Rows, i: int, n: int, means: Mapping[str, str]
) -> Callable[[str], float]:
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


def matched(name: str, coarse: Rows, fine: Rows) -> Iterator[tuple[dict[str, str], Any]]:
    """Rows of the last state, and values of the finer run at the same places."""
    ours, theirs = last_time(coarse), last_time(fine)
    if name in MEANS and "time_s" in ours[0]:
        for i, a in enumerate(ours):
            yield a, mean_over_step(coarse, fine, i, len(ours), MEANS[name])
        return
    if name != "fractures.csv":
        if len(ours) == len(theirs):
            for a, b in zip(ours, theirs, strict=True):
                yield a, lambda column, b=b: float(b[column])
        return
    for f in sorted({row["fracture"] for row in ours}):
        own = [row for row in ours if row["fracture"] == f]
        other = [row for row in theirs if row["fracture"] == f]
        s = [float(row["s_m"]) for row in other]
        length = s[-1] + s[0]
        for row in own[:: max(1, len(own) // 6)]:
            place = float(row["s_m"])

            def at(
                column: str,
                other: Rows = other,
                s: list[float] = s,
                x: float = place,
                length: float = length,
            ) -> float:
                values = np.array([float(r[column] or "nan") for r in other])
                # Jumps fall with the root of the distance from an end.
                root = np.sqrt(np.abs(np.array(s) * (length - np.array(s))))
                if not column.startswith("jump"):
                    return float(np.interp(x, s, values))
                return float(np.interp(x, s, values / root)) * math.sqrt(abs(x * (length - x)))

            yield row, at


def _size(text: str) -> float:
    """Magnitude of a number of a table."""
    try:
        return abs(float(text))
    except ValueError:
        return 0.0


def compare(coarse: Path, fine: Path) -> Iterator[tuple[str, float, float, float]]:
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
        for row, reference in matched(name, ours, theirs):
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
        pilot = solve(solver, scene, 60.0)
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
    coarse, fine = solve(solver, scene, 60.0), solve(solver, finer(scene), 240.0, again=False)
    if coarse is None or fine is None:
        print(label, "not run", coarse, fine, flush=True)
        return []
    values = list(compare(coarse, fine))
    missed = defaultdict(list)
    for what, value, stated, true in values:
        if true > stated:
            missed[what].append(f"{value:.4g}+-{stated:.2g} true {true:.2g}")
    cpu = [json.loads((f / "run.json").read_text())["cpu_s"] for f in (coarse, fine)]
    print(label, coarse.name, fine.name, f"{len(values)} values, CPU {cpu[0]:.1f} {cpu[1]:.1f} s")
    for what, texts in missed.items():
        print("   ", what, len(texts), "; ".join(texts[:3]), flush=True)
    return values


def toml(value: object) -> str:
    """Text of a value in TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


def settings(scene: Scene) -> str:
    """The scene as changes of an empty one."""
    addresses = {}
    for group, items in scene.items():
        for i, item in enumerate(items if isinstance(items, list) else [items]):
            middle = f".{i + 1}" if isinstance(items, list) else ""
            addresses.update({f"{group}{middle}.{name}": v for name, v in item.items()})
    return "{ " + ", ".join(f'"{k}" = {toml(v)}' for k, v in addresses.items()) + " }"


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
    jobs = [(f, s, i, solver) for f in families for s in seeds for i in range(STATES)]
    with ThreadPoolExecutor(1) as pool:
        results = list(pool.map(lambda job: (job[0], state(*job)), jobs))
    for family in families:
        table: dict[str, list[tuple[float, float]]] = defaultdict(list)
        for name, values in results:
            if name == family:
                for what, _, stated, true in values:
                    table[what].append((stated, true))
        print(f"\n{family}\n{'quantity':52} values held  factor")
        for what, pairs in sorted(table.items()):
            held = 100.0 * sum(t <= s for s, t in pairs) / len(pairs)
            factor = statistics.median(s / max(t, 1e-300) for s, t in pairs)
            need = np.quantile([t / max(s, 1e-300) for s, t in pairs], 0.95)
            print(f"{what:52} {len(pairs):6d} {held:5.1f} {factor:7.2f}  {need:.3g}")


if __name__ == "__main__":
    main()
