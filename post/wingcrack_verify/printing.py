"""A page as PDF, printed by a browser without a window."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

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
