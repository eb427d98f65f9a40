"""Kill a program again and again while it writes: every file that has its name is whole.

Usage: python check_killed_writer.py PROGRAM
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

from check_run_files import read_vtu

FOLDER = Path("write_endlessly.out")
N_POINTS = 20000


def check(program: str) -> None:
    """Assert that both files are whole after each kill."""
    expected = tuple(float(i) for i in range(1, N_POINTS + 1))
    table = "x_m,y_m\n" + "".join(f"{x},{x}\n" for x in expected)
    n_aside = 0
    for kill in range(12):
        with subprocess.Popen([program]) as writer:
            while not (FOLDER / "table.csv").exists() and writer.poll() is None:
                time.sleep(0.01)
            time.sleep(0.02 + 0.0037 * kill)  # somewhere else in the work each time
            assert writer.poll() is None, "the program ended by itself"
            writer.kill()
        n_aside += len(list(FOLDER.glob("*.part")))
        assert read_vtu(FOLDER / "grid.vtu")["x"] == expected
        assert (FOLDER / "table.csv").read_text(encoding="utf-8") == table
    print(f"12 kills, {n_aside} of them in the middle of a file")


if __name__ == "__main__":
    check(sys.argv[1])
