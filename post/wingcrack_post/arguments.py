"""What `wingcrack plot` can be asked for; needs nothing but Python."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from wingcrack_post.durations import parse_times

GROUPS = (
    "summary",
    "story",
    "network",
    "maps",
    "fractures",
    "tips",
    "wells",
    "probes",
    "view",
)
ALL = "all"
FORMATS = ("png", "pdf")
DEFAULT_FORMATS = ("png",)

_EPILOG = """\
Without --only, the figures in which something happens are drawn, and those that were drawn before:
network and stress intensities where tips grow, maps, profiles, lengths and states where a fracture
slips or opens, wells where there are several or stages; balance and view only on request.

groups of figures (--only), written to DIR/figures:
  summary    any run on one page: body and loads, network by state, pressure or load, length,
             K_eq over K_IC, errors, warnings; and index.html, which shows all figures
  story      an injection on one page: the network with its slip events, well pressure,
             injectivity, where the fluid is, lengths, seismic moment
  network    the fractures at the start and what has grown, coloured by its order
  maps       pore pressure, or without a fluid stress, in up to six states, with the contact states
  fractures  opening, slip, aperture, pressure and tractions along each fracture; of more than 12
             those with a well, that grow, that are longest, unless --only names this group
  tips       stress intensities; load and growth; length, well pressure, states; fluid balance
  wells      pressures, flow, volume and injectivity of each well
  probes     pressure, displacement and stress at the probe points
  view       the deformed body, its displacements drawn larger than they are

A figure whose files are there and would come out the same is not drawn again.

example:
  ./wingcrack plot out/wing_crack --times 0.5h,20h,40h --only maps,fractures
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"wingcrack plot: {message}; ./wingcrack plot --help says more\n")


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = _parser()
    given = parser.parse_args(arguments)
    for directory in given.directories:
        if not directory.is_dir():
            parser.error(f"there is no directory {directory}")
    return given


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="wingcrack_post",
        description="Figures of wingcrack runs.",
        epilog="example:\n  python -m wingcrack_post plot out/wing_crack\n",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(required=True, metavar="plot", title="command")
    plot = commands.add_parser(
        "plot",
        prog="./wingcrack plot",
        help="draw the figures of finished or running runs",
        description="Draw the figures of finished or running runs into DIR/figures.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    plot.add_argument(
        "directories", metavar="DIR", nargs="+", type=Path, help="output directory of a run"
    )
    plot.add_argument(
        "--times",
        type=_times,
        default=(),
        metavar="T,...",
        help="times of maps and profiles: seconds, or with the unit s, min, h or d; the nearest"
        " written times are drawn (default: the first, the start of growth, the highest"
        " well pressure, equally spaced fracture lengths, the last; no short steps after growth)",
    )
    plot.add_argument(
        "--only",
        type=_one_of((*GROUPS, ALL)),
        default=(),
        metavar="GROUP,...",
        help=f"draw these groups: {', '.join(GROUPS)}, or {ALL}",
    )
    add_format(plot)
    plot.add_argument("--quiet", action="store_true", help="print nothing but errors")
    return parser


def add_format(parser: argparse.ArgumentParser) -> None:
    """Let a command that draws be asked for formats."""
    parser.add_argument(
        "--format",
        type=_one_of(FORMATS),
        default=DEFAULT_FORMATS,
        metavar="FORMAT,...",
        help="of the figures: png, pdf, or png,pdf (default: png)",
    )


def _times(text: str) -> tuple[float, ...]:
    try:
        return parse_times(text)
    except ValueError as reason:
        raise argparse.ArgumentTypeError(str(reason)) from None


def _one_of(names: tuple[str, ...]) -> Callable[[str], tuple[str, ...]]:
    def parse(text: str) -> tuple[str, ...]:
        chosen = tuple(part.strip() for part in text.split(","))
        for part in chosen:
            if part not in names:
                raise argparse.ArgumentTypeError(f"'{part}' is none of {', '.join(names)}")
        return chosen

    return parse
