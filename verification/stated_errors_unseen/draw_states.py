"""Scenes drawn by a seed: rocks, fractures, loads, wells and steps (for compare_states.py)."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from typing import Any

import numpy as np

Scene = dict[str, Any]


class Draw:
    """Random numbers with few digits."""

    def __init__(self, seed: str) -> None:
        """Start from a seed."""
        self.random = random.Random(seed)

    def among(self, *values: Any) -> Any:
        """Choose one."""
        return self.random.choice(values)

    def between(self, low: float, high: float) -> float:
        """Choose a number."""
        return float(f"{self.random.uniform(low, high):.3g}")

    def decades(self, low: float, high: float) -> float:
        """Choose a positive number by its logarithm."""
        return float(f"{math.exp(self.random.uniform(math.log(low), math.log(high))):.3g}")


def path(draw: Draw, centre: Sequence[float], length: float, bends: int) -> np.ndarray:
    """A fracture that turns by 10 to 60 degrees at each bend."""
    angle = draw.random.uniform(0.0, math.pi)
    points = [np.zeros(2)]
    for _ in range(bends + 1):
        along = np.array([math.cos(angle), math.sin(angle)])
        points.append(points[-1] + along * length / (bends + 1))
        angle += math.radians(draw.random.uniform(10.0, 60.0)) * draw.among(-1, 1)
    all_points = np.array(points)
    middle = 0.5 * (all_points.min(axis=0) + all_points.max(axis=0))
    placed: np.ndarray = np.round((all_points - middle + centre) / length, 4) * length
    return placed


def nearest(a: np.ndarray, b: np.ndarray) -> float:
    """Least distance of two polylines, sampled."""
    share = np.linspace(0.0, 1.0, 40)[:, None]
    first, second = (
        np.concatenate([p[i] + share * (p[i + 1] - p[i]) for i in range(len(p) - 1)])
        for p in (a, b)
    )
    return float(np.min(np.linalg.norm(first[:, None] - second[None], axis=2)))


def network(draw: Draw, n: int, length: float, bends: int) -> list[np.ndarray]:
    """Fractures that do not meet, near the middle of a body ten lengths wide."""
    paths: list[np.ndarray] = []
    while len(paths) < n:
        spread = 0.9 if n > 1 else 0.2
        centre = [draw.random.uniform(-spread, spread) * length for _ in range(2)]
        own = length * (draw.random.uniform(0.6, 1.2) if n > 1 else 1.0)
        new = path(draw, centre, float(f"{own:.3g}"), draw.random.randint(0, bends))
        if all(nearest(new, old) > 0.15 * length for old in paths):
            paths.append(new)
    return paths


def base(draw: Draw, length: float) -> tuple[Scene, tuple[float, float]]:
    """The body, its rock and its load."""
    w = 5.0 * length
    most, least = draw.between(12.0, 30.0) * 1e6, draw.between(6.0, 12.0) * 1e6
    scene: Scene = {
        "scene": {"name": "state"},
        "domain": {"x_min": -w, "x_max": w, "y_min": -w, "y_max": w},
        "material": {"young": draw.between(5.0, 60.0) * 1e9, "poisson": draw.between(0.1, 0.4)},
        "fracture": [],
        "side": [
            {"name": "left", "x_displacement": 0.0},
            {"name": "bottom", "y_displacement": 0.0},
            {"name": "right", "x_traction": -most},
            {"name": "top", "y_traction": -least},
        ],
        "probe": [],
        "output": {"vtu": False},
    }
    for i in range(2):
        place = [draw.between(-2.0, 2.0) * length for _ in range(2)]
        scene["probe"].append({"name": f"p{i + 1}", "x": place[0], "y": place[1]})
    return scene, (most, least)


def add_fractures(draw: Draw, scene: Scene, paths: list[np.ndarray], kind: str) -> None:
    """Fractures of one kind."""
    friction = draw.between(0.2, 0.7)
    joint = {}
    if kind == "joint":
        joint = {"normal_stiffness": draw.decades(3e9, 3e11), "closure": draw.decades(1e-5, 9e-5)}
    for i, p in enumerate(paths):
        scene["fracture"].append(
            {
                "name": f"f{i + 1}",
                "x": [float(f"{v:.6g}") for v in p[:, 0]],
                "y": [float(f"{v:.6g}") for v in p[:, 1]],
                "friction": friction,
                **joint,
            }
        )


def body(draw: Draw) -> Scene:
    """Without a fluid: sliding, opened, bent, joints, several fractures."""
    length = draw.among(0.1, 1.0, 10.0)
    scene, (most, least) = base(draw, length)
    kind = draw.among("slide", "slide", "open", "joint")
    n = draw.among(1, 1, 2, 3, 5)
    add_fractures(draw, scene, network(draw, n, length, 2), kind)
    for fracture in scene["fracture"]:
        share = draw.between(0.1, 0.8) if kind != "open" else draw.between(1.0, 1.6)
        fracture["face_pressure"] = float(f"{share * least:.3g}")
        if kind == "open":
            fracture["face_pressure"] = float(f"{most + 0.3 * share * least:.3g}")
    if kind == "open" and draw.among(True, False):
        scene["load"] = {"factors": [1.0, 0.4], "steps": 2}
    size = float(f"{length / draw.among(8, 10, 15, 20, 30):.3g}")
    scene["growth"] = {"intensities": True}
    scene["fe"] = {"size_fracture": size, "size_boundary": draw.among(0.5, 1.0) * length}
    return scene


def injected(draw: Draw) -> Scene:
    """With a fluid and without growth: wells and stages; slip of a part; joints."""
    length = draw.among(0.3, 1.0, 5.0, 20.0, 50.0)
    scene, (_, least) = base(draw, length)
    kind = draw.among("slide", "slide", "joint")
    n = draw.among(1, 1, 2, 3)
    add_fractures(draw, scene, network(draw, n, length, 1), kind)
    aperture = draw.decades(2e-5, 1e-3)
    for fracture in scene["fracture"]:
        fracture["aperture"] = aperture + fracture.get("closure", 0.0)
        fracture["dilation_deg"] = draw.among(0.0, 1.0, 3.0)
    fluid(draw, scene, least, draw.decades(1e-20, 1e-16))
    end = draw.decades(10.0, 1e5)
    start = scene["initial"]["pressure"]
    wells = []
    for i in range(draw.among(1, 1, 2) if n > 1 else 1):
        well: dict[str, Any] = {"fracture": f"f{i + 1}"}
        if draw.among(True, False):
            held = length**2 * (1e6 / scene["material"]["young"] + aperture / length * 4e-4)
            rate = float(f"{held / end * draw.decades(0.3, 10.0):.3g}")
            well["rate"] = rate
            if draw.among(True, False):
                well["time"], well["rate"] = [0.0, end / 2.0], [rate, rate * draw.between(-0.3, 2)]
        else:
            well["pressure"] = float(f"{start + draw.between(0.2, 1.3) * (least - start):.4g}")
        wells.append(well)
    scene["injection"] = wells
    scene["time"] = {"end": end, "tolerance": 0.01}
    if draw.among(True, False, False):
        scene["time"]["step"] = end / 20.0
    scene["growth"] = {"intensities": True}
    cells(draw, scene, length)
    return scene


def placed(draw: Draw) -> Scene:
    """Two or three wells at places of one fracture or of two that cross; cells coarse to fine."""
    length = draw.among(1.0, 10.0, 50.0)
    scene, (_, least) = base(draw, length)
    lines = []
    for angle in (draw.between(0.1, 1.4), draw.between(1.7, 3.0)):
        end = 0.5 * length * np.round([math.cos(angle), math.sin(angle)], 3)
        lines.append([-end, end])
    lines = lines[: draw.among(1, 1, 2)]
    add_fractures(draw, scene, [np.array(line) for line in lines], "slide")
    aperture = draw.decades(2e-5, 5e-4)
    for fracture in scene["fracture"]:
        fracture["aperture"] = aperture
    fluid(draw, scene, least, draw.decades(1e-20, 1e-16))
    end = draw.decades(100.0, 1e5)
    start = scene["initial"]["pressure"]
    drop = draw.decades(1e4, 2e6)
    rate = drop * aperture**3 / (12.0 * scene["fluid"]["viscosity"] * length)
    scene["injection"] = []
    for i in range(draw.among(2, 2, 3)):
        f = draw.among(*range(len(lines)))
        share = draw.between(0.02, 0.98)
        x, y = (float(f"{v:.6g}") for v in (1.0 - share) * lines[f][0] + share * lines[f][1])
        well = {"fracture": f"f{f + 1}", "x": x, "y": y}
        if i == 1 and draw.among(True, False):
            well["pressure"] = start
        else:
            well["rate"] = float(f"{rate * (1.0, -1.0, draw.between(-0.5, 0.5))[i]:.3g}")
        scene["injection"].append(well)
    scene["time"] = {"end": end, "tolerance": 0.01}
    scene["growth"] = {"intensities": True}
    cells(draw, scene, length)
    size = length / draw.among(2, 3, 5, 10, 10, 20)
    scene["coarse"]["size_fracture"] = size
    return scene


def fluid(draw: Draw, scene: Scene, least: float, permeability: float) -> None:
    """Fluid in fractures and rock."""
    porosity = draw.between(0.01, 0.1)
    scene["material"].update(
        {"biot": draw.between(0.4, 1.0), "porosity": porosity, "permeability": permeability}
    )
    scene["fluid"] = {"compressibility": 4.4e-10, "viscosity": draw.decades(1e-4, 1e-3)}
    scene["initial"] = {
        "fracture_pressure": "equilibrated",
        "pressure": float(f"{draw.between(0.1, 0.6) * least:.4g}"),
    }


def cells(draw: Draw, scene: Scene, length: float) -> None:
    """Cells and windows."""
    size = float(f"{length / draw.among(8, 10, 15, 20):.3g}")
    scene["coarse"] = {"size_fracture": size, "size_boundary": length}
    scene["fine"] = {"window": draw.among(5.0, 8.0) * size, "size_ratio": 0.5}


def growing(draw: Draw) -> Scene:
    """Wings that grow by a fraction of their fracture."""
    length = draw.among(0.3, 1.0, 5.0, 20.0)
    scene, (_, least) = base(draw, length)
    add_fractures(draw, scene, network(draw, draw.among(1, 1, 2), length, 1), "slide")
    aperture = draw.decades(5e-5, 1e-3)
    for fracture in scene["fracture"]:
        fracture["aperture"] = aperture
        fracture["dilation_deg"] = draw.among(0.0, 1.0)
    fluid(draw, scene, least, draw.decades(1e-20, 1e-17))
    toughness = float(f"{draw.decades(0.1, 1.0) * 2e6 * math.sqrt(length):.3g}")
    scene["material"]["toughness"] = toughness
    held = length**2 * (2e6 / scene["material"]["young"] + aperture / length * 4e-3)
    scene["injection"] = [{"fracture": "f1", "rate": float(f"{held / draw.decades(100, 1e4):.3g}")}]
    scene["time"] = {"end": 1e6, "tolerance": 0.01}
    cells(draw, scene, length)
    size = scene["coarse"]["size_fracture"]
    gain = float(f"{draw.between(0.1, 0.4) * length:.3g}")
    scene["growth"] = {"enabled": True, "stop_gain": gain, "increment": size / 2.0}
    return scene


def driven(draw: Draw) -> Scene:
    """Wings, some in hot rock, at faults that weaken, or next to a stiff region."""
    scene = growing(draw)
    material = scene["material"]
    if draw.among(True, False):
        del scene["growth"]["increment"]
    if draw.among(True, False, False):
        material.update({"heat_capacity": 2.2e6, "heat_conductivity": 2.6})
        material["heat_expansion"] = draw.among(1e-5, 2.4e-5)
        scene["fluid"]["heat_capacity"] = 4.2e6
        scene["heat"] = {"temperature": 400.0}
        scene["injection"][0]["temperature"] = draw.among(380.0, 350.0)
    if draw.among(True, False, False):
        for fracture in scene["fracture"]:
            fracture["friction_residual"] = 0.6 * fracture["friction"]
            fracture["weakening_slip"] = draw.decades(1e-4, 3e-3)
    if draw.among(True, False, False):
        w = scene["domain"]["x_max"]
        stiff = {"young": 2.0 * material["young"], "poisson": material["poisson"]}
        stiff["toughness"] = material["toughness"] * draw.among(0.5, 2.0)
        outline = {"x": [0.05 * w, 0.6 * w, 0.6 * w, 0.05 * w], "y": [-w / 2, -w / 2, w / 2, w / 2]}
        scene["region"] = [{"name": "stiff", **outline, **stiff}]
    return scene


FAMILIES = {"body": body, "injected": injected, "placed": placed, "growing": growing}
