"""Interrupted in the middle, a call leaves nothing behind and says so by its status."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from map_calls import TOP, needs_solver


def cpu_seconds(process: int) -> float:
    """CPU time of a process so far: on a busy machine the time of the clock says nothing."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@needs_solver
@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_an_import_and_nothing_is_written(
    tmp_path: Path, number: signal.Signals, status: int
) -> None:
    rows = [f"{x},{y},{x + 3.0},{y + 3.01}" for x in range(60) for y in range(40)]
    (tmp_path / "m.csv").write_text("x1,y1,x2,y2\n" + "\n".join(rows) + "\n")
    process = subprocess.Popen(
        [sys.executable, "-m", "wingcrack", "import", "m.csv", "--repair", "0.5"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(TOP / "post")},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    while cpu_seconds(process.pid) < 2.5:  # it takes far longer
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(number)
    _, words = process.communicate(timeout=60)
    assert process.returncode == status
    assert "Traceback" not in words
    assert [file.name for file in tmp_path.iterdir()] == ["m.csv"]
