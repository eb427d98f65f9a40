"""How a run ended, judged by its exit status and its run.json, and the record of that."""

from __future__ import annotations

import json
import signal
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from wingcrack.figures.text_files import read_json

RECORD = "outcome.json"


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes
    ----------
    folder : str
        Where its files are.
    status : str
        "finished", "failed" (exit status 1), "refused" (exit status 2), "crashed" (a signal, the
        time limit), or "invalid" where the caller does not say rightly what to run.
    reason : str
        Last line on stderr or the reason in run.json, where it did not finish.
    cpu_s, wall_s : float
        From run.json, and measured around the call; 0 where unknown.
    reused : bool
        Whether the run is one of an earlier call.
    """

    folder: str
    status: str
    reason: str
    cpu_s: float
    wall_s: float
    reused: bool = False


def judge_end(folder: Path, status: int, late: bool, limit_s: float, wall_s: float) -> Outcome:
    """Outcome of a call that ended with an exit status, or was ended as it was too `late`."""
    place = str(folder)
    said = (folder / "stderr.txt").read_text(encoding="utf-8", errors="replace").split("\n")
    last = next((line.strip() for line in reversed(said) if line.strip()), "")
    if late:
        return Outcome(place, "crashed", f"not done after {limit_s:g} s", 0.0, wall_s)
    record = _run_record(folder / "output" / "run.json")
    cpu_s = record.get("cpu_s")
    cpu_s = float(cpu_s) if isinstance(cpu_s, int | float) else 0.0
    if status < 0:
        name = signal.Signals(-status).name
        return Outcome(place, "crashed", f"ended by {name} {last}".strip(), cpu_s, wall_s)
    if status == 2:
        return Outcome(place, "refused", last, cpu_s, wall_s)
    if status != 0:
        return Outcome(place, "failed", last or f"exit status {status}", cpu_s, wall_s)
    if record.get("status") != "finished":
        reason = f"run.json says {record.get('status', 'nothing')!r}: {record.get('reason', '')}"
        return Outcome(place, "failed", reason, cpu_s, wall_s)
    if not cpu_s > 0.0:
        return Outcome(place, "failed", "run.json has no cpu_s above 0", 0.0, wall_s)
    return Outcome(place, "finished", "", cpu_s, wall_s)


def write_outcome(folder: Path, outcome: Outcome) -> None:
    """Leave the outcome in the run's folder, for later calls; it appears whole."""
    record = folder / RECORD
    aside = record.with_suffix(".aside")
    aside.write_text(json.dumps(asdict(outcome), indent=1), encoding="utf-8")
    aside.replace(record)


def read_outcome(folder: Path) -> Outcome | None:
    """Outcome that an earlier call left, or None."""
    try:
        found = read_json(folder / RECORD)
        return Outcome(**(found | {"folder": str(folder), "reused": True}))
    except (OSError, ValueError, TypeError):
        return None


def _run_record(path: Path) -> dict[str, Any]:
    try:
        found = read_json(path)
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}
