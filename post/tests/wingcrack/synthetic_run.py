"""A synthetic run directory with known numbers, in the format of the contract.

Nothing here is a solution of the model: fields are closed formulas, so that tests know every
value. One fracture of 0.1 m at 45 degrees in a 2 m square grows wings towards the x direction from
the middle of the run on; it sticks, then slips, and opens in its middle.
"""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

BODY = 2.0  # [m]
LENGTH = 0.1  # [m], before growth
FRICTION = 0.5
TOUGHNESS = 0.7e6  # [Pa m^1/2]
STEPS = 13
HOUR = 3600.0
GROWTH_STEP = 5  # the first step with a wing: growth began at the end of the step before
LAST_WING = 0.12  # [m]
STATES = ("stick", "slip", "open")


@dataclass(frozen=True)
class Cells:
    """Fracture cells at one step; s is the arc length from the present start of the fracture."""

    ends: FloatArray
    s: FloatArray
    centre: FloatArray
    jump_n: FloatArray
    jump_t: FloatArray
    traction_n: FloatArray
    traction_t: FloatArray
    pressure: FloatArray
    state: npt.NDArray[np.int64]


def times() -> FloatArray:
    """Times of all steps [s]."""
    return np.arange(1.0, STEPS + 1.0) * 5.0 * HOUR


def wing_length(step: int) -> float:
    """Length of each of the two wings [m]: none, then growing with the square of the time."""
    share = (step - GROWTH_STEP + 1) / (STEPS - GROWTH_STEP)
    return LAST_WING * max(0.0, share) ** 2


def well_pressure(step: int) -> float:
    """Pressure at the well [Pa]."""
    return 7.0e6 + 0.5e6 * step


def polyline(step: int) -> FloatArray:
    """Vertices of the fracture, wings included [m]."""
    half = LENGTH / 2 / np.sqrt(2.0)
    old = BODY / 2 + np.array([[-half, -half], [half, half]])
    wing = wing_length(step)
    if wing == 0.0:
        return old
    angle = np.deg2rad(-15.0)
    offset = wing * np.array([np.cos(angle), np.sin(angle)])
    return np.vstack((old[0] - offset, old, old[1] + offset))


def fracture_cells(step: int, size: float = 0.01) -> Cells:
    """Fields along the fracture by closed formulas."""
    vertices = polyline(step)
    ends = []
    for start, end in itertools.pairwise(vertices):
        count = max(1, round(float(np.linalg.norm(end - start)) / size))
        nodes = start + np.linspace(0.0, 1.0, count + 1)[:, None] * (end - start)
        ends += list(itertools.pairwise(nodes))
    segments = np.array(ends)
    lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    s = np.cumsum(lengths) - lengths / 2
    total = float(lengths.sum())
    bell = np.maximum(0.0, 1.0 - (2.0 * s / total - 1.0) ** 2)
    load = step / (STEPS - 1)
    opened = bell > 1.3 - 0.8 * load
    slipped = bell > 0.7 - load
    traction_n = np.where(opened, 0.0, -8.0e6 * (1.0 - 0.8 * load * bell))
    bound = -FRICTION * traction_n
    return Cells(
        ends=segments,
        s=s,
        centre=segments.mean(axis=1),
        jump_n=np.where(opened, 4.0e-5 * load * bell, 0.0),
        jump_t=np.where(slipped, -1.2e-4 * load * bell, 0.0),
        traction_n=traction_n,
        traction_t=np.where(slipped, -bound, -0.7 * bound),
        pressure=np.full(s.size, well_pressure(step)),
        state=np.where(opened, 2, np.where(slipped, 1, 0)),
    )


def square(cells: int) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    """Triangles of a square, finer towards its middle."""
    line = np.linspace(-1.0, 1.0, cells + 1)
    line = BODY / 2 * (1.0 + 0.15 * line + 0.85 * line**3)
    x, y = np.meshgrid(line, line)
    corner = np.arange(cells * (cells + 1)).reshape(cells, cells + 1)[:, :-1].ravel()
    first = np.column_stack((corner, corner + 1, corner + cells + 2))
    second = np.column_stack((corner, corner + cells + 2, corner + cells + 1))
    points = np.column_stack((x.ravel(), y.ravel(), np.zeros(x.size)))
    return points, np.concatenate((first, second))


def matrix_pressure(step: int, centres: FloatArray) -> FloatArray:
    """Pore pressure [Pa]: falls off with the distance from the fracture."""
    vertices = polyline(step)
    distance = np.full(len(centres), np.inf)
    for start, end in itertools.pairwise(vertices):
        edge = end - start
        share = np.clip((centres - start) @ edge / (edge @ edge), 0.0, 1.0)
        foot = start + share[:, None] * edge
        distance = np.minimum(distance, np.linalg.norm(centres - foot, axis=1))
    reach = 0.01 + 0.004 * step
    return 6.8e6 + (well_pressure(step) - 6.8e6) * np.exp(-distance / reach)


