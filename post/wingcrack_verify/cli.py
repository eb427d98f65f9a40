"""`wingcrack verify`: the verification cases and their report."""

from __future__ import annotations

import sys
import time
from types import SimpleNamespace

from wingcrack.errors import CaseError
from wingcrack_verify.execute import Job, Outcome, Programs, Runner
from wingcrack_verify.judge import RED
from wingcrack_verify.report import Report, make_report
from wingcrack_verify.suite import Suite, judge_suite, read_suite


def verify(given: SimpleNamespace) -> int:
    """Do what is asked for; give the exit status."""
    try:
        suite = read_suite(given.cases, given.names, given.quick)
    except CaseError as reason:
        print(f"wingcrack verify: {reason}", file=sys.stderr)
        return 2
    runner = Runner(Programs(given.build, given.cases / "programs"), given.cache, given.jobs)
    try:
        return _verify(suite, runner, given)
    except KeyboardInterrupt:
        print("wingcrack verify: interrupted; what is done is kept", file=sys.stderr)
        return 130


def _verify(suite: Suite, runner: Runner, given: SimpleNamespace) -> int:
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
    written, unprinted = make_report(report, given.report)
    for line in report.summary_lines():
        print(line)
    if unprinted:
        print(unprinted)
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
