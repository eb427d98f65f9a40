"""Trees for the tests of the launcher, and the built program for those of the whole."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from launcher_tree import (
    APT_CACHE,
    APT_GET,
    PACKAGES,
    SUDO,
    Tree,
    add_environment,
    add_program,
    make_tree,
)
from system_scene import GROWING, SCENE, call, run


@pytest.fixture
def bare_tree(tmp_path: Path) -> Tree:
    """A tree where nothing has been set up."""
    return make_tree(tmp_path)


@pytest.fixture(scope="session")
def shared_tree(tmp_path_factory: pytest.TempPathFactory) -> Tree:
    """A tree that the first call has set up; a test must leave it as it is."""
    tree = make_tree(tmp_path_factory.mktemp("launcher"))
    done = tree.call("check", tree.scene())
    assert done.returncode == 0, done.stderr
    return tree


@pytest.fixture
def ready_tree(shared_tree: Tree, tmp_path: Path) -> Tree:
    """The tree that is set up, called from an empty folder."""
    return Tree(shared_tree.root, tmp_path)


def _copy(source: str, target: str) -> None:
    """Copy a file; one of pip, which nothing writes into, is linked."""
    if "/site-packages/pip/" in source:
        os.link(source, target)
    else:
        shutil.copy2(source, target)


@pytest.fixture
def own_tree(shared_tree: Tree, tmp_path: Path) -> Tree:
    """A tree that is set up and free to be changed: a copy, so it has noticed being elsewhere."""
    root = tmp_path / "tree"
    shutil.copytree(shared_tree.root, root, symlinks=True, copy_function=_copy)
    place = tmp_path / "place"
    place.mkdir()
    tree = Tree(root, place)
    assert tree.call("check", tree.scene()).returncode == 0
    return tree


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """A folder for PATH that holds a package manager."""
    folder = tmp_path / "machine"
    add_program(folder, "apt-get", APT_GET)
    add_program(folder, "apt-cache", APT_CACHE)
    add_program(folder, "sudo", SUDO)
    return folder


@pytest.fixture
def lacking_tree(tmp_path: Path, machine: Path) -> Tree:
    """A tree whose system packages are not there, and nothing else is missing."""
    tree = make_tree(tmp_path, PACKAGES)
    add_environment(tree)
    tree.environment["PATH"] = f"{machine}:{os.environ['PATH']}"
    return tree


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> None:
    """The real program is built, so that no later call has anything to say about building."""
    place = tmp_path_factory.mktemp("program")
    (place / "small.nml").write_text(SCENE)
    done = call(place, "check", "small.nml")
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="session")
def resting(program: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of a run without growth; a test must leave them as they are."""
    return run(tmp_path_factory.mktemp("resting"), SCENE)


@pytest.fixture(scope="session")
def growing(program: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of a run whose fracture grows at both ends; a test must leave them as they are."""
    return run(tmp_path_factory.mktemp("growing"), GROWING)
