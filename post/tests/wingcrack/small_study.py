"""A small study with a stand-in for the solver, for tests to break in one place."""

from __future__ import annotations

import csv
import io
import os
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

from wingcrack.command_line import main

POST = Path(__file__).resolve().parents[2]

# The stand-in knows p = 1e15 rate*time, and takes its orders from a scene's title.
_SOLVER = r"""#!/bin/bash
value() { sed -n "s/^ *$1 = *'\{0,1\}\([^'!]*\)'\{0,1\} *$/\1/p" "$scene" | tail -n 1; }
scene=$2
rate=$(value rate)
title=$(value title)
if [[ $1 == check ]]; then
    for scene in "${@:2}"; do
        if grep -q 'rote' "$scene"; then
            echo 'wingcrack: scene.nml, line 7: rote is unknown; did you mean rate?' >&2
            exit 2
        fi
        if [[ $(value title) == refuse ]]; then
            echo "wingcrack: rate $(value rate) is too much" >&2
            exit 2
        fi
    done
    exit 0
fi
echo "$rate $title" >>@CALLS@
case $title in
    fail)
        echo 'wingcrack: no convergence' >&2
        echo 'wingcrack: the step is too small' >&2
        exit 1
        ;;
    slow) sleep 0.4 ;;
    hang) sleep 600 ;;
esac
{
    echo time_s,well_pressure_pa
    awk -v rate="$rate" 'BEGIN { for (t = 0; t <= 4; t++) printf "%d,%.17g\n", t, 1e15*rate*t }'
} >history.csv
echo kind,time_s >events.csv
if [[ $title != quiet ]]; then echo growth,2.5 >>events.csv; fi
echo '{"status": "finished", "cpu_s": 0.01, "steps": 4}' >run.json
"""

_SCENE = """\
&scene name = 'small', title = 'plain' /
&fracture name = 'f1', friction = 0.5, x = 0.0, 1.0 /
&injection fracture = 'f1', rate = 1.0e-9 /
&fluid viscosity = 1.0e-3 /
"""

HEAD = """\
title = "Small"
scene = "scene.nml"
"""

OVER = """\
[over]
"injection.rate" = [1.0e-9, 2.0e-9, 4.0e-9]
"""

PRESSURE = """\
[[quantity]]
name = "pressure"
unit = "MPa"
file = "history.csv"
column = "well_pressure_pa/1e6"
take = "max"
"""

ONSET = """\
[[quantity]]
name = "onset"
unit = "s"
file = "events.csv"
column = "time_s"
where = { kind = "growth" }
take = "first"
"""

LINES = """\
[[figure]]
name = "pressure"
kind = "lines"
file = "history.csv"
x = "time_s"
column = "well_pressure_pa"
x_label = "time [s]"
y_label = "pressure [Pa]"
"""

SOUND = HEAD + OVER + PRESSURE + ONSET
DRAWN = SOUND + LINES  # a figure costs as much as all the rest


@dataclass
class SmallStudy:
    """Folder with a study, its scene and a solver that only pretends."""

    folder: Path

    @property
    def out(self) -> Path:
        """Where the results go."""
        return self.folder / "out"

    @property
    def file(self) -> Path:
        """The study's file."""
        return self.folder / "study.toml"

    @property
    def calls(self) -> list[str]:
        """Rate and title of every run so far."""
        file = self.folder / "calls"
        return file.read_text().splitlines() if file.exists() else []

    @property
    def rows(self) -> list[dict[str, str]]:
        """The table."""
        with (self.out / "table.csv").open(newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def write(self, text: str) -> None:
        """Write the study's file."""
        self.file.write_text(text, encoding="utf-8")

    def words(self, *arguments: str) -> list[str]:
        """Words of a call."""
        words = ["study", str(self.file), "--out", str(self.out)]
        return [*words, "--build", str(self.folder / "build"), *arguments]

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        """Start a call."""
        return subprocess.Popen(
            [sys.executable, "-m", "wingcrack", *self.words(*arguments)],
            env=os.environ | {"PYTHONPATH": str(POST)},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def call(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Call to its end."""
        return call_here(self.words(*arguments))


def call_here(words: list[str]) -> subprocess.CompletedProcess[str]:
    """Do what the words ask for in this process: a new one takes half a second to begin."""
    with redirect_stdout(io.StringIO()) as said, redirect_stderr(io.StringIO()) as error:
        try:
            status = main(words)
        except SystemExit as ended:
            status = int(ended.code or 0)
    return subprocess.CompletedProcess(words, status, said.getvalue(), error.getvalue())


def small_study(folder: Path, text: str = SOUND) -> SmallStudy:
    """Write a study, its scene and the stand-in."""
    solver = folder / "build" / "fortran" / "app" / "wingcrack-solver"
    solver.parent.mkdir(parents=True)
    solver.write_text(_SOLVER.replace("@CALLS@", str(folder / "calls")))
    solver.chmod(0o755)
    (folder / "scene.nml").write_text(_SCENE)
    made = SmallStudy(folder)
    made.write(text)
    return made


def wait_for(holds: Callable[[], bool], limit_s: float = 60.0) -> None:
    """Wait until something holds, and fail if it never does."""
    deadline = time.monotonic() + limit_s
    while not holds():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.02)
