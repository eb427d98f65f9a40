"""Runs and checks of scenes for the command line: the solver is called, and signals reach it."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import FrameType, SimpleNamespace

from wingcrack.command_line.declaring import TOP
from wingcrack.command_line.run_commands import judge_place

_PROGRAMS = TOP / "build" / "release" / "fortran" / "app"
SOLVER, RANKS_SOLVER = _PROGRAMS / "wingcrack-solver", _PROGRAMS / "wingcrack-ranks"
LAUNCHER = TOP / "wingcrack"

_CANNOT_START = 127
_SAME: dict[int, int] = {signal.SIGINT: signal.SIGINT, signal.SIGTERM: signal.SIGTERM}
# Of signals, mpiexec takes SIGINT and SIGTERM for its own business, and hands on two others
# (algebra_ranks.c).
_FOR_RANKS: dict[int, int] = {signal.SIGINT: signal.SIGUSR1, signal.SIGTERM: signal.SIGUSR2}
_MPIEXEC = [
    *("mpiexec.openmpi", "--quiet", "--oversubscribe", "--bind-to", "none"),
    *("--mca", "mpi_yield_when_idle", "1", "--mca", "btl_vader_single_copy_mechanism", "none"),
]


def run(given: SimpleNamespace) -> int:
    """Run a scene, then draw its figures; give the exit status."""
    scene, out = given.scene, given.out
    if given.restart is not None:
        return _go_on(given)
    if out is None:
        status, name = _call([SOLVER, "name", scene], stdout=subprocess.PIPE)
        if status:
            return status
        out = f"out/{name.strip()}"
        judge_place(out)
    if given.ranks > 1:
        # A scene without use for them is refused before MPI is installed for it.
        for program, *asked in ((SOLVER, "ranks", scene), (LAUNCHER, "prepare-ranks")):
            status, _ = _call([program, *asked])
            if status:
                return status
    quiet = ["--quiet"] if given.quiet else []
    words = ["run", scene, "--out", out, *quiet]
    if given.ranks > 1:
        status = _on_ranks(given.ranks, given.threads, words)
    else:
        status, _ = _call([SOLVER, *words], given.threads)
    return _drawn(status, out, given)


def _go_on(given: SimpleNamespace) -> int:
    """Go on from a checkpoint; give the exit status."""
    out = given.out or given.restart
    scene = [] if given.scene is None else [given.scene]
    end = [] if given.end is None else ["--end", repr(given.end)]
    quiet = ["--quiet"] if given.quiet else []
    words = ["run", *scene, "--restart", given.restart, *end, "--out", out, *quiet]
    status, _ = _call([SOLVER, *words], given.threads)
    return _drawn(status, out, given)


def _drawn(status: int, out: str, given: SimpleNamespace) -> int:
    """Draw the figures of a run that has ended with this status; give the exit status."""
    if status != 0:
        return status
    if not given.quiet:
        from wingcrack.closing import closing_lines

        for line in closing_lines(Path(out)):
            print(line, flush=True)
    if not given.no_plot:
        # Figures are an extra: without them the run is still done.
        drawn, _ = _call([LAUNCHER, "plot", out, "--quiet"])
        if drawn in (130, 143):
            return drawn
        page = Path(out) / "figures" / "index.html"
        if drawn != 0:
            _say(f"the run is done, but drawing its figures failed; try ./wingcrack plot {out}")
        elif not given.quiet and page.is_file():
            count = len(list(page.parent.glob("[!.]*.png")))
            print(f"{count} figures and {page}", flush=True)
    return status


def check(given: SimpleNamespace) -> int:
    """Let the solver judge a scene; give the exit status.

    Its words are written here: gfortran does not tell of a full disk.
    """
    asked = ["--stress"] if given.stress or given.json or given.mohr else []
    status, words = _call([SOLVER, "check", given.scene, *asked], stdout=subprocess.PIPE)
    if status == 0 and asked:
        from wingcrack.figures import mohr  # of the wheel too, but only for this

        return mohr.show(words, as_json=given.json, figure=given.mohr)
    sys.stdout.write(words)
    return status


def _on_ranks(ranks: int, threads: int, words: Sequence[str]) -> int:
    """Exit status of a run whose large matrices are shared by processes."""
    status, _ = _call(
        [*_MPIEXEC, "-n", str(ranks), RANKS_SOLVER, *words],
        threads,
        sent=_FOR_RANKS,
        stdin=subprocess.DEVNULL,
        start_new_session=True,
    )
    for ours, theirs in _FOR_RANKS.items():
        if status == 128 + theirs:  # before the ranks knew of it
            return 128 + ours
    if 130 < status < 200 and status != 143:
        _say(
            f"signal {status - 128} has ended a rank, which may be for want of memory;"
            " the last state written before that is on disk"
        )
    return status


def _call(
    words: Sequence[str | Path],
    threads: int = 1,
    *,
    sent: Mapping[int, int] = _SAME,
    stdin: int | None = None,
    stdout: int | None = None,
    start_new_session: bool = False,
) -> tuple[int, str]:
    """Exit status and, from a pipe, words of a program; signals to this process reach it.

    Its threads do not keep a core busy while they wait.
    """
    count = {"OPENBLAS_NUM_THREADS": str(threads), "OMP_NUM_THREADS": str(threads)}
    as_root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}  # as all here
    process: subprocess.Popen[str] | None = None
    early: list[int] = []

    def forward(number: int, _frame: FrameType | None) -> None:
        if process is None:
            early.append(number)
        else:
            process.send_signal(sent[number])

    heeded = [number for number in sent if signal.getsignal(number) != signal.SIG_IGN]
    before = {number: signal.signal(number, forward) for number in heeded}
    try:
        process = subprocess.Popen(
            words,
            env={**os.environ, **count, **as_root, "OMP_WAIT_POLICY": "passive"},
            stdin=stdin,
            stdout=stdout,
            start_new_session=start_new_session,
            text=True,
        )
        for number in early:
            process.send_signal(sent[number])
        said, _ = process.communicate()
    except OSError as reason:
        return _say(f"{words[0]} cannot be started: {reason.strerror}", 3), ""
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    status = process.returncode if process.returncode >= 0 else 128 - process.returncode
    if status == _CANNOT_START and words[0] == SOLVER:
        status = _why_not()
    return status, said or ""


def _why_not() -> int:
    """Say why the solver cannot start; give the exit status."""
    told = subprocess.run(["ldd", SOLVER], capture_output=True, text=True, check=False).stdout
    lacking = ", ".join(re.findall(r"^\s*(.*) => not found$", told, re.MULTILINE))
    if not lacking:
        return _say(
            "there is not enough memory to start: allow this process at least 1 GB (ulimit -v)", 1
        )
    return _say(
        f"the solver cannot start without {lacking}; remove the folders {TOP / '.venv'} and"
        f" {TOP / 'build'} and call again, which installs and builds again",
        3,
    )


def _say(text: str, status: int = 0) -> int:
    print(f"wingcrack: {text}", file=sys.stderr)
    return status
