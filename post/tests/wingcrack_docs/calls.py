"""Commands that pages show: which are run here, and whether the others can be understood."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

from documents import TOP
from wingcrack import command_line
from wingcrack.scenes.solver import SOLVER

# What stands for something of the reader's own, and what is put in its place.
STAND_INS = {
    "SCENE.nml": "inputs/paper_c/onset.nml",
    "MAP": "map.geojson",
    "MAP.geojson": "map.geojson",
    "STUDY.toml": "inputs/studies/d3_rate.toml",
    "inputs/<folder>/<scene>.nml": "inputs/paper_c/onset.nml",
    "DIR": "out/onset",
    "KIND": "injection",
    "NAME": "onset_c1",
    "FILE": "named.nml",
    "N": "2",
    "OTHER_SOLVER": str(SOLVER),
}
# Runs that take a second or two; of other scenes only what they say is checked.
CHEAP = ("mine.nml",)


def stand_in(words: list[str]) -> list[str]:
    """Put something in place of what the reader has, and drop the brackets of what is optional."""
    bare = [word if "=" in word else word.strip("[]") for word in words]
    return [STAND_INS.get(word, word) for word in bare]


def launch(place: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Call the launcher in a folder; it must not install anything."""
    return subprocess.run(
        [TOP / "wingcrack", *words],
        cwd=place,
        env={**os.environ, "WINGCRACK_NO_INSTALL": "1"},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@cache
def help_of(*words: str) -> str:
    """What the launcher says of itself or of a subcommand."""
    done = launch(TOP, *words, "--help")
    assert done.returncode == 0, done.stderr
    return done.stdout


def short_form(words: list[str]) -> list[str] | None:
    """The words of a call of the launcher as they are run here; None: they are only understood."""
    command, *rest = words
    if "--help" in rest or command in ("--help", "--version", "check"):
        return words
    if command in ("new", "import"):
        return [*words, "--overwrite"]
    if command == "run" and "--restart" in rest:
        return None
    if command == "run":
        return [*words, "--no-plot", "--quiet"] if rest[0] in CHEAP else ["check", rest[0]]
    if command == "study":
        kept = _without_value(words, "--cluster")
        return kept if "--check" in kept else [*kept, "--check"]
    return None


def _without_value(words: list[str], option: str) -> list[str]:
    if option not in words:
        return words
    at = words.index(option)
    return words[:at] + words[at + 2 :]


def understand(words: list[str]) -> None:
    """Fail unless the launcher understands a call, which is not made; from the folder it is for."""
    command, *rest = words
    assert re.search(rf"^  {command}\b", help_of(), re.MULTILINE), command
    if command == "run" and rest:
        for option in (word for word in rest if word.startswith("-")):
            assert option.partition("=")[0] in help_of(command), f"{command} has no {option}"
    elif rest or command not in ("run", "check"):
        # pages make the same files
        overwrite = ["--overwrite"] if command in ("new", "import") else []
        command_line.understand([*words, *overwrite])
    if command == "test":
        for name in rest:
            assert name in _names_of_tests(), f"no test has '{name}' in its name"


@cache
def _names_of_tests() -> str:
    folders = ("fortran/*/tests", "cpp_mesh/tests", "tests", "post/tests/*")
    files = [file.stem for folder in folders for file in TOP.glob(f"{folder}/test_*")]
    return " ".join(files) + (TOP / "tools" / "lint.sh").read_text("utf-8")


@cache
def _help_of_program(program: str) -> str:
    words = [sys.executable, str(TOP / program), "--help"]
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def understand_other(words: list[str]) -> None:
    """Fail unless what a command of other programs names is there."""
    program, *rest = words
    if program == ".venv/bin/python" and rest and rest[0].endswith(".py") and "/" in rest[0]:
        for option in (word for word in rest[1:] if word.startswith("--")):
            assert option in _help_of_program(rest[0]), f"{rest[0]} has no {option}"
    elif program == "podman":
        if rest[0] == "build":
            assert (TOP / rest[rest.index("--file") + 1]).is_file()
    elif program == "cmake":
        assert rest[:2] == ["--install", "build/release"], rest
    elif program.startswith("/opt/wingcrack/bin/") or "WINGCRACK_PYTHON" in program:
        assert "wingcrack" in " ".join(rest) or rest[0] == "run"
    else:
        known = (".venv/bin/python", ".venv/bin/pip", "python3", "/opt/wingcrack/venv/bin/pip")
        assert program in known or program in ("export", "eval"), f"what is {program}?"
