"""Whether stated errors hold: over all judged runs, not in each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from wingcrack.sweeps.expressions import Array
from wingcrack.sweeps.fields import Entry, Positive


class Held(Entry):
    """Share of the values within the tolerance, and median of tolerance over error."""

    share: Annotated[float, Field(gt=0.0, le=1.0)]
    factor: Positive


@dataclass(frozen=True)
class Holding:
    """How many values are within the tolerance, and by how much in the median."""

    good: bool
    reason: str


def holding(wanted: Held, tolerance: float, errors: Sequence[Array]) -> Holding:
    """Judge the errors of all values of all judged runs, in the unit of the tolerance.

    Values without an error count as held; they have no factor.
    """
    values = np.concatenate([np.abs(item) for item in errors]) if errors else np.zeros(0)
    if values.size == 0:
        return Holding(False, "no value to judge")
    held = int(np.count_nonzero(values <= tolerance))
    share = held / values.size
    wrong = values[values > 0.0]
    factor = float(np.median(tolerance / wrong)) if wrong.size else 1.0
    text = f"{held} of {values.size} hold ({100 * share:.3g} %), median factor {factor:.2g}"
    good = share >= wanted.share and factor <= wanted.factor
    return Holding(good, text)
