"""Command line: ``python -m wingcrack_post plot DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from wingcrack_post.errors import RunError

if TYPE_CHECKING:
    from wingcrack_post.figures import Outcome

GROUPS = ("network", "maps", "fractures", "tips", "probes", "view")
FORMATS = ("png", "pdf")

_EPILOG = """\
groups of figures (--only), written to DIR/figures:
  network    the fractures at the start and what has grown, coloured by its order
  maps       pore pressure, or without a fluid stress, at several times, with the contact states
  fractures  opening, slip, aperture, pressure and tractions along each fracture
  tips       stress intensities; load and growth; length, well pressure, states; fluid balance
  probes     pressure, displacement and stress at the probe points
  view       the deformed body, drawn by pyvista (PNG only)

example:
  wingcrack plot out/wing_crack --times 0.5h,20h,40h --only maps,fractures
"""


@dataclass(frozen=True)
class _Choices:
    times_s: tuple[float, ...]
    only: tuple[str, ...]
    formats: tuple[str, ...]
    quiet: bool


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help.\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status: 0 done, 2 bad input, 3 lacking library."""
    parser = _parser()
    given = parser.parse_args(arguments)
    choices = _Choices(given.times, given.only, given.format, given.quiet)
    status = 0
    for directory in given.directories:
        status = max(status, _plot(directory, choices))
    return status


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
        prog="wingcrack plot",
        help="draw the figures of finished or running runs",
        description="Draw the figures of finished or running runs into DIR/figures.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
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
        " written times are drawn (default: the first, the start of growth, equally spaced"
        " fracture lengths, the last)",
    )
    plot.add_argument(
        "--only",
        type=_one_of(GROUPS),
        default=GROUPS,
        metavar="GROUP,...",
        help=f"draw only these groups: {', '.join(GROUPS)}",
    )
    plot.add_argument(
        "--format",
        type=_one_of(FORMATS),
        default=FORMATS,
        metavar="FORMAT,...",
        help="png, pdf (default: both)",
    )
    plot.add_argument("--quiet", action="store_true", help="print nothing but errors")
    return parser


def _times(text: str) -> tuple[float, ...]:
    from wingcrack_post.times import parse_times

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


def _plot(directory: Path, choices: _Choices) -> int:
    """Draw the chosen figures of one run and return its exit status."""
    # late, so that --help and mistakes in the call answer at once
    from wingcrack_post.figures import draw_figures
    from wingcrack_post.read import read_run

    left_out: list[Outcome] = []
    drawn = False
    try:
        run = read_run(directory)
        for outcome in draw_figures(run, choices.only, choices.formats, choices.times_s):
            drawn = drawn or bool(outcome.files)
            if outcome.reason:
                left_out.append(outcome)
            if not choices.quiet:
                _report(outcome)
    except RunError as reason:
        print(f"wingcrack plot: {reason}", file=sys.stderr)
        return 2
    if drawn:
        for outcome in left_out:
            if outcome.lacking:
                print(f"{outcome.name}: left out: {outcome.reason}.", file=sys.stderr)
        return 0
    reasons = "; ".join(dict.fromkeys(outcome.reason for outcome in left_out))
    print(f"wingcrack plot: {directory}: nothing was drawn: {reasons}.", file=sys.stderr)
    return 3 if any(outcome.lacking for outcome in left_out) else 2


def _report(outcome: Outcome) -> None:
    for file in outcome.files:
        print(file, flush=True)
    if outcome.reason and not outcome.lacking:
        print(f"{outcome.name}: left out: {outcome.reason}.", flush=True)
