"""Synthetic runs for all tests."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from synthetic_run import write_run
from wingcrack.figures import style


@pytest.fixture(scope="session")
def wet_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a finished run with fluid; shared, so not to be changed."""
    return write_run(tmp_path_factory.mktemp("runs") / "wet")


@pytest.fixture(scope="session")
def dry_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a finished mechanics-only run; shared, so not to be changed."""
    return write_run(tmp_path_factory.mktemp("runs") / "dry", fluid=False)


@pytest.fixture
def own_run(wet_run: Path, tmp_path: Path) -> Path:
    """Give a copy of the run with fluid that a test may damage."""
    return Path(
        shutil.copytree(wet_run, tmp_path / "own", ignore=shutil.ignore_patterns("figures"))
    )


@pytest.fixture
def full_size() -> None:
    """Let pictures of a test have their full resolution."""


@pytest.fixture(autouse=True)
def _small_pictures(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw with fewer dots per inch, a fifth faster, where a test does not need `full_size`."""
    if "full_size" not in request.fixturenames:
        monkeypatch.setitem(style.RC, "savefig.dpi", 80)
