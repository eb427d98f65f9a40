"""The set-up: what it installs and builds, what it refuses, and that it does nothing twice."""

from __future__ import annotations

import os
import shutil
import subprocess
import time
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from launcher_tree import PACKAGES, Tree, add_environment, add_program, asked, make_tree


def test_forbidden_to_install_it_names_all_that_is_missing(tmp_path: Path, machine: Path) -> None:
    tree = make_tree(tmp_path, PACKAGES, "numpy==0.0.1\n# a remark\nno-such-thing==2.0\n")
    tree.environment["PATH"] = f"{machine}:{os.environ['PATH']}"
    done = tree.call("check", tree.scene(), WINGCRACK_NO_INSTALL="1")
    assert done.returncode == 3
    assert done.stdout == ""
    for name in ("alpha-tool", "beta-lib-5*", "numpy==0.0.1", "no-such-thing==2.0"):
        assert name in done.stderr
    assert "always" not in done.stderr
    assert asked(machine) == []
    assert not (tree.root / ".venv").exists()


def test_forbidden_to_install_it_still_builds_and_runs(own_tree: Tree) -> None:
    (own_tree.root / "fortran" / "b_more.sh").write_text("echo rebuilt\n")
    done = own_tree.call("check", own_tree.scene(), WINGCRACK_NO_INSTALL="1")
    assert done.returncode == 0
    assert "rebuilt" in done.stdout


def test_missing_packages_are_named_with_their_purpose_and_installed(
    lacking_tree: Tree, machine: Path
) -> None:
    done = lacking_tree.call("check", lacking_tree.scene())
    assert done.returncode == 0, done.stderr
    assert "solver check" in done.stdout
    assert "first thing" in done.stderr
    assert "second thing" in done.stderr
    # The newest of the versions on offer, in the order of versions, not of letters.
    assert asked(machine)[-1] == "install alpha-tool beta-lib-5.10"


@pytest.fixture
def ranks_tree(lacking_tree: Tree, machine: Path) -> Tree:
    """A tree whose system packages are not there, where ranks take one more."""
    (lacking_tree.root / "tools" / "system_packages_ranks.txt").write_text(
        "gamma-mpi | command gamma-mpi | third thing\n"
    )
    add_program(machine, "mpiexec.openmpi", 'while [[ $1 != -n ]]; do shift; done; exec "${@:3}"')
    return lacking_tree


def test_what_ranks_take_is_installed_and_built_for_them_alone(
    ranks_tree: Tree, machine: Path
) -> None:
    scene = ranks_tree.scene()
    assert ranks_tree.call("run", scene, "--no-plot").returncode == 0
    assert asked(machine)[-1] == "install alpha-tool beta-lib-5.10"
    program = ranks_tree.root / "build" / "release" / "fortran" / "app" / "wingcrack-ranks"
    assert not program.exists()
    done = ranks_tree.call("run", scene, "--ranks", "2", "--no-plot")
    assert done.returncode == 0, done.stderr
    assert "third thing" in done.stderr
    assert asked(machine)[-1] == "install gamma-mpi"
    assert program.exists()
    before = ranks_tree.log
    again = ranks_tree.call("run", scene, "--ranks", "2", "--no-plot")
    assert (again.returncode, again.stderr) == (0, "")
    assert ranks_tree.log == before


def test_forbidden_to_install_it_names_what_ranks_take(ranks_tree: Tree, machine: Path) -> None:
    scene = ranks_tree.scene()
    assert ranks_tree.call("run", scene, "--no-plot").returncode == 0
    done = ranks_tree.call("run", scene, "--ranks", "2", WINGCRACK_NO_INSTALL="1")
    assert (done.returncode, done.stdout) == (3, "")
    assert "gamma-mpi" in done.stderr
    assert "gamma-mpi" not in asked(machine)[-1]


