"""The runs of the cases: the command of each, and their execution in parallel."""

from __future__ import annotations

import fcntl
import os
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from wingcrack.errors import CaseError, EnvironmentLacksError
from wingcrack.runner.pool import Pool
from wingcrack.runner.task import Outcome, Task, tables_of
from wingcrack.sweeps.scene import scene_hash, scene_text
from wingcrack_verify.contents import Run

__all__ = ["Job", "Outcome", "Programs", "Runner"]


@dataclass(frozen=True)
class Job:
    """A run of a case, ready to start."""

    case: str
    run: Run


class Programs:
    """Where the compiled programs are, and the sources of those that cases bring."""

    def __init__(self, build: Path, sources: Path) -> None:
        self._build = build
        self._sources = sources

    def path(self, run: Run) -> Path:
        """Executable of a run."""
        if run.program is None:
            path = self._build / "fortran" / "app" / "wingcrack-solver"
        else:
            path = self._build / "verification" / run.program
        if not path.is_file():
            if run.program and not (self._sources / f"{run.program}.f90").is_file():
                raise CaseError(f"there is no program programs/{run.program}.f90")
            raise EnvironmentLacksError(f"not built: {path} is missing")
        return path


class Runner:
    """Runs jobs in parallel and reuses what an earlier call has done."""

    def __init__(self, programs: Programs, cache: Path, parallel: int) -> None:
        self._programs = programs
        self._cache = cache
        self._pool: Pool[int] = Pool(parallel)

    def run_all(
        self, jobs: Iterable[Job], progress: Callable[[Job, Outcome], None]
    ) -> dict[tuple[str, str], Outcome]:
        """Outcome of each job by case and run; `progress` is called with each as it ends.

        Another call with the same cache waits: each would remove the folders of the other's runs.
        """
        listed = list(jobs)
        self._cache.mkdir(parents=True, exist_ok=True)
        handle = os.open(self._cache, os.O_RDONLY)
        try:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                print(f"waiting for another call that runs in {self._cache}", file=sys.stderr)
                fcntl.flock(handle, fcntl.LOCK_EX)
            outcomes = self._pool.run_all(
                range(len(listed)),
                lambda number: self.run(listed[number]),
                lambda number, outcome: progress(listed[number], outcome),
            )
        finally:
            os.close(handle)
        return {
            (listed[number].case, listed[number].run.name): outcome
            for number, outcome in outcomes.items()
        }

    def run(self, job: Job) -> Outcome:
        """Run a job, or find what an earlier call left."""
        try:
            task = self._task(job)
        except CaseError as reason:
            return Outcome("", "invalid", str(reason), 0.0, 0.0)
        return self._pool.run_task(task)

    def _task(self, job: Job) -> Task:
        run = job.run
        program = self._programs.path(run)
        text: str | None = None
        tables: tuple[Path, ...] = ()
        if run.scene is not None:
            text = scene_text(run.scene, run.set, run.unset)
            tables = tables_of(run.scene, text)
        folder = self._cache / job.case
        limit = run.time_limit_s
        return Task(run.name, folder, program, text, run.args, tables, limit, scene_hash())
