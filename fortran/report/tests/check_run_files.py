"""Read what test_report_run wrote with a reader that shares nothing with the writer.

Only the standard library is needed.

Usage: python check_run_files.py RUN_DIRECTORY
"""

from __future__ import annotations

import csv
import json
import re
import struct
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

FORMATS = {"Float64": "d", "Int32": "i", "UInt8": "B"}
RUN_KEYS = {
    "scene", "version", "status", "reason", "steps", "cells", "dofs", "used", "left_out",
    "timers_s", "cpu_s", "wall_s", "peak_memory_mb", "mass_error_relative", "contact_residual",
    "newton_iterations", "step_cuts", "warnings",
}  # fmt: skip


def read_vtu(path: Path) -> dict[str, tuple[float, ...]]:
    """Arrays of a VTU file with raw appended data, by name."""
    head, raw = path.read_bytes().split(b'<AppendedData encoding="raw">', 1)
    raw = raw[raw.index(b"_") + 1 :]
    order = "<" if b'byte_order="LittleEndian"' in head else ">"
    arrays = {}
    end = 0
    for tag in re.findall(r'<DataArray [^>]*format="appended"[^>/]*', head.decode()):
        attributes = ElementTree.fromstring(tag + "/>").attrib
        offset = int(attributes["offset"])
        assert offset == end, f"{path}: {attributes['Name']} does not follow the array before it"
        (n_bytes,) = struct.unpack_from(order + "Q", raw, offset)
        code = FORMATS[attributes["type"]]
        count = n_bytes // struct.calcsize(code)
        arrays[attributes["Name"]] = struct.unpack_from(f"{order}{count}{code}", raw, offset + 8)
        end = offset + 8 + n_bytes
    assert raw[end:].split() == [b"</AppendedData>", b"</VTKFile>"], f"{path}: bad end"
    ElementTree.fromstring(head.decode() + "</VTKFile>")
    return arrays


def read_collection(path: Path) -> list[dict[str, tuple[float, ...]]]:
    """Arrays of all files of a PVD collection."""
    sets = ElementTree.parse(path).getroot().iter("DataSet")
    return [read_vtu(path.parent / item.attrib["file"]) for item in sets]


def check(directory: Path) -> None:
    """Assert that the files say what test_report_run put in."""
    assert not list(directory.rglob("*.part")), "something is left aside"

    run = json.loads((directory / "run.json").read_text(encoding="utf-8"))
    assert run.keys() >= RUN_KEYS, RUN_KEYS - run.keys()
    assert set(run["timers_s"]) == {
        "mesh", "discretize", "assemble", "factorize", "solve", "contact", "tips", "remesh",
        "transfer", "output",
    }  # fmt: skip
    assert set(run["newton_iterations"]) == {"total", "max"}

    network = json.loads((directory / "network.json").read_text(encoding="utf-8"))
    assert [f["name"] for f in network["fractures"]] == ["main", "side"]
    assert [(j["kind"], j["fractures"]) for j in network["joints"]] == [
        ("boundary", [1]),
        ("T", [1, 2]),
    ]
    assert [step["time_s"] for step in network["steps"]] == [0.0]

    for name in ("history", "tips", "fractures", "probes", "events"):
        with (directory / f"{name}.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        assert len(rows) > 1 and len({len(row) for row in rows}) == 1, f"{name}.csv is ragged"

    matrix = read_collection(directory / "matrix.pvd")
    assert len(matrix) == 2
    assert matrix[1]["types"] == (5, 5, 5, 5)
    assert matrix[1]["connectivity"] == (0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7)
    assert matrix[1]["pressure"] == (6.0e6, 6.1e6, 6.2e6, 1.0e7 / 3.0)
    assert matrix[1]["displacement"][:3] == (0.1 * 1.0e-3, 0.2 * 1.0e-3, 0.0)
    xx, yy, zz, xy, yz, xz = matrix[1]["stress"][:6]
    assert (xx, yy, xy, yz, xz) == (-1.0e7, -2.0e7, 5.0e5, 0.0, 0.0)
    # Plane strain: the strain along z, (zz' - nu (xx' + yy'))/E with effective stresses, is zero.
    effective = [stress + 0.8 * 6.0e6 for stress in (xx, yy, zz)]
    assert abs(effective[2] - 0.2 * (effective[0] + effective[1])) <= 1.0e-8
    assert matrix[1]["permeability"][:6] == (1.0e-18, 2.0e-18, 0.0, 0.0, 0.0, 0.0)

    fractures = read_collection(directory / "fractures.pvd")
    assert fractures[0]["types"] == (3, 3, 3)
    assert fractures[0]["connectivity"] == (0, 1, 1, 2, 3, 1)
    assert fractures[0]["fracture"] == (1, 1, 2)
    assert fractures[0]["state"] == (0, 1, 2)
    assert fractures[0]["arc_length"] == (0.25, 0.75, 0.125)
    assert fractures[0]["jump"] == (0.0, 0.0, 1.0e-4, -2.0e-3, 1.0e-3, 0.0)
    assert fractures[0]["traction"] == (-1.0e7, 1.0e6, -5.0e6, 3.0e6, 0.0, 0.0)
    assert fractures[0]["aperture"] == (1.0e-3, 1.1e-3, 2.0e-3)

    intersections = read_collection(directory / "intersections.pvd")
    assert intersections[0]["types"] == (1,)
    assert intersections[0]["Points"] == (0.5, 0.5, 0.0)
    assert intersections[0]["pressure"] == (6.75e6,)


if __name__ == "__main__":
    check(Path(sys.argv[1]))