def test_ranks_in_vain_install_nothing(ranks_tree: Tree, machine: Path) -> None:
    done = ranks_tree.call("run", ranks_tree.scene("# no fluid"), "--ranks", "2")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.splitlines()[-1] == "it has no fluid"
    assert "gamma-mpi" not in asked(machine)[-1]


def test_stale_package_lists_are_updated_once(lacking_tree: Tree, machine: Path) -> None:
    (machine / "stale").touch()
    done = lacking_tree.call("check", lacking_tree.scene())
    assert done.returncode == 0, done.stderr
    assert asked(machine)[-2:] == ["update", "install alpha-tool beta-lib-5.10"]


def test_a_failed_installation_says_why(lacking_tree: Tree, machine: Path) -> None:
    (machine / "broken").touch()
    done = lacking_tree.call("check", lacking_tree.scene())
    assert done.returncode == 3
    assert "E: no such package" in done.stderr
    assert "apt could not install the packages" in done.stderr.splitlines()[-1]


def test_a_python_package_that_cannot_be_had_is_an_error(tmp_path: Path) -> None:
    tree = make_tree(tmp_path, requirements="no-such-thing==2.0\n")
    done = tree.call("check", tree.scene(), PIP_NO_INDEX="1", PIP_FIND_LINKS="")
    assert done.returncode == 3
    assert "installing the Python packages failed" in done.stderr.splitlines()[-1]
    # The next call does not take the half-made environment for a complete one.
    again = tree.call("check", tree.scene(), WINGCRACK_NO_INSTALL="1")
    assert again.returncode == 3
    assert "no-such-thing==2.0" in again.stderr


def test_an_old_python_is_refused(bare_tree: Tree, tmp_path: Path) -> None:
    old = tmp_path / "old"
    for name in ("python3", "python3.11", "python3.12", "python3.13", "python3.14"):
        add_program(old, name, '[[ $1 == --version ]] && echo "Python 3.9.2" || exit 1')
    done = bare_tree.call("check", bare_tree.scene(), PATH=f"{old}:{os.environ['PATH']}")
    assert done.returncode == 3
    assert "Python 3.11 or newer is needed, and here is Python 3.9.2" in done.stderr


def test_a_build_that_fails_shows_the_compiler_and_is_tried_again(own_tree: Tree) -> None:
    script = own_tree.root / "cmake" / "assemble.sh"
    good = script.read_text()
    script.write_text("echo 'error: what the compiler says' >&2; exit 1\n")
    (own_tree.root / "fortran" / "a_solver.sh").touch()
    done = own_tree.call("check", own_tree.scene())
    assert done.returncode == 3
    assert "error: what the compiler says" in done.stderr
    assert "building wingcrack-solver failed" in done.stderr.splitlines()[-1]
    assert own_tree.call("check", own_tree.scene()).returncode == 3
    script.write_text(good)
    assert own_tree.call("check", own_tree.scene()).returncode == 0


def test_later_calls_do_nothing_and_are_quick(own_tree: Tree) -> None:
    before = own_tree.log
    durations = []
    for _ in range(5):
        start = time.perf_counter()
        done = own_tree.call("check", own_tree.scene())
        durations.append(time.perf_counter() - start)
        assert (done.returncode, done.stderr) == (0, "")
    assert own_tree.log == before
    assert min(durations) < 0.5


def test_later_calls_need_no_writing(own_tree: Tree) -> None:
    shutil.rmtree(own_tree.root / "build" / "release" / "CMakeFiles")
    (own_tree.root / "build" / "setup.lock").unlink()
    assert own_tree.call("check", own_tree.scene()).returncode == 0
    assert not (own_tree.root / "build" / "setup.lock").exists()


def test_changed_new_and_removed_sources_are_built(own_tree: Tree) -> None:
    def words() -> str:
        done = own_tree.call("check", own_tree.scene())
        assert done.returncode == 0, done.stderr
        return done.stdout

    part = own_tree.root / "fortran" / "b_more.sh"
    assert "more" not in words()
    part.write_text("echo more of it\n")
    assert "more of it" in words()
    part.write_text("echo more and more\n")
    assert "more and more" in words()
    part.unlink()
    assert "more" not in words()


