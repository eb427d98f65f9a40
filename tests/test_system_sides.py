"""How bodies are held: joints that end on sides, point supports, springs.

Sides are held and loaded so that a uniform stress is the exact solution, whatever the joints, as
long as all of them stick: a patch test. References are closed forms.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from system_scene import changed, numbers, record, rows, run

pytestmark = pytest.mark.usefixtures("program")

YOUNG, POISSON = 20.0e9, 0.25
WIDTH, HEIGHT = 2.0, 4.0
ROUNDING = 1.0e-10

# A joint from side to side at 30 degrees, which a pressure of 30 MPa from above makes slide where
# its friction is below tan 30 = 0.577.
ROLLERS = """\
&domain x_min = 0, x_max = 2, y_min = 0, y_max = 4 /
&material young = 20e9, poisson = 0.25 /
&fracture name = 'f', x = 0, 2, y = 1.4, 2.5547005383792515, friction = 0.65 /
&side name = 'left', x_displacement = 0 /
&side name = 'bottom', y_displacement = 0 /
&side name = 'top', y_traction = -30e6 /
&fe size_fracture = 0.2, size_boundary = 0.4 /
&output vtu = .false. /
"""

BONDED = (
    "cohesion = 8.8e6, tensile_strength = 1e6, weakening_slip = 1e-3, friction_residual = 0.2, "
    "opening_weakening = 1e-3, friction = 0.2"
)


def strain(sxx: float, syy: float) -> tuple[float, float]:
    """Give the plane strains of uniform principal stresses along x and y [Pa]."""
    factor, share = (1 - POISSON**2) / YOUNG, POISSON / (1 - POISSON)
    return factor * (sxx - share * syy), factor * (syy - share * sxx)


def check_patch(out: Path, sxx: float, syy: float, joints: list[tuple[float, float]]) -> None:
    """All cells stick under the tractions of a uniform stress; joints by their directions."""
    cells = rows(out / "fractures.csv")
    assert cells
    assert {cell["state"] for cell in cells} == {"stick"}
    scale = max(abs(sxx), abs(syy))
    for cell in cells:
        dx, dy = joints[int(cell["fracture"]) - 1]
        length = math.hypot(dx, dy)
        tx, ty = dx / length, dy / length
        normal, shear = sxx * ty**2 + syy * tx**2, (syy - sxx) * tx * ty
        assert float(cell["traction_n_pa"]) == pytest.approx(normal, abs=ROUNDING * scale)
        assert float(cell["traction_t_pa"]) == pytest.approx(shear, abs=ROUNDING * scale)


@pytest.mark.parametrize(
    "law",
    [
        "friction = 0.65",
        "friction = 0.65, dilation_deg = 5",
        BONDED,  # strength 8.8 + 0.2 22.5 = 13.3 MPa, the shear is 12.99 MPa
        "friction = 0.65, friction_residual = 0.3, weakening_slip = 1e-4",
    ],
)
def test_joint_on_rollers_sticks(tmp_path: Path, law: str) -> None:
    """Its end on a side with a given displacement bears as much as the rest."""
    out = run(tmp_path, changed(ROLLERS, ("friction = 0.65", law)))
    check_patch(out, 0.0, -30.0e6, [(2.0, 2.0 / math.sqrt(3.0))])


JOINTS: dict[str, list[list[tuple[float, float]]]] = {
    "from a corner": [[(0.0, 0.0), (1.0, 2.2)]],
    "from corner to corner": [[(0.0, 0.0), (2.0, 4.0)]],
    "two from one place on a side": [[(0.0, 1.5), (1.0, 2.5)], [(0.0, 1.5), (1.2, 1.1)]],
    "with a branch": [[(0.0, 1.4), (1.0, 1.9), (2.0, 2.4)], [(0.8, 4.0), (1.0, 1.9)]],
    "from bottom to top": [[(0.7, 0.0), (1.4, 4.0)]],
}


@pytest.mark.parametrize("name", JOINTS)
@pytest.mark.parametrize("hold", ["displacements", "springs"])
def test_patch(tmp_path: Path, name: str, hold: str) -> None:
    """Joints of all kinds on sides that move by given displacements, or stand on springs."""
    joints, (sxx, syy) = JOINTS[name], (-12.0e6, -25.0e6)
    exx, eyy = strain(sxx, syy)
    moved, pushed, spring = 1.0e-4, -2.0e-4, 1.0e9
    far_x, far_y = moved + exx * WIDTH, pushed + eyy * HEIGHT
    scene = f"""\
