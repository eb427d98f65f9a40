"""Command line: ``python -m wingcrack_verify [CASE ...]``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from wingcrack_verify.errors import CaseError, EnvironmentLacksError
from wingcrack_verify.execute import Job, Outcome, Programs, Runner
from wingcrack_verify.judge import RED
from wingcrack_verify.report import Report, make_report
from wingcrack_verify.suite import Suite, judge_suite, read_suite

TOP = Path(__file__).resolve().parents[2]

_EPILOG = """\
Runs the verification cases, measures their errors and writes verification/report/ with index.html,
report.pdf and report.json. What has not changed since an earlier call is not run again.

Exit status: 0 all passed or known gaps; 1 a case failed or is in error; 2 bad usage; 3 not built.

example:
  wingcrack verify --quick
  wingcrack verify onset_c1 stability
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help.\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status."""
    given = _parser().parse_args(arguments)
    try:
        suite = read_suite(given.cases, given.names, given.quick)
    except CaseError as reason:
        print(f"wingcrack verify: {reason}", file=sys.stderr)
        return 2
    runner = Runner(Programs(given.build, given.cases / "programs"), given.cache, given.jobs)
    try:
        return _verify(suite, runner, given)
    except EnvironmentLacksError as reason:
        print(f"wingcrack verify: {reason}", file=sys.stderr)
        return 3
    except KeyboardInterrupt:
        print("wingcrack verify: interrupted; what is done is kept", file=sys.stderr)
        return 130


def _verify(suite: Suite, runner: Runner, given: argparse.Namespace) -> int:
    begin = time.perf_counter()
    progress = _Progress(len(suite.jobs))
    outcomes = runner.run_all(suite.jobs, progress)
    run_s = time.perf_counter() - begin
    judged = judge_suite(suite, outcomes)
    report = Report(
        judged,
        quick=given.quick,
        selected=bool(given.names),
        jobs=given.jobs,
        runs=len(outcomes),
        reused=sum(outcome.reused for outcome in outcomes.values()),
        run_s=run_s,
        build=given.build,
    )
    written = make_report(report, given.report)
    for line in report.summary_lines():
        print(line)
    print(f"{written}  ({time.perf_counter() - begin:.0f} s)")
    return 1 if report.verdict in RED else 0


class _Progress:
    """A line per finished run."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._done = 0
        self._width = len(str(total))

    def __call__(self, job: Job, outcome: Outcome) -> None:
        self._done += 1
        if outcome.reused:
            how = "as before"
        elif outcome.status == "finished":
            how = f"{outcome.cpu_s:.2f} CPU s"
        else:
            how = f"{outcome.status}: {outcome.reason}"
        place = f"[{self._done:{self._width}}/{self._total}]"
        print(f"{place} {job.case}: {job.run.name}: {how}", flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="wingcrack verify",
        description="Verification cases: errors, orders, run times, stability.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="CASE", help="folders of verification/")
    parser.add_argument("--quick", action="store_true", help="only the quick cases")
    parser.add_argument("--jobs", type=_count, default=2, metavar="N", help="runs at a time (2)")
    for name, path, text in (
        ("--cases", TOP / "verification", "where the cases are"),
        ("--build", TOP / "build" / "release", "where the solver was built"),
        ("--cache", TOP / "build" / "verification", "where the files of the runs are kept"),
        ("--report", TOP / "verification" / "report", "where the report goes"),
    ):
        parser.add_argument(name, type=Path, default=path, metavar="DIR", help=text)
    return parser


def _count(text: str) -> int:
    number = int(text)
    if not 1 <= number <= 64:
        raise argparse.ArgumentTypeError(f"{text} is not a number from 1 to 64")
    return number
