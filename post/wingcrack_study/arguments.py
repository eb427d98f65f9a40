"""What `wingcrack study` can be asked for; needs nothing but Python."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from wingcrack_post.arguments import add_format

TOP = Path(__file__).resolve().parents[2]
CLUSTERS = ("none", "local", "slurm", "pbs", "ssh")

_EPILOG = """\
Runs a scene many times, as the study's file says (docs/studies.md), and writes table.csv,
table.parquet, statistics.csv, study.json and figures/ into the folder. A call that was ended, even
killed, goes on where it stopped when it is given again: finished runs are not repeated.

Exit status: 0 done; 1 a run failed (the table has all others); 2 bad study, scene or usage
(nothing was run); 3 the environment lacks something; 130 and 143 interrupted: the table has what
was done until then.

example:
  ./wingcrack study inputs/studies/d3_rate.toml --quick
  ./wingcrack study inputs/studies/monte_carlo.toml --jobs 4 --out out/chance
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack study: {message}; ./wingcrack study --help says more\n")


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = _parser()
    given = parser.parse_args(arguments)
    if given.study.is_dir():
        parser.error(f"{given.study} is a folder, not a study's file")
    if not given.study.is_file():
        parser.error(f"there is no study {given.study}")
    if given.out is None:
        name = given.study.stem + ("_quick" if given.quick else "")
        given.out = Path("out") / name
    given.out = given.out.resolve()  # runs are made in folders of their own
    place = next(folder for folder in (given.out, *given.out.parents) if folder.exists())
    if not place.is_dir():
        parser.error(f"results cannot go to {given.out}: {place} is a file")
    return given


def _parser() -> argparse.ArgumentParser:
    cores = len(os.sched_getaffinity(0))
    parser = _Parser(
        prog="./wingcrack study",
        description="Many runs of a scene from one file, with a table of them and figures.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("study", type=Path, metavar="STUDY.toml", help="the study's file")
    parser.add_argument(
        "--jobs",
        type=_count,
        metavar="N",
        help=f"runs at a time, or workers of the cluster (default: the cores at hand, {cores})",
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="where the results go (default: out/STUDY)"
    )
    parser.add_argument(
        "--quick", action="store_true", help="the short form that the study's file tells in [quick]"
    )
    parser.add_argument(
        "--cluster",
        choices=CLUSTERS,
        help="how the runs are spread: none (processes of this call), or by Dask on this machine "
        "(local) or others (default: as the study's file says, else none)",
    )
    add_format(parser)
    parser.add_argument(
        "--check", action="store_true", help="read the study and check all its scenes, run nothing"
    )
    parser.add_argument(
        "--build",
        type=lambda text: Path(text).resolve(),
        default=TOP / "build" / "release",
        metavar="DIR",
        help="where the solver was built",
    )
    return parser


def _count(text: str) -> int:
    if not (text.isdecimal() and 1 <= int(text) <= 1024):
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number from 1 to 1024")
    return int(text)
