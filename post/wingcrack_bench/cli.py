"""Command line: ``python -m wingcrack_bench [NAME ...]``."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path

from wingcrack_bench.arguments import TOP, parse, read_benchmarks
from wingcrack_bench.measure import (
    EnvironmentLacksError,
    Measurement,
    RunFailedError,
    measure,
)
from wingcrack_bench.table import as_json, as_table
from wingcrack_verify.environment import machine, revision


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status."""
    given = parse(arguments)
    known = read_benchmarks()
    try:
        measured = []
        for name in given.names or known:
            print(f"measuring {name}: {known[name].title}", file=sys.stderr)
            measured.append(measure(known[name], given.solver, given.repeat, given.instructions))
    except (RunFailedError, EnvironmentLacksError) as reason:
        print(f"wingcrack bench: {reason}", file=sys.stderr)
        return 3 if isinstance(reason, EnvironmentLacksError) else 1
    except KeyboardInterrupt:
        print("wingcrack bench: interrupted; nothing was written", file=sys.stderr)
        return 130
    _tell(measured, given.out)
    return 0


def _tell(measured: Sequence[Measurement], out: Path) -> None:
    print(as_table(measured))
    for measurement in measured:
        if measurement.why_not_counted:
            print(f"{measurement.name}: no instructions: {measurement.why_not_counted}")
    out.mkdir(parents=True, exist_ok=True)
    record = {"revision": revision(TOP), "machine": machine(), "measurements": as_json(measured)}
    part = out / "bench.json.part"
    part.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    part.replace(out / "bench.json")
