"""The solver as these packages ask it what it thinks of a scene."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from wingcrack.errors import EnvironmentLacksError

SOLVER = (
    Path(__file__).resolve().parents[3] / "build" / "release" / "fortran" / "app"
) / "wingcrack-solver"


def call(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the solver to its end.

    Raises `EnvironmentLacksError` if it is not there or cannot be started.
    """
    threads = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    try:
        return subprocess.run(
            [SOLVER, *arguments],
            env={**os.environ, **threads},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
        )
    except OSError as reason:
        raise EnvironmentLacksError(
            f"the solver {SOLVER} cannot be started ({reason.strerror}); ./wingcrack build makes it"
        ) from None


def check(scene: Path) -> tuple[bool, str]:
    """Let the solver judge a scene file.

    Returns
    -------
    bool, str
        Whether it is good; the solver's description of it, or the sentence that refuses it.
    """
    done = call("check", scene)
    if done.returncode == 0:
        return True, done.stdout
    words = done.stderr.strip().splitlines()
    return False, words[-1].removeprefix("wingcrack: ") if words else "the solver gave no reason"
