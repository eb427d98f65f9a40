"""One call of the solver or of another program, ready to start, in a separate folder."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TypeAlias

from wingcrack.runner.outcome import Outcome, judge_end, read_outcome, write_outcome

# One thread each: what runs at a time is counted in runs, and CPU times mean something.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}

_ENDED = (0, 1, 2)  # exit statuses that the program chose: the outcome is the same next time

Starter: TypeAlias = "Callable[[Callable[[], subprocess.Popen[bytes]]], subprocess.Popen[bytes]]"
Ender: TypeAlias = "Callable[[subprocess.Popen[bytes]], None]"


@dataclass(frozen=True)
class Task:
    """What to run, and where its files go.

    Attributes
    ----------
    label : str
        Name of the run, unique among those of `parent`.
    parent : Path
        Folder in which the run gets its own.
    program : Path
        The executable.
    text : str or None
        The scene, for the solver; None for a program with arguments.
    args : tuple of str
        Arguments of a program.
    tables : tuple of Path
        Files that the scene names, to be put beside it.
    time_limit_s : float
        A run that takes longer is ended, and has crashed [s].
    code : str
        Hash of the modules that decided what is run.
    """

    label: str
    parent: Path
    program: Path
    text: str | None
    args: tuple[str, ...]
    tables: tuple[Path, ...]
    time_limit_s: float
    code: str = ""

    @cached_property
    def folder(self) -> Path:
        """Its folder, named by the label and a hash of all that the run's files depend on."""
        limit = str(self.time_limit_s)
        tables = (_file_hash(table) for table in self.tables if table.is_file())
        parts = (_file_hash(self.program), self.code + _own_hash(), limit, self.text or "")
        content = "\0".join((*parts, *self.args, *tables))
        return self.parent / f"{slug(self.label)}-{hash_of(content.encode())[:16]}"


def tables_of(scene: Path, text: str) -> tuple[Path, ...]:
    """CSV files that the text of a scene names: they lie beside its file."""
    names = re.findall(r"^\s*schedule\s*=\s*'([^']+)'", text, re.MULTILINE)
    return tuple(scene.parent / name for name in names)


def copy_tables(task: Task, folder: Path) -> None:
    """Put the files that the scene names beside it; one that is missing is the solver's to tell."""
    for table in task.tables:
        if table.is_file():
            shutil.copy(table, folder)


def run_task(
    task: Task,
    started: Starter = lambda start: start(),
    ended: Ender = lambda child: None,
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
    outcome = judge_end(task.folder, status, late, task.time_limit_s, wall_s)
    if late or status in _ENDED:
        write_outcome(task.folder, outcome)
    return outcome


def slug(name: str) -> str:
    """Name of a folder for a label: readable, and no two alike."""
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
    return [*_bound(), str(task.program), *run]


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
