"""Runs of the solver that go on from a checkpoint, and comparisons of their files."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from system_scene import SOLVER, varied

EVERY_STATE = "\n&scene name = 'a_run' /\n&output checkpoint_states = 1 /\n"
FINE = varied(("size_fracture = 0.02", "size_fracture = 0.01"), ("step = 3600.0", "step = 600.0"))
# Times and memory of run.json, which differ from run to run.
_COST = re.compile(
    r'"(?:\w+_s|peak_memory_mb|mesh|discretize|assemble|factorize|solve|contact|tips'
    r'|remesh|transfer|output)": '
)


def solver(*words: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [SOLVER, *map(str, words)], capture_output=True, text=True, check=False, timeout=300
    )


def contents(folder: Path) -> dict[str, bytes | list[str]]:
    """All files but checkpoints and log, run.json without costs."""
    found: dict[str, bytes | list[str]] = {}
    for path in sorted(folder.rglob("*")):
        if path.is_dir() or path.name == "run.log" or path.name.startswith("checkpoint"):
            continue
        name = str(path.relative_to(folder))
        found[name] = path.read_bytes()
        if name == "run.json":
            lines = path.read_text().splitlines()
            found[name] = [line for line in lines if not _COST.search(line)]
    return found


def assert_same(first: Path, second: Path) -> None:
    one, other = contents(first), contents(second)
    assert one.keys() == other.keys()
    assert [name for name in one if one[name] != other[name]] == []


def finished(folder: Path, name: str, text: str, *words: str | Path) -> Path:
    """Run a scene in a folder, and give the folder of its files."""
    (folder / f"{name}.nml").write_text(text + EVERY_STATE)
    run = solver("run", folder / f"{name}.nml", *words, "--out", folder / name, "--quiet")
    assert run.returncode == 0, run.stderr
    return folder / name
