"""Errors of the package; each message is one sentence for the user."""

from __future__ import annotations

from pathlib import Path


class RunError(Exception):
    """The files of the run are missing, damaged or not what the contract says."""


class AbsentError(Exception):
    """A sound run that simply does not hold what a figure needs, such as pressure or tips."""


class EnvironmentLacksError(Exception):
    """The machine lacks something that is needed: a library, the solver, another program."""


class CaseError(Exception):
    """A case is wrong in itself: a key, metric, column or row that is not there, a NaN."""


class SceneError(Exception):
    """The solver refuses the scene, or an address in it leads nowhere."""


class RunFailedError(Exception):
    """The solver started and did not reach the scene's end.

    Parameters
    ----------
    reason : str
        What the solver said last.
    directory : Path
        Where the last good state is, for `wingcrack.open`.
    status : int
        Exit status of the solver: 1 failed, 130 and 143 interrupted.
    """

    def __init__(self, reason: str, directory: Path, status: int) -> None:
        super().__init__(reason)
        self.directory = directory
        self.status = status
