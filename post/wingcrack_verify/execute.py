"""Running solver and programs: each run once, and again only when something has changed."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from wingcrack_verify.case import Run
from wingcrack_verify.errors import CaseError, EnvironmentLacksError
from wingcrack_verify.scene import scene_text

_RECORD = "outcome.json"
_ENDED = (0, 1, 2)  # exit statuses that the program chose: the outcome is the same next time


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes
    ----------
    folder : str
        Where its files are.
    status : str
        "finished", "failed" (exit status 1), "refused" (exit status 2), "crashed" (a signal, the
        time limit), or "invalid" where the case does not say rightly what to run.
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
        self._parallel = parallel
        self._children: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self._stopped = False

    def run_all(
        self, jobs: Iterable[Job], progress: Callable[[Job, Outcome], None]
    ) -> dict[tuple[str, str], Outcome]:
        """Outcome of each job by case and run; `progress` is told of each as it ends."""
        outcomes: dict[tuple[str, str], Outcome] = {}
        with ThreadPoolExecutor(self._parallel) as pool:
            waiting = {pool.submit(self.run, job): job for job in jobs}
            try:
                for done in as_completed(waiting):
                    job = waiting[done]
                    outcomes[job.case, job.run.name] = done.result()
                    progress(job, done.result())
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                self._stop()
                raise
        return outcomes

    def run(self, job: Job) -> Outcome:
        """Run a job, or find what an earlier call left."""
        try:
            program = self._programs.path(job.run)
            text = None
            if job.run.scene is not None:
                text = scene_text(job.run.scene, job.run.set, job.run.unset)
        except CaseError as reason:
            return Outcome("", "invalid", str(reason), 0.0, 0.0)
        folder = self._cache / job.case / f"{_slug(job.run.name)}-{_key(program, text, job.run)}"
        earlier = _read_record(folder)
        if earlier is not None:
            return earlier
        for old in folder.parent.glob(f"{_slug(job.run.name)}-*"):
            shutil.rmtree(old)
        return self._start(job.run, program, text, folder)

    def _start(self, run: Run, program: Path, text: str | None, folder: Path) -> Outcome:
        output = folder / "output"
        output.mkdir(parents=True)
        if text is not None:
            (folder / "input.nml").write_text(text, encoding="utf-8")
            for table in _tables(run, text):
                shutil.copy(table, folder)
            command = [str(program), "run", "../input.nml", "--out", ".", "--quiet"]
        else:
            command = [str(program), *run.args]
        begin = time.perf_counter()
        status, late = self._call(command, output, run.time_limit_s)
        wall_s = time.perf_counter() - begin
        outcome = _judge_end(folder, status, late, run.time_limit_s, wall_s)
        if late or status in _ENDED:
            record = folder / _RECORD
            aside = record.with_suffix(".aside")
            aside.write_text(json.dumps(asdict(outcome), indent=1), encoding="utf-8")
            aside.replace(record)
        return outcome

    def _call(self, command: list[str], output: Path, limit_s: float) -> tuple[int, bool]:
        """Exit status, and whether the time limit ended it."""
        environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        with (
            (output.parent / "stdout.txt").open("wb") as out,
            (output.parent / "stderr.txt").open("wb") as error,
        ):
            with self._lock:
                if self._stopped:
                    raise KeyboardInterrupt
                child = subprocess.Popen(
                    command,
                    cwd=output,
                    stdin=subprocess.DEVNULL,
                    stdout=out,
                    stderr=error,
                    env=environment,
                )
                self._children.add(child)
            try:
                return child.wait(timeout=limit_s), False
            except subprocess.TimeoutExpired:
                child.kill()
                return child.wait(), True
            finally:
                with self._lock:
                    self._children.discard(child)

    def _stop(self) -> None:
        with self._lock:
            self._stopped = True
            for child in self._children:
                child.send_signal(signal.SIGTERM)


def _judge_end(folder: Path, status: int, late: bool, limit_s: float, wall_s: float) -> Outcome:
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


def _run_record(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _read_record(folder: Path) -> Outcome | None:
    try:
        found = json.loads((folder / _RECORD).read_text(encoding="utf-8"))
        return Outcome(**(found | {"folder": str(folder), "reused": True}))
    except (OSError, ValueError, TypeError):
        return None


def _key(program: Path, text: str | None, run: Run) -> str:
    """Short hash of all that a run's files depend on."""
    limit = str(run.time_limit_s)
    tables = (_file_hash(table) for table in _tables(run, text or "") if table.is_file())
    content = "\0".join((_file_hash(program), _own_hash(), limit, text or "", *run.args, *tables))
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def _tables(run: Run, text: str) -> list[Path]:
    """CSV files that a scene names: they lie beside it."""
    names = re.findall(r"^\s*schedule\s*=\s*'([^']+)'", text, re.MULTILINE)
    return [run.scene.parent / name for name in names] if run.scene is not None else []


def _file_hash(path: Path) -> str:
    state = path.stat()
    return _hash_of(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=64)
def _hash_of(path: Path, _changed: int, _size: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@lru_cache(maxsize=1)
def _own_hash() -> str:
    """Hash of the modules that decide what is run; judging is always done anew."""
    here = Path(__file__).parent
    content = b"".join((here / name).read_bytes() for name in ("execute.py", "scene.py"))
    return hashlib.sha256(content).hexdigest()


def _slug(name: str) -> str:
    digest = hashlib.sha256(name.encode()).hexdigest()[:6]
    return f"{re.sub(r'[^A-Za-z0-9]+', '_', name).strip('_')[:40]}-{digest}"
