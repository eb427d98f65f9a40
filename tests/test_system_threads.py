"""Results are the same to the last bit for any number of threads, through the real program."""

from __future__ import annotations

from pathlib import Path

import pytest
from system_scene import TOP, call, changed

pytestmark = pytest.mark.usefixtures("program")


def test_threads_change_no_bit(tmp_path: Path) -> None:
    """Scene C2 with large windows: stencils, windows, and fronts of windows and of the body."""
    text = changed(
        (TOP / "inputs/paper_c/wing_crack.nml").read_text(),
        ("window = 0.5", "window = 1.0"),
        ("stop_gain = 0.25", "stop_gain = 0.02"),
    )
    (tmp_path / "scene.nml").write_text(text)
    for threads in ("1", "2", "3"):
        done = call(
            tmp_path, "run", "scene.nml", "--out", threads, "--no-plot", "--threads", threads
        )
        assert done.returncode == 0, done.stderr
    for table in ("history.csv", "tips.csv", "fractures.csv"):
        alone = (tmp_path / "1" / table).read_bytes()
        assert alone.count(b"\n") > 10
        assert (tmp_path / "2" / table).read_bytes() == alone
        assert (tmp_path / "3" / table).read_bytes() == alone
