"""What `wingcrack new` can be asked for; needs nothing but Python."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

KINDS = {
    "injection": "fluid into one fracture, which slips; stress intensity factors",
    "network": "fluid into fractures that cross and touch",
    "wells": "two wells in stages, up to pressures, in fractured rock",
    "mechanics": "no fluid: a crack grows under tension",
    "column": "no fractures: consolidation of a column",
}

_EPILOG = (
    "kinds:\n"
    + "".join(f"  {kind:<11}{words}\n" for kind, words in KINDS.items())
    + """
The file is a whole scene with a comment on every name; it runs in seconds as it is.

example:
  ./wingcrack new network --out /tmp/mine.nml
  ./wingcrack run /tmp/mine.nml --out /tmp/mine
"""
)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack new: {message}; ./wingcrack new --help says more\n")


def judge_name(parser: argparse.ArgumentParser, out: Path) -> None:
    """Refuse a scene file by whose name the scene could not be called."""
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}", out.stem):
        parser.error(
            f"the scene is called as its file, so {out.name} may have letters, digits, '_', '-' and"
            " '.' only, at most 64, and begins with a letter or a digit"
        )


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = argparse.ArgumentParser(prog="wingcrack_scenes")
    commands = parser.add_subparsers(required=True, dest="command", parser_class=_Parser)
    new = commands.add_parser(
        "new",
        prog="./wingcrack new",
        description="Write a commented scene to start from.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    new.add_argument(
        "kind", metavar="KIND", nargs="?", default="injection", help="default: injection"
    )
    new.add_argument(
        "--out", type=Path, metavar="FILE", help="the file to write (default: KIND.nml)"
    )
    new.add_argument("--overwrite", action="store_true", help="replace a file that is there")
    given = parser.parse_args(arguments)
    _judge(new, given)
    return given


def _judge(parser: _Parser, given: argparse.Namespace) -> None:
    if given.kind not in KINDS:
        parser.error(f"there is no kind '{given.kind}' (there are: {', '.join(KINDS)})")
    if given.out is None:
        given.out = Path(f"{given.kind}.nml")
    if given.out.suffix != ".nml":
        parser.error(f"--out must end in .nml, unlike {given.out}")
    judge_name(parser, given.out)
    if given.out.is_dir() or not given.out.parent.is_dir():
        parser.error(f"the scene cannot go to {given.out}: there is no such folder, or it is one")
    if given.out.exists() and not given.overwrite:
        parser.error(f"{given.out} is there already; --overwrite replaces it")
