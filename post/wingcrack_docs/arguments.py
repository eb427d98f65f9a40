"""What `wingcrack docs` can be asked for; needs nothing but Python."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

_EPILOG = """\
The site is in build/site; it asks no other machine for anything. Pages of the Fortran modules are
made by FORD, and made again only when a module has changed.

--pictures runs the scenes of inputs/ and those of the tutorial (minutes; what has run is not run
again) and writes docs/gallery.md and docs/pictures, which are kept with the sources.

example:
  ./wingcrack docs --serve --no-fortran
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack docs: {message}; ./wingcrack docs --help says more\n")


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = _Parser(
        prog="./wingcrack docs",
        description="Build the documentation as a site.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "--serve", action="store_true", help="show it to this machine's browsers until ctrl-C"
    )
    parser.add_argument(
        "--port", type=_port, default=8000, metavar="N", help="of --serve (default: 8000)"
    )
    parser.add_argument("--no-fortran", action="store_true", help="without the Fortran modules")
    parser.add_argument(
        "--pictures", action="store_true", help="make gallery and pictures anew, no site"
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="where the site goes (default: build/site)"
    )
    given = parser.parse_args(arguments)
    if given.pictures and (given.serve or given.out):
        parser.error("--pictures writes into docs/, so --serve and --out do not go with it")
    if given.out is not None and given.out.exists() and not given.out.is_dir():
        parser.error(f"the site cannot go to {given.out}: it is no folder")
    return given


def _port(text: str) -> int:
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"'{text}' is no number from 1 to 65535")
    return int(text)
