"""What `wingcrack view` can be asked for; needs nothing but Python."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

_EPILOG = """\
The page shows a field of the rock in every written state, the fractures by state, the wells, and
the history beside them. While a run goes on, new states appear by themselves. Only this machine
reaches the page, and it asks no other. Ctrl-C ends it.

example:
  ./wingcrack view out/onset
  ./wingcrack view out/onset --port 8040 --no-browser    # then: ssh -L 8040:localhost:8040 HOST
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack view: {message}; ./wingcrack view --help says more\n")


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = _Parser(
        prog="./wingcrack view",
        description="Show a finished or running run in the browser.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("directory", metavar="DIR", type=Path, help="output directory of a run")
    parser.add_argument(
        "--port", type=_port, default=0, metavar="N", help="port of the page (default: a free one)"
    )
    parser.add_argument(
        "--no-browser", action="store_true", help="only print the address, open no browser"
    )
    given = parser.parse_args(arguments)
    if not given.directory.is_dir():
        parser.error(f"there is no directory {given.directory}")
    return given


def _port(text: str) -> int:
    if not (text.isascii() and text.isdecimal() and 1 <= int(text) <= 65535):
        raise argparse.ArgumentTypeError(f"'{text}' is no port, a whole number from 1 to 65535")
    return int(text)
