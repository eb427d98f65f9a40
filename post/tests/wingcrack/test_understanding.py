"""Calls are understood alike with Click and, before it is installed, without it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from wingcrack.command_line.declaring import command

POST = Path(__file__).resolve().parents[2]
SCENE = POST.parent / "inputs" / "paper_c" / "onset.nml"
LAWS = ["--box=0,0,9,9", "--density=p20=1", "--length", "constant:1", "--orientation", "uniform"]

_UNDERSTAND = """\
import json, sys
if sys.argv[1] == "without":
    sys.modules["click"] = None
from wingcrack.command_line import understand, way
assert way.__name__.endswith(f"{sys.argv[1]}_click")
call = understand(sys.argv[2:])
if call is not None:
    print(call.does, json.dumps(vars(call.given), default=str, sort_keys=True))
"""


def understood(way: str, words: list[str], place: Path) -> tuple[int, str, str]:
    """Status, stdout and stderr of a call that is only understood."""
    done = subprocess.run(
        [sys.executable, "-c", _UNDERSTAND, way, *words],
        cwd=place,
        env={"PYTHONPATH": str(POST)},
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ["run", str(SCENE)],
        ["run", "--threads=3", "--ranks", "2", str(SCENE), "--out", "some where", "--no-plot"],
        ["run", "--restart", ".", "--end", "7200"],
        ["check", str(SCENE)],
        ["check", "--stress", str(SCENE), "--json", "--mohr", "m.pdf"],
        ["plot", ".", "/", "--times", "1h,90", "--only", "maps,tips", "--format", "png,pdf"],
        ["view", ".", "--port", "8040"],
        ["study", str(SCENE), "--cluster", "local", "--jobs", "3", "--quick"],
        ["new", "wells", "--out", "a.nml"],
        ["import", str(SCENE.parents[1] / "examples" / "outcrop.geojson"), "--set", "friction=1"],
        ["import", *LAWS, "--out", "n.nml", "--distance", "1"],
        ["verify", "--quick", "onset_c1"],
        ["reproduce", "paper_b", "--quick"],
        ["bench", "b1", "--repeat", "5"],
        ["test", "mypy", "ruff"],
        ["build", "--debug"],
        ["docs", "--serve"],
    ],
)
def test_both_ways_give_the_same_call(words: list[str], tmp_path: Path) -> None:
    (tmp_path / "checkpoint.bin").touch()  # for a restart
    ways = [understood(way, words, tmp_path) for way in ("with", "without")]
    assert ways[0] == ways[1]
    assert (ways[0][0], ways[0][2]) == (0, "")
    assert json.loads(ways[0][1].partition(" ")[2])["command"] == words[0]


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["no_such"],
        ["run", "nowhere.nml"],
        ["run", str(SCENE), "--threads", "two"],
        ["plot", ".", "--no-such"],
        ["study"],
        ["import", "nowhere.csv"],
        ["import", *LAWS],
        ["verify", "no_such_case"],
        ["view", ".", ".."],
    ],
)
def test_both_ways_refuse_the_same(words: list[str], tmp_path: Path) -> None:
    for way in ("with", "without"):
        status, out, error = understood(way, words, tmp_path)
        assert (status, out, error.count("\n")) == (2, "", 1)
        assert error.startswith("wingcrack")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", [["--help"], ["import", "--help"], ["plot", ".", "-h"]])
def test_both_ways_help(words: list[str], tmp_path: Path) -> None:
    for way in ("with", "without"):
        status, out, error = understood(way, words, tmp_path)
        assert (status, error) == (0, "")
        assert "example:\n  ./wingcrack " in out


def test_what_is_not_installed_is_not_here() -> None:
    for does, is_here in {
        "wingcrack_verify.bench.cli:bench": True,
        "no_such_package.part.cli:bench": False,
        "wingcrack.no_such_part.cli:bench": False,
    }.items():
        assert command("bench", does, example="")(lambda _: None).is_here is is_here
