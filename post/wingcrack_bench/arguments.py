"""What `wingcrack bench` can be asked for; needs only Python."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from wingcrack_bench.catalogue import TOP, read_benchmarks

BASELINE = TOP / "tools" / "bench_baseline.json"
SOLVER = TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver"

_EPILOG = """\
Measures the CPU time of scenes on one thread: median and spread of several runs, phases, the first
and the further steps, memory, and how cost grows with size; prints tables and writes bench.json.
The measurements are listed in tools/benchmarks.toml.

  --instructions  counts them with valgrind, and compares with what --store has kept in
                  tools/bench_baseline.json: more than 10 % above that is a loss
  --against       runs another build of the solver in turn with this one: a median of CPU times
                  more than 25 % above the other's is a loss
  --quick         the smallest scenes, whose instructions are counted: seconds. CI judges by these,
                  and only where compilers and libraries are those of the stored counts

Exit status: 0 all measured; 1 a run failed, or a loss was found; 2 bad usage; 3 valgrind is not
there.

example:
  ./wingcrack bench
  ./wingcrack bench b4 b6 --repeat 5
  ./wingcrack bench c1 --against /tmp/before/wingcrack-solver
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack bench: {message}; ./wingcrack bench --help says more\n")


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = _parser()
    given = parser.parse_args(arguments)
    known, _ = read_benchmarks()
    for name in given.names:
        if name not in known:
            parser.error(f"there is no measurement '{name}' (there are: {', '.join(known)})")
    if given.out.exists() and not given.out.is_dir():
        parser.error(f"results cannot go to {given.out}, which is a file")
    if given.against is not None and not given.against.is_file():
        parser.error(f"there is no program {given.against} to compare with")
    if given.store and given.against is not None:
        parser.error("--store keeps counts, which --against does not make")
    if given.quick and given.names:
        parser.error("--quick has measurements of its own; leave out the names, or --quick")
    if not given.names:
        given.names = [name for name, entry in known.items() if entry.quick == given.quick]
        if not given.quick:
            given.names += [name for name, entry in known.items() if name == "b1"]
    return given


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="./wingcrack bench",
        description="Measure how long scenes take, and where the time goes.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="which ones (default: all)")
    parser.add_argument(
        "--repeat",
        type=_count,
        default=3,
        metavar="N",
        help="runs of each but the longest; the median counts (3)",
    )
    parser.add_argument("--quick", action="store_true", help="the short form, for CI")
    parser.add_argument("--instructions", action="store_true", help="count instructions too")
    parser.add_argument("--store", action="store_true", help="keep the counts to compare with")
    parser.add_argument(
        "--against", type=Path, metavar="SOLVER", help="another build of the solver to pair with"
    )
    parser.add_argument(
        "--out", type=Path, default=Path("out/bench"), metavar="DIR", help="for bench.json"
    )
    parser.add_argument("--solver", type=Path, default=SOLVER, help=argparse.SUPPRESS)
    parser.add_argument("--baseline", type=Path, default=BASELINE, help=argparse.SUPPRESS)
    return parser


def _count(text: str) -> int:
    if not (text.isdecimal() and int(text) >= 1):
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number from 1")
    return int(text)
