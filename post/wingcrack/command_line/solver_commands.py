"""Commands of the solver: run and check."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

from wingcrack.command_line.declaring import Parameter, RefusedError, UsageError, command, flag
from wingcrack.command_line.values import place, whole

_SCENE = Parameter("scene", "SCENE.nml", read=place)


@command(
    "run",
    "wingcrack.solving:run",
    _SCENE,
    Parameter("--out", "DIR", "for the results (default: out/NAME of the scene)", place),
    Parameter("--threads", "N", "for windows side by side and loops (1)", whole(1, 9999), 1),
    Parameter(
        "--ranks",
        "N",
        "processes that share the matrices of a large body with a fluid, from 10,000 cells on (1);"
        " the first call with more than one installs MPI, MUMPS for it and builds a second program"
        " (docs/scale.md)",
        whole(1, 9999),
        1,
    ),
    flag("--quiet", "no progress on the terminal"),
    flag("--no-plot", "no figures"),
    statuses="""\
0 done; 1 the run failed (the reason is the last line on stderr and in run.json);
2 bad input or usage (nothing is written); 3 the environment lacks something; 130 and 143
interrupted by SIGINT and SIGTERM (the last good state is on disk).""",
    example="./wingcrack run inputs/paper_c/onset.nml --out /tmp/onset --no-plot\n",
)
def run(given: SimpleNamespace) -> None:
    """Run a scene and draw its figures."""
    if given.out == "":
        raise UsageError("--out needs a value")
    _judge_scene(given)
    if given.out is not None:
        judge_place(given.out)


@command(
    "check",
    "wingcrack.solving:check",
    _SCENE,
    about="Prints what the scene has, what it leaves out and its estimated size. Writes nothing.\n",
    statuses="0 good; 1 the words cannot be written; 2 the scene is refused, or bad usage.",
    example="./wingcrack check inputs/paper_c/onset.nml\n",
)
def check(given: SimpleNamespace) -> None:
    """Read and validate a scene without running it."""
    _judge_scene(given)


def _judge_scene(given: SimpleNamespace) -> None:
    name, scene = given.scene, Path(given.scene or "")
    if not name:
        raise RefusedError(
            f"{given.command} needs a scene file, as in ./wingcrack {given.command}"
            " inputs/paper_c/onset.nml"
        )
    if scene.is_dir():
        raise RefusedError(f"{name} is a folder, not a scene file")
    if not scene.exists():
        raise RefusedError(f"there is no scene file {name}")
    if not scene.is_file():
        raise RefusedError(f"{name} is a pipe or a device, not a scene file")
    if not os.access(scene, os.R_OK):
        raise RefusedError(f"the scene file {name} cannot be read")


def judge_place(out: str) -> None:
    """Refuse results where a file is in the way."""
    place = next((place for place in (Path(out), *Path(out).parents) if place.exists()), None)
    if place is not None and not place.is_dir():
        raise RefusedError(f"results cannot go to {out}: {place} is a file")
