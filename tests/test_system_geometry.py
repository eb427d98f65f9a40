"""What `check` accepts can be meshed, windows around tips included; the rest it refuses."""

from __future__ import annotations

import math
import random
import subprocess
from pathlib import Path

import pytest
from system_scene import SOLVER, rows, run

pytestmark = pytest.mark.usefixtures("program")

HELD = """\
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&side name = 'right', x_traction = -10e6 /
&side name = 'top', y_traction = -13e6 /
&output vtu = .false. /
"""
POROUS = """\
&material young = 10e9, poisson = 0.25, biot = 0.3, porosity = 0.05, permeability = 1e-18 /
&fluid compressibility = 4e-10, viscosity = 1e-3 /
&time end = 1e-3, step = 1e-3 /
&growth intensities = .true. /
"""
# The windows of other tips hold the end of 'a', whose elements reach across the region's outline.
CROSSED_OUTLINE = (
    HELD
    + POROUS
    + """\
&domain x_min = -1, x_max = 1, y_min = -1, y_max = 1 /
&region name = 'r', x = -0.418, 0.231, 0.231, -0.418, y = -2, -2, 2, 2, young = 1e9 /
&fracture name = 'a', x = -0.3046, 0.2349, y = -0.0202, 0.0926, friction = 0.6, aperture = 1e-5 /
&fracture name = 'b', x = -0.1467, 0.1221, y = -0.1008, 0.1315, friction = 0.6, aperture = 1e-5 /
&coarse size_fracture = 0.0888, size_boundary = 0.2 /
&fine window = 0.355 /
"""
)


def check(place: Path, text: str) -> subprocess.CompletedProcess[str]:
    """Let the solver check a scene."""
    scene = place / "scene.nml"
    scene.write_text(text)
    return subprocess.run([SOLVER, "check", scene], capture_output=True, text=True, check=False)


def test_outline_next_to_a_tip_in_a_window(tmp_path: Path) -> None:
    """Edges along a region's outline keep clear of the elements around all tips."""
    assert len(rows(run(tmp_path, CROSSED_OUTLINE) / "tips.csv")) == 2 * 4


@pytest.mark.parametrize("sort", ["fluid", "mechanics"])
def test_tip_too_near_an_interface(tmp_path: Path, sort: str) -> None:
    """Refused with its line before anything is written; an end on another fracture is no tip."""
    text = CROSSED_OUTLINE.replace("x = -0.3046, 0.2349", "x = -0.3046, 0.2315")
    if sort == "mechanics":
        text = text.replace("&fluid compressibility = 4e-10, viscosity = 1e-3 /\n", "")
        text = text.replace("&time end = 1e-3, step = 1e-3 /\n", "")
        text = text.replace(", biot = 0.3, porosity = 0.05, permeability = 1e-18", "")
        text = text.replace(", aperture = 1e-5", "")
        text = text.replace("&coarse", "&fe").replace("&fine window = 0.355 /\n", "")
    done = check(tmp_path, text)
    line = next(i for i, row in enumerate(text.splitlines(), 1) if "name = 'a'" in row)
    assert done.returncode == 2
    assert f"scene.nml:{line}: &fracture: fracture 'a': the tip at ( 2.315" in done.stderr
    assert "from rock of another stiffness" in done.stderr
    aperture = ", aperture = 1e-5" if sort == "fluid" else ""
    crossing = f"&fracture name = 'c', x = 2*0.2315, y = -0.1, 0.3, friction = 0.6{aperture} /\n"
    refused = check(tmp_path, text + crossing)
    assert "fracture 'c': the tip at ( 2.315" in refused.stderr
    assert check(tmp_path, text.replace("intensities = .true.", "")).returncode == 0


def random_network(seed: int) -> str:
    """Give a scene of fractures that almost touch, hug sides, or are small, beside a region."""
    draw = random.Random(seed)

    def small() -> float:
        return 10 ** draw.uniform(-3, -1)

    fractures: list[list[tuple[float, float]]] = []
    for _ in range(draw.randint(2, 5)):
        angle, length = draw.uniform(0, 2 * math.pi), draw.uniform(0.1, 0.4)
        dx, dy = length * math.cos(angle), length * math.sin(angle)
        x, y = draw.uniform(0.2, 0.8), draw.uniform(0.2, 0.8)
        kind = draw.choice(["free", "side", "end", "beside", "shared"]) if fractures else "free"
        if kind == "side":
            x = small()
        elif kind != "free":
            first, last = draw.choice(fractures)
            share = {"end": 1.0, "shared": 1.0, "beside": draw.uniform(0.2, 0.8)}[kind]
            gap = 0.0 if kind == "shared" else small() / math.hypot(dx, dy)
            x = first[0] + share * (last[0] - first[0]) + gap * dx
            y = first[1] + share * (last[1] - first[1]) + gap * dy
        places = [(x, y), (x + dx, y + dy)]
        fractures.append([(min(1, max(0, p)), min(1, max(0, q))) for p, q in places])
    left, low = draw.uniform(0, 0.8), draw.uniform(0, 0.8)
    size = draw.choice([0.02, 0.05, 0.1])
    text = HELD + POROUS + "&domain x_min = 0, x_max = 1, y_min = 0, y_max = 1 /\n"
    text += f"&coarse size_fracture = {size}, size_boundary = 0.2 /\n"
    text += f"&fine window = {draw.choice(['0.25', '0.5'])} /\n"
    text += (
        f"&region name = 'r', x = {left}, {left + 0.2}, {left + 0.1}, "
        f"y = {low}, {low + 0.05}, {low + 0.3}, young = 1e9 /\n"
    )
    for number, ((a, b), (c, d)) in enumerate(fractures):
        text += (
            f"&fracture name = 'f{number}', x = {a!r}, {c!r}, y = {b!r}, {d!r}, "
            "friction = 0.6, aperture = 1e-5 /\n"
        )
    return text


@pytest.mark.parametrize("seed", range(12))
def test_what_check_accepts_is_meshed(tmp_path: Path, seed: int) -> None:
    """A run of it ends well, or by a stated limit on results; never by its mesh."""
    text = random_network(seed)
    judged = check(tmp_path, text)
    assert judged.returncode in (0, 2), judged.stderr
    if judged.returncode == 2:
        assert judged.stderr.count("\n") == 1
        assert "scene.nml:" in judged.stderr
        return
    done = subprocess.run(
        [SOLVER, "run", tmp_path / "scene.nml", "--out", tmp_path / "out", "--quiet"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0 or "a limit of the run is exceeded" in done.stderr, done.stderr
