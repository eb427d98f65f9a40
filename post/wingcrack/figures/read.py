"""All files of a run, read into one typed value."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wingcrack.errors import AbsentError, RunError
from wingcrack.figures.fields import Snapshot, read_series
from wingcrack.figures.scene import Scene, read_scene
from wingcrack.figures.table import Table, read_table
from wingcrack.figures.text_files import read_json
from wingcrack.figures.unchanged import MEASURED


@dataclass(frozen=True)
class Run:
    """The files of a finished, stopped or still running simulation.

    A file that the scene did not ask for, or that is not written yet, is None (or an empty
    series); only ``history.csv`` has to be there. All values are SI; units are in column names.
    """

    directory: Path
    history: Table  # a row per accepted step
    tips: Table | None
    fractures: Table | None
    probes: Table | None
    wells: Table | None
    events: Table | None
    slip_events: Table | None
    # record, network: the contents of ``run.json`` and ``network.json``
    record: dict[str, Any] | None
    network: dict[str, Any] | None
    scene: Scene | None
    # matrix, fracture_fields: the written VTU files with their times
    matrix: tuple[Snapshot, ...]
    fracture_fields: tuple[Snapshot, ...]

    @property
    def thickness_m(self) -> float:
        """Thickness of the body [m]; 1 where the scene has none."""
        return self.scene.thickness_m if self.scene else 1.0

    @property
    def name(self) -> str:
        """Name of the scene, or of the directory where no file tells it."""
        if self.record and isinstance(self.record.get("scene"), str):
            return str(self.record["scene"])
        if self.scene and self.scene.name:
            return self.scene.name
        return self.directory.resolve().name

    def fracture_name(self, label: str) -> str:
        """How figures call a fracture: its name in scene or network, else its number."""
        law = self.scene.fracture(label) if self.scene else None
        if law and law.name:
            return law.name
        for fracture in (self.network or {}).get("fractures", []):
            if str(fracture.get("fracture")) == label and fracture.get("name"):
                return str(fracture["name"])
        return f"fracture {label}" if label.isdecimal() else label


def read_run(directory: str | Path) -> Run:
    """Read the files of a run.

    Raises `RunError` if the directory or ``history.csv`` is missing, or a file is damaged.

    `directory`: what ``wingcrack run`` wrote, for instance ``out/wing_crack``.
    """
    root = Path(directory)
    if not root.is_dir():
        raise RunError(f"{root}: there is no such directory.")
    if not (root / "history.csv").is_file():
        raise RunError(
            f"{root}: history.csv is missing, so this is no directory that 'wingcrack run' wrote."
        )
    history = read_table(root / "history.csv")
    if history.rows == 0:
        raise RunError(f"{history.path}: the file has no rows yet, as no step has been accepted.")
    return Run(
        directory=root,
        history=history,
        tips=_optional_table(root / "tips.csv"),
        fractures=_optional_table(root / "fractures.csv"),
        probes=_optional_table(root / "probes.csv"),
        wells=_optional_table(root / "wells.csv"),
        events=_optional_table(root / "events.csv"),
        slip_events=_optional_table(root / "slip_events.csv"),
        record=_without_measures(optional_json(root / "run.json")),
        network=optional_json(root / "network.json"),
        scene=read_scene(root / "scene.nml"),
        matrix=read_series(root / "matrix.pvd"),
        fracture_fields=read_series(root / "fractures.pvd"),
    )


def needed(table: Table | None, file: str, holds: str) -> Table:
    """Give a table with rows, or say what is absent.

    Raises `AbsentError` if the run has no such file, or the file has no rows.
    """
    if table is None:
        raise AbsentError(f"the run has no {file} ({holds})")
    if table.rows == 0:
        raise AbsentError(f"{file} has no rows ({holds})")
    return table


def _optional_table(path: Path) -> Table | None:
    return read_table(path) if path.exists() else None


def optional_json(path: Path) -> dict[str, Any] | None:
    """Give the object that a JSON file holds; None where there is no such file.

    Raises `RunError` if it is damaged.
    """
    if not path.exists():
        return None
    try:
        content = read_json(path)
    except (OSError, ValueError) as reason:
        raise RunError(f"{path}: the file is no valid JSON ({reason}).") from None
    if not isinstance(content, dict):
        raise RunError(f"{path}: a JSON object was expected.")
    return content


def _without_measures(record: dict[str, Any] | None) -> dict[str, Any] | None:
    """Leave out of run.json what says nothing of the scene: a second run gives the same figures."""
    if record is None:
        return None
    return {name: value for name, value in record.items() if name not in MEASURED}