def test_python_of_the_environment_finds_the_packages(own_tree: Tree) -> None:
    def found() -> str:
        done = subprocess.run(
            [
                own_tree.root / ".venv/bin/python",
                "-c",
                "import wingcrack as p; print(p.__file__)",
            ],
            cwd=own_tree.place,
            capture_output=True,
            text=True,
            check=False,
        )
        return done.stdout.strip()

    expected = str(own_tree.root / "post" / "wingcrack" / "__init__.py")
    assert own_tree.call("check", own_tree.scene()).returncode == 0
    assert found() == expected
    (path,) = own_tree.root.glob(".venv/lib/python3*/site-packages/wingcrack.pth")
    path.unlink()
    assert found() == ""
    assert own_tree.call("check", own_tree.scene()).returncode == 0
    assert found() == expected


def test_a_changed_requirement_is_installed(own_tree: Tree) -> None:
    before = own_tree.log
    with (own_tree.root / "requirements.txt").open("a") as file:
        file.write("# nothing, but another list\n")
    assert own_tree.call("check", own_tree.scene()).returncode == 0
    # The environment holds all the new list asks for, so nothing is installed.
    assert "pip" not in own_tree.log.removeprefix(before)
    with (own_tree.root / "requirements.txt").open("a") as file:
        file.write("no-such-thing==2.0\n")
    done = own_tree.call("check", own_tree.scene(), WINGCRACK_NO_INSTALL="1")
    assert done.returncode == 3
    assert "no-such-thing==2.0" in done.stderr


def test_a_moved_tree_is_built_anew(own_tree: Tree, tmp_path: Path) -> None:
    new = tmp_path / "elsewhere"
    own_tree.root.rename(new)
    moved = Tree(new, own_tree.place)
    done = moved.call("check", moved.scene())
    assert done.returncode == 0, done.stderr
    cache = (new / "build" / "release" / "CMakeCache.txt").read_text()
    assert f"CMAKE_HOME_DIRECTORY:INTERNAL={new}\n" in cache


def test_an_environment_without_its_python_is_made_anew(own_tree: Tree) -> None:
    python = own_tree.root / ".venv" / "bin" / "python"
    python.unlink()
    python.symlink_to("/nowhere/python3")
    assert own_tree.call("check", own_tree.scene()).returncode == 0
    assert python.resolve().exists()


def test_two_first_calls_share_one_set_up(bare_tree: Tree) -> None:
    scene = bare_tree.scene()
    calls = [bare_tree.start("check", scene) for _ in range(2)]
    for process in calls:
        with process:
            out, error = process.communicate(timeout=300)
        assert process.returncode == 0, error
        assert "solver check" in out
    assert bare_tree.log.count("-m venv") == 1
    assert bare_tree.log.count("cmake --build") == 1


def add_package(tree: Tree, version: str) -> None:
    """Let no-such-thing be installed in .venv."""
    (packages,) = tree.root.glob(".venv/lib/python3*/site-packages")
    folder = packages / f"no_such_thing-{version}.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text(f"Name: no-such-thing\nVersion: {version}\n")


@contextmanager
def drawing(tree: Tree) -> Iterator[subprocess.Popen[str]]:
    """Use .venv until the file `go on` is there."""
    with tree.start("plot", ".", POST_WAITS_FOR="go on", POST_IMPORTS="pip") as process:
        deadline = time.monotonic() + 60
        while not (tree.place / "post started").exists():
            assert time.monotonic() < deadline
            time.sleep(0.01)
        try:
            yield process
        finally:
            (tree.place / "go on").touch()
            assert process.wait(60) == 0


