"""Write networks of random fractures with one well, as scenes.

    .venv/bin/python verification/random_networks/make_scenes.py

writes those of this case into its folder. Others, for runs by hand:

    ... make_scenes.py --seeds 7 8 --number 30 --side 2.0 --length 0.15 0.35 --end 300 --folder /tmp

Rock, fluid, stresses and well are those of scene D4. The first fracture has the well: in the middle
of the body, at 21 degrees from the larger stress, so that it opens before others. All others lie
anywhere, in any direction, as long as they stay 0.15 m away from the sides; how they cross, and how
near their ends come to each other, is left to chance.
"""

from __future__ import annotations

import argparse
import math
import random
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
MARGIN = 0.15  # between fractures and the sides [m]
WELL = (-0.13, -0.05, 0.13, 0.05)  # ends of the first fracture, from the middle [m]

SCENE = """\
! {number} random fractures, seed {seed}: written by make_scenes.py.
&scene name = 'network_{number}_{seed}' /
&domain x_min = 0.0, x_max = {side}, y_min = 0.0, y_max = {side} /
&material
  young = 40.0e9, poisson = 0.2, biot = 0.8, porosity = 0.01, permeability = 5.0e-20
  toughness = 1.0e6
/
&fluid compressibility = 4.4e-10, viscosity = 1.0e-4 /
{fractures}
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&side name = 'top', y_traction = -10.0e6 /
&injection fracture = 'f1', rate = {rate} /
&initial fracture_pressure = 'equilibrated' /
&time end = {end} /
&coarse size_fracture = 0.02, size_boundary = 0.1 /
&fine window = 0.1, size_ratio = 0.5 /
&growth enabled = .true., new_aperture = 1.0e-5 /
&output vtu = .false. /
"""

FRACTURE = (
    "&fracture name = '{name}', x = {x0:.6f}, {x1:.6f}, y = {y0:.6f}, {y1:.6f}, "
    "friction = 0.5, dilation_deg = 1.0, aperture = 1.0e-3 /"
)


@dataclass(frozen=True)
class Network:
    """What a network is drawn from."""

    number: int  # of fractures
    side: float  # of the square body [m]
    length: tuple[float, float]  # of fractures, shortest and longest [m]
    rate: float  # of the well [m2/s]
    end: float  # [s]


EIGHT = Network(8, 2.0, (0.2, 0.5), 2.0e-7, 150.0)
THIRTY = Network(30, 2.0, (0.15, 0.35), 2.0e-7, 100.0)
HUNDRED = Network(100, 3.65, (0.15, 0.35), 2.0e-7, 100.0)  # as many per area as thirty
CASE = [(EIGHT, range(1, 5)), (THIRTY, range(1, 11)), (HUNDRED, range(1, 2))]


def fractures(network: Network, seed: int) -> list[tuple[float, float, float, float]]:
    """Give the ends x0, y0, x1, y1 of the fractures."""
    draw = random.Random(seed)
    middle = 0.5 * network.side
    x0, y0, x1, y1 = (middle + place for place in WELL)
    found = [(x0, y0, x1, y1)]
    while len(found) < network.number:
        x, y = draw.uniform(0.0, network.side), draw.uniform(0.0, network.side)
        angle, half = draw.uniform(0.0, math.pi), 0.5 * draw.uniform(*network.length)
        across, up = half * math.cos(angle), half * math.sin(angle)
        ends = (x - across, y - up, x + across, y + up)
        if min(ends) >= MARGIN and max(ends) <= network.side - MARGIN:
            found.append(ends)
    return found


def scene_text(network: Network, seed: int) -> str:
    """Give the scene of a seed."""
    drawn = fractures(network, seed)
    names = [f"f{k + 1}" for k in range(network.number)]
    return SCENE.format(
        number=network.number,
        seed=seed,
        side=network.side,
        rate=network.rate,
        end=network.end,
        fractures="\n".join(
            FRACTURE.format(name=name, x0=x0, y0=y0, x1=x1, y1=y1)
            for name, (x0, y0, x1, y1) in zip(names, drawn, strict=True)
        ),
    )


def main() -> None:
    """Write the scenes."""
    parser = argparse.ArgumentParser(description="Write networks of random fractures.")
    parser.add_argument("--seeds", type=int, nargs="+", help="default: the scenes of the case")
    parser.add_argument("--number", type=int, default=THIRTY.number)
    parser.add_argument("--side", type=float, default=THIRTY.side)
    parser.add_argument("--length", type=float, nargs=2, default=THIRTY.length)
    parser.add_argument("--rate", type=float, default=THIRTY.rate)
    parser.add_argument("--end", type=float, default=THIRTY.end)
    parser.add_argument("--folder", type=Path, default=HERE)
    given = parser.parse_args()
    wanted = CASE
    if given.seeds is not None:
        shortest, longest = given.length
        network = Network(given.number, given.side, (shortest, longest), given.rate, given.end)
        wanted = [(network, given.seeds)]
    for network, seeds in wanted:
        for seed in seeds:
            path = given.folder / f"network_{network.number}_{seed}.nml"
            path.write_text(scene_text(network, seed), encoding="utf-8")


if __name__ == "__main__":
    main()
