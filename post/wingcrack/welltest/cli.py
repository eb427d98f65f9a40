"""`wingcrack analyse`: well-test analysis of runs and of measured records."""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

from wingcrack.errors import AbsentError, RunError
from wingcrack.welltest.record import read_record, records_of_run
from wingcrack.welltest.results import Cell, Rock, evaluate, rock_of_scene

if TYPE_CHECKING:
    from wingcrack.figures.scene import Scene

_SHOWN = (  # column, its error, factor, unit and label of the lines on the terminal
    ("isip_pa", "isip_error_pa", 1e-6, "MPa", "instantaneous shut-in pressure"),
    ("linear_reservoir_pa", "linear_reservoir_error_pa", 1e-6, "MPa", "reservoir, linear flow"),
    ("area_root_k", "area_root_k_error", 1.0, "m2", "area times root of permeability"),
    ("radial_reservoir_pa", "radial_reservoir_error_pa", 1e-6, "MPa", "reservoir, radial flow"),
    ("k_h", "k_h_error", 1.0, "m2", "permeability (k h over thickness)"),
    ("closure_tangent_pa", None, 1e-6, "MPa", "closure by the tangent"),
    ("closure_compliance_pa", None, 1e-6, "MPa", "closure by compliance"),
    ("closure_root_pa", None, 1e-6, "MPa", "closure by the root of time"),
    ("closure_first_cell_pa", None, 1e-6, "MPa", "first cell closes"),
    ("closure_last_cell_pa", None, 1e-6, "MPa", "last cell closes"),
)


def analyse(given: SimpleNamespace) -> int:
    """Analyse the shut-ins of a run or record; give the exit status: 0 done, 2 bad input."""
    # late, so that --help and mistakes in the call answer at once
    from wingcrack.figures import style
    from wingcrack.figures.read import read_run
    from wingcrack.welltest.panels import shut_in_panels

    path: Path = given.path
    try:
        if path.is_dir():
            out = given.out or path
            run = read_run(path)
            records, rock = records_of_run(run), rock_of_scene(path / "scene.nml")
            for words in _other_rock(run.scene):
                print(f"wingcrack analyse: {words}", file=sys.stderr)
        else:
            out = given.out or Path("out") / path.stem
            records, rock = [read_record(path, given.columns)], Rock(given.viscosity, given.storage)
        found = evaluate(records, rock)
        if not found:
            wells = ", ".join(record.well for record in records)
            raise RunError(f"{path}: no well is shut in after an injection (there are: {wells}).")
    except (RunError, AbsentError) as reason:
        print(f"wingcrack analyse: {reason}", file=sys.stderr)
        return 2
    table = out / "figures" / "well_test.csv"
    table.parent.mkdir(parents=True, exist_ok=True)
    with table.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, found[0][1], lineterminator="\n")
        writer.writeheader()
        writer.writerows(row for _, row in found)
    for fall, row in found:
        if not given.quiet:
            print(_words(row), flush=True)
        stem = out / "figures" / f"well_test_{fall.well}_{fall.number}"
        for file in style.save(shut_in_panels(fall, row), stem, given.format):
            if not given.quiet:
                print(file, flush=True)
    if not given.quiet:
        print(table)
    return 0


def _other_rock(scene: Scene | None) -> Iterator[str]:
    """Warn of regions at wells, whose rock differs from that of the analysis."""
    from matplotlib.path import Path as Outline

    for well in scene.wells if scene else ():
        inside = [
            region.name
            for region in (scene.regions if scene else ())
            if well.place_m is None or Outline(region.corners).contains_point(well.place_m)
        ]
        if inside:
            where = f"in '{well.fracture}'"
            if well.place_m:
                where = f"at ({well.place_m[0]:g}, {well.place_m[1]:g}) m"
            yield (
                f"warning: the rock of the well {where} may be that of the region '{inside[-1]}',"
                " but the analysis uses that of &material"
            )


def _words(row: dict[str, Cell]) -> str:
    """What a shut-in says, in lines for the terminal."""
    lines = [f"{row['well']}, shut-in {row['shut_in']} at {row['start_s']:.6g} s:"]
    for column, error, factor, unit, label in _SHOWN:
        value = row[column]
        if not isinstance(value, float):
            continue
        stated = row[error] if error else None
        within = f" +- {factor * stated:.2g}" if isinstance(stated, float) else ""
        lines.append(f"  {label + ':':<36}{factor * value:.5g}{within} {unit}")
    return "\n".join(lines)
