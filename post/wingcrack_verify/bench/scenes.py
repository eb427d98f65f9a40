"""The scene files of the measurements."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from wingcrack.sweeps.scene import scene_text
from wingcrack_verify.bench.catalogue import TOP, Benchmark


def write_scene(benchmark: Benchmark, folder: Path, more: Mapping[str, Any] | None = None) -> Path:
    """Write the scene of a measurement, perhaps with further entries changed; give its path."""
    source = benchmark.scene
    if source is None:
        source = folder / "many_fractures.nml"
        command = [sys.executable, str(TOP / "tools" / "many_fractures.py")]
        done = subprocess.run(
            [*command, *benchmark.many_fractures], capture_output=True, text=True, check=True
        )
        source.write_text(done.stdout, encoding="utf-8")
    target = folder / f"{benchmark.name}{'_first' if more else ''}.nml"
    target.write_text(scene_text(source, {**benchmark.changes, **(more or {})}, ()), "utf-8")
    return target
