"""Run the independent model of scene C2 and write what the case compares with.

    python verification/wing_crack_c2/make_reference.py               # independent.csv, minutes
    python verification/wing_crack_c2/make_reference.py --table       # the convergence table
    python verification/wing_crack_c2/make_reference.py --body plane  # infinite plane, to stdout

It reads the scene and nothing else: no result of the program.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any, TextIO

import f90nml
import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from independent.geometry import Resolution  # noqa: E402
from independent.growth import grow  # noqa: E402
from independent.images import Supports  # noqa: E402
from independent.poroelastic import Rock  # noqa: E402
from independent.simulation import Scene, Simulation, State  # noqa: E402

SCENE = HERE / "../../inputs/paper_c/wing_crack.nml"
BODIES: dict[str, Supports] = {"plane": "none", "tractions": "tractions", "rollers": "rollers"}
COLUMNS = ["time_s", "fracture_length_m", "well_pressure_pa", "keq_pa_sqrtm", "k2_pa_sqrtm"]
COLUMNS += ["back_stress_pa", "direction_deg", "opening_volume_m2"]
REFERENCE = Resolution(
    fracture_cells=12,
    levels=10,
    tip_elements=4,
    first_piece=0.5e-3,
    largest_piece=5.0e-3,
    piece_growth=1.2,
    first_step=0.5,
    step_growth=1.14,
    side_cells=14,
)
COARSE = Resolution()
COARSEST = replace(COARSE, first_piece=2.0e-3, largest_piece=20.0e-3, piece_growth=1.56)
VARIANTS = {
    "a: pieces to 20 mm, else as b": COARSEST,
    "b: pieces to 10 mm, all else coarser too": COARSE,
    "c: reference, pieces to 5 mm": REFERENCE,
    "b, steps before the onset twice as long": replace(COARSE, first_step=2.0, step_growth=1.69),
    "b, 4 cells on half the fracture": replace(COARSE, fracture_cells=4),
    "b, coarser elements at kink and tip": replace(COARSE, levels=6, tip_elements=2),
    "b, 5 cells on a side of the body": replace(COARSE, side_cells=5),
    "b, pore pressure and stress uncoupled": COARSE,
}


def read_scene(path: Path, supports: Supports) -> Scene:
    """Scene of the model from a scene file of one straight fracture in a square."""
    groups: dict[str, Any] = f90nml.read(path)
    material, fluid, fracture = groups["material"], groups["fluid"], groups["fracture"]
    domain, sides = groups["domain"], {side["name"]: side for side in groups["side"]}
    ends = np.array(fracture["x"]) + 1j * np.array(fracture["y"])
    if abs(domain["x_max"] - domain["x_min"] - domain["y_max"] + domain["y_min"]) > 1e-9:
        raise ValueError(f"{path}: the body must be a square")
    middle = 0.5 * (domain["x_min"] + domain["x_max"] + 1j * (domain["y_min"] + domain["y_max"]))
    if abs(ends.mean() - middle) > 1e-9:
        raise ValueError(f"{path}: the fracture must lie in the middle of the body")
    return Scene(
        rock=Rock(
            material["young"],
            material["poisson"],
            material["biot"],
            material["porosity"],
            material["permeability"],
            fluid["compressibility"],
            fluid["viscosity"],
        ),
        toughness=material["toughness"],
        stress_xx=sides["right"]["x_traction"],
        stress_yy=sides["top"]["y_traction"],
        half_length=float(abs(ends[1] - ends[0]) / 2.0),
        angle=float(np.angle(ends[1] - ends[0])),
        aperture=fracture["aperture"],
        friction=fracture["friction"],
        dilation=float(np.tan(np.radians(fracture["dilation_deg"]))),
        rate=groups["injection"]["rate"],
        gain=groups["growth"]["stop_gain"],
        supports=supports,
        half_width=0.5 * (domain["x_max"] - domain["x_min"]),
    )


def run(scene: Scene, resolution: Resolution, coupled: bool = True) -> Simulation:
    """March to the end, with a line to stderr per step."""
    simulation = Simulation(scene, resolution, coupled)

    def report(state: State) -> None:
        print(
            f"{state.time:9.1f} s  {state.pressure / 1e6:7.4f} MPa",
            f"wing {state.geometry.wing:.5f} m",
            file=sys.stderr,
        )

    grow(simulation, report)
    return simulation


def write(simulation: Simulation, file: TextIO) -> None:
    """Write a row per state."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(COLUMNS)
    half_length = simulation.scene.half_length
    for state in simulation.states:
        values = [
            state.time,
            2.0 * (half_length + state.geometry.wing),
            state.pressure,
            state.equivalent,
            state.k2,
            state.back_stress,
            float(np.degrees(state.geometry.angle[-1])),
            2.0 * state.volume,
        ]
        writer.writerow([f"{value:.8g}" for value in values])


def onset(simulation: Simulation) -> float:
    """Time at which growth begins [s]."""
    return [state.time for state in simulation.states if state.geometry.wing == 0.0][-1]


def print_table(scene: Scene, only: str) -> None:
    """Print what the resolution does to the results, as a table of README.md."""
    print("| setting | onset [s] | highest pressure [MPa] | length at 10, 20, 25 h [m] |", end=" ")
    print("gain of 0.25 m [h] | CPU [s] |\n|---|---|---|---|---|---|")
    for name, resolution in VARIANTS.items():
        if not name.startswith(only):
            continue
        start = time.process_time()
        simulation = run(scene, resolution, coupled="uncoupled" not in name)
        times = [state.time for state in simulation.states]
        lengths = [2.0 * (scene.half_length + state.geometry.wing) for state in simulation.states]
        at = np.interp(np.array([10.0, 20.0, 25.0]) * 3600.0, times, lengths)
        highest = max(state.pressure for state in simulation.states)
        print(
            f"| {name} | {onset(simulation):.2f} | {highest / 1e6:.4f} |",
            ", ".join(f"{length:.4f}" for length in at),
            f"| {times[-1] / 3600.0:.3f} | {time.process_time() - start:.0f} |",
            flush=True,
        )


def main() -> None:
    """Read the command line and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--scene", type=Path, default=SCENE, help="scene file")
    parser.add_argument("--body", choices=BODIES, default="rollers", help="how the body is held")
    parser.add_argument("--table", action="store_true", help="print the convergence table")
    parser.add_argument("--only", default="", help="rows of the table that begin so")
    arguments = parser.parse_args()
    scene = read_scene(arguments.scene, BODIES[arguments.body])
    if arguments.table:
        print_table(scene, arguments.only)
    elif arguments.body == "rollers" and arguments.scene == SCENE:
        simulation = run(scene, REFERENCE)
        with (HERE / "independent.csv").open("w", encoding="ascii") as file:
            write(simulation, file)
    else:
        write(run(scene, REFERENCE), sys.stdout)


if __name__ == "__main__":
    main()
