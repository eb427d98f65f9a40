"""What `wingcrack bench` can be asked for, and the list of its measurements; needs only Python."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

TOP = Path(__file__).resolve().parents[2]

_EPILOG = """\
Measures the CPU time of scenes, by phase and by step of propagation, on one thread; prints a table
and writes bench.json. The measurements are listed in tools/benchmarks.txt.

Exit status: 0 all measured; 1 a run failed; 2 bad usage; 3 valgrind is not there.

example:
  ./wingcrack bench
  ./wingcrack bench b4 b6 --repeat 5
"""


@dataclass(frozen=True)
class Benchmark:
    """A scene that is measured."""

    name: str
    scene: Path
    title: str


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack bench: {message}; ./wingcrack bench --help says more\n")


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = _parser()
    given = parser.parse_args(arguments)
    known = read_benchmarks()
    for name in given.names:
        if name not in known:
            parser.error(f"there is no measurement '{name}' (there are: {', '.join(known)})")
    if given.out.exists() and not given.out.is_dir():
        parser.error(f"results cannot go to {given.out}, which is a file")
    return given


def read_benchmarks() -> dict[str, Benchmark]:
    """Read the list of the benchmarks."""
    found = {}
    for line in (TOP / "tools" / "benchmarks.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            name, scene, title = (part.strip() for part in line.split("|"))
            found[name] = Benchmark(name, TOP / scene, title)
    return found


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
        "--repeat", type=_count, default=3, metavar="N", help="runs of each; the fastest counts (3)"
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


def _count(text: str) -> int:
    if not (text.isdecimal() and int(text) >= 1):
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number from 1")
    return int(text)
