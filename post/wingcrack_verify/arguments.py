"""What `wingcrack verify` can be asked for; needs nothing but Python."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

TOP = Path(__file__).resolve().parents[2]

_EPILOG = """\
Runs the verification cases, measures their errors and writes verification/report/ with index.html,
report.json and, where Chromium or Chrome is installed, report.pdf. What has not changed since an
earlier call is not run again.

Exit status: 0 all passed or known gaps; 1 a case failed or is in error; 2 bad usage; 3 not built.

example:
  ./wingcrack verify --quick
  ./wingcrack verify onset_c1 stability
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack verify: {message}; ./wingcrack verify --help says more\n")


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = _parser()
    given = parser.parse_args(arguments)
    there = case_folders(given.cases)
    for name in given.names:
        if name not in there:
            known = ", ".join(sorted(there)) or "none"
            parser.error(f"there is no case '{name}' (there are: {known})")
    if given.report.exists() and not given.report.is_dir():
        parser.error(f"the report cannot go to {given.report}, which is a file")
    return given


def case_folders(top: Path) -> dict[str, Path]:
    """Folders of the cases by name."""
    return {
        path.parent.name: path.parent
        for pattern in ("*/check.toml", "*/stability.toml")
        for path in sorted(top.glob(pattern))
    }


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="./wingcrack verify",
        description="Verification cases: errors, orders, run times, stability.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("names", nargs="*", metavar="CASE", help="folders of verification/")
    parser.add_argument("--quick", action="store_true", help="only the quick cases")
    parser.add_argument("--jobs", type=_count, default=2, metavar="N", help="runs at a time (2)")
    for name, path, text in (
        ("--cases", TOP / "verification", "where the cases are"),
        ("--build", TOP / "build" / "release", "where the solver was built"),
        ("--cache", TOP / "build" / "verification", "where the files of the runs are kept"),
        ("--report", TOP / "verification" / "report", "where the report goes"),
    ):
        parser.add_argument(name, type=_folder, default=path, metavar="DIR", help=text)
    return parser


def _folder(text: str) -> Path:
    return Path(text).resolve()  # programs are run in folders of their own


def _count(text: str) -> int:
    if not (text.isdecimal() and 1 <= int(text) <= 64):
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number from 1 to 64")
    return int(text)
