"""What the Python commands do when their words cannot be written, or are no text."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

START = Path(__file__).resolve().parent.parent / "tools" / "start.py"
COMMANDS = ("run", "plot", "view", "study", "new", "import", "verify", "bench", "docs")


def start(place: Path, *arguments: str | bytes, out: int, error: int) -> tuple[int, str]:
    """Give exit status and stderr of a command that is started as the launcher does it."""
    done = subprocess.run(
        [sys.executable, "-I", START, *arguments],
        cwd=place,
        stdin=subprocess.DEVNULL,
        stdout=out,
        stderr=error,
        check=False,
        timeout=120,
    )
    return done.returncode, (done.stderr or b"").decode()


def unread_pipe() -> int:
    """Give the end to write to of a pipe that nobody reads."""
    reading, writing = os.pipe()
    os.close(reading)
    return writing


@pytest.mark.parametrize("command", COMMANDS)
def test_a_pipe_that_nobody_reads_ends_a_call_quietly(tmp_path: Path, command: str) -> None:
    out = unread_pipe()
    called = start(tmp_path, command, "--help", out=out, error=subprocess.PIPE)
    os.close(out)
    assert called == (141, "")


def test_an_error_that_nobody_reads_ends_a_call_quietly(tmp_path: Path) -> None:
    error = unread_pipe()
    called = start(tmp_path, "view", "nowhere", out=subprocess.DEVNULL, error=error)
    os.close(error)
    assert called == (141, "")


def test_a_full_disk_is_told(tmp_path: Path) -> None:
    with Path("/dev/full").open("wb") as full:
        arguments = ["import", "--help"]
        status, said = start(tmp_path, *arguments, out=full.fileno(), error=subprocess.PIPE)
    reason = "wingcrack: the output cannot be written: No space left on device\n"
    assert (status, said) == (1, reason)


def test_an_argument_that_is_no_text_is_refused(tmp_path: Path) -> None:
    (tmp_path / os.fsdecode(b"\xff.csv")).write_text("x1,y1,x2,y2\n0,0,1,1\n")
    before = sorted(tmp_path.iterdir())
    arguments = ("import", b"\xff.csv")
    status, said = start(tmp_path, *arguments, out=subprocess.DEVNULL, error=subprocess.PIPE)
    assert (status, said) == (2, "wingcrack: the argument '\\udcff.csv' is not UTF-8 text\n")
    assert sorted(tmp_path.iterdir()) == before
