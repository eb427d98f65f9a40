"""Runs all scenes of a study, here or on a cluster, and collects their outcomes."""

from __future__ import annotations

import itertools
import logging
import os
import resource
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import Any

from wingcrack.errors import (
    CaseError,
    EnvironmentLacksError,
    RunError,
    RunFailedError,
    SceneError,
)
from wingcrack.runner.pool import Pool
from wingcrack.runner.task import ONE_THREAD, Outcome, Task, copy_tables, read_outcome, tables_of
from wingcrack.runs.run import open_run
from wingcrack.studies import TOP, remote
from wingcrack.studies.cluster import Cluster, connect
from wingcrack.studies.study import Study, StudyRun
from wingcrack.sweeps.scene import scene_hash

SOLVER = Path("fortran") / "app" / "wingcrack-solver"
RUNS = "runs"  # the folder of all runs' folders

_SILENCE_S = 10.0
_TOGETHER = 25  # scenes that one process checks


def tasks_of(study: Study, build: Path, out: Path) -> dict[int, Task]:
    """What is to be run, by the runs' numbers.

    Raises `EnvironmentLacksError` if the solver is not built.
    """
    solver = build / SOLVER
    if not solver.is_file():
        raise EnvironmentLacksError(f"not built: {solver} is missing")
    found = {}
    start = state_of(study)
    for run in study.runs:
        tables = tables_of(study.scene.resolve(), run.text)
        limit = study.time_limit_s
        place = out / RUNS
        found[run.number] = Task(
            run.label, place, solver, run.text, (), tables, limit, scene_hash(), start
        )
    return found


def state_of(study: Study) -> Path | None:
    """Folder with the state from which the runs go on; it is computed if it is not there.

    Raises `CaseError` if there is no such run, or it does not reach the state.
    """
    if study.origin is None:
        return None
    try:
        run = open_run(study.origin.run)
        return run.directory if study.origin.at is None else run.at(study.origin.at).directory
    except (RunError, RunFailedError, SceneError) as error:
        raise CaseError(f"from: {error}") from None


def done_before(tasks: Mapping[int, Task]) -> dict[int, Outcome]:
    """Outcomes of runs that an earlier call has left."""
    found = {number: read_outcome(task.folder) for number, task in tasks.items()}
    return {number: outcome for number, outcome in found.items() if outcome is not None}


def check_scenes(runs: Sequence[StudyRun], tasks: Mapping[int, Task], parallel: int) -> None:
    """Let the solver read and judge the scenes; nothing is run.

    Raises `CaseError`: with the solver's reason for the first scene that it refuses.
    """
    if not runs:
        return
    size = min(_TOGETHER, -(-len(runs) // parallel))
    # what is wrong with the study is mostly wrong with all: ask about one first
    ends = [0, 1, *range(1 + size, len(runs), size), len(runs)]
    parts = [runs[begin:end] for begin, end in itertools.pairwise(ends) if runs[begin:end]]
    with tempfile.TemporaryDirectory(prefix="wingcrack-study-") as name:

        def check(part: Sequence[StudyRun]) -> None:
            _check(part, tasks, Path(name))

        check(parts[0])
        with ThreadPoolExecutor(parallel) as threads:
            told_s, count = time.monotonic(), 1
            for part, _ in zip(parts[1:], threads.map(check, parts[1:]), strict=True):
                count += len(part)
                if time.monotonic() - told_s > _SILENCE_S:
                    told_s = time.monotonic()
                    print(f"{count} of {len(runs)} scenes are checked", flush=True)


def _check(runs: Sequence[StudyRun], tasks: Mapping[int, Task], place: Path) -> None:
    """Refuse the first scene that the solver refuses, with its reason.

    One process checks them all; where it refuses one, they are checked one by one.
    """
    for run in runs:
        folder = place / str(run.number)
        folder.mkdir(exist_ok=True)
        (folder / "scene.nml").write_text(tasks[run.number].text or "", encoding="utf-8")
        copy_tables(tasks[run.number], folder)
    program = str(tasks[runs[0].number].program)
    if len(runs) > 1:
        files = [f"{run.number}/scene.nml" for run in runs]
        if _said([program, "check", *files], place) is None:
            return
    for run in runs:
        reason = _said([program, "check", "scene.nml"], place / str(run.number))
        if reason is not None:
            raise CaseError(f"run {run.number} ({run.label}): {reason}")


def _said(command: list[str], folder: Path) -> str | None:
    """Why the solver refuses what it is to check; None if it does not."""
    done = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | ONE_THREAD,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    if done.returncode == 0:
        return None
    lines = done.stderr.strip().splitlines() or [f"check ends with status {done.returncode}"]
    return lines[-1].removeprefix("wingcrack: ")


def run_tasks(
    tasks: Mapping[int, Task],
    cluster: Cluster,
    workers: int,
    progress: Callable[[int, Outcome], None],
) -> None:
    """Run all tasks; `progress` is called with each as it ends, and keeps it.

    Raises `EnvironmentLacksError` if the cluster cannot be started.
    """
    if cluster.kind == "none":
        pool: Pool[int] = Pool(workers)
        pool.run_all(tasks, lambda number: pool.run_task(tasks[number]), progress)
    elif tasks:
        _run_on_cluster(tasks, cluster, workers, progress)


def _run_on_cluster(
    tasks: Mapping[int, Task],
    cluster: Cluster,
    workers: int,
    progress: Callable[[int, Outcome], None],
) -> None:
    """As `run_tasks`. A run whose worker is lost is given to another one, up to three times."""
    with ExitStack() as stack:
        client = connect(cluster, workers, stack)
        from cloudpickle import register_pickle_by_value

        as_completed: Any = import_module("distributed").as_completed
        logging.getLogger("distributed").setLevel(logging.CRITICAL)
        register_pickle_by_value(remote)
        post = str(TOP / "post")
        waiting = {
            client.submit(remote.run_there, post, _plain(task), pure=False): number
            for number, task in tasks.items()
        }
        for future in as_completed(waiting, loop=client.loop):
            number = waiting[future]
            failure = future.exception()
            if failure is None:
                outcome = Outcome(**future.result())
            else:
                said = str(failure).strip().splitlines() or [type(failure).__name__]
                place = str(tasks[number].folder)
                outcome = Outcome(place, "crashed", f"no worker ran it: {said[0]}", 0.0, 0.0)
            progress(number, outcome)
            future.release()


def _plain(task: Task) -> dict[str, object]:
    return {field.name: getattr(task, field.name) for field in fields(task)}


class Clock:
    """Wall and CPU time of a call, with all that it started and has ended [s]."""

    def __init__(self) -> None:
        self._begin = time.perf_counter()

    def wall_s(self) -> float:
        """Wall time since the start [s]."""
        return time.perf_counter() - self._begin

    def cpu_s(self) -> float:
        """CPU time of this process and its children so far [s]."""
        parts = [
            resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        ]
        return sum(part.ru_utime + part.ru_stime for part in parts)
