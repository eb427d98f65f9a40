"""What the launcher hands to the solver and to the figures, and what it returns."""

from __future__ import annotations

import signal
import time

import pytest
from launcher_tree import Tree


def test_run_solves_and_then_draws(ready_tree: Tree) -> None:
    scene = ready_tree.scene("# name wing_crack")
    done = ready_tree.call("run", scene)
    assert done.returncode == 0
    assert done.stdout.splitlines() == [
        f"solver run {scene} --out out/wing_crack",
        "threads 1",
        "post plot out/wing_crack",
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