&domain x_min = 0, x_max = {WIDTH}, y_min = 0, y_max = {HEIGHT} /
&material young = {YOUNG}, poisson = {POISSON} /
&side name = 'left', x_displacement = {moved} /
&side name = 'bottom', y_displacement = {pushed} /
&fe size_fracture = 0.3, size_boundary = 0.5 /
&output vtu = .false. /
"""
    if hold == "springs":
        scene += (
            f"&side name = 'right', x_spring = {spring}, x_traction = {sxx + spring * far_x!r} /\n"
            f"&side name = 'top', y_spring = {spring}, y_traction = {syy + spring * far_y!r} /\n"
        )
    else:
        scene += (
            f"&side name = 'right', x_displacement = {far_x!r} /\n"
            f"&side name = 'top', y_displacement = {far_y!r} /\n"
        )
    for number, points in enumerate(joints):
        x, y = (", ".join(map(repr, values)) for values in zip(*points, strict=True))
        scene += f"&fracture name = 'f{number}', x = {x}, y = {y}, friction = 6.0 /\n"
    directions = [(p[-1][0] - p[0][0], p[-1][1] - p[0][1]) for p in joints]
    check_patch(run(tmp_path, scene), sxx, syy, directions)


def test_joint_slides_on_clamps(tmp_path: Path) -> None:
    """A block that is pushed over another one along rollers: its slip is that of the side."""
    scene = changed(
        ROLLERS,
        ("x = 0, 2, y = 1.4, 2.5547005383792515, friction = 0.65", "x = 0, 2, y = 2, 2, FRICTION"),
        ("FRICTION", "law = 'frictionless'"),
        ("&side name = 'left', x_displacement = 0 /", "&side name = 'left', y_displacement = 0 /"),
        ("&side name = 'bottom', ", "&side name = 'bottom', x_displacement = 0, "),
        ("y_traction = -30e6", "x_displacement = 0.01, y_displacement = 0"),
    )
    out = run(tmp_path, scene + "&side name = 'right', y_displacement = 0 /\n")
    assert numbers(out / "fractures.csv", "jump_t_m") == pytest.approx([0.01] * 10, rel=1e-9)


# A body under the same pressure all around, which restraints hold against rigid motions alone.
POROUS = """\
&material young = 8e9, poisson = 0.12, biot = 0.9, porosity = 0.2, permeability = 1e-18 /
&fluid compressibility = 4.5e-10, viscosity = 1e-3 /
&restraint x = 0, y = 0, x_displacement = 0, y_displacement = 0 /
&restraint x = 0.5, y = 0, y_displacement = 0 /
&probe name = 'c', x = 0, y = 0 /
&probe name = 'd', x = 0.3, y = -0.4 /
&time end = 1, step = 1 /
&coarse size_boundary = 0.2 /
&output vtu = .false. /
"""
SQUARE = """\
&domain x_min = -1, x_max = 1, y_min = -1, y_max = 1 /
&side name = 'left', x_traction = 5e6 /
&side name = 'right', x_traction = -5e6 /
&side name = 'top', y_traction = -5e6 /
&side name = 'bottom', y_traction = 5e6 /
"""
DISC = """\
&domain shape = 'disc', x_centre = 0, y_centre = 0, radius = 1 /
&side name = 'rim', normal_traction = -5e6 /
"""


@pytest.mark.parametrize("body", [SQUARE, DISC])
def test_restraints_bear_nothing(tmp_path: Path, body: str) -> None:
    """Pressure and displacement are those of a body that nothing holds: Skempton's response."""
    out = run(tmp_path, body + POROUS)
    young, nu, biot, porosity = 8.0e9, 0.12, 0.9, 0.2
    bulk, shear = young / (3 * (1 - 2 * nu)), young / (2 * (1 + nu))
    storage = porosity * 4.5e-10 + (biot - porosity) / bulk  # S of docs/theory.md
    plane = bulk + shear / 3  # mean stress in the plane over the change of area
    pressure = biot * 5e6 / (storage * plane + biot**2)
    contraction = (5e6 - biot * pressure) / (2 * plane)
    last = rows(out / "probes.csv")[-1]
    for point, x, y in (("c", 0.0, 0.0), ("d", 0.3, -0.4)):
        assert float(last[f"{point}_p_pa"]) == pytest.approx(pressure, rel=1e-9)
        assert float(last[f"{point}_sxx_pa"]) == pytest.approx(-5e6, rel=1e-9)
        assert float(last[f"{point}_sxy_pa"]) == pytest.approx(0.0, abs=1.0)
        assert float(last[f"{point}_ux_m"]) == pytest.approx(-contraction * x, abs=1e-12)
        assert float(last[f"{point}_uy_m"]) == pytest.approx(-contraction * y, abs=1e-12)
    assert record(out)["warnings"] == []


