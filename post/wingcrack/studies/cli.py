"""`wingcrack study`: many runs of a scene, a table of them and figures."""

from __future__ import annotations

import fcntl
import json
import os
import signal
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from wingcrack.errors import CaseError
from wingcrack.figures.text_files import write_whole
from wingcrack.runner.task import Outcome, Task
from wingcrack.studies.convergence import write_convergence
from wingcrack.studies.outputs import UnreadableError, judge_run
from wingcrack.studies.running import Clock, check_scenes, done_before, run_tasks, tasks_of
from wingcrack.studies.study import Study, read_study
from wingcrack.studies.table import (
    StudyTable,
    make_table,
    write_csv,
    write_parquet,
    write_statistics,
)

_ENDED_BY = {signal.SIGINT: 130, signal.SIGTERM: 143}


class _Ended(BaseException):
    """A signal asks for the end."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.status = _ENDED_BY[signal.Signals(number)]


def study(given: SimpleNamespace) -> int:
    """Do what is asked for; give the exit status."""

    def end(number: int, _frame: object) -> None:
        raise _Ended(number)

    try:
        with _signals(end):
            return _Call(given).do()
    except CaseError as reason:
        return _say(str(reason), 2)
    except OSError as reason:
        place = f"{reason.filename}: " if reason.filename else ""
        return _say(f"{place}{reason.strerror or reason}", 1)
    except _Ended as ended:
        return _say("interrupted; nothing was run", ended.status)


def _say(text: str, status: int) -> int:
    print(f"wingcrack study: {text}", file=sys.stderr)
    return status


class _Call:
    """One call: the study, its machines, and what has been run."""

    def __init__(self, given: SimpleNamespace) -> None:
        self.given = given
        self.out: Path = given.out
        self.clock = Clock()
        self.study = read_study(given.study, given.quick)
        kind = given.cluster or self.study.cluster.kind
        self.cluster = self.study.cluster.model_copy(update={"kind": kind})
        self.workers = given.jobs or self.cluster.workers or len(os.sched_getaffinity(0))

    def do(self) -> int:
        """Run what is not done yet, if the solver takes the scenes; give the exit status."""
        study = self.study
        tasks = tasks_of(study, self.given.build, self.out)
        before = done_before(tasks)
        print(f"{study.title}\n{len(tasks)} runs, {len(before)} of them done before", flush=True)
        check_scenes([run for run in study.runs if run.number not in before], tasks, self.workers)
        if self.given.check:
            print("all scenes are sound; nothing was run")
            return 0
        self.out.mkdir(parents=True, exist_ok=True)
        with _folder_of_one(self.out):
            return self._run(tasks)

    def _run(self, tasks: Mapping[int, Task]) -> int:
        """Run what is not done, then write table and figures, whatever has ended the runs."""
        before = done_before(tasks)  # again: another call may have had the folder until now
        ledger = _Ledger(self.study, before, self.workers, self.clock)
        open_tasks = {number: task for number, task in tasks.items() if number not in before}
        status, why = 0, "interrupted"
        try:
            for outcome in before.values():
                ledger.judge(outcome)
            run_tasks(open_tasks, self.cluster, self.workers, ledger)
        except _Ended as ended:
            status = ended.status
        except SystemExit as ended:  # nobody reads what is printed any more
            status = int(ended.code or 1)
        except UnreadableError as reason:
            status, why = 1, f"{reason}; ended"
        with _signals(signal.SIG_IGN):  # nothing but SIGKILL comes between
            return self._finish(ledger, status, why)

    def _finish(self, ledger: _Ledger, ended: int, why: str) -> int:
        """Write table and figures of what there is, and report how it went."""
        study, out = self.study, self.out
        table = make_table(study, ledger.outcomes, out)
        write_csv(table, out / "table.csv")
        write_parquet(table, out / "table.csv", out / "table.parquet")
        if study.quantiles:
            write_statistics(study, table, out / "statistics.csv")
        write_convergence(study, table, out / "convergence.csv")
        before_s = self.clock.cpu_s()
        notes = [] if ended else _draw(study, table, out, self.given.format)
        self._write_record(ledger, ended, self.clock.cpu_s() - before_s)
        _tell(table, notes)
        if ended:
            left = len(study.runs) - len(ledger.outcomes)
            return _say(f"{why} with {left} runs to go; {out / 'table.csv'} has the rest", ended)
        bad = sum(row["status"] != "finished" for row in table.rows)
        if bad:
            return _say(f"{bad} of {len(table.rows)} runs failed; {out / 'table.csv'} says why", 1)
        if lacking := _read_of_none(study, table):
            return _say(f"'{lacking}' could be read of no run; {out / 'table.csv'} says why", 1)
        print(out / "table.csv")
        return 0

    def _write_record(self, ledger: _Ledger, ended: int, figures_s: float) -> None:
        """Write study.json: what the call did, and what it cost."""
        new = [outcome for outcome in ledger.outcomes.values() if not outcome.reused]
        counted = self.cluster.kind in ("none", "local")  # of others only their machines know
        record: dict[str, Any] = {
            "title": self.study.title,
            "study": self.given.study.name,
            "quick": self.given.quick,
            "status": "stopped" if ended else "finished",
            "cluster": self.cluster.kind,
            "runs": len(self.study.runs),
            "runs_done": len(ledger.outcomes),
            "runs_of_this_call": len(new),
            "runs_failed": sum(item.status != "finished" for item in ledger.outcomes.values()),
            "wall_s": round(self.clock.wall_s(), 3),
            "runs_cpu_s": round(sum(outcome.cpu_s for outcome in new), 3),
            "figures_cpu_s": round(figures_s, 3),
            "cpu_s": round(self.clock.cpu_s(), 3) if counted else None,
        }
        write_whole(self.out / "study.json", json.dumps(record, indent=1) + "\n")


class _Ledger:
    """The outcomes so far, and a line for each that comes."""

    def __init__(
        self, study: Study, before: Mapping[int, Outcome], workers: int, clock: Clock
    ) -> None:
        self.outcomes = dict(before)
        self.reused = len(before)
        self._study, self._is_judged = study, False
        self._labels = {run.number: run.label for run in study.runs}
        self._workers = workers
        self._clock = clock

    def __call__(self, number: int, outcome: Outcome) -> None:
        self.outcomes[number] = outcome
        if outcome.status == "finished":
            how = f"{outcome.cpu_s:.2f} CPU s"
        else:
            how = f"{outcome.status}: {outcome.reason}"
        done, total = len(self.outcomes), len(self._labels)
        place = f"[{done:{len(str(total))}}/{total}]"
        print(f"{place} {self._labels[number]}: {how}{self._left()}", flush=True)
        self.judge(outcome)

    def judge(self, outcome: Outcome) -> None:
        """Refuse to go on if the first finished run lacks what shall be read of all.

        Raises `UnreadableError`: with what it lacks.
        """
        if self._is_judged or outcome.status != "finished":
            return
        self._is_judged = True
        output, study = Path(outcome.folder) / "output", self._study
        may_lack = {item.file for item in study.quantities if item.may_be_absent}
        for place, selection in study.selections:
            if selection.file not in may_lack or (output / selection.file).exists():
                judge_run(selection, place, output, study.names)

    def _left(self) -> str:
        """How long the rest will take, if it is like what was run."""
        new, left = len(self.outcomes) - self.reused, len(self._labels) - len(self.outcomes)
        if left == 0 or new < self._workers:
            return ""
        seconds = self._clock.wall_s() / new * left
        return f"  (about {seconds / 60:.0f} min left)" if seconds > 90 else ""


def _read_of_none(study: Study, table: StudyTable) -> str:
    """Name of a quantity that no run has, and that may not be absent."""
    for quantity in study.quantities:
        if not quantity.may_be_absent and all(row[quantity.heading] is None for row in table.rows):
            return quantity.name
    return ""


def _draw(study: Study, table: StudyTable, out: Path, formats: Sequence[str]) -> list[str]:
    """Draw all figures; give what is missing in them."""
    if not study.plots:
        return []
    from wingcrack.studies.figures import draw

    notes = []
    for plot in study.plots:
        try:
            files, missing = draw(study, plot, table, out, formats)
            print(files[0], flush=True)
            notes += [f"figure '{plot.name}': {item}" for item in missing]
        except CaseError as reason:
            notes.append(str(reason))
    return notes


def _tell(table: StudyTable, notes: Sequence[str]) -> None:
    """List what failed and what could not be read, each with its reason."""
    for row in table.rows:
        if row["reason"]:
            print(f"{row['label']}: {row['status']}: {row['reason']}")
    for note in notes:
        print(note)


@contextmanager
def _signals(handler: Any) -> Iterator[None]:
    """Let a handler have the signals that end the call."""
    earlier = {number: signal.signal(number, handler) for number in _ENDED_BY}
    try:
        yield
    finally:
        for number, before in earlier.items():
            signal.signal(number, before)


@contextmanager
def _folder_of_one(out: Path) -> Iterator[None]:
    """Keep the folder of the study for this call alone."""
    handle = os.open(out, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise CaseError(f"another study is running in {out}: wait, or say --out") from None
    finally:
        os.close(handle)
