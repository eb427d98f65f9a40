"""A small scene for tests of the whole program, and calls of the launcher that runs it."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
SOLVER = TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver"

# Scene C1 of Paper C (Dang 2023) on some 450 cells, with steps of one hour: a fracture 0.1 m long
# at 45 degrees in a body of 2 m x 2 m under 20 MPa and 10 MPa.
SCENE = """\
&domain x_min = 0.0, x_max = 2.0, y_min = 0.0, y_max = 2.0 /
&material
  young = 40.0e9, poisson = 0.2
  biot = 0.8, porosity = 0.01, permeability = 5.0e-20
  toughness = 0.3e6
/
&fluid compressibility = 4.0e-10, viscosity = 1.0e-4 /
&fracture
  name = 'f1'
  x = 0.9646446609406726, 1.0353553390593274
  y = 0.9646446609406726, 1.0353553390593274
  friction = 0.5, dilation_deg = 1.0, aperture = 1.0e-3
/
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&side name = 'top', y_traction = -10.0e6 /
&injection fracture = 'f1', rate = 5.0e-9, start = 3600.0, end = 14400.0 /
&time end = 18000.0, step = 3600.0 /
&coarse size_fracture = 0.02, size_boundary = 0.25 /
&fine window = 0.4 /
&growth intensities = .true. /
&probe name = 'inside', x = 1.5, y = 1.5 /
&probe name = 'corner', x = 2.0, y = 2.0 /
"""


def changed(text: str, *changes: tuple[str, str]) -> str:
    """Give a text with pieces replaced, each of which must stand in it."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def varied(*changes: tuple[str, str]) -> str:
    """Give the scene with pieces replaced."""
    return changed(SCENE, *changes)


def with_heat(scene: str) -> str:
    """Give a scene like SCENE with heat: cold water in hot rock."""
    for group, words in (
        ("material", "heat_conductivity = 2.6, heat_capacity = 2.2e6, heat_expansion = 2.4e-5,"),
        ("fluid", "heat_capacity = 4.2e6,"),
        ("injection", "temperature = 50.0,"),
    ):
        scene = scene.replace(f"&{group}", f"&{group} {words}")
    return scene + "&heat temperature = 150.0 /\n"


GROWING = varied(
    ("intensities = .true.", "enabled = .true., stop_gain = 0.015"),
    ("end = 18000.0", "end = 7200.0"),
)
GROWING_BY_PARIS = GROWING.replace("enabled = .true.", "enabled = .true., law = 'paris'")


def _heed_interrupts() -> None:
    """Undo an ignored SIGINT, which a shell would inherit and could not undo."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def start(place: Path, *arguments: str | Path) -> subprocess.Popen[str]:
    """Start the real launcher in a folder, and leave it running."""
    return subprocess.Popen(
        [TOP / "wingcrack", *arguments],
        cwd=place,
        env=os.environ,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=_heed_interrupts,
    )


def call(place: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the real launcher in a folder to its end."""
    with start(place, *arguments) as process:
        out, error = process.communicate(timeout=300)
    return subprocess.CompletedProcess(process.args, process.returncode, out, error)


def bare(place: Path, *arguments: str | Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run the bare solver in a folder to its end, with more variables in its environment."""
    return subprocess.run(
        [SOLVER, *arguments],
        cwd=place,
        env=os.environ | variables,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def run(place: Path, text: str, out: str = "out") -> Path:
    """Run a scene with the bare solver, and give the directory of its files."""
    (place / "small.nml").write_text(text)
    done = bare(place, "run", "small.nml", "--out", out, "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return place / out


def record(out: Path) -> dict[str, object]:
    """Give what run.json holds."""
    content = json.loads((out / "run.json").read_text())
    assert isinstance(content, dict)
    return content


def rows(path: Path) -> list[dict[str, str]]:
    """Give the rows of a table; every one must have all columns."""
    lines = list(csv.reader(path.read_text().splitlines()))
    return [dict(zip(lines[0], line, strict=True)) for line in lines[1:]]


def numbers(path: Path, column: str) -> list[float]:
    """Give one column of a table."""
    return [float(row[column]) for row in rows(path)]
