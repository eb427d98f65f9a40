"""Calls of the packages for maps and scenes in a folder, and what they wrote."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import f90nml
import pytest

from wingcrack.command_line import main
from wingcrack.scenes.solver import SOLVER

TOP = Path(__file__).resolve().parents[3]
OUTCROP = TOP / "inputs" / "examples" / "outcrop.geojson"

needs_solver = pytest.mark.skipif(not SOLVER.exists(), reason="the solver is not built")


def feature(*places: tuple[float, float], **properties: object) -> dict[str, object]:
    """Give a line of a GeoJSON map."""
    geometry = {"type": "LineString", "coordinates": [list(place) for place in places]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def area(*places: tuple[float, float], **properties: object) -> dict[str, object]:
    """Give a polygon of a GeoJSON map."""
    ring = [list(place) for place in (*places, places[0])]
    geometry = {"type": "Polygon", "coordinates": [ring]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def geojson(path: Path, *features: dict[str, object], **more: object) -> Path:
    """Write a GeoJSON map."""
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features, **more}))
    return path


def imported(path: Path, *options: str) -> tuple[int, Path]:
    """Import a map beside itself; give the status and where the scene should be."""
    scene = path.with_suffix(".nml")
    return main(["import", str(path), "--out", str(scene), *options]), scene


def fractures(scene: Path) -> dict[str, dict[str, object]]:
    """Give the fractures of a scene by name, as another reader of namelists sees them."""
    group = f90nml.read(scene)["fracture"]
    return {item["name"]: dict(item) for item in (group if isinstance(group, list) else [group])}


def rows(scene: Path, status: str) -> list[tuple[str, str, str]]:
    """Give fault, fracture and other of the rows of a status."""
    with scene.with_suffix(".repairs.csv").open(newline="") as file:
        table = list(csv.DictReader(file))
    return [(r["fault"], r["fracture"], r["other"]) for r in table if r["status"] == status]
