"""Errors of the package; each message is one sentence for the user."""

from __future__ import annotations

from pathlib import Path

from wingcrack.figures.errors import AbsentError, EnvironmentLacksError, RunError

__all__ = ["AbsentError", "EnvironmentLacksError", "RunError", "RunFailedError", "SceneError"]


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
