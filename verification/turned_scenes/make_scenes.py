"""Write one scene six ways that must not matter: mirrored, turned, in other units, ...

`python make_scenes.py` writes the files *.nml of this case. The scene has what fields ask for: a
well with storage, losses and a limit, one in the rock, friction that weakens, a bond, a joint that
closes, a skin, a fluid whose viscosity and density follow pressure, sides in the course
of time, a spring, an inflow, a region of other rock.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

Place = Callable[[float, float], tuple[float, float]]


def scene(
    title: str,
    place: Place,
    sides: dict[str, str],
    *,
    length: float = 1.0,
    stress: float = 1.0,
    turned: bool = False,
    is_reversed: bool = False,
    idle: bool = False,
) -> str:
    """Return the text of a scene.

    Parameters
    ----------
    place
        Where a point of the scene goes [m].
    sides
        Where the sides left, right, bottom and top go.
    length, stress
        What units of length and stress are multiplied by; time stays.
    turned
        Whether x and y change places.
    is_reversed
        Whether groups, and the vertices of fractures, come in the reverse order.
    idle
        Whether steps must end at times when nothing happens.
    """
    axis = ("y", "x") if turned else ("x", "y")
    flow = length**2

    def points(*pairs: tuple[float, float]) -> str:
        moved = [place(x, y) for x, y in (reversed(pairs) if is_reversed else pairs)]
        return ", ".join(
            f"{name} = " + ", ".join(f"{length * p[k]:.17g}" for p in moved)
            for k, name in enumerate(("x", "y"))
        )

    ends = [place(0.0, 0.0), place(4.0, 3.0)]
    low = [length * min(e[k] for e in ends) for k in (0, 1)]
    high = [length * max(e[k] for e in ends) for k in (0, 1)]
    across, along = axis

    # Tractions on the whole of a course: 15 s in the middle of a straight piece are idle.
    times = [0.0, 15.0, 30.0] if idle else [0.0, 30.0]
    level = [-12.0e6 * stress, -14.0e6 * stress, -16.0e6 * stress]
    if not idle:
        level = [level[0], level[-1]]
    outwards = "normal_traction"
    groups = [
        f"&fracture\n  name = 'main', {points((1.4, 1.1), (2.6, 1.9))}\n  friction = 0.6, "
        f"friction_residual = 0.4, weakening_slip = {4e-4 * length:.17g}\n"
        f"  dilation_deg = 1.0, aperture = {1e-4 * length:.17g}, "
        f"cohesion = {3e5 * stress:.17g}\n/",
        f"&fracture\n  name = 'other', {points((2.0, 1.9), (2.4, 1.3))}\n  friction = 0.5, "
        f"aperture = {2e-4 * length:.17g}\n  normal_stiffness = {1e11 * stress / length:.17g}, "
        f"closure = {1e-4 * length:.17g}, skin = {1e9 * stress / length:.17g}\n/",
        f"&region name = 'soft', young = {8e9 * stress:.17g}, permeability = {3e-16 * flow:.17g}, "
        f"{points((2.9, 0.5), (3.5, 0.5), (3.5, 2.5), (2.9, 2.5))} /",
        f"&side name = '{sides['left']}', {across}_displacement = 0.0, "
        f"pressure = {2e6 * stress:.17g} /",
        f"&side name = '{sides['bottom']}', {along}_displacement = 0.0 /",
        f"&side\n  name = '{sides['right']}', {across}_spring = {2e10 * stress / length:.17g}\n"
        f"  {outwards} = {-10e6 * stress:.17g}\n/",
        f"&side\n  name = '{sides['top']}'\n  time = {', '.join(f'{t:g}' for t in times)}\n"
        f"  {outwards} = {', '.join(f'{v:.17g}' for v in level)}\n"
        f"  inflow = {2e-8 * length:.17g}\n/",
        f"&injection\n  name = 'w', fracture = 'main', {points((2.0, 1.5))}\n"
        f"  time = 0.0, 20.0, 45.0, rate = {4e-6 * flow:.17g}, {2e-5 * flow:.17g}, 0.0\n"
        f"  pressure = {9e6 * stress:.17g}, storage = {1e-13 * flow / stress:.17g}\n"
        f"  friction = {5e9 * stress / flow:.17g}\n/",
        f"&injection\n  name = 'rock', {points((0.8, 2.2))}, radius = {0.002 * length:.17g}\n"
        f"  pressure = {1e6 * stress:.17g}\n/",
        "&probe name = 'p', " + points((1.0, 1.0)) + " /",
    ]
    if is_reversed:
        groups.reverse()
    head = [
        f"! Written by make_scenes.py.\n&scene title = '{title}' /",
        f"&domain x_min = {low[0]:.17g}, x_max = {high[0]:.17g}, y_min = {low[1]:.17g}, "
        f"y_max = {high[1]:.17g} /",
        f"&material\n  young = {2e10 * stress:.17g}, poisson = 0.25, biot = 0.8, porosity = 0.02\n"
        f"  permeability = {1e-16 * flow:.17g}\n/",
        f"&fluid compressibility = {4e-10 / stress:.17g}, viscosity = {1e-3 * stress:.17g}\n"
        f"  viscosity_law = 'exponential', viscosity_exponent = {-3e-8 / stress:.17g}\n"
        f"  density_law = 'exponential', reference_pressure = {2e6 * stress:.17g}\n/",
        f"&initial pressure = {2e6 * stress:.17g} /",
        "&time end = 80.0 /",
        f"&coarse size_fracture = {0.05 * length:.17g}, size_boundary = {0.3 * length:.17g} /",
        f"&fine window = {0.4 * length:.17g} /",
        "&growth intensities = .true. /",
        f"&output vtu = .false., stimulated_jump = {1e-6 * length:.17g} /",
    ]
    return "\n".join([*head, *groups]) + "\n"


STRAIGHT = {name: name for name in ("left", "right", "bottom", "top")}


def main() -> None:
    """Write the scenes."""
    mirrored = {**STRAIGHT, "left": "right", "right": "left"}
    turned = {"left": "bottom", "right": "top", "bottom": "right", "top": "left"}

    def same(x: float, y: float) -> tuple[float, float]:
        return x, y

    scenes = {
        "as_it_is": scene("As it is", same, STRAIGHT),
        "mirrored": scene("Mirrored", lambda x, y: (4.0 - x, y), mirrored),
        "turned": scene("Turned by 90 degrees", lambda x, y: (3.0 - y, x), turned, turned=True),
        "units": scene("Other units", same, STRAIGHT, length=1024.0, stress=16.0),
        "order": scene("In the other order", same, STRAIGHT, is_reversed=True),
        "idle": scene("Idle times", same, STRAIGHT, idle=True),
    }
    for name, text in scenes.items():
        (Path(__file__).parent / f"{name}.nml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
