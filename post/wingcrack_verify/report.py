"""The report as a whole: its rows, its verdict and its files."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections import Counter
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory

from wingcrack.figures.text_files import write_whole
from wingcrack_verify import environment
from wingcrack_verify.judge import PASSED, VERDICTS
from wingcrack_verify.page import illustrate, page_text, shortened
from wingcrack_verify.record import Context, record_of
from wingcrack_verify.rows import Row, rows_of
from wingcrack_verify.suite import JudgedSuite

TOP = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Report:
    """What was judged, and how the call went."""

    judged: JudgedSuite
    quick: bool
    selected: bool
    jobs: int
    runs: int
    reused: int
    run_s: float
    build: Path = TOP / "build" / "release"
    rows: tuple[Row, ...] = field(init=False)

    def __post_init__(self) -> None:
        """List the rows once."""
        object.__setattr__(self, "rows", tuple(rows_of(self.judged)))

    @property
    def verdict(self) -> str:
        """The worst of all."""
        return self.judged.verdict

    @property
    def counts(self) -> dict[str, int]:
        """Number of rows by verdict."""
        found = Counter(row.verdict for row in self.rows)
        return {verdict: found[verdict] for verdict in VERDICTS}

    def summary_lines(self) -> list[str]:
        """Lines for the terminal at the end: what did not pass, then the counts."""
        lines = [
            f"{row.verdict.upper()}  {row.case}: {row.quantity}: {reason}"
            for row in self.rows
            if row.verdict != PASSED
            for reason in shortened(row.reasons) or [""]
        ]
        counts = ", ".join(f"{number} {verdict}" for verdict, number in self.counts.items())
        return [*lines, f"{counts}; {self.runs} runs, {self.reused} of them as before"]


def make_report(report: Report, folder: Path) -> tuple[Path, str]:
    """Write index.html, report.json and, if not quick and a browser can, report.pdf, each whole.

    Gives the page's path, and why there is no PDF, else an empty text.
    """
    folder.mkdir(parents=True, exist_ok=True)
    context = Context(
        made=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        revision=environment.revision(TOP),
        machine=environment.machine(),
        packages=environment.packages(report.build),
        scope=_scope(report),
        call={
            "runs": report.runs,
            "runs reused": report.reused,
            "runs at a time": report.jobs,
            "time for the runs [s]": round(report.run_s, 1),
        },
    )
    record = record_of(report.judged, report.rows, report.counts, context)
    pictures = illustrate(report.judged, report.jobs, passed=not report.quick)
    write_whole(folder / "report.json", json.dumps(record, indent=1, allow_nan=False).encode())
    page = folder / "index.html"
    write_whole(page, page_text(report.judged, record, pictures, folder).encode())
    target = folder / "report.pdf"
    target.unlink(missing_ok=True)
    return page, "" if report.quick else print_page(page, target)


def _scope(report: Report) -> str:
    which = "the quick cases" if report.quick else "all cases"
    which = f"{which} that were asked for by name" if report.selected else which
    return f"{which}, figures of what did not pass" if report.quick else which


BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_PATIENCE_S = 300.0


def print_page(page: Path, target: Path) -> str:
    """Print a page to a PDF, which appears whole; an earlier one goes.

    Returns
    -------
    str
        Why there is no PDF, as one sentence for the user; empty if there is one.
    """
    target.unlink(missing_ok=True)
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        return (
            f"no {target.name} was written: printing it takes Chromium or Chrome"
            " (Debian: apt install chromium)."
        )
    with TemporaryDirectory(dir=target.parent, prefix=".print.") as folder:
        printed = Path(folder) / target.name
        call = [
            browser,
            "--headless",
            "--disable-gpu",
            "--no-pdf-header-footer",
            f"--user-data-dir={folder}/profile",
            f"--print-to-pdf={printed}",
            page.resolve().as_uri(),
        ]
        if os.geteuid() == 0:
            call.insert(1, "--no-sandbox")  # root has none
        try:
            done = subprocess.run(call, capture_output=True, timeout=_PATIENCE_S, check=False)
        except (OSError, subprocess.TimeoutExpired) as reason:
            return f"no {target.name} was written: {browser} failed ({reason})."
        if done.returncode != 0 or not printed.is_file():
            return f"no {target.name} was written: {browser} ended with {done.returncode}."
        printed.replace(target)
    return ""
