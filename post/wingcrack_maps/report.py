"""Faults that were found, repaired and left: on the terminal, as CSV and as JSON."""

from __future__ import annotations

import csv
import io
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from wingcrack_maps.faults import ANGLES, BODY, HARMLESS, KINDS, Fault, place_text
from wingcrack_maps.features import Line, Note
from wingcrack_maps.repair import Repair

COLUMNS = ("status", "fault", "fracture", "other", "x_m", "y_m", "size", "what")
_SHOWN = 60  # rows on the terminal; the files have all
_NOTES = 4  # of one kind


@dataclass
class Report:
    """Everything that a user should know of an import."""

    source: str
    near: float
    angle_deg: float
    counts: dict[str, int | float | str] = field(default_factory=dict)
    rows: list[dict[str, str]] = field(default_factory=list)

    def add_faults(self, faults: Sequence[Fault], lines: Sequence[Line]) -> None:
        """Add what is wrong and stays so."""
        for fault in faults:
            names = [lines[i].name for i in fault.lines]
            status = "allowed" if fault.kind in HARMLESS else "left"
            words = f"{names[0]} {KINDS[fault.kind]}"
            alone = ("hairpin", "short fracture", "short segment", "repeated vertex",
                     *HARMLESS)  # fmt: skip
            if len(names) == 1 and fault.kind not in alone:
                names.append(BODY)
            self._add(status, fault.kind, names, fault.place, _size(fault.kind, fault.size), words)

    def add_repairs(self, repairs: Sequence[Repair]) -> None:
        """Add what was repaired, in this order."""
        for repair in repairs:
            size = _size(repair.kind, repair.size)
            self._add("repaired", repair.kind, repair.names, repair.place, size, repair.what)

    def add_notes(self, notes: Sequence[Note]) -> None:
        """Add what was noticed on the way."""
        for note in notes:
            self._add("noted", note.kind, (), None, "", note.what)

    def number(self, status: str) -> int:
        """How many rows have a status."""
        return sum(row["status"] == status for row in self.rows)

    def _add(
        self,
        status: str,
        kind: str,
        names: Sequence[str],
        place: tuple[float, float] | None,
        size: str,
        what: str,
    ) -> None:
        x, y = (place_text(place, 0.01 * self.near)) if place else ("", "")
        first, others = (names[0], " ".join(names[1:])) if names else ("", "")
        values = (status, kind, first, others, x, y, size, what)
        self.rows.append(dict(zip(COLUMNS, values, strict=True)))


def _size(kind: str, size: float) -> str:
    return f"{size:.4g} degree" if kind in ANGLES else f"{size:.4g} m"


def terminal_text(report: Report) -> str:
    """Give the table for the terminal; of many notes of one kind it shows the first."""
    lines = [f"{name:<22}{value}" for name, value in report.counts.items()]
    faults = [row for row in report.rows if row["status"] != "noted"]
    if faults:
        lines.append("")
    for row in faults[:_SHOWN]:
        where = f"({', '.join(place_text((float(row['x_m']), float(row['y_m'])), report.near))})"
        who = " ".join(word for word in (row["fracture"], row["other"]) if word)
        lines.append(
            f"{row['status']:<9}{row['fault']:<16} {who:<22} {where:<20} {row['size']:<12}"
            f" {row['what']}"
        )
    if len(faults) > _SHOWN:
        lines.append(f"and {len(faults) - _SHOWN} rows more, in the files")
    notes = [row for row in report.rows if row["status"] == "noted"]
    if notes:
        lines.append("")
    times = Counter(row["fault"] for row in notes)
    seen: Counter[str] = Counter()
    for row in notes:
        kind = row["fault"]
        seen[kind] += 1
        if times[kind] <= _NOTES or seen[kind] == 1:
            lines.append(f"noted    {kind:<16} {row['what']}")
        elif seen[kind] == 2:
            lines.append(f"noted    {kind:<16} and {times[kind] - 1} more, in the files")
    return "\n".join(lines)


def file_texts(report: Report, stem: Path) -> dict[Path, str]:
    """Give the texts of the two files beside a scene, by path."""
    table = io.StringIO()
    writer = csv.DictWriter(table, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(report.rows)
    content = {
        "source": report.source,
        "near_m": report.near,
        "angle_deg": report.angle_deg,
        **report.counts,
        "rows": report.rows,
    }
    return {
        stem.with_suffix(".repairs.csv"): table.getvalue(),
        stem.with_suffix(".repairs.json"): json.dumps(content, indent=1, ensure_ascii=False) + "\n",
    }