def test_restraints_beyond_need(tmp_path: Path) -> None:
    """More of them than hold the body are loads, which is said."""
    more = changed(POROUS, ("x = 0.5, y = 0, y_disp", "x = 0.5, y = 0, x_displacement = 0, y_disp"))
    out = run(tmp_path, SQUARE + more)
    assert "&restraint: surplus is 1.0: they are then point loads" in str(record(out)["warnings"])


# A stiff body on springs along two sides, which the tractions on the top push and turn.
ON_SPRINGS = """\
&domain x_min = 0, x_max = 3, y_min = 0, y_max = 2 /
&material young = 30e15, poisson = 0.2 MORE /
&side name = 'bottom', x_spring = 4e8, y_spring = 9e8 /
&side name = 'right', x_spring = 2e8, y_spring = 1e8 /
&side name = 'top', x_traction = 1e6, y_traction = -3e6 /
&probe name = 'a', x = 0.5, y = 1.5 /
&probe name = 'b', x = 2.5, y = 0.5 /
&output vtu = .false. /
"""


def springs_move(x: float, y: float) -> tuple[float, float]:
    """Displacement of a rigid body on those springs, by its three equations of balance."""
    kb, kr = (4e8, 9e8), (2e8, 1e8)
    # u = (a - w y, b + w x); forces and moment about the origin, per metre of thickness.
    matrix = [
        [kb[0] * 3 + kr[0] * 2, 0.0, -kr[0] * 2],
        [0.0, kb[1] * 3 + kr[1] * 2, kb[1] * 4.5 + kr[1] * 6],
        [-kr[0] * 2, kb[1] * 4.5 + kr[1] * 6, kb[1] * 9 + kr[0] * 8 / 3 + kr[1] * 18],
    ]
    load = [3e6, -9e6, -9e6 * 1.5 - 3e6 * 2]
    for i in range(3):
        for j in range(i + 1, 3):
            share = matrix[j][i] / matrix[i][i]
            matrix[j] = [b - share * a for a, b in zip(matrix[i], matrix[j], strict=True)]
            load[j] -= share * load[i]
    w = load[2] / matrix[2][2]
    b = (load[1] - matrix[1][2] * w) / matrix[1][1]
    a = (load[0] - matrix[0][2] * w) / matrix[0][0]
    return a - w * y, b + w * x


@pytest.mark.parametrize("level", ["fine", "coarse", "window"])
def test_body_on_springs(tmp_path: Path, level: str) -> None:
    """Springs alone hold it, in finite elements, finite volumes, and in a window of the body."""
    scene = changed(ON_SPRINGS, (" MORE", ""))
    if level == "fine":
        scene += "&fe size_boundary = 0.4 /\n"
    else:
        scene = changed(ON_SPRINGS, ("MORE", ", biot = 0.7, porosity = 0.1, permeability = 1e-18"))
        scene += (
            "&fluid compressibility = 4e-10, viscosity = 1e-3 /\n&time end = 1, step = 1 /\n"
            "&coarse size_boundary = 0.2, size_fracture = 0.2 /\n"
            "&fracture name = 'f', x = 1, 1.6, y = 0.6, 0.9, friction = 0.9, aperture = 1e-6 /\n"
        )
    if level == "window":
        scene += "&fine window = 'body' /\n&growth intensities = .true. /\n"
    out = run(tmp_path, scene)
    last = rows(out / "probes.csv")[-1]
    # Finite volumes have the springs at a third of each half face: of second order in the cells.
    accuracy = 1e-5 if level == "fine" else 4e-3
    for point, x, y in (("a", 0.5, 1.5), ("b", 2.5, 0.5)):
        ux, uy = springs_move(x, y)
        assert float(last[f"{point}_ux_m"]) == pytest.approx(ux, rel=accuracy)
        assert float(last[f"{point}_uy_m"]) == pytest.approx(uy, rel=accuracy)
    if level == "window":
        assert len(rows(out / "tips.csv")) > 0
