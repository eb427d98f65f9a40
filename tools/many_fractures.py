"""Print a scene with many fractures that do not touch, for measurements of cost.

    python tools/many_fractures.py --rows 10 --cells 30 >many.nml

Fractures of random angle and friction stand one to a square of the body; every fifth is fed.
Compression holds most of them, so that some cells stick, some slip, and fed ones may open.
"""

import argparse
import math
import random

HEADER = """\
! {count} fractures of {cells} cells each, written by tools/many_fractures.py with seed {seed}.

&scene name = 'many_{total}' /
&domain x_min = 0.0, x_max = {size}, y_min = 0.0, y_max = {size} /
&material young = 40.0e9, poisson = 0.2, biot = 0.8, porosity = 0.01, permeability = 5.0e-20 /
&fluid compressibility = 4.0e-10, viscosity = 1.0e-4 /
&side name = 'left', x_displacement = 0.0 /
&side name = 'bottom', y_displacement = 0.0 /
&side name = 'right', x_traction = -20.0e6 /
&side name = 'top', y_traction = -10.0e6 /
&initial fracture_pressure = 'equilibrated' /
&time end = {end}, step = {step} /
&coarse size_fracture = {near}, size_boundary = {far}{more} /
&growth enabled = .false. /
&output vtu = .false. /
"""

FRACTURE = (
    "&fracture name = 'f{number}', x = {x[0]:.6f}, {x[1]:.6f}, y = {y[0]:.6f}, {y[1]:.6f}, "
    "friction = {friction:.3f}, dilation_deg = 1.0, aperture = 1.0e-3 /"
)


def main() -> None:
    """Read what is asked for and print the scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=10, help="rows and columns of fractures")
    parser.add_argument("--cells", type=int, default=30, help="of a fracture")
    parser.add_argument("--far", type=float, default=4.0, help="largest over smallest cells")
    parser.add_argument("--steps", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--crossing", action="store_true", help="each is crossed by another one")
    parser.add_argument("--more", default="", help="more names of &coarse")
    asked = parser.parse_args()
    numbers = random.Random(asked.seed)
    length, step = 0.6, 600.0
    near = length / asked.cells
    per_square = 2 if asked.crossing else 1
    count = per_square * asked.rows**2
    print(
        HEADER.format(
            count=count,
            cells=asked.cells,
            seed=asked.seed,
            total=count * asked.cells,
            size=float(asked.rows),
            end=asked.steps * step,
            step=step,
            near=near,
            far=near * asked.far,
            more=f", {asked.more}" if asked.more else "",
        )
    )
    number = 0
    for row in range(asked.rows):
        for column in range(asked.rows):
            centre = [place + 0.5 + 0.15 * (numbers.random() - 0.5) for place in (column, row)]
            angle = math.pi * numbers.random()
            for turn in range(per_square):
                number += 1
                half = [0.5 * length * f(angle + 1.2 * turn) for f in (math.cos, math.sin)]
                print(
                    FRACTURE.format(
                        number=number,
                        x=[centre[0] - half[0], centre[0] + half[0]],
                        y=[centre[1] - half[1], centre[1] + half[1]],
                        friction=0.2 + 0.6 * numbers.random(),
                    )
                )
                if number % 5 == 1:
                    rate = 1.0e-7 * 10.0 ** numbers.uniform(-2.0, -0.5)
                    print(f"&injection fracture = 'f{number}', rate = {rate:.3e} /")


if __name__ == "__main__":
    main()
