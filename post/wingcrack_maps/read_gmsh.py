"""Maps from gmsh's .geo and .msh files, by their physical curves and surfaces."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import gmsh
import numpy as np
from shapely import coverage_union_all, unary_union
from shapely.geometry import LineString, MultiLineString, Polygon
from shapely.ops import linemerge

from wingcrack_maps.features import Area, Line, Map, Points
from wingcrack_scenes.errors import SceneError

_COMMANDS = re.compile(
    r"\b(NonBlocking)?System(Call)?\b|\b(Include|Merge|ShapeFromFile|OnelabRun|Plugin|Print|Save)\b"
    r"|\b(Parse|Eval|Call|Macro)\w*\b|\bPrintf\b"
)


def read_gmsh(path: Path) -> Map:
    """Read the physical groups of a file.

    Physical curves on the rim of all physical surfaces are sides of the body and left out with a
    note; the others are fractures. The outline of all physical surfaces is the body's, and each
    surface a region where there are several.
    """
    _refuse_commands(path)
    gmsh.initialize(["wingcrack"], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        return _read(path)
    except SceneError:
        raise
    except Exception as reason:  # gmsh's module raises nothing more special
        said = " ".join(gmsh.logger.getLastError().split()) or reason
        raise SceneError(f"{path}: gmsh cannot read it: {said}") from None
    finally:
        gmsh.finalize()


def _refuse_commands(path: Path) -> None:
    """Refuse a script that could start programs or read further files: a map is data."""
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as reason:
        raise SceneError(f"{path}: it cannot be read: {reason.strerror}") from None
    if path.suffix.lower() == ".msh":  # gmsh would take anything else for a script
        if not (lines and lines[0].strip() == "$MeshFormat"):
            raise SceneError(f"{path}: no mesh of gmsh, which begins with $MeshFormat")
        return
    for number, line in enumerate(lines, start=1):
        found = _COMMANDS.search(line)
        if found:
            raise SceneError(
                f"{path}:{number}: {found[0]} is not run in a map, which must hold geometry only;"
                " mesh it with gmsh yourself and import the .msh file"
            )


def _read(path: Path) -> Map:
    if gmsh.model.mesh.getNodes()[0].size == 0:
        gmsh.model.mesh.generate(2 if gmsh.model.getPhysicalGroups(2) else 1)
    found = Map()
    nodes = _nodes()
    surfaces = {name: _outline(tags, nodes) for name, tags in _groups(2)}
    rim = _add_areas(found, surfaces, path)
    for name, tags in _groups(1):
        pieces = [MultiLineString(list(_edges(tag, nodes))) for tag in tags]
        merged = linemerge([line for piece in pieces for line in piece.geoms])
        lines = list(merged.geoms) if hasattr(merged, "geoms") else [merged]
        if rim is not None and all(
            rim.contains(line.interpolate(0.5, normalized=True)) for line in lines
        ):
            found.note("left out", f"physical curve '{name}' lies on the rim: a side, no fracture")
            continue
        for number, line in enumerate(lines, start=1):
            label = name if len(lines) == 1 else f"{name}.{number}"
            points = _without_straight(np.array(line.coords))
            found.lines.append(Line(label, points, {}, f"physical curve '{name}'"))
    if not (found.lines or found.areas):
        raise SceneError(
            f"{path}: it has no physical curves or surfaces; name them in gmsh, as"
            ' Physical Curve("f1") = {5};'
        )
    return found


def _nodes() -> dict[int, tuple[float, float]]:
    tags, places, _ = gmsh.model.mesh.getNodes()
    table = np.asarray(places).reshape(-1, 3)
    return {int(tag): (float(x), float(y)) for tag, (x, y, _) in zip(tags, table, strict=True)}


def _groups(dimension: int) -> Iterator[tuple[str, list[int]]]:
    for _, tag in gmsh.model.getPhysicalGroups(dimension):
        entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        name = gmsh.model.getPhysicalName(dimension, tag)
        yield name or str(tag), [int(entity) for entity in entities]


def _edges(curve: int, nodes: dict[int, tuple[float, float]]) -> Iterator[LineString]:
    kinds, _, ends = gmsh.model.mesh.getElements(1, curve)
    for kind, tags in zip(kinds, ends, strict=True):
        per_edge = gmsh.model.mesh.getElementProperties(kind)[3]
        for first, second in np.asarray(tags).reshape(-1, per_edge)[:, :2]:
            yield LineString([nodes[int(first)], nodes[int(second)]])


def _outline(surfaces: list[int], nodes: dict[int, tuple[float, float]]) -> Polygon:
    """What the elements of meshed surfaces cover."""
    cells = []
    for surface in surfaces:
        kinds, _, corners = gmsh.model.mesh.getElements(2, surface)
        for kind, tags in zip(kinds, corners, strict=True):
            _, _, _, per_cell, _, primary = gmsh.model.mesh.getElementProperties(kind)
            for cell in np.asarray(tags).reshape(-1, per_cell)[:, :primary]:
                cells.append(Polygon([nodes[int(tag)] for tag in cell]))
    return coverage_union_all(cells)


def _add_areas(
    found: Map, surfaces: dict[str, Polygon], path: Path
) -> LineString | MultiLineString | None:
    """Add body and regions, and give the rim of the body."""
    if not surfaces:
        return None
    whole = unary_union(list(surfaces.values()))
    if whole.is_empty or not isinstance(whole, Polygon):
        raise SceneError(f"{path}: the physical surfaces must be one piece, which is the body")
    if whole.interiors:
        found.note("hole left out", "holes of the body are left out")
    corners = _without_straight(np.array(whole.exterior.coords))[:-1]
    found.areas.append(Area("body", corners, "boundary", {}, "physical surfaces"))
    # of regions that overlap the later one counts: one within another comes after it
    by_size = sorted(surfaces.items(), key=lambda item: -Polygon(item[1].envelope).area)
    for name, outline in by_size if len(surfaces) > 1 else ():
        for part in outline.geoms if hasattr(outline, "geoms") else (outline,):
            corners = _without_straight(np.array(part.exterior.coords))[:-1]
            source = f"physical surface '{name}'"
            found.areas.append(Area(name, corners, "region", {}, source))
    return whole.exterior.buffer(1e-9 * whole.length)


def _without_straight(points: Points) -> Points:
    """Leave out vertices on straight lines: nodes of the mesh that say nothing of the geometry."""
    is_closed = bool((points[0] == points[-1]).all())
    if is_closed:  # begin at a true corner
        ring = points[:-1]
        turn = _turns(np.roll(ring, 1, axis=0), ring, np.roll(ring, -1, axis=0))
        start = int(np.argmax(turn))
        points = np.vstack([np.roll(ring, -start, axis=0), ring[start]])
    turn = _turns(points[:-2], points[1:-1], points[2:])
    return np.asarray(points[np.concatenate([[True], turn > 1e-9, [True]])])


def _turns(before: Points, here: Points, after: Points) -> Points:
    """Sine of the angle by which a polyline turns [-]."""
    a, b = here - before, after - here
    sine = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return np.asarray(sine / (np.hypot(*a.T) * np.hypot(*b.T)))
