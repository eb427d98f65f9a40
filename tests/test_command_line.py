"""The launcher's words: help, version, and the refusal of what it does not understand."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from launcher_tree import TOP

from wingcrack import __version__
from wingcrack.command_line import understand

LAUNCHER = TOP / "wingcrack"
SCENE = TOP / "inputs" / "paper_c" / "onset.nml"
COMMANDS = (
    "run",
    "check",
    "plot",
    "view",
    "new",
    "import",
    "study",
    "verify",
    "reproduce",
    "bench",
    "test",
    "build",
    "format",
    "lint",
    "docs",
)
MAP = TOP / "inputs" / "examples" / "outcrop.geojson"
LAWS = ["--box", "0,0,9,9", "--density", "p20=1", "--length", "constant:1"]
LAWS += ["--orientation", "uniform"]


def call(place: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [LAUNCHER, *arguments],
        cwd=place,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def test_version_is_that_of_the_python_package(tmp_path: Path) -> None:
    done = call(tmp_path, "--version")
    assert (done.returncode, done.stdout, done.stderr) == (0, f"wingcrack {__version__}\n", "")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_subcommand_has_help_with_an_example(tmp_path: Path, command: str) -> None:
    done = call(tmp_path, command, "--help")
    assert done.returncode == 0
    assert done.stderr == ""
    assert "example:" in done.stdout.lower()
    assert f"wingcrack {command}" in done.stdout


def test_help_names_every_subcommand(tmp_path: Path) -> None:
    done = call(tmp_path, "--help")
    assert done.returncode == 0
    for command in (*COMMANDS, "--version"):
        assert command in done.stdout


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["run"], "run needs a scene file"),
        (["run", "--quiet"], "run needs a scene file"),
        (["run", "nowhere.nml"], "there is no scene file nowhere.nml"),
        (["run", "."], ". is a folder, not a scene file"),
        (["check", "/dev/null"], "/dev/null is a pipe or a device, not a scene file"),
        (["run", str(SCENE), "--out", str(SCENE)], "onset.nml is a file"),
        (["run", str(SCENE), "--out", f"{SCENE}/deeper/down"], "onset.nml is a file"),
        (["run", "nowhere.nml", "other.nml"], "got unexpected extra argument (other.nml)"),
        (["run", "nowhere.nml", "--fast"], "no such option '--fast'"),
        (["study"], "missing argument 'STUDY.toml'"),
        (["study", "nowhere.toml"], "there is no study nowhere.toml"),
        (["study", "."], ". is a folder, not a study's file"),
        (["study", str(SCENE), "--jobs", "0"], "'0' is no whole number from 1 to 1024"),
        (
            ["study", str(SCENE), "--cluster", "moon"],
            "'moon' is not one of 'none', 'local'",
        ),
        (["study", str(SCENE), "--out", f"{SCENE}/deeper"], "onset.nml is a file"),
        (["new", "reactor"], "there is no kind 'reactor' (there are: injection, network"),
        (["new", "--out", "scene.txt"], "--out must end in .nml, unlike scene.txt"),
        (["new", "--out", "nowhere/scene.nml"], "the scene cannot go to nowhere/scene.nml"),
        (["new", "--out", "Störung 1.nml"], "may have letters, digits"),
        (["new", "--out", str(SCENE)], "onset.nml is there already; --overwrite replaces it"),
        (["import"], "a MAP is missing"),
        (["import", "nowhere.csv"], "there is no map nowhere.csv"),
        (["import", "."], ". is a folder, not a map"),
        (["import", str(SCENE)], "which says what it is"),
        (
            ["import", str(MAP), "--unit", "mile"],
            "'--unit': 'mile' is not one of 'm', 'km'",
        ),
        (["import", str(MAP), "--repair", "0"], "'0' must be greater than 0"),
        (["import", str(MAP), "--repair", "nan"], "'nan' is no number"),
        (["import", str(MAP), "--angle", "1"], "'1' must be from 3 to 45 degrees"),
        (["import", str(MAP), "--origin", "1;2"], "'1;2' must be X,Y, centre or corner"),
        (["import", str(MAP), "--scene", "none.nml"], "there is no scene file none.nml"),
        (["import", str(MAP), "--out", str(SCENE)], "onset.nml is there already"),
        (["import", str(MAP), *LAWS], "are for a network without MAP"),
        (["import", *LAWS], "--orientation and --out"),
        (["import", *LAWS[:-2], "--out", "n.nml"], "a MAP is missing"),
        (["import", *LAWS, "--out", "n.nml", "--unit", "m"], "are of a MAP"),
        (["import", *LAWS, *LAWS[2:4], "--out", "n.nml"], "must be given equally often"),
        (["import", *LAWS, "--box", "1,0,0,1"], "'1,0,0,1' must be X0,Y0,X1,Y1 with X0 < X1"),
        (["import", *LAWS, "--density", "p32=1"], "'p32=1' must be p20=N or p21=L"),
        (["import", *LAWS, "--length", "power:2,1"], "'power:2,1' has 2 numbers after its name"),
        (["import", *LAWS, "--length", "power:2,4,1"], "MIN must be less than MAX"),
        (["import", *LAWS, "--length", "constant:-1"], "lengths must be greater than 0"),
        (["import", *LAWS, "--orientation", "fisher:1,2"], "is none of uniform, constant"),
        (["import", *LAWS, "--seed", "1.5"], "'1.5' is no whole number from 0 on"),
        (["reproduce", "paper_e"], "there is no paper 'paper_e'"),
        (["reproduce", "paper_b", "--out", str(SCENE)], "onset.nml, which is a file"),
        (["verify", "--fast"], "no such option '--fast'"),
        (["verify", "no_such_case"], "there is no case 'no_such_case'"),
        (["verify", "--jobs"], "option '--jobs' requires an argument"),
        (["verify", "--jobs", "x"], "'x' is no whole number from 1 to 64"),
        (["verify", "--report", str(SCENE)], "onset.nml, which is a file"),
        (["run", "nowhere.nml", "--out"], "option '--out' requires an argument"),
        (["run", "nowhere.nml", "--out", ""], "--out needs a value"),
        (["run", "nowhere.nml", "--out="], "--out needs a value"),
        (["run", "nowhere.nml", "--threads", "0"], "is no whole number from 1 to 9999"),
        (["run", "nowhere.nml", "--threads", "two"], "is no whole number from 1 to 9999"),
        (["run", "nowhere.nml", "--threads=1.5"], "is no whole number from 1 to 9999"),
        (["run", "nowhere.nml", "--ranks"], "option '--ranks' requires an argument"),
        (["run", "nowhere.nml", "--ranks", "0"], "is no whole number from 1 to 9999"),
        (["run", "nowhere.nml", "--ranks", "-2"], "is no whole number from 1 to 9999"),
        (["run", "nowhere.nml", "--ranks=two"], "is no whole number from 1 to 9999"),
        (["run", "nowhere.nml", "--ranks="], "is no whole number from 1 to 9999"),
        (["check", "nowhere.nml", "--ranks", "2"], "no such option '--ranks'"),
        (["check"], "check needs a scene file"),
        (["check", "nowhere.nml"], "there is no scene file nowhere.nml"),
        (["check", "nowhere.nml", "--out", "here"], "no such option '--out'"),
        (["check", "nowhere.nml", "--mohr", "m.jpg"], "--mohr must end in .png or"),
        (["check", "nowhere.nml", "other.nml"], "got unexpected extra argument (other.nml)"),
        (["plot"], "plot needs the directory of a run"),
        (["plot", "nowhere"], "there is no directory nowhere"),
        (["plot", ".", "--only", "map"], "'map' is none of summary, story, network, maps"),
        (["view"], "view needs the directory of a run"),
        (["view", "nowhere"], "there is no directory nowhere"),
        (["view", str(SCENE)], f"there is no directory {SCENE}"),
        (["view", ".", ".."], "got unexpected extra argument"),
        (["view", ".", "--port", "0"], "'0' is no whole number from 1 to 65535"),
        (["view", ".", "--port=65536"], "'65536' is no whole number from 1 to 65535"),
        (["view", ".", "--port", "eight"], "'eight' is no whole number from 1 to 65535"),
        (["bench", "--fast"], "no such option '--fast'"),
        (["bench", "no_such_scene"], "there is no measurement 'no_such_scene'"),
        (["bench", "--repeat"], "option '--repeat' requires an argument"),
        (["bench", "--repeat", "0"], "'0' is no whole number from 1"),
        (["bench", "--out", str(SCENE)], "onset.nml, which is a file"),
        (["test", "--fast"], "no such option '--fast'"),
        (["build", "--fast"], "no such option '--fast'"),
        (["build", "--debug", "more"], "got unexpected extra argument (more)"),
        (["format", "here"], "got unexpected extra argument (here)"),
        (["lint", "here"], "got unexpected extra argument (here)"),
    ],
)
def test_wrong_usage_gives_one_sentence_and_writes_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    reason: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stop:
        understand(arguments)
    assert stop.value.code == 2
    said = capsys.readouterr()
    assert (said.out, said.err.count("\n")) == ("", 1)
    assert reason in said.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ([], "a subcommand is missing"),
        (["simulate"], "unknown subcommand simulate"),
        (["--out", "here"], "unknown subcommand --out"),
        (["test", "a|b"], "'a|b' is no part of a test's name"),
        (["run", "nowhere.nml"], "there is no scene file nowhere.nml"),
        (["import", str(MAP), "--repair", "nan"], "'nan' is no number"),
    ],
)
def test_the_launcher_ends_with_the_status_of_wrong_usage(
    tmp_path: Path, arguments: list[str], reason: str
) -> None:
    done = call(tmp_path, *arguments)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert reason in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_pipe_is_no_scene(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.nml")
    done = call(tmp_path, "run", "pipe.nml")
    assert done.returncode == 2
    assert done.stderr == "wingcrack: pipe.nml is a pipe or a device, not a scene file\n"


@pytest.mark.parametrize("arguments", [["run", "--help"], ["run", "a.nml", "-h"], ["-h"]])
def test_help_wins_over_what_else_is_said(tmp_path: Path, arguments: list[str]) -> None:
    done = call(tmp_path, *arguments)
    assert done.returncode == 0
    assert "./wingcrack run" in done.stdout


@pytest.mark.parametrize("words", [["help", "run"], ["help"], ["help", "import"]])
def test_help_is_a_word_too(tmp_path: Path, words: list[str]) -> None:
    said = [call(tmp_path, *words), call(tmp_path, *words[1:], "--help")]
    assert said[0].stdout == said[1].stdout
    assert [done.returncode for done in said] == [0, 0]


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("wingcrack pl", "plain,plot"),
        ("wingcrack run --th", "plain,--threads"),
        ("wingcrack import map.csv --unit k", "plain,km"),
        ("wingcrack run in", "file,in"),
    ],
)
def test_the_shell_can_complete_words(tmp_path: Path, words: str, offered: str) -> None:
    done = subprocess.run(
        [LAUNCHER],
        cwd=tmp_path,
        env={
            **os.environ,
            "_WINGCRACK_COMPLETE": "bash_complete",
            "COMP_WORDS": words,
            "COMP_CWORD": str(words.count(" ")),
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout.split()) == (0, [offered])


def test_works_through_a_symbolic_link(tmp_path: Path) -> None:
    link = tmp_path / "wc"
    link.symlink_to(LAUNCHER)
    done = subprocess.run([link, "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("wingcrack ")
