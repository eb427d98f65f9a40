"""What the launcher hands to the solver and to the figures, and what it returns."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
from launcher_tree import Tree, add_program


def test_run_solves_and_then_draws(ready_tree: Tree) -> None:
    scene = ready_tree.scene("# name wing_crack")
    done = ready_tree.call("run", scene)
    assert done.returncode == 0
    assert done.stdout.splitlines() == [
        f"solver run {scene} --out out/wing_crack",
        "threads 1",
        "post plot out/wing_crack --quiet",
    ]


def test_a_scene_without_a_readable_name_is_bad_input(ready_tree: Tree) -> None:
    done = ready_tree.call("run", ready_tree.scene("# bad scene"))
    assert done.returncode == 2
    assert (done.stdout, done.stderr) == ("", "what is bad about it\n")


@pytest.mark.parametrize(
    "options",
    [
        ["--out", "some where", "--threads", "3", "--quiet"],
        ["--out=some where", "--threads=3", "--quiet"],
    ],
)
def test_options_reach_solver_and_figures(ready_tree: Tree, options: list[str]) -> None:
    scene = ready_tree.scene()
    done = ready_tree.call("run", *options, scene)
    assert done.stdout.splitlines() == [
        f"solver run {scene} --out some where --quiet",
        "threads 3",
        "post plot some where --quiet",
    ]


def test_no_plot_draws_nothing(ready_tree: Tree) -> None:
    done = ready_tree.call("run", ready_tree.scene(), "--no-plot")
    assert done.returncode == 0
    assert "solver" in done.stdout
    assert "post" not in done.stdout


def test_threads_of_the_environment_do_not_count(ready_tree: Tree) -> None:
    done = ready_tree.call("run", ready_tree.scene(), OPENBLAS_NUM_THREADS="7")
    assert "threads 1\n" in done.stdout


@pytest.mark.parametrize("status", [1, 2, 3, 130])
def test_a_failed_run_keeps_its_status_and_last_words(ready_tree: Tree, status: int) -> None:
    done = ready_tree.call("run", ready_tree.scene(f"echo 'the reason' >&2; exit {status}"))
    assert done.returncode == status
    assert done.stderr == "the reason\n"
    assert "post" not in done.stdout


def test_figures_that_fail_are_a_warning(ready_tree: Tree) -> None:
    done = ready_tree.call("run", ready_tree.scene(), POST_STATUS="3")
    assert done.returncode == 0
    assert "drawing its figures failed" in done.stderr


@pytest.mark.parametrize(("sent", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("command", ["run", "check"])
def test_a_signal_to_the_launcher_reaches_the_solver(
    ready_tree: Tree, command: str, sent: signal.Signals, status: int
) -> None:
    scene = ready_tree.scene(
        "trap 'echo state saved; exit 130' INT\n"
        "trap 'echo state saved; exit 143' TERM\n"
        "echo ready >started\n"
        "for i in {1..200}; do sleep 0.05; done\n"
    )
    with ready_tree.start(command, scene) as process:
        deadline = time.monotonic() + 60
        while not (ready_tree.place / "started").exists():
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.send_signal(sent)
        out, _ = process.communicate(timeout=60)
    assert process.returncode == status
    assert "state saved" in out
    assert "post" not in out


def test_a_solver_killed_by_a_signal_is_reported(ready_tree: Tree) -> None:
    done = ready_tree.call("run", ready_tree.scene("kill -SEGV $$"))
    assert done.returncode == 128 + signal.SIGSEGV
    assert "post" not in done.stdout


@pytest.mark.parametrize("status", [0, 2])
def test_check_hands_over_to_the_solver(ready_tree: Tree, status: int) -> None:
    scene = ready_tree.scene(f"exit {status}")
    done = ready_tree.call("check", scene)
    assert done.returncode == status
    assert done.stdout.splitlines() == [f"solver check {scene}", "threads 1"]


@pytest.mark.parametrize("status", [0, 2, 3])
def test_plot_hands_over_to_the_figures(ready_tree: Tree, status: int) -> None:
    (ready_tree.place / "some where").mkdir()
    done = ready_tree.call("plot", "some where", "--only", "maps", POST_STATUS=str(status))
    assert done.returncode == status
    assert done.stdout == "post plot some where --only maps\n"


def test_modules_of_the_working_directory_are_not_executed(ready_tree: Tree) -> None:
    for name in ("argparse", "numpy", "pathlib", "wingcrack"):
        (ready_tree.place / f"{name}.py").write_text("raise SystemExit('not this one')\n")
    paths = {"PYTHONPATH": str(ready_tree.place), "POST_IMPORTS": "argparse"}
    done = ready_tree.call("plot", ".", **paths)
    assert (done.returncode, done.stdout, done.stderr) == (0, "post plot .\n", "")
    done = ready_tree.call("run", ready_tree.scene(), "--out", "here", **paths)
    assert (done.returncode, done.stderr) == (0, "")
    assert "post plot here" in done.stdout


@pytest.mark.parametrize("command", [["plot", "."], ["bench"]])
def test_a_python_package_that_is_gone_is_named(ready_tree: Tree, command: list[str]) -> None:
    done = ready_tree.call(*command, POST_IMPORTS="such_a_package")
    assert done.returncode == 3
    assert done.stderr.count("\n") == 1
    assert "No module named 'such_a_package'" in done.stderr
    assert f"remove the folder {ready_tree.root / '.venv'}" in done.stderr


def test_a_library_that_is_gone_is_named(own_tree: Tree) -> None:
    # A program in place of the solver, and then without a library that it was linked with.
    library = own_tree.place / "libgone.so"
    source = own_tree.place / "gone.c"
    source.write_text("int gone(void) { return 0; }\n")
    subprocess.run(["gcc", "-shared", "-o", library, source], check=True)
    source.write_text("int gone(void); int main(void) { return gone(); }\n")
    solver = own_tree.root / "build" / "release" / "fortran" / "app" / "wingcrack-solver"
    subprocess.run(["gcc", "-o", solver, source, library], check=True)
    scene = own_tree.scene()
    assert own_tree.call("check", scene).returncode == 0
    library.unlink()
    for command in ("check", "run"):
        done = own_tree.call(command, scene)
        assert done.returncode == 3
        reason = done.stderr.splitlines()[-1]
        assert "libgone.so" in reason
        assert f"remove the folders {own_tree.root / '.venv'}" in reason


def test_fonts_are_listed_beside_the_environment(ready_tree: Tree) -> None:
    package = ready_tree.root / "post" / "wingcrack" / "figures" / "cli.py"
    stand_in = package.read_text()
    package.write_text(
        "import os\ndef plot(_given):\n    print(os.environ['MPLCONFIGDIR'])\n    return 0\n"
    )
    try:
        done = ready_tree.call("plot", ".", MPLCONFIGDIR="/somewhere/stale")
    finally:
        package.write_text(stand_in)
    assert done.stdout == f"{ready_tree.root / '.venv' / 'matplotlib'}\n"


# A stand-in for mpiexec: it tells how many ranks it is to start, and becomes the first of them.
MPIEXEC = """\
while [[ $1 != -n ]]; do shift; done
echo "mpiexec $1 $2"
shift 2
exec "$@"
"""


@pytest.fixture
def ranks_tree(ready_tree: Tree, tmp_path: Path) -> Tree:
    """The tree that is set up, on a machine with MPI; its place stays empty."""
    place = tmp_path / "place"
    place.mkdir()
    add_program(tmp_path / "machine", "mpiexec.openmpi", MPIEXEC)
    path = {"PATH": f"{tmp_path / 'machine'}:{os.environ['PATH']}"}
    return Tree(ready_tree.root, place, path)


@pytest.mark.parametrize("options", [["--ranks", "3"], ["--ranks=3"]])
def test_ranks_are_started_by_mpiexec(ranks_tree: Tree, options: list[str]) -> None:
    scene = ranks_tree.scene()
    done = ranks_tree.call("run", scene, "--out", "here", "--threads", "2", *options)
    assert done.returncode == 0
    assert done.stdout.splitlines() == [
        "mpiexec -n 3",
        f"solver run {scene} --out here",
        "threads 2",
        "post plot here --quiet",
    ]


def test_one_rank_is_no_affair_of_mpi(ranks_tree: Tree) -> None:
    done = ranks_tree.call("run", ranks_tree.scene(), "--ranks", "1", "--no-plot")
    assert done.returncode == 0
    assert "mpiexec" not in done.stdout


def test_ranks_without_a_fluid_are_refused(ranks_tree: Tree) -> None:
    done = ranks_tree.call("run", ranks_tree.scene("# no fluid"), "--ranks", "2")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "it has no fluid\n")


@pytest.mark.parametrize("status", [1, 2, 130, 137])
def test_ranks_that_fail_keep_their_status(ranks_tree: Tree, status: int) -> None:
    done = ranks_tree.call("run", ranks_tree.scene(f"exit {status}"), "--ranks", "2")
    assert done.returncode == status
    assert "post" not in done.stdout
    assert ("signal 9 has ended a rank" in done.stderr) == (status == 137)


@pytest.mark.parametrize(
    ("sent", "heard", "status"), [(signal.SIGINT, "USR1", 130), (signal.SIGTERM, "USR2", 143)]
)
def test_a_signal_reaches_ranks_as_mpiexec_hands_it_on(
    ranks_tree: Tree, sent: signal.Signals, heard: str, status: int
) -> None:
    scene = ranks_tree.scene(
        "trap 'echo not this one; exit 1' INT TERM\n"
        f"trap 'echo state saved; exit {status}' {heard}\n"
        "echo ready >started\n"
        "for i in {1..200}; do sleep 0.05; done\n"
    )
    with ranks_tree.start("run", scene, "--ranks", "2") as process:
        deadline = time.monotonic() + 60
        while not (ranks_tree.place / "started").exists():
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.send_signal(sent)
        out, _ = process.communicate(timeout=60)
    assert process.returncode == status
    assert "state saved" in out


@pytest.mark.parametrize(("died_of", "status"), [("USR1", 130), ("USR2", 143)])
def test_a_signal_before_the_ranks_know_it_counts_too(
    ranks_tree: Tree, died_of: str, status: int
) -> None:
    done = ranks_tree.call("run", ranks_tree.scene(f"kill -{died_of} $$"), "--ranks", "2")
    assert done.returncode == status
