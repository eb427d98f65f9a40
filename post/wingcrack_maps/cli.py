"""`wingcrack import`: scenes of fracture maps and of random networks."""

from __future__ import annotations

import json
import os
import signal
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import NoReturn

import shapely
from shapely.geometry import LineString, Polygon

from wingcrack.scenes.errors import SceneError
from wingcrack.scenes.parameters import groups
from wingcrack.scenes.solver import call, check
from wingcrack_maps.base import Base, read_base
from wingcrack_maps.body import assign_roles, boundary_of, rectangle_around
from wingcrack_maps.contacts import weld
from wingcrack_maps.entries import complete, entry_values, give_names, set_regions, setting
from wingcrack_maps.faults import SAME, Limits, extent, find_faults
from wingcrack_maps.features import Map
from wingcrack_maps.random_network import Set, random_network
from wingcrack_maps.read import read_map
from wingcrack_maps.repair import Repair, repair
from wingcrack_maps.report import Report, file_texts, terminal_text
from wingcrack_maps.scene_text import FRACTURE_DEFAULTS, Network, cell_sizes, scene_text
from wingcrack_maps.units import shift


def make_scene(given: SimpleNamespace) -> int:
    """Write the scene; give the exit status: 0 done, 2 bad input, 3 lacking solver."""
    signal.signal(signal.SIGTERM, _end)
    try:
        content, path = _content(given)
        report = _make(given, content, path)
    except SceneError as reason:
        print(f"wingcrack import: {reason}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("wingcrack import: interrupted; nothing was written", file=sys.stderr)
        return 130
    left = report.number("left")
    if left and given.repair is None:
        print(f"{left} faults remain; --repair DISTANCE repairs them.")
    print(f"{given.out} is written, and with {given.out.stem}.repairs.csv and .json what was done.")
    return 0


def _end(number: int, frame: object) -> NoReturn:
    """End on SIGTERM in a way that tidies up."""
    sys.exit(128 + number)


def _tell(done: int, left: int) -> None:
    """Say how far a long repair is, on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{done} repairs, {left} faults left  ", end="", file=sys.stderr, flush=True)
        if left == 0:
            print(file=sys.stderr)


def _content(given: SimpleNamespace) -> tuple[Map, str]:
    """Give what there is to be written, and where it comes from."""
    if given.map is None:
        laws = zip(given.density, given.length, given.orientation, strict=True)
        sets = [Set(*three) for three in laws]
        network = random_network(sets, given.box, given.seed, given.distance, given.crossings)
        return network, f"a random network with seed {given.seed}"
    content = read_map(given.map, given.unit, given.crs, given.layer)
    if given.origin is not None:
        shift(content, given.origin)
    assign_roles(content, given.polygons, str(given.map))
    return content, str(given.map)


def _make(given: SimpleNamespace, content: Map, path: str) -> Report:
    """Examine, repair, write; give what is told of it."""
    base = read_base(given.scene)
    if given.growth and base is not None and "growth" in base.groups:
        raise SceneError(
            f"{given.scene} has a group &growth; set enabled = .true. there, and leave out --growth"
        )
    if not content.lines:
        raise SceneError(f"{path}: it has no lines, so no fractures")
    _leave_out(given, content, path)
    if extent(content.lines) == 0.0:
        raise SceneError(f"{path}: all its lines lie at one place and have no length")
    give_names(content, base.names if base is not None else set())
    set_regions(given.region, content)
    _add_entries(given, content, path, base)
    body = _body(given, content, base)
    if base is None:
        content.note("assumed", "rock, fluid, stress, well and time are ours: change them to yours")
    limits = _limits(given, content)
    read = len(content.lines)
    total = sum(line.length for line in content.lines)
    _weld(content, body, limits)
    found = find_faults(content.lines, body, limits)
    report = Report(path, limits.near, limits.angle_deg)
    repairs: list[Repair] = []
    if given.repair is not None:
        content.lines, repairs = repair(content.lines, body, limits, given.ends, _tell)
        if not content.lines:
            raise SceneError(f"{path}: with --repair {given.repair:g} no fracture would be left")
        _weld(content, body, limits)
    left = find_faults(content.lines, body, limits)
    report.counts = {
        "fractures read": read,
        "fractures written": len(content.lines),
        "length read (m)": float(f"{total:.6g}"),
        "length written (m)": float(f"{sum(line.length for line in content.lines):.6g}"),
        "regions": sum(area.role == "region" for area in content.areas),
        "near (m)": float(f"{limits.near:.4g}"),
        "faults found": len(found),
        "repairs": len(repairs),
        "faults left": len(left),
    }
    report.add_repairs(repairs)
    report.add_faults(left, content.lines)
    network = _network(given, content, path, body, base)
    report.add_notes(content.notes)
    print(terminal_text(report), flush=True)
    text = scene_text(network, _heading(given, path), base)
    _write(given.out, text, report)
    return report


def _leave_out(given: SimpleNamespace, content: Map, path: str) -> None:
    """Leave out short traces and vertices on request, before faults are looked for."""
    if given.simplify is not None:
        before = sum(len(line.points) for line in content.lines)
        shapes = [LineString(line.points).simplify(given.simplify) for line in content.lines]
        content.lines = [
            replace(line, points=shapely.get_coordinates(shape))
            for line, shape in zip(content.lines, shapes, strict=True)
        ]
        after = sum(len(line.points) for line in content.lines)
        content.note("simplified", f"{before - after} of {before} vertices were within"
                     f" {given.simplify:g} m of the line without them")  # fmt: skip
    if given.drop_shorter is None:
        return
    kept = [line for line in content.lines if line.length >= given.drop_shorter]
    dropped = sum(line.length for line in content.lines) - sum(line.length for line in kept)
    if not kept:
        raise SceneError(f"{path}: no fracture has {given.drop_shorter:g} m, see --drop-shorter")
    content.note("dropped", f"{len(content.lines) - len(kept)} traces shorter than"
                 f" {given.drop_shorter:g} m, together {dropped:.6g} m")  # fmt: skip
    content.lines = kept


def _add_entries(given: SimpleNamespace, content: Map, path: str, base: Base | None) -> None:
    """Let attributes of the fractures be entries of their groups, with what goes for all."""
    group = groups()["fracture"]
    asked = dict(setting(text, group) for text in given.set)
    values = entry_values("fracture", content.lines, content, path)
    complete(values, asked, content, assumed=False)
    defaults = {
        name: value
        for name, value in FRACTURE_DEFAULTS.items()
        if name != "aperture" or base is None or "fluid" in base.groups
    }
    complete(values, defaults, content, assumed=True)
    for line, entries in zip(content.lines, values, strict=True):
        line.attributes = dict(entries)


def _body(given: SimpleNamespace, content: Map, base: Base | None) -> Polygon | None:
    outline = boundary_of(content)
    if base is not None and "domain" in base.groups:
        if outline is not None:
            raise SceneError(
                f"{given.scene} has a body and so has the map ({outline.source}); leave out &domain"
            )
        return base.body()
    if outline is not None:
        return Polygon(outline.points)
    return rectangle_around([*content.lines, *content.wells], given.margin)


def _limits(given: SimpleNamespace, content: Map) -> Limits:
    lengths = sorted(line.length for line in content.lines if line.length > 0.0)
    if not lengths:
        raise SceneError("no fracture has a length: each lies at one place")
    near = given.repair or given.near or lengths[len(lengths) // 2] / 40.0
    if given.repair is not None and given.near not in (None, given.repair):
        raise SceneError("--near and --repair ask for two distances; give one of them")
    same = max(SAME * extent(content.lines), content.precision, 1e-12)
    return Limits(near, given.angle, same)


def _weld(content: Map, body: Polygon | None, limits: Limits) -> None:
    """Make joints of what meets within the precision of the map, and say so."""
    content.lines, number, largest = weld(content.lines, body, limits.same)
    if number:
        content.note(
            "precision", f"at {number} places fractures missed each other by up to {largest:.2g} m:"
            f" less than the {limits.same:.2g} m to which the map is known, so they meet"
        )  # fmt: skip


def _network(
    given: SimpleNamespace, content: Map, path: str, body: Polygon | None, base: Base | None
) -> Network:
    regions = [area for area in content.areas if area.role == "region"]
    region_values = entry_values("region", regions, content, path)
    for area, values in zip(regions, region_values, strict=True):
        if not values:
            content.note(
                "no rock", f"region '{area.name}' has no rock properties: the scene has it as a"
                " comment; an attribute or --region defines them"
            )  # fmt: skip
    cell = given.cell
    if cell is None and base is not None:
        cell = base.number("coarse", "size_fracture") or base.number("fe", "size_fracture")
    cells: list[float] = []
    if cell is None and not given.growth and (base is None or "fe" not in base.groups):
        cells, words = cell_sizes(content.lines)
        content.note("cells", words)
    line_values = [line.attributes for line in content.lines]
    lines = content.lines
    entries = (line_values, regions, region_values, body, cell, cells, given.growth)
    wells = entry_values("injection", content.wells, content, path)
    return Network(lines, *entries, content.wells, wells)  # type: ignore[arg-type]


def _heading(given: SimpleNamespace, path: str) -> str:
    if given.map is None:
        return f"Random fractures with seed {given.seed}."
    words = "as they are" if given.repair is None else f"repaired within {given.repair:g} m"
    return f"Fractures of {Path(path).name}, {words}; {given.out.stem}.repairs.csv has details."


def _write(out: Path, text: str, report: Report) -> None:
    """Write all files once the solver accepts the scene, or none."""
    try:
        with tempfile.NamedTemporaryFile(
            "w", dir=out.parent, prefix=f"{out.stem}.", suffix=".nml", delete=False
        ) as file:
            trial = Path(file.name)
            file.write(text)
    except OSError as reason:
        raise SceneError(f"{out}: it cannot be written: {reason.strerror}") from None
    try:
        is_good, words = check(trial)
        if not is_good:
            said = words.replace(str(trial), str(out)).replace(trial.stem, out.stem)
            hint = "" if report.number("repaired") else "; --repair DISTANCE may mend it"
            raise SceneError(f"check refuses the scene, so nothing is written: {said}{hint}")
        for file_path, content in file_texts(report, out).items():
            file_path.write_text(content, encoding="utf-8")
        print(f"\n{words.rstrip().replace(trial.stem, out.stem)}")
        print(f"{_cost(trial)}\n")
        trial.chmod(0o666 & ~_mask())
        trial.replace(out)
    except OSError as reason:
        raise SceneError(f"{out}: it cannot be written: {reason.strerror}") from None
    finally:
        trial.unlink(missing_ok=True)


def _cost(scene: Path) -> str:
    """What a run costs, by the solver; maps without growth took one to three times that."""
    cost = json.loads(call("check", scene, "--stress").stdout)["cost"]
    seconds, factor = float(cost["cpu_s"]), float(cost["factor"])
    least, most = (1.0, 3.0) if factor <= 2.0 else (1.0 / factor, factor)
    return f"a run:        {least * seconds:.2g} to {most * seconds:.2g} CPU s, without its figures"


def _mask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
