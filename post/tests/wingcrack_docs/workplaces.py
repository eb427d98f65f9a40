"""A folder like that of the sources, where commands of the pages may write."""

from __future__ import annotations

import json
from pathlib import Path

from documents import TOP
from wingcrack.scenes import solver

_TRACES = (((0.0, 0.0), (9.0, 6.0)), ((2.0, 7.0), (8.0, 0.0)))  # [m] from the origin
_MAP = {
    "type": "FeatureCollection",
    "crs": {"type": "name", "properties": {"name": "EPSG:25832"}},
    "features": [
        {
            "type": "Feature",
            "properties": {},
            "geometry": {"type": "LineString", "coordinates": trace},
        }
        for trace in _TRACES
    ],
}


def make_workplace(place: Path) -> Path:
    """Put the shipped scenes and the run of C1 that pages speak of into a folder; return it."""
    for name in ("inputs", "packaging", "verification"):
        (place / name).symlink_to(TOP / name)
    (place / "map.geojson").write_text(json.dumps(_MAP))
    (place / "record.csv").write_text("")
    for run in ("onset", "wing_crack", "outcrop", "dfit"):
        (place / "out" / run).mkdir(parents=True)
    scene = TOP / "inputs" / "paper_c" / "onset.nml"
    done = solver.call("run", scene, "--out", place / "out" / "onset", "--quiet")
    assert done.returncode == 0, done.stderr
    return place
