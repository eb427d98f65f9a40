"""Measurements as tables for people and as JSON for programs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from wingcrack_verify.bench.baseline import Baseline
from wingcrack_verify.bench.catalogue import Growth
from wingcrack_verify.bench.measure import Measurement

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
