"""What a scene does not need stays out: shown by unknowns and by the instructions executed."""

from __future__ import annotations

import json
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from callgrind_profile import Profile, profile, why_not
from system_scene import TOP

needs_valgrind = pytest.mark.skipif(bool(why_not()), reason=why_not())

# A plate of 1 m x 2 m on its lower edge, drawn or pressed at the upper one. Meshes are as coarse as
# they can be: what is executed does not depend on it, and valgrind takes fifty times as long.
PLATE = """\
&domain x_min = 0.0, x_max = 1.0, y_min = -1.0, y_max = 1.0 /
&material young = 1.0e9, poisson = 0.25, toughness = 1.0e6 /
&side name = 'bottom', y_displacement = 0.0 /
&restraint x = 0.0, y = -1.0, x_displacement = 0.0 /
&fe size_fracture = 0.4, size_boundary = 1.0, rosette_sectors = 6 /
"""
DRAWN = "&side name = 'top', y_traction = 1.0e6 /\n"
PRESSED = "&side name = 'top', y_traction = -1.0e7 /\n"
CRACK = "&fracture name = 'f', x = 0.35, 0.65, y = -0.15, 0.15, {law} /\n"
NO_FILES = "&output vtu = .false. /\n"

# A body of 2 m x 2 m of porous rock under 20 MPa and 10 MPa, and one step in time.
POROUS = """\
&domain x_min = 0.0, x_max = 2.0, y_min = 0.0, y_max = 2.0 /
&material
  young = 40.0e9, poisson = 0.2, biot = 0.8, porosity = 0.01, permeability = 5.0e-20
  toughness = 0.3e6
/
&fluid compressibility = 4.0e-10, viscosity = 1.0e-4 /
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&side name = 'top', y_traction = -10.0e6 /
&time end = 3600.0, step = 3600.0 /
&output vtu = .false. /
"""
WELL = """\
&fracture
  name = 'f', x = 0.9, 1.1, y = 0.9, 1.1, friction = 0.5, dilation_deg = 1.0, aperture = 1.0e-3
/
&injection fracture = 'f', rate = 5.0e-9 /
"""
CROSSING = "&fracture name = 'g', x = 0.9, 1.1, y = 1.1, 0.9, friction = 0.5, aperture = 1.0e-3 /\n"
BAND = "&region name = 'r', x = 0, 2, 2, 0, y = 1.2, 1.2, 1.8, 1.8, permeability = 1e-18 /\n"
COARSE = "&coarse size_fracture = 0.1, size_boundary = 0.5 /\n"

SCENES = {
    "plate": PLATE + DRAWN + NO_FILES,
    "its intensities": PLATE
    + DRAWN
    + NO_FILES
    + CRACK.format(law="law = 'open'")
    + "&growth intensities = .true. /\n",
    "growing wings, VTU files": PLATE
    + PRESSED
    + CRACK.format(law="friction = 0.1")
    + "&growth enabled = .true., increment = 0.1, stop_gain = 0.05 /\n",
    "porous body": POROUS + "&coarse size_boundary = 0.5 /\n",
    "with a well": POROUS + COARSE + WELL,
    "with a joint and a region": POROUS + COARSE + WELL + CROSSING + BAND,
    "two levels": POROUS
    + COARSE
    + WELL
    # by steps as they are: those that seek the equilibrium evaluate the same seven times as often
    + "&fine window = 0.4, size_ratio = 1.0, rosette_sectors = 6 /\n"
    + "&growth enabled = .true., law = 'paris', stop_gain = 0.01 /\n",
}

# Modules, or the beginnings of their names, that a scene has no use for, or of "module: procedure".
# Those of growth: what evaluates tips and moves them.
FLUID = ("coarse_", "twolevel_")
TIPS = ("fine_tip_intensity", "fine_tip_interaction", "fine_tip_energy", "growth_law")
CONTACT = ("contact_point: contact_equations", "contact_point: contact_residual")
WINDOWS = ("fine_", "twolevel_window", "twolevel_transfer", "twolevel_faces")
JOINTS = ("coarse_fracture_flow: fill_joint", "coarse_fracture_flow: fill_branch")
REGIONS = (
    "coarse_permeability",
    "scene_region_outline",
    "scene_check_regions",
    "base_plane: left_part",
)
FILES = ("report_vtu",)
ABSENT = {
    "plate": FLUID + TIPS + CONTACT + FILES,
    "its intensities": FLUID + CONTACT + FILES,
    "growing wings, VTU files": FLUID + REGIONS,
    "porous body": (
        "mechanics_",
        *WINDOWS,
        *TIPS,
        *CONTACT,
        "coarse_newton",
        *JOINTS,
        *REGIONS,
        *FILES,
    ),
    "with a well": ("mechanics_", *WINDOWS, *TIPS, *JOINTS, *REGIONS, *FILES),
    "with a joint and a region": ("mechanics_", *WINDOWS, *TIPS, *FILES),
    "two levels": ("mechanics_", *JOINTS, *REGIONS, *FILES),
}
# The same instrument sees them where they are wanted.
PRESENT = {
    "plate": ("mechanics_", "fine_"),
    "its intensities": TIPS,
    "growing wings, VTU files": (*TIPS, *CONTACT, *FILES),
    "porous body": ("coarse_",),
    "with a well": ("coarse_newton", *CONTACT),
    "with a joint and a region": ("coarse_newton", *CONTACT, *JOINTS, *REGIONS),
    "two levels": (*FLUID, *WINDOWS, *TIPS, *CONTACT),
}


@pytest.fixture(scope="module")
def profiles(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Profile]:
    """Profiles of all scenes."""
    top = tmp_path_factory.mktemp("profiles")
    places = [top / str(number) for number in range(len(SCENES))]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(zip(SCENES, pool.map(profile, SCENES.values(), places), strict=True))


@needs_valgrind
@pytest.mark.parametrize("scene", SCENES)
def test_what_is_left_out_is_not_called(profiles: dict[str, Profile], scene: str) -> None:
    assert not profiles[scene].executed(*ABSENT[scene])
    for module in PRESENT[scene]:
        assert profiles[scene].executed(module), module


@needs_valgrind
def test_what_is_left_out_saves(
    profiles: dict[str, Profile], capsys: pytest.CaptureFixture[str]
) -> None:
    """Each part of a scene costs; without it its components execute nothing, or less."""
    components = ("mechanics", "coarse", "twolevel", "fine", "contact", "growth", "report")
    with capsys.disabled():
        print(
            "\nthousands of instructions" + "".join(f"{component:>10}" for component in components)
        )
        for name, counts in profiles.items():
            by_component = counts.components()
            numbers = "".join(f"{by_component[component] / 1e3:>10.0f}" for component in components)
            print(f"{name:<25}{numbers}")
    chains = (
        ("plate", "its intensities", "growing wings, VTU files"),
        ("porous body", "with a well", "two levels"),
    )
    for chain in chains:
        totals = [
            sum(profiles[name].components()[component] for component in components)
            for name in chain
        ]
        assert totals == sorted(totals)
        assert len(set(totals)) == len(totals)


@pytest.mark.usefixtures("program")
@pytest.mark.parametrize("scene", ["plate", "growing wings, VTU files"])
def test_no_unknowns_of_a_fluid(scene: str, tmp_path: Path) -> None:
    solver = TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver"
    (tmp_path / "scene.nml").write_text(SCENES[scene])
    subprocess.run(
        [solver, "run", "scene.nml", "--out", "out", "--quiet"], cwd=tmp_path, check=True
    )
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    assert set(record["dofs"]) == {"displacement"}
    assert any("pressure" in words for words in record["left_out"])
