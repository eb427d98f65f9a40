"""Runs the scene of a measurement, and determines its cost."""

from __future__ import annotations

import csv
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wingcrack.errors import EnvironmentLacksError
from wingcrack.figures.text_files import read_json
from wingcrack.runner.task import ONE_THREAD
from wingcrack.sweeps.scene import scene_text
from wingcrack_verify.bench.catalogue import TOP, Benchmark

# One set of kernels of OpenBLAS whatever the processor, too: counts mean something then.
_COUNTED = {**ONE_THREAD, "OPENBLAS_CORETYPE": "Haswell"}


class RunFailedError(Exception):
    """A run did not end well; the message is its reason."""


@dataclass(frozen=True)
class Run:
    """What one run cost, and how large it was."""

    cpu_s: float  # CPU time of the whole process [s]
    # the part of it that each phase took; "rest" is what no phase covers [s]
    phases_s: dict[str, float]
    states: int  # accepted time steps, or load factors with equilibrium
    growths: int  # propagation steps: how often the mesh followed growth
    sizes: dict[str, int]  # cells, fracture cells, unknowns of all blocks at the end
    memory_mb: float  # largest memory of the process [MB of 2**20 bytes]


@dataclass(frozen=True)
class Measurement:
    """What a scene costs."""

    name: str
    title: str
    typical: Run  # the run with the median CPU time
    cpu_s: tuple[float, ...]  # CPU time of each run, in their order [s]
    # CPU time of a run that ends after its first step, if that is measured [s]
    first_step_s: float | None = None
    # CPU time of the other program, run in turn with this one [s]; empty without one
    other_s: tuple[float, ...] = ()
    instructions: int | None = None  # of the whole process, or None if they were not counted
    why_not_counted: str = ""  # what stood in the way of counting; empty if nothing did

    @property
    def median_s(self) -> float:
        """Median of the CPU times [s]."""
        return statistics.median(self.cpu_s)

    @property
    def spread(self) -> float:
        """Largest less smallest CPU time, as a share of the median [-]."""
        return (max(self.cpu_s) - min(self.cpu_s)) / self.median_s

    @property
    def further_step_s(self) -> float | None:
        """CPU time of each step after the first [s]."""
        if self.first_step_s is None or self.typical.states < 2:
            return None
        return max(0.0, self.median_s - self.first_step_s) / (self.typical.states - 1)

    @property
    def cpu_per_growth_s(self) -> float | None:
        """CPU time of a propagation step [s], with its share of everything else."""
        return self.median_s / self.typical.growths if self.typical.growths else None

    @property
    def remeshing_share(self) -> float:
        """Share of remeshing and transfer in the CPU time [-]."""
        phases = self.typical.phases_s
        return (phases["remesh"] + phases["transfer"]) / self.typical.cpu_s

    @property
    def ratio(self) -> float | None:
        """Median CPU time over that of the other program [-]; None without one."""
        return self.median_s / statistics.median(self.other_s) if self.other_s else None


def measure(
    benchmark: Benchmark, solver: Path, repetitions: int, other: Path | None
) -> Measurement:
    """Run a scene some times, in turn with another program if there is one."""
    with _folder() as name:
        folder = Path(name)
        scene = write_scene(benchmark, folder)
        repetitions = 1 if benchmark.once else repetitions
        runs, others = [], []
        for _ in range(repetitions):
            runs.append(_run(solver, benchmark.name, scene, folder / "out"))
            if other is not None:
                others.append(_run(other, benchmark.name, scene, folder / "other").cpu_s)
        first = None
        if benchmark.one_step and other is None:
            scene = write_scene(benchmark, folder, benchmark.one_step)
            firsts = [
                _run(solver, benchmark.name, scene, folder / "first").cpu_s
                for _ in range(repetitions)
            ]
            first = statistics.median(firsts)
    typical = sorted(runs, key=lambda run: run.cpu_s)[len(runs) // 2]
    return Measurement(
        benchmark.name,
        benchmark.title,
        typical,
        tuple(run.cpu_s for run in runs),
        first,
        tuple(others),
    )


def count(benchmark: Benchmark, solver: Path) -> tuple[int | None, str]:
    """Count the instructions of a run with valgrind; or say why that cannot be.

    Raises `EnvironmentLacksError` if there is no valgrind.
    """
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        raise EnvironmentLacksError("instructions are counted by valgrind, which is not installed")
    with _folder() as name:
        folder = Path(name)
        scene = write_scene(benchmark, folder)
        counter = [valgrind, "--tool=cachegrind", "--cache-sim=no"]
        try:
            words = _call(
                [*counter, f"--cachegrind-out-file={folder / 'counts'}", str(solver)],
                benchmark.name,
                scene,
                folder / "out",
                _COUNTED,
            )
        except RunFailedError as reason:
            # a build for this processor may use what valgrind does not know
            return None, f"valgrind cannot run the program here ({reason})"
    found = re.search(r"I +refs: +([0-9,]+)", words)
    return (int(found[1].replace(",", "")), "") if found else (None, "valgrind gave no count")


def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="wingcrack-bench-")


def _run(solver: Path, name: str, scene: Path, out: Path) -> Run:
    before = _children_s()
    _call([str(solver)], name, scene, out, ONE_THREAD)
    return _read(out, _children_s() - before)


def _children_s() -> float:
    """CPU time of all processes that were started and have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _call(
    program: Sequence[str], name: str, scene: Path, out: Path, environment: dict[str, str]
) -> str:
    """Run the solver, perhaps within another program, and give what it says on stderr."""
    done = subprocess.run(
        [*program, "run", str(scene), "--out", str(out), "--quiet"],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"exit status {done.returncode}"]
        raise RunFailedError(f"{name}: {lines[-1].removeprefix('wingcrack: ')}")
    return done.stderr


def _read(out: Path, cpu_s: float) -> Run:
    """Read what a run wrote about itself."""
    record = read_json(out / "run.json")
    phases = {name: float(seconds) for name, seconds in record["timers_s"].items()}
    phases["rest"] = max(0.0, cpu_s - sum(phases.values()))
    with (out / "events.csv").open(newline="", encoding="utf-8") as file:
        growths = sum(row["kind"] == "remesh" for row in csv.DictReader(file))
    return Run(
        cpu_s=cpu_s,
        phases_s=phases,
        states=int(record["steps"]),
        growths=growths,
        sizes={
            "cells": int(record["cells"]),
            "fracture_cells": int(record["fracture_cells"]),
            "unknowns": sum(record["dofs"].values()),
        },
        memory_mb=float(record["peak_memory_mb"]),
    )


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
