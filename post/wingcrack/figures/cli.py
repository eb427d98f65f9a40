"""`wingcrack plot`: the figures of runs."""

from __future__ import annotations

import gc
import logging
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

from wingcrack.errors import RunError

if TYPE_CHECKING:
    from wingcrack.figures.catalogue import Outcome


def plot(given: SimpleNamespace) -> int:
    """Draw what is asked for; give the exit status: 0 done, 2 bad input, 3 lacking library."""
    status = 0
    for directory in given.directories:
        status = max(status, _plot(directory, given))
    return status


def _plot(directory: Path, given: SimpleNamespace) -> int:
    """Draw the chosen figures of one run and return its exit status."""
    # late, so that --help and mistakes in the call answer at once
    from wingcrack.figures.catalogue import draw_figures

    # what matplotlib says about fonts that this machine lacks helps nobody: it takes another
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    left_out: list[Outcome] = []
    drawn = False
    try:
        gc.disable()  # a tenth of the time; `draw_figures` tidies up where there are many
        for outcome in draw_figures(directory, given.only, given.format, given.times, given.style):
            drawn = drawn or bool(outcome.files)
            if outcome.reason:
                left_out.append(outcome)
            if not given.quiet:
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
        print(f"{file} (unchanged)" if outcome.unchanged else file, flush=True)
    if outcome.reason and not outcome.lacking:
        print(f"{outcome.name}: left out: {outcome.reason}.", flush=True)
