"""Measurements as tables for people and as JSON for programs."""

from __future__ import annotations

import hashlib
import json
import math
import re
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from wingcrack.figures.text_files import write_whole
from wingcrack_verify.bench.catalogue import Growth
from wingcrack_verify.bench.measure import Measurement
from wingcrack_verify.environment import machine, packages

_PHASE = 0.02  # share of the CPU time below which a phase is not shown


def as_table(measurements: Sequence[Measurement], stored: Baseline) -> str:
    """Give a row per measurement; columns that nobody has are left out."""
    columns = {
        "": [m.name for m in measurements],
        "CPU [s]": [_number(m.median_s) for m in measurements],
        "spread": [f"{100 * m.spread:.0f} %" if len(m.cpu_s) > 1 else "-" for m in measurements],
        "states": [str(m.typical.states) for m in measurements],
        "per state [s]": [_number(m.median_s / max(m.typical.states, 1)) for m in measurements],
        "first [s]": [_number(m.first_step_s) for m in measurements],
        "further [s]": [_number(m.further_step_s) for m in measurements],
        "growths": [str(m.typical.growths or "-") for m in measurements],
        "per growth [s]": [_number(m.cpu_per_growth_s) for m in measurements],
        "remesh": [f"{100 * m.remeshing_share:.1f} %" for m in measurements],
        "unknowns": [str(m.typical.sizes["unknowns"]) for m in measurements],
        "memory [MB]": [f"{m.typical.memory_mb:.0f}" for m in measurements],
        "instructions [1e6]": [_millions(m.instructions) for m in measurements],
        "to stored": [_ratio(instructions_ratio(m, stored)) for m in measurements],
        "to other [CPU]": [_ratio(m.ratio) for m in measurements],
    }
    shown = {name: cells for name, cells in columns.items() if set(cells) != {"-"}}
    widths = [max(len(name), *map(len, cells)) for name, cells in shown.items()]
    lines = [list(shown), *zip(*shown.values(), strict=True)]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if k == 0 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        )
        for line in lines
    )


def as_phases(measurements: Sequence[Measurement]) -> str:
    """Tell where the time goes, the longest phase first."""
    lines = ["where the time goes [s]:"]
    for m in measurements:
        phases = sorted(m.typical.phases_s.items(), key=lambda item: -item[1])
        parts = [
            f"{name} {_number(seconds)}"
            for name, seconds in phases
            if seconds >= _PHASE * m.typical.cpu_s
        ]
        lines.append(f"  {m.name}: {', '.join(parts)}")
    return "\n".join(lines)


def as_growth(exponents: Sequence[Exponent]) -> str:
    """Tell how cost grows with size."""
    lines = []
    for found in exponents:
        steps = ", ".join(f"{value:.2f}" for value in found.fourfold)
        sizes = ", ".join(str(size) for size in found.sizes)
        lines.append(
            f"CPU time over {found.of.replace('_', ' ')} ({sizes}): exponent {found.fitted:.2f};"
            f" CPU(4n)/CPU(n) {steps}"
        )
    return "\n".join(lines)


def instructions_ratio(measurement: Measurement, stored: Baseline) -> float | None:
    """Instructions over the stored count; None without both."""
    before = stored.instructions.get(measurement.name)
    if measurement.instructions is None or not before:
        return None
    return measurement.instructions / before


def as_json(measurements: Sequence[Measurement], stored: Baseline) -> list[dict[str, Any]]:
    """Give the measurements with what follows from them."""
    return [
        asdict(m)
        | {
            "median_s": m.median_s,
            "spread": m.spread,
            "further_step_s": m.further_step_s,
            "cpu_per_growth_s": m.cpu_per_growth_s,
            "remeshing_share": m.remeshing_share,
            "instructions_ratio": instructions_ratio(m, stored),
            "cpu_ratio": m.ratio,
        }
        for m in measurements
    ]


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def _millions(count: int | None) -> str:
    return "-" if count is None else f"{count / 1e6:.1f}"


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


