"""What `cmake --install` installs works without the folder of the sources."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from launcher_tree import TOP

from wingcrack import __version__


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory, program: None) -> Path:
    """An installation, moved after it was made: nothing in it may know where it was."""
    first = tmp_path_factory.mktemp("first") / "prefix"
    subprocess.run(
        ["cmake", "--install", TOP / "build" / "release", "--prefix", first],
        check=True,
        capture_output=True,
    )
    return first.rename(tmp_path_factory.mktemp("then") / "pre fix")


def call(
    prefix: Path, place: Path, *words: str, python: str = sys.executable
) -> subprocess.CompletedProcess[str]:
    """Call the installed command in a folder; the tree of the sources is not on any path."""
    kept = {name: os.environ[name] for name in ("PATH", "HOME") if name in os.environ}
    return subprocess.run(
        [prefix / "bin" / "wingcrack", *words],
        cwd=place,
        env=kept | {"WINGCRACK_PYTHON": python, "XDG_CACHE_HOME": str(place / "cache")},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def test_it_runs_a_scene_and_draws(prefix: Path, tmp_path: Path) -> None:
    scene = prefix / "share" / "wingcrack" / "inputs" / "paper_b" / "edge_mode1.nml"
    done = call(prefix, tmp_path, "run", str(scene), "--no-plot", "--quiet")
    assert done.returncode == 0, done.stderr
    done = call(prefix, tmp_path, "plot", "out/edge_mode1", "--only", "network", "--format", "png")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "edge_mode1" / "figures" / "network.png").is_file()


def test_it_knows_its_version_and_writes_scenes(prefix: Path, tmp_path: Path) -> None:
    assert call(prefix, tmp_path, "--version").stdout == f"wingcrack {__version__}\n"
    assert call(prefix, tmp_path, "new", "column").returncode == 0
    assert call(prefix, tmp_path, "check", "column.nml").returncode == 0


def test_its_solver_needs_no_library_of_the_sources(prefix: Path) -> None:
    done = subprocess.run(
        ["ldd", prefix / "bin" / "wingcrack-solver"], capture_output=True, text=True, check=True
    )
    assert "not found" not in done.stdout
    assert str(TOP) not in done.stdout


def test_what_needs_the_sources_is_refused(prefix: Path, tmp_path: Path) -> None:
    for command in ("test", "verify", "docs"):
        done = call(prefix, tmp_path, command)
        assert done.returncode == 2
        assert f"{command} needs the folder of the sources" in done.stderr


def test_a_python_that_will_not_do_is_named(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    done = call(prefix, tmp_path, "plot", "run", python="/no/such/python")
    assert done.returncode == 3
    assert "there is no Python /no/such/python" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    done = call(prefix, tmp_path, "plot", "run", python="/usr/bin/true")
    assert done.returncode == 3


def test_tests_stay_with_the_sources(prefix: Path) -> None:
    packages = prefix / "lib" / "wingcrack" / "post"
    assert not list(packages.glob("tests*"))
    assert (packages / "wingcrack_verify").is_dir()
    assert not (packages / "wingcrack_verify" / "bench").exists()