def _write_csv(path: Path, columns: dict[str, list[object]]) -> None:
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(map(str, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _history(fluid: bool) -> dict[str, list[object]]:
    columns: dict[str, list[object]] = {
        "time_s": list(times()),
        "dt_s": [5.0 * HOUR] * STEPS,
        "newton_iterations": [4] * STEPS,
    }
    if fluid:
        injected = 5.0e-9 * times()
        columns |= {
            "well_pressure_pa": [well_pressure(step) for step in range(STEPS)],
            "injected_m2": list(injected),
            "leakoff_m2": list(0.6 * injected),
            "prefilled_m2": [0.0] * STEPS,
            "outflow_m2": [0.0] * STEPS,
        }
        columns["fracture_volume_m2"] = list(1.0e-4 + 0.4 * injected)
        columns["mass_error_relative"] = [0.0, *[1.0e-13] * (STEPS - 1)]
    cells = [fracture_cells(step) for step in range(STEPS)]
    columns["max_slip_m"] = [float(np.abs(c.jump_t).max()) for c in cells]
    columns["max_opening_m"] = [float(c.jump_n.max()) for c in cells]
    for number, state in enumerate(STATES):
        columns[f"n_{state}"] = [int(np.sum(c.state == number)) for c in cells]
    columns["fracture_length_m"] = [LENGTH + 2.0 * wing_length(step) for step in range(STEPS)]
    columns["n_tips"] = [2] * STEPS
    columns["n_intersections"] = [0] * STEPS
    columns["seismic_moment_nm"] = [1.0e3 * step for step in range(STEPS)]
    return columns


def _tips() -> dict[str, list[object]]:
    names = [
        "time_s",
        "tip",
        "fracture",
        "x_m",
        "y_m",
        "k1_pa_sqrtm",
        "k2_pa_sqrtm",
        "k1_dc_pa_sqrtm",
        "k2_dc_pa_sqrtm",
        "keq_pa_sqrtm",
        "g_j_m2",
        "angle_deg",
        "advance_m",
    ]
    columns: dict[str, list[object]] = {name: [] for name in names}
    for step, time in enumerate(times()):
        for tip in (1, 2):
            vertices = polyline(step)
            x, y = vertices[-1] if tip == 2 else vertices[0]
            k2 = 0.38e6 + 0.03e6 * min(step, GROWTH_STEP) - 0.08e6 * max(0, step - GROWTH_STEP)
            k1 = 0.02e6 * step + (0.35e6 if step > GROWTH_STEP else 0.0) + 0.01e6 * tip
            values = (
                time,
                tip,
                1,
                x,
                y,
                k1,
                k2,
                1.02 * k1,
                0.98 * k2,
                k1 + 0.5 * abs(k2),
                5.0,
                -65.0,
                0.01,
            )
            for name, value in zip(names, values, strict=True):
                columns[name].append(value)
    return columns


def _fractures(fluid: bool) -> dict[str, list[object]]:
    columns: dict[str, list[object]] = {
        name: [] for name in ("time_s", "fracture", "s_m", "x_m", "y_m")
    }
    jumps = ["aperture_m"] if fluid else []
    for name in (*jumps, "jump_n_m", "jump_t_m", "traction_n_pa", "traction_t_pa"):
        columns[name] = []
    if fluid:
        columns["pressure_pa"] = []
    columns["state"] = []
    for step, time in enumerate(times()):
        cells = fracture_cells(step)
        values: dict[str, list[object]] = {
            "time_s": [time] * cells.s.size,
            "fracture": [1] * cells.s.size,
            "s_m": list(cells.s),
            "x_m": list(cells.centre[:, 0]),
            "y_m": list(cells.centre[:, 1]),
            "aperture_m": list(1.0e-3 + cells.jump_n),
            "jump_n_m": list(cells.jump_n),
            "jump_t_m": list(cells.jump_t),
            "traction_n_pa": list(cells.traction_n),
            "traction_t_pa": list(cells.traction_t),
            "pressure_pa": list(cells.pressure),
            "state": [STATES[number] for number in cells.state],
        }
        for name, column in columns.items():
            column += values[name]
    return columns


def _probes(fluid: bool) -> dict[str, list[object]]:
    columns: dict[str, list[object]] = {"time_s": list(times())}
    steps = np.arange(STEPS)
    for index, name in enumerate(("c", "d")):
        if fluid:
            columns[f"{name}_p_pa"] = list(6.8e6 + (1 + index) * 0.05e6 * steps)
        columns[f"{name}_ux_m"] = list(-(6.3e-4 - 2.0e-6 * steps) * (1 + index) / 2)
        columns[f"{name}_uy_m"] = list(1.0e-4 * (1 + index) + 1.0e-6 * steps)
        columns[f"{name}_sxx_pa"] = list(-20.0e6 + 0.01e6 * steps)
        columns[f"{name}_syy_pa"] = list(-10.0e6 + 0.02e6 * steps)
        columns[f"{name}_sxy_pa"] = list(0.05e6 * steps * (1 + index))
    return columns


def _write_fields(root: Path, cells_per_side: int, fluid: bool) -> None:
    import pyvista

    points, triangles = square(cells_per_side)
    centres = points[triangles].mean(axis=1)
    entries: dict[str, list[str]] = {"matrix": [], "fractures": []}
    for step, time in enumerate(times()):
        mesh = pyvista.UnstructuredGrid({pyvista.CellType.TRIANGLE: triangles}, points)
        strain = np.array([-4.0e-4, -1.0e-4, 0.0])
        mesh.cell_data["displacement"] = centres * strain
        mesh.cell_data["stress"] = np.tile([-20e6, -10e6, -6e6, 0.0, 0.0, 0.0], (len(centres), 1))
        if fluid:
            mesh.cell_data["pressure"] = matrix_pressure(step, centres[:, :2])
            mesh.cell_data["permeability"] = np.tile(
                [5e-20, 5e-20, 0.0, 0.0, 0.0, 0.0], (len(centres), 1)
            )
        cells = fracture_cells(step)
        ends = np.column_stack((cells.ends.reshape(-1, 2), np.zeros(2 * len(cells.ends))))
        lines = np.arange(len(ends)).reshape(-1, 2)
        fractures = pyvista.UnstructuredGrid({pyvista.CellType.LINE: lines}, ends)
        data = {
            "fracture": np.ones(len(lines), dtype=int),
            "jump": np.column_stack((cells.jump_n, cells.jump_t)),
            "traction": np.column_stack((cells.traction_n, cells.traction_t)),
            "state": cells.state,
            "arc_length": cells.s,
        }
        if fluid:
            data |= {"aperture": 1.0e-3 + cells.jump_n, "pressure": cells.pressure}
        for name, values in data.items():
            fractures.cell_data[name] = values
        for name, grid in (("matrix", mesh), ("fractures", fractures)):
            file = f"{name}_{step:04d}.vtu"
            save_raw(grid, root / file)
            entries[name].append(f'<DataSet timestep="{time}" part="0" file="{file}"/>')
    for name, lines_of_file in entries.items():
        (root / f"{name}.pvd").write_text(
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
            + "\n".join(lines_of_file)
            + "\n</Collection>\n</VTKFile>\n",
            encoding="utf-8",
        )


def save_raw(grid: Any, path: Path) -> None:
    """Let VTK write a grid in the layout that a run has: raw appended arrays, sizes as UInt64."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.SetEncodeAppendedData(False)
    writer.SetCompressorTypeToNone()
    writer.SetHeaderTypeToUInt64()
    writer.Write()


def write_run(root: Path, *, cells_per_side: int = 12, fluid: bool = True) -> Path:
    """Write a finished run into a new directory and return it."""
    root.mkdir(parents=True)
    _write_csv(root / "history.csv", _history(fluid))
    _write_csv(root / "tips.csv", _tips())
    _write_csv(root / "fractures.csv", _fractures(fluid))
    _write_csv(root / "probes.csv", _probes(fluid))
    (root / "events.csv").write_text(
        "time_s,kind,fracture,x_m,y_m,detail\n"
        f'{times()[GROWTH_STEP - 1]},growth,1,1.0,1.0,"tip 1, 1 mm"\n',
        encoding="utf-8",
    )
    (root / "scene.nml").write_text(
        "! the scene as understood\n"
        "&scene\n  name = 'synthetic', title = 'one fracture / two wings'\n/\n"
        f"&material young = 4.0E+10, poisson = 0.2, toughness = {TOUGHNESS} /\n"
        f"&fracture\n  name = 'flaw'\n  x = 0.9646, 1.0354\n  y(1:2) = 0.9646, 1.0354\n"
        f"  friction = {FRICTION} ! mu_s\n/\n",
        encoding="utf-8",
    )
    record = {"scene": "synthetic", "version": "0.1.0", "status": "finished", "steps": STEPS}
    (root / "run.json").write_text(json.dumps(record), encoding="utf-8")
    x, y = polyline(STEPS - 1).T.tolist()
    network = {"fractures": [{"fracture": 1, "name": "flaw", "x_m": x, "y_m": y}]}
    (root / "network.json").write_text(json.dumps(network), encoding="utf-8")
    _write_fields(root, cells_per_side, fluid)
    return root
