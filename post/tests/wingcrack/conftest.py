"""Synthetic runs for all tests."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from synthetic_run import write_run


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