@dataclass(frozen=True)
class Exponent:
    """How CPU time grows over measurements of one kind."""

    of: str  # what is counted
    sizes: tuple[int, ...]
    cpu_s: tuple[float, ...]  # median CPU time [s] of each size
    fitted: float  # slope of its logarithm over that of the size, by least squares
    # CPU(4n)/CPU(n) from each size to the next one, at the slope between the two
    fourfold: tuple[float, ...]


def exponents(kinds: Sequence[Growth], measured: Mapping[str, Measurement]) -> tuple[Exponent, ...]:
    """Fit each kind of which at least two sizes were measured."""
    found = []
    for kind in kinds:
        mine = [measured[name] for name in kind.names if name in measured]
        sizes = tuple(m.typical.sizes[kind.of] for m in mine)
        if len(set(sizes)) >= 2:
            found.append(fit(kind.of, sizes, tuple(m.median_s for m in mine)))
    return tuple(found)


def fit(of: str, sizes: tuple[int, ...], cpu_s: tuple[float, ...]) -> Exponent:
    """Fit a power of the size to CPU times."""
    x, y = [math.log(n) for n in sizes], [math.log(seconds) for seconds in cpu_s]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True)) / sum(
        (a - mean_x) ** 2 for a in x
    )
    between = [
        4.0 ** ((y[k + 1] - y[k]) / (x[k + 1] - x[k])) for k in range(len(x) - 1) if x[k + 1] > x[k]
    ]
    return Exponent(of, sizes, cpu_s, slope, tuple(between))


MOST_INSTRUCTIONS = 1.10  # over the stored count: more is a loss
MOST_CPU = 1.25  # over the CPU time of the other program: more is a loss
_OURS = ("Fortran compiler", "CXX compiler", "build type")  # of what `packages` tells
_LIBRARIES = re.compile(
    r"\s(lib(?:gmsh|dmumps|mumps|metis|pord|scotch|\w*blas|gfortran|stdc|m\.|c\.)\S*) => (/\S+)"
)


@dataclass(frozen=True)
class Baseline:
    """What was stored."""

    made_with: dict[str, str]  # compilers, libraries and the processor that the code was made for
    instructions: dict[str, int]  # by measurement


def made_with(solver: Path) -> dict[str, str]:
    """What the count of a solver's instructions depends on, apart from its own source."""
    build = next((p for p in solver.resolve().parents if (p / "CMakeCache.txt").is_file()), None)
    found: dict[str, str] = {}
    if build is not None:
        known = packages(build)
        found |= {name: known[name] for name in _OURS if name in known}
        cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
        target = re.search(r"^WINGCRACK_PROCESSOR:\w+=(.*)$", cache, flags=re.M)
        found["processor"] = target[1] if target else "unknown"
        if "native" in found["processor"]:
            found["processor"] += f", {machine()['processor']}"
    found["valgrind"] = _said("valgrind", "--version")
    for name, path in _LIBRARIES.findall(_said("ldd", str(solver))):
        digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()[:12]
        found[name] = f"{Path(path).resolve().name} {digest}"
    return found


def read_baseline(path: Path) -> Baseline:
    """Read what was stored; nothing if there is no such file."""
    if not path.exists():
        return Baseline({}, {})
    content = json.loads(path.read_text(encoding="utf-8"))
    return Baseline(content["made_with"], content["instructions"])


def store(path: Path, new: Baseline) -> None:
    """Store counts; others of before stay if they were made with the same."""
    old = read_baseline(path)
    counts = old.instructions if old.made_with == new.made_with else {}
    content = {
        "made_with": new.made_with,
        "instructions": dict(sorted({**counts, **new.instructions}.items())),
    }
    write_whole(path, json.dumps(content, indent=2) + "\n")


def differences(stored: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """Name what the stored counts were made with, and these are not."""
    return [
        f"{name} ({stored.get(name, 'none')} then, {here.get(name, 'none')} here)"
        for name in sorted({*stored, *here})
        if stored.get(name) != here.get(name)
    ]


def _said(*command: str) -> str:
    """Give what a program prints; nothing where it is not there."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return done.stdout.strip()
