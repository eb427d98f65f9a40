"""The pyvista view of a run, drawn by a child process.

VTK ends the whole process where it finds no OpenGL. With the picture made in a child, a machine
without OpenGL lacks the view and not the other figures.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from wingcrack_post.errors import AbsentError, EnvironmentLacksError, RunError
from wingcrack_post.fields import nearest
from wingcrack_post.read import Run
from wingcrack_post.states import last_settled

SECONDS_ALLOWED = 300
BAD_INPUT, LACKING = 2, 3  # exit status of the child, as the command line's own
_UNEXPECTED = 1  # what Python gives for an exception that nobody catches


def draw_view(run: Run, target: Path, time_s: float | None = None) -> Path:
    """Draw the body at the written time nearest to `time_s` into `target`.

    Without a time it is the last written one that is in no short step after growth.

    Raises
    ------
    AbsentError
        If the run wrote no VTU files.
    EnvironmentLacksError
        If there is no OpenGL here.
    RunError
        If a VTU file is damaged.
    """
    if not run.matrix:
        raise AbsentError("the run has no matrix.pvd (VTU output off, or no step written yet)")
    target.parent.mkdir(parents=True, exist_ok=True)
    aside = target.with_name(f".{target.stem}.{os.getpid()}.png")
    if time_s is None:
        written = [snapshot.time_s for snapshot in run.matrix]
        place = last_settled(run, written, [snapshot.row for snapshot in run.matrix])
    else:
        place = run.matrix.index(nearest(run.matrix, time_s))
    try:
        done = _call_child(run.directory, aside, place)
        said = (done.stderr.strip().splitlines() or ["it gave no reason"])[-1]
        if done.returncode == BAD_INPUT:
            raise RunError(said)
        if done.returncode in (LACKING, _UNEXPECTED):
            raise EnvironmentLacksError(f"the view could not be drawn ({said})")
        if done.returncode != 0 or not aside.is_file():
            raise EnvironmentLacksError(
                "no OpenGL was found for the view; the package libegl1 (or libosmesa6) gives it"
            )
        aside.replace(target)
    except subprocess.TimeoutExpired:
        raise EnvironmentLacksError(
            f"the view was given up after {SECONDS_ALLOWED} s of rendering"
        ) from None
    finally:
        aside.unlink(missing_ok=True)
    return target


def _call_child(directory: Path, aside: Path, place: int) -> subprocess.CompletedProcess[str]:
    package_root = str(Path(__file__).resolve().parents[1])
    paths = [package_root, *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {
        # EGL needs no display; left to itself VTK first tries X, and warns
        "VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow",
        **os.environ,
        "PYTHONPATH": os.pathsep.join(paths),
    }
    # -P: no module comes from the folder where the user happens to be
    command = [sys.executable, "-P", "-m", "wingcrack_post.render"]
    return subprocess.run(
        [*command, str(directory), str(aside), str(place)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=SECONDS_ALLOWED,
        check=False,
    )
