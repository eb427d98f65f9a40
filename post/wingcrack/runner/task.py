"""One call of the solver or of another program, ready to start, in a separate folder."""

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
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, TypeAlias

from wingcrack.figures.text_files import read_json, write_whole

RECORD = "outcome.json"


@dataclass(frozen=True)
class Outcome:
    """How a run ended."""

    folder: str  # where its files are
    # "finished", "failed" (exit status 1), "refused" (exit status 2), "crashed" (a signal, the time
    # limit), or "invalid" where the caller does not say rightly what to run
    status: str
    reason: str  # last line on stderr or the reason in run.json, where it did not finish
    # cpu_s, wall_s: from run.json, and measured around the call; 0 where unknown
    cpu_s: float
    wall_s: float
    reused: bool = False  # whether the run is one of an earlier call


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
    write_whole(folder / RECORD, json.dumps(asdict(outcome), indent=1))


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


# One thread each: what runs at a time is counted in runs, and CPU times mean something.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}

_ENDED = (0, 1, 2)  # exit statuses that the program chose: the outcome is the same next time

Starter: TypeAlias = "Callable[[Callable[[], subprocess.Popen[bytes]]], subprocess.Popen[bytes]]"
Ender: TypeAlias = "Callable[[subprocess.Popen[bytes]], None]"


@dataclass(frozen=True)
class Task:
    """What to run, and where its files go."""

    label: str  # name of the run, unique among those of `parent`
    parent: Path  # folder in which the run gets its own
    program: Path  # the executable
    text: str | None  # the scene, for the solver; None for a program with arguments
    args: tuple[str, ...]  # arguments of a program
    tables: tuple[Path, ...]  # files that the scene names, to be put next to it
    time_limit_s: float  # a run that takes longer is ended, and has crashed [s]
    code: str = ""  # hash of the modules that decided what is run
    origin: Path | None = None  # folder with the checkpoint from which the run goes on

    @cached_property
    def folder(self) -> Path:
        """Its folder, named by the label and a hash of all that the run's files depend on."""
        limit = str(self.time_limit_s)
        files = (*self.tables, *([self.origin / "checkpoint.bin"] if self.origin else ()))
        tables = (_file_hash(table) for table in files if table.is_file())
        parts = (_file_hash(self.program), self.code + _own_hash(), limit, self.text or "")
        content = "\0".join((*parts, *self.args, *tables))
        return self.parent / f"{slug(self.label)}-{hash_of(content.encode())[:16]}"


def tables_of(scene: Path, text: str) -> tuple[Path, ...]:
    """CSV files that the text of a scene names: in the folder of its file."""
    names = re.findall(r"^\s*schedule\s*=\s*'([^']+)'", text, re.MULTILINE)
    return tuple(scene.parent / name for name in names)


def copy_tables(task: Task, folder: Path) -> None:
    """Put the files that the scene names next to it; the solver reports one that is missing."""
    for table in task.tables:
        if table.is_file():
            shutil.copy(table, folder)


def run_task(
    task: Task, started: Starter = lambda start: start(), ended: Ender = lambda child: None
) -> Outcome:
    """Run a task, or find what an earlier call left.

    `started` is handed the function that starts the process, and gives the process; `ended` is
    told when it has ended.
    """
    earlier = read_outcome(task.folder)
    if earlier is not None:
        return earlier
    for old in task.parent.glob(f"{slug(task.label)}-*"):
        _remove(old)
    output = task.folder / "output"
    output.mkdir(parents=True)
    command = _command(task)
    begin = time.perf_counter()
    status, late = _call(command, output, task.time_limit_s, started, ended)
    wall_s = time.perf_counter() - begin
    if status == 0:  # of a run that is done nobody takes the state
        for checkpoint in output.glob("checkpoint*.bin"):
            checkpoint.unlink()
    outcome = judge_end(task.folder, status, late, task.time_limit_s, wall_s)
    if late or status in _ENDED:
        write_outcome(task.folder, outcome)
    return outcome


def slug(name: str) -> str:
    """Name of a folder for a label: readable and unique."""
    readable = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:40]
    return f"{readable}-{hash_of(name.encode())[:6]}"


def hash_of(content: bytes) -> str:
    """Hash of bytes, as text."""
    return hashlib.sha256(content).hexdigest()


def _command(task: Task) -> list[str]:
    if task.text is None:
        return [*_bound(), str(task.program), *task.args]
    (task.folder / "input.nml").write_text(task.text, encoding="utf-8")
    copy_tables(task, task.folder)
    run = ("run", "../input.nml", "--out", ".", "--quiet")
    origin = () if task.origin is None else ("--restart", str(task.origin.resolve()))
    return [*_bound(), str(task.program), *run, *origin]


@lru_cache(maxsize=1)
def _bound() -> tuple[str, ...]:
    """Words before a command by which it ends with who started it, however that one ended."""
    program = shutil.which("setpriv")
    return () if program is None else (program, "--pdeathsig", "KILL", "--")


def _call(
    command: list[str], output: Path, limit_s: float, started: Starter, ended: Ender
) -> tuple[int, bool]:
    """Exit status, and whether the time limit ended it."""
    with (
        (output.parent / "stdout.txt").open("wb") as out,
        (output.parent / "stderr.txt").open("wb") as error,
    ):
        child = started(
            lambda: subprocess.Popen(
                command,
                cwd=output,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=error,
                env=os.environ | ONE_THREAD,
            )
        )
        late = threading.Event()
        # wait(timeout) would look every few milliseconds whether it has ended
        limit = threading.Timer(limit_s, _end, (child, late))
        limit.daemon = True
        limit.start()
        try:
            return child.wait(), late.is_set()
        finally:
            limit.cancel()
            ended(child)


def _end(child: subprocess.Popen[bytes], late: threading.Event) -> None:
    """End a process that is still there at its time limit, and say so."""
    if child.poll() is None:
        late.set()
        child.kill()


def _remove(folder: Path) -> None:
    """Take a folder away, even if a process that nobody waits for any more still writes there."""
    aside = folder.with_name(f".{folder.name}.{os.getpid()}.old")
    with suppress(FileNotFoundError):  # another worker was faster
        folder.rename(aside)
        shutil.rmtree(aside, ignore_errors=True)


def _file_hash(path: Path) -> str:
    state = path.stat()
    return _hash_of_file(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=64)
def _hash_of_file(path: Path, _changed: int, _size: int) -> str:
    return hash_of(path.read_bytes())


@lru_cache(maxsize=1)
def _own_hash() -> str:
    """Hash of this module, which decides how a run is called."""
    return hash_of(Path(__file__).read_bytes())
