"""`wingcrack analyse` on runs whose properties are known: leak-off of a fracture, well in rock."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from system_scene import call, rows, run

import wingcrack

pytestmark = pytest.mark.usefixtures("program")

# W1: 600 s of injection into a closed fracture of 20 m, then 17 hours of shut-in.
FRACTURE = """\
&domain x_min = -50, x_max = 50, y_min = -50, y_max = 50 /
&material young = 40e9, poisson = 0.25, biot = 0.2, porosity = 0.01, permeability = 1e-18 /
&fluid compressibility = 5e-10, viscosity = 3e-4 /
&fracture name = 'c', x = -10, 10, y = 0, 0, friction = 1.4, aperture = 2e-4 /
&in_situ sxx = -70e6, syy = -60e6 /
&initial pressure = 20e6 /
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&injection name = 'w', fracture = 'c', rate = 1e-6, 0.0, time = 0, 600 /
&time end = 60600 /
&coarse size_fracture = 1.0, size_boundary = 8 /
"""

# W2: an hour of injection into rock of 1e-16 m2, then nine hours of shut-in.
ROCK = """\
&domain x_min = -50, x_max = 50, y_min = -50, y_max = 50 /
&material young = 40e9, poisson = 0.25, biot = 0.9, porosity = 0.05, permeability = 1e-16 /
&fluid compressibility = 4.5e-10, viscosity = 3e-4 /
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&injection name = 'w', x = 0.3, y = 0.2, radius = 0.1, rate = 1e-5, 0.0, time = 0, 3600 /
&time end = 36000, tolerance = 1e-4 /
&coarse size_boundary = 1.4 /
"""


def _analysed(folder: Path, text: str) -> tuple[Path, dict[str, str], str]:
    out = run(folder, text)
    done = call(folder, "analyse", "out")
    assert done.returncode == 0, done.stderr
    (row,) = rows(out / "figures" / "well_test.csv")
    return out, row, done.stdout


def test_fall_off_of_a_fracture_gives_its_leak_off_area(tmp_path: Path) -> None:
    """A sqrt(k) within 3 % and within its error; the reservoir within its error."""
    out, row, said = _analysed(tmp_path, FRACTURE)
    exact = 40.0 * math.sqrt(1e-18)
    assert float(row["area_root_k"]) == pytest.approx(exact, rel=0.03)
    assert abs(float(row["area_root_k"]) - exact) < float(row["area_root_k_error"])
    reservoir, error = (float(row[f"linear_reservoir{end}_pa"]) for end in ("", "_error"))
    assert abs(reservoir - 20.0e6) < error < 0.2e6
    assert row["closure_first_cell_s"] == ""  # the fracture has never opened
    assert "area times root of permeability" in said
    assert (out / "figures" / "well_test_w_1.png").stat().st_size > 10_000
    frame = wingcrack.open(out).well_test()
    assert frame.area_root_k[0] == float(row["area_root_k"])


def test_fall_off_of_a_well_in_rock_gives_its_permeability(tmp_path: Path) -> None:
    """Permeability within 3 % and its error.

    The line begins where flow has reached 2 sqrt(c t) = 7 m, five cells. With cells of 2 m a line
    that is even by chance begins at 3 m, and k h is 6 % off.
    """
    _, row, _ = _analysed(tmp_path, ROCK)
    assert float(row["k_h"]) == pytest.approx(1e-16, rel=0.03)
    assert abs(float(row["k_h"]) - 1e-16) < float(row["k_h_error"])


def test_a_region_at_the_well_is_named(tmp_path: Path) -> None:
    region = "&region name = 'clay', x = -5, 5, 5, -5, y = -5, -5, 5, 5, permeability = 1e-19 /\n"
    elsewhere = region.replace("-5, 5, 5, -5", "35, 45, 45, 35").replace("clay", "sand")
    text = FRACTURE.replace("fracture = 'c', rate", "fracture = 'c', x = 0, y = 0, rate")
    run(tmp_path, text.replace("60600", "6060") + region + elsewhere)
    done = call(tmp_path, "analyse", "out")
    assert done.returncode == 0, done.stderr
    assert "well at (0, 0) m may be that of the region 'clay', but" in done.stderr
    assert "sand" not in done.stderr


def test_run_without_a_shut_in_is_refused(tmp_path: Path) -> None:
    text = FRACTURE.replace("1e-6, 0.0, time = 0, 600", "1e-6").replace("60600", "10")
    out = run(tmp_path, text)
    done = call(tmp_path, "analyse", "out")
    assert done.returncode == 2
    assert "no well is shut in after an injection (there are: w)" in done.stderr
    assert not (out / "figures" / "well_test.csv").exists()