def test_what_is_in_use_is_not_changed(own_tree: Tree) -> None:
    variables = {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": ""}
    add_package(own_tree, "1.0")
    with drawing(own_tree) as first:
        with (own_tree.root / "requirements.txt").open("a") as file:
            file.write("no-such-thing==2.0\n")
        before = own_tree.log
        with own_tree.start("check", own_tree.scene(), **variables) as other:
            assert other.stderr is not None
            said = other.stderr.readline()
            assert "waiting for other calls that use .venv to finish" in said
            assert f"60 s at most: wingcrack plot . (process {first.pid})" in said
            assert own_tree.log == before
            (own_tree.place / "go on").touch()
            other.communicate(timeout=300)
    assert "pip install" in own_tree.log.removeprefix(before)


def test_a_call_waits_only_so_long_for_what_is_in_use(own_tree: Tree) -> None:
    add_package(own_tree, "1.0")
    with drawing(own_tree) as first:
        (own_tree.root / "requirements.txt").write_text("no-such-thing==2.0\n")
        before = own_tree.log
        done = own_tree.call("check", own_tree.scene(), WINGCRACK_WAIT="1")
        assert (done.returncode, done.stdout) == (3, "")
        said = done.stderr.splitlines()[-1]
        assert said.startswith("wingcrack: waited 1 s for other calls that use .venv to finish")
        assert said.endswith(f"call again: wingcrack plot . (process {first.pid})")
        assert own_tree.log == before
    # Nothing of the old environment was touched.
    (own_tree.root / "requirements.txt").write_text("")
    done = own_tree.call("check", own_tree.scene(), WINGCRACK_NO_INSTALL="1")
    assert done.returncode == 0, done.stderr


def test_packages_are_added_while_others_are_in_use(own_tree: Tree, tmp_path: Path) -> None:
    name = "no_such_thing-2.0"
    with zipfile.ZipFile(tmp_path / f"{name}-py3-none-any.whl", "w") as wheel:
        wheel.writestr("no_such_thing.py", "")
        wheel.writestr(f"{name}.dist-info/METADATA", "Name: no-such-thing\nVersion: 2.0\n")
        about = "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        wheel.writestr(f"{name}.dist-info/WHEEL", about)
        wheel.writestr(f"{name}.dist-info/RECORD", "")
    (own_tree.root / "requirements_study.txt").write_text("no-such-thing==2.0\n")
    (own_tree.place / "s.toml").write_text("")
    with drawing(own_tree):
        variables = {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(tmp_path)}
        done = own_tree.call("study", "s.toml", **variables)
        assert (done.returncode, done.stdout) == (0, "post study s.toml\n"), done.stderr
        assert "waiting" not in done.stderr


def test_the_tools_of_a_developer_are_not_for_everyone(own_tree: Tree) -> None:
    (own_tree.root / "requirements_developer.txt").write_text("no-such-thing==2.0\n")
    assert own_tree.call("check", own_tree.scene()).returncode == 0
    for command in ("test", "lint", "format"):
        done = own_tree.call(command, WINGCRACK_NO_INSTALL="1")
        assert done.returncode == 3
        assert "no-such-thing==2.0" in done.stderr
    assert own_tree.call("build", WINGCRACK_NO_INSTALL="1").returncode == 0


def test_what_maps_take_is_not_for_everyone(own_tree: Tree) -> None:
    (own_tree.root / "requirements_maps.txt").write_text("no-such-thing==2.0\n")
    (own_tree.place / "m.csv").write_text("x1,y1,x2,y2\n0,0,1,1\n")
    laws = ["--box=0,0,9,9", "--density=p20=1", "--length=constant:1", "--orientation=uniform"]
    for call in (["import", "m.csv"], ["import", *laws, "--out", "n.nml"]):
        done = own_tree.call(*call, WINGCRACK_NO_INSTALL="1")
        assert done.returncode == 3
        assert "no-such-thing==2.0" in done.stderr
    done = own_tree.call("new", "network", WINGCRACK_NO_INSTALL="1")
    assert (done.returncode, done.stdout) == (0, "post new network\n")


def test_a_map_and_a_network_are_handed_over(own_tree: Tree) -> None:
    (own_tree.place / "my map.csv").write_text("x1,y1,x2,y2\n0,0,1,1\n")
    done = own_tree.call("import", "my map.csv", "--set", "friction=0.5", POST_STATUS="2")
    assert done.returncode == 2
    assert done.stdout == "post import my map.csv --set friction=0.5\n"


def test_a_wrong_call_is_refused_before_anything_is_set_up(bare_tree: Tree) -> None:
    for call in (
        ["verify", "--jobs", "x"],
        ["bench", "x"],
        ["plot", ".", "--only", "x"],
        ["new", "x"],
    ):
        done = bare_tree.call(*call)
        assert (done.returncode, done.stdout) == (2, "")
        assert "'x'" in done.stderr
        assert done.stderr.count("\n") == 1
    assert not (bare_tree.root / ".venv").exists()
    assert not (bare_tree.root / "build").exists()


@pytest.mark.parametrize("command", ["verify", "bench", "plot", "view", "new", "import"])
def test_help_does_not_wait_for_an_installation(bare_tree: Tree, command: str) -> None:
    done = bare_tree.call(command, "--help")
    assert (done.returncode, done.stderr) == (0, "")
    assert f"./wingcrack {command}" in done.stdout
    assert not (bare_tree.root / ".venv").exists()


def test_plot_does_not_wait_for_the_build(bare_tree: Tree) -> None:
    add_environment(bare_tree)
    (bare_tree.root / "CMakeLists.txt").write_text("nonsense\n")
    done = bare_tree.call("plot", bare_tree.place)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"post plot {bare_tree.place}\n"


def test_a_failed_check_does_not_stop_the_others(own_tree: Tree) -> None:
    # None of the tools is in this tree's environment, so every step fails.
    done = own_tree.call("test")
    assert done.returncode == 1
    assert done.stdout.rindex("== pytest") > done.stdout.index("== fprettify")
    reason = done.stderr.splitlines()[-1]
    for step in ("shellcheck", "fprettify", "ruff check", "mypy", "CTest and bench", "pytest"):
        assert step in reason


def test_a_name_chooses_among_the_checks(own_tree: Tree) -> None:
    done = own_tree.call("test", "fortitude")
    assert done.returncode == 1
    assert done.stdout.count("== ") == 1
    assert done.stderr.splitlines()[-1] == "wingcrack: failed: fortitude"


def test_a_name_that_no_test_has_is_told(own_tree: Tree) -> None:
    done = own_tree.call("test", "no_such_thing", "nor_this")
    assert done.returncode == 1
    reason = "no test has a name with 'no_such_thing' or 'nor_this' in it"
    assert done.stderr.splitlines()[-1] == f"wingcrack: {reason}"


def test_a_build_in_sight_shows_what_the_compiler_says(own_tree: Tree) -> None:
    script = own_tree.root / "cmake" / "assemble.sh"
    script.write_text(f"echo 'warning: mind this' >&2\n{script.read_text()}")
    (own_tree.root / "fortran" / "a_solver.sh").touch()
    done = own_tree.call("build")
    assert done.returncode == 0
    assert "warning: mind this" in done.stdout
    script.write_text("echo 'error: not this' >&2; exit 1\n")
    (own_tree.root / "fortran" / "a_solver.sh").touch()
    done = own_tree.call("build", "--debug")
    assert done.returncode == 1
    assert "error: not this" in done.stdout
    assert done.stderr.splitlines()[-1] == "wingcrack: building, debug, failed"


def test_warnings_are_errors_where_ci_says_so(own_tree: Tree) -> None:
    def answer() -> str:
        cache = (own_tree.root / "build" / "release" / "CMakeCache.txt").read_text()
        return next(line for line in cache.splitlines() if "WARNINGS_ARE_ERRORS" in line)[-3:]

    assert own_tree.call("check", own_tree.scene(), CI="").returncode == 0
    assert answer() == "OFF"
    assert own_tree.call("check", own_tree.scene(), CI="true").returncode == 0
    assert answer() == "=ON"
