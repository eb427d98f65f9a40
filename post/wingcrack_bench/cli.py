"""Command line: ``python -m wingcrack_bench [NAME ...]``."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from wingcrack_bench.measure import (
    EnvironmentLacksError,
    Measurement,
    RunFailedError,
    measure,
    read_benchmarks,
)
from wingcrack_bench.table import as_json, as_table
from wingcrack_verify.environment import machine, revision

TOP = Path(__file__).resolve().parents[2]

_EPILOG = """\
Measures the CPU time of scenes, by phase and by step of propagation, on one thread; prints a table
and writes bench.json. The measurements are listed in tools/benchmarks.txt.

Exit status: 0 all measured; 1 a run failed; 2 bad usage; 3 valgrind is not there.

example:
  ./wingcrack bench
  ./wingcrack bench b4 b6 --repeat 5
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack bench: {message}\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status."""
    parser = _parser()
    given = parser.parse_args(arguments)
    known = read_benchmarks(TOP / "tools" / "benchmarks.txt", TOP)
    for name in given.names:
        if name not in known:
            parser.error(f"there is no measurement {name}; there are {', '.join(known)}")
    if given.repeat < 1:
        parser.error(f"--repeat needs a whole number from 1, not {given.repeat}")
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


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="./wingcrack bench",
        description="Measure how long scenes take, and where the time goes.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="which ones (default: all)")
    parser.add_argument(
        "--repeat", type=int, default=3, metavar="N", help="runs of each; the fastest counts (3)"
    )
    parser.add_argument(
        "--instructions", action="store_true", help="count instructions too, if valgrind is there"
    )
    parser.add_argument(
        "--out", type=Path, default=Path("out/bench"), metavar="DIR", help="for bench.json"
    )
    parser.add_argument(
        "--solver",
        type=Path,
        default=TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver",
        help=argparse.SUPPRESS,
    )
    return parser
