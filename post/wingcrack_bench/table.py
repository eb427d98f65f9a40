"""Measurements as a table for people and as JSON for programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from wingcrack_bench.measure import Measurement

_FIRST, _OTHER = 26, 11  # widths of the columns


def as_table(measurements: Sequence[Measurement]) -> str:
    """Give a table with a column per benchmark."""
    lines = [_line("", [m.name for m in measurements])]
    lines.append(_line("CPU time [s]", [_seconds(m.cpu_s) for m in measurements]))
    for phase in measurements[0].phases_s:
        seconds = [m.phases_s.get(phase, 0.0) for m in measurements]
        lines.append(_line(f"  {phase}", [_seconds(value) if value else "-" for value in seconds]))
    lines += [
        _line("accepted states", [str(m.states) for m in measurements]),
        _line("CPU per state [s]", [_seconds(m.cpu_s / m.states) for m in measurements]),
        _line("propagation steps", [str(m.growths) for m in measurements]),
        _line(
            "CPU per propagation [s]",
            [_seconds(m.cpu_per_growth_s) if m.cpu_per_growth_s else "-" for m in measurements],
        ),
        _line("remesh, transfer [%]", [f"{100 * m.remeshing_share:.1f}" for m in measurements]),
        _line("unknowns", [str(m.unknowns) for m in measurements]),
        _line("peak memory [MB]", [f"{m.memory_mb:.0f}" for m in measurements]),
    ]
    counts = [m.instructions for m in measurements]
    if any(count is not None for count in counts):
        texts = ["-" if count is None else f"{count / 1e6:.1f}" for count in counts]
        lines.append(_line("instructions [1e6]", texts))
    return "\n".join(lines)


def as_json(measurements: Sequence[Measurement]) -> list[dict[str, object]]:
    """Give the measurements with what follows from them."""
    return [
        asdict(m) | {"cpu_per_growth_s": m.cpu_per_growth_s, "remeshing_share": m.remeshing_share}
        for m in measurements
    ]


def _line(title: str, cells: Sequence[str]) -> str:
    return f"{title:<{_FIRST}}" + "".join(f"{cell:>{_OTHER}}" for cell in cells)


def _seconds(value: float) -> str:
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"
