"""Coulomb contact with dilation at the collocation points: the states, and when they change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .elastic import Numbers

OPEN, STICK, SLIP = 0, 1, 2


@dataclass
class Contact:
    """States of points, each with the slip it had at the last accepted time."""

    state: npt.NDArray[np.int_]
    sign: Numbers  # of the slip increment, where a point slips
    slip: Numbers  # at the last accepted time [m]

    def moved(self, old: Numbers, new: Numbers) -> Contact:
        """The same for points at other places along the crack; beyond the old end all is open."""
        nearest = np.abs(new[:, None] - old[None, :]).argmin(axis=1)
        fresh = new > old[-1] + (old[-1] - old[-2])
        return Contact(
            np.where(fresh, OPEN, self.state[nearest]),
            np.where(fresh, 1.0, self.sign[nearest]),
            np.where(fresh, 0.0, np.interp(new, old, self.slip)),
        )

    def updated(
        self,
        opening: Numbers,
        slip: Numbers,
        normal: Numbers,
        shear: Numbers,
        friction: float,
        dilation: float,
    ) -> Contact:
        """States that the jumps and contact tractions of a trial ask for."""
        scale = max(float(np.abs(normal).max()), 1.0)
        length = max(float(np.abs(slip).max()), 1e-12)
        state, sign = self.state.copy(), self.sign.copy()
        for point in range(state.size):
            advance = slip[point] - self.slip[point]
            if self.state[point] == OPEN:
                if opening[point] - dilation * abs(slip[point]) < -1e-9 * length:
                    state[point] = SLIP
                    sign[point] = 1.0 if advance >= 0.0 else -1.0
            elif normal[point] > 1e-9 * scale:
                state[point] = OPEN
            elif self.state[point] == SLIP:
                if advance * sign[point] < -1e-9 * length:
                    state[point] = STICK
            elif abs(shear[point]) > -friction * normal[point] + 1e-9 * scale:
                state[point] = SLIP
                sign[point] = np.sign(shear[point])
        return Contact(state, sign, self.slip)
