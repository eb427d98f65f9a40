"""Running a benchmark and what it cost."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from wingcrack_bench.arguments import Benchmark


class RunFailedError(Exception):
    """A run did not end well; the message is its reason."""


class EnvironmentLacksError(Exception):
    """Something that was asked for takes a program that is not there."""


@dataclass(frozen=True)
class Measurement:
    """What a run cost.

    Attributes
    ----------
    cpu_s : float
        CPU time of the process [s], the least of all repetitions.
    phases_s : dict of str to float
        The part of it that each phase took; "rest" is what no phase covers [s].
    states : int
        Accepted time steps, or load factors with equilibrium.
    growths : int
        Propagation steps: how often the mesh followed growth.
    unknowns : int
        Of all blocks, at the end.
    memory_mb : float
        Largest memory of the process [MB of 2**20 bytes].
    instructions : int or None
        Of the whole process, or None if they were not counted.
    why_not_counted : str
        What stood in the way of counting; empty if nothing did.
    """

    name: str
    title: str
    cpu_s: float
    phases_s: dict[str, float]
    states: int
    growths: int
    unknowns: int
    memory_mb: float
    instructions: int | None = None
    why_not_counted: str = ""

    @property
    def cpu_per_growth_s(self) -> float | None:
        """CPU time of a propagation step [s], with its share of everything else."""
        return self.cpu_s / self.growths if self.growths else None

    @property
    def remeshing_share(self) -> float:
        """Share of remeshing and transfer in the CPU time [-]."""
        return (self.phases_s["remesh"] + self.phases_s["transfer"]) / self.cpu_s


def measure(
    benchmark: Benchmark, solver: Path, repetitions: int, count_instructions: bool
) -> Measurement:
    """Run a benchmark some times; the least CPU time is the one least disturbed."""
    with tempfile.TemporaryDirectory(prefix="wingcrack-bench-") as folder:
        out = Path(folder) / "out"
        runs = []
        for _ in range(repetitions):
            _run([str(solver)], benchmark, out)
            runs.append(_read(benchmark, out))
        best = min(runs, key=lambda run: run.cpu_s)
        if not count_instructions:
            return best
        instructions, why_not = _count(solver, benchmark, Path(folder))
    values = vars(best) | {"instructions": instructions, "why_not_counted": why_not}
    return Measurement(**values)


def _run(program: list[str], benchmark: Benchmark, out: Path) -> str:
    """Run the solver, perhaps within another program, and give what it says on stderr."""
    done = subprocess.run(
        [*program, "run", str(benchmark.scene), "--out", str(out), "--quiet"],
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"exit status {done.returncode}"]
        raise RunFailedError(f"{benchmark.name}: {lines[-1].removeprefix('wingcrack: ')}")
    return done.stderr


def _read(benchmark: Benchmark, out: Path) -> Measurement:
    """Read what a run wrote about itself."""
    record = json.loads((out / "run.json").read_text(encoding="utf-8"))
    phases = {name: float(seconds) for name, seconds in record["timers_s"].items()}
    cpu = float(record["cpu_s"])
    phases["rest"] = max(0.0, cpu - sum(phases.values()))
    with (out / "events.csv").open(newline="", encoding="utf-8") as file:
        growths = sum(row["kind"] == "remesh" for row in csv.DictReader(file))
    return Measurement(
        name=benchmark.name,
        title=benchmark.title,
        cpu_s=cpu,
        phases_s=phases,
        states=int(record["steps"]),
        growths=growths,
        unknowns=sum(record["dofs"].values()),
        memory_mb=float(record["peak_memory_mb"]),
    )


def _count(solver: Path, benchmark: Benchmark, folder: Path) -> tuple[int | None, str]:
    """Count the instructions of the process with valgrind; or say why that cannot be."""
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        raise EnvironmentLacksError("--instructions needs valgrind, which is not installed")
    counter = [valgrind, "--tool=callgrind", f"--callgrind-out-file={folder / 'counts'}"]
    try:
        words = _run([*counter, str(solver)], benchmark, folder / "counted")
    except RunFailedError as reason:
        # The release build uses all that this processor can, which valgrind may not know.
        return None, f"valgrind cannot run the program here ({reason})"
    found = re.search(r"Collected : ([0-9]+)", words)
    return (int(found.group(1)), "") if found else (None, "valgrind told no count")
