"""Foreign files that a scene names: not told, not waited for, and nothing without end."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from system_scene import SCENE, SOLVER, varied

pytestmark = pytest.mark.usefixtures("program")

SECRET = "s3cretWord"
FOREIGN = {
    "passwords": f"root:{SECRET}:19000:0:99999:7:::\n",
    "a key": f"{SECRET}\n",
    "settings": f"# settings\npassword = '{SECRET}'\n",
    "a quote that is open": f"it's {SECRET}\n",
    "a table of others": f"user,{SECRET}\n{SECRET},1\n",
    "an address": f"&{SECRET}.org:80 {SECRET}\n",
    "an include of words": f"include {SECRET}\n",
    "bytes": f"\x01\x02{SECRET}\n",
}
WAYS = {
    "include": SCENE + "include 'foreign'\n",
    "well": varied(("rate = 5.0e-9, start = 3600.0,", "schedule = 'foreign',")),
    "side": varied(("x_traction = -20.0e6", "schedule = 'foreign'")),
    "scene": "",
}


def check(place: Path, scene: str) -> subprocess.CompletedProcess[str]:
    """Let the bare solver judge a scene, which must take no time."""
    return subprocess.run(
        [SOLVER, "check", scene],
        cwd=place,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=15,
        check=False,
    )


@pytest.mark.parametrize("content", FOREIGN)
@pytest.mark.parametrize("way", WAYS)
def test_what_a_foreign_file_holds_is_not_told(way: str, content: str, tmp_path: Path) -> None:
    (tmp_path / "foreign").write_text(FOREIGN[content])
    (tmp_path / "small.nml").write_text(WAYS[way])
    done = check(tmp_path, "foreign" if way == "scene" else "small.nml")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "no scene file" in done.stderr or "no table" in done.stderr
    assert SECRET.lower() not in done.stderr.lower()


def test_a_slip_in_a_file_of_ours_is_told(tmp_path: Path) -> None:
    (tmp_path / "rock.inc").write_text("! rock\n&tine end = 1.0 /\n")
    (tmp_path / "small.nml").write_text(SCENE + "include 'rock.inc'\n")
    done = check(tmp_path, "small.nml")
    assert "rock.inc:2: unknown group &tine, the nearest is &time" in done.stderr
    (tmp_path / "rate.csv").write_text("# pump\ntime_s,raet_m2_s\n0,1\n")
    (tmp_path / "small.nml").write_text(WAYS["well"].replace("foreign", "rate.csv"))
    done = check(tmp_path, "small.nml")
    assert "rate.csv:2: the column 'raet_m2_s' must be one of rate_m2_s" in done.stderr


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind", ["pipe", "zeros", "nothing", "folder"])
def test_what_is_no_file_with_text_is_not_waited_for(kind: str, way: str, tmp_path: Path) -> None:
    if kind == "pipe":
        os.mkfifo(tmp_path / "foreign")
    elif kind == "zeros":
        (tmp_path / "foreign").symlink_to("/dev/zero")
    elif kind == "nothing":
        (tmp_path / "foreign").touch()
    else:
        (tmp_path / "foreign").mkdir()
    (tmp_path / "small.nml").write_text(WAYS[way])
    done = check(tmp_path, "foreign" if way == "scene" else "small.nml")
    assert (done.returncode, done.stdout) == (2, "")
    words = "no file that can be read" if kind == "folder" else "empty, a pipe or a device"
    assert words in done.stderr


def includes(place: Path) -> str:
    """Give a scene of 16 files, each of which includes the next one ten times."""
    for k in range(15):
        (place / f"{k}.inc").write_text(f"include '{k + 1}.inc'\n" * 10)
    (place / "15.inc").write_text("! the last\n")
    return SCENE + "include '0.inc'\n"


def table(place: Path, rows: int) -> str:
    """Give a scene whose well follows a long table."""
    lines = [f"{k},1e-9" for k in range(rows)]
    (place / "rate.csv").write_text("\n".join(["time_s,rate_m2_s", *lines, ""]))
    return varied(("rate = 5.0e-9, start = 3600.0, end = 14400.0", "schedule = 'rate.csv'"))


def defined(values: str, number: str) -> str:
    """Give a scene with named values, and an expression in the place of a number."""
    return f"&define {values} /\n" + varied(("young = 40.0e9", f"young = {number}"))


# What makes a long or a dear text; then what the refusal says, with the number.
ENDLESS = {
    "includes": (includes, "include '15.inc' is one more than the 1000 files"),
    "terms": (
        lambda _: defined("a = 1.0", "'" + "+".join(["a"] * 400_000) + "'"),
        "it has more than 10000 characters",
    ),
    "expressions": (
        lambda _: defined("a = 1.0", " ".join(["'a*1e5'"] * 400_000)),
        "young has more than 100000 values",
    ),
    "names": (
        lambda _: defined("\n".join(f"v{k} = {k}" for k in range(20_000)), "4e10"),
        "v1000 is one more than the 1000 values",
    ),
    "rows": (lambda place: table(place, 200_000), "more than the 100000 rows"),
    "bytes of a table": (lambda place: table(place, 400_000), "larger than the 4 MB"),
    "tables": (
        lambda place: (
            table(place, 99_999) + "&injection fracture = 'f1', schedule = 'rate.csv' /\n" * 30
        ),
        "more file than the 10 MB",
    ),
}


@pytest.mark.parametrize("kind", ENDLESS)
def test_a_scene_without_end_is_refused_with_the_number(kind: str, tmp_path: Path) -> None:
    make, words = ENDLESS[kind]
    (tmp_path / "small.nml").write_text(make(tmp_path))
    done = check(tmp_path, "small.nml")
    assert (done.returncode, done.stdout) == (2, "")
    assert words in done.stderr


def test_ten_thousand_wells_are_judged_at_once(tmp_path: Path) -> None:
    wells = "".join(
        f"&injection name = 'w{k}', x = 0.3, y = 0.3, rate = 0, radius = 1e-4 /\n"
        for k in range(9980)
    )
    (tmp_path / "small.nml").write_text(SCENE + wells)
    assert check(tmp_path, "small.nml").returncode == 0


def test_a_long_expression_and_many_names_are_read_at_once(tmp_path: Path) -> None:
    names = "\n".join(f"v{k} = {k}" for k in range(1000))
    terms = "+".join(["v999*1e5"] * 1100)
    (tmp_path / "small.nml").write_text(defined(names, f"'{terms}'"))
    done = check(tmp_path, "small.nml")
    assert done.returncode == 0, done.stderr
