"""Tests that are skipped: told at the end, and what they take is installed where all are wanted."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from launcher_tree import TOP, Tree, asked

TESTS = """\
import pytest
def test_here():
    pass
@pytest.mark.skipif(True, reason="no valgrind")
def test_counted():
    pass
@pytest.mark.parametrize("k", [1, 2])
def test_asked(k):
    pytest.skip("no browser")
"""
MODULE = 'import pytest\npytest.importorskip("no_such_module", reason="no such module")\n'
CTEST = """\
<testsuite name="all" tests="2" skipped="1">
    <testcase name="test_a" classname="test_a" status="run"><system-out/></testcase>
    <testcase name="test_b" classname="test_b" status="notrun">
        <skipped message="SKIP_RETURN_CODE=77"/>
    </testcase>
</testsuite>
"""


def tell(folder: Path, **variables: str) -> tuple[int, str]:
    environment = {k: v for k, v in os.environ.items() if k != "WINGCRACK_ALL_TESTS"}
    call = [sys.executable, "-I", str(TOP / "tools" / "skipped.py"), str(folder)]
    done = subprocess.run(call, env={**environment, **variables}, capture_output=True, text=True)
    assert done.stderr == ""
    return done.returncode, done.stdout


def test_every_skipped_test_is_told_with_its_reason(tmp_path: Path) -> None:
    (tmp_path / "test_x.py").write_text(TESTS)
    (tmp_path / "test_y.py").write_text(MODULE)
    call = [
        sys.executable,
        "-P",
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "--numprocesses=2",
    ]
    done = subprocess.run([*call, "--junitxml=out/pytest.xml"], cwd=tmp_path, capture_output=True)
    assert done.returncode == 0
    (tmp_path / "out" / "CTest, debug build.xml").write_text(CTEST)
    status, words = tell(tmp_path / "out")
    assert (status, words.splitlines()[0]) == (0, "SKIPPED: 5 tests")
    reasons: dict[str, list[str]] = {}
    for line in words.splitlines()[1:-1]:
        if line.startswith("      "):
            reasons[next(reversed(reasons))].append(line.strip())
        else:
            reasons[line.strip()] = []
    assert {reason: sorted(tests) for reason, tests in reasons.items()} == {
        "SKIP_RETURN_CODE=77": ["CTest, debug build: test_b"],
        "no valgrind": ["pytest: test_x.test_counted"],
        "no browser": ["pytest: test_x.test_asked[1]", "pytest: test_x.test_asked[2]"],
        "no such module": ["pytest: test_y"],
    }
    status, wanted = tell(tmp_path / "out", WINGCRACK_ALL_TESTS="1")
    assert (status, wanted.splitlines()[:-1]) == (1, words.splitlines()[:-1])


def test_nothing_skipped_is_told_too(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text('<testsuite><testcase name="a" classname="b"/></testsuite>')
    assert tell(tmp_path, WINGCRACK_ALL_TESTS="1") == (0, "no test was skipped\n")


@pytest.fixture
def optional_tree(lacking_tree: Tree, machine: Path) -> Tree:
    """A tree whose tests take more packages, each kind one."""
    for use in ("ranks", "tests", "browser"):
        (lacking_tree.root / "tools" / f"system_packages_{use}.txt").write_text(
            f"for-{use} | command for-{use} | a thing for {use}\n"
        )
    apt = (machine / "apt-get").read_text()
    more = (
        'for one in $words; do [[ $one == for-* ]] && ln -sf "$(type -P true)" "$here/$one"; done'
    )
    (machine / "apt-get").write_text(f"{apt}{more}\nexit 0\n")
    return lacking_tree


@pytest.mark.parametrize(
    ("variables", "installed"),
    [
        ({"CI": ""}, []),
        ({"CI": "true"}, ["for-tests", "for-ranks"]),
        ({"CI": "", "WINGCRACK_ALL_TESTS": "1"}, ["for-tests", "for-ranks", "for-browser"]),
    ],
)
def test_what_tests_take_is_installed_where_all_are_wanted(
    optional_tree: Tree, machine: Path, variables: dict[str, str], installed: list[str]
) -> None:
    """The names are kept while it installs: one linter is all that is run."""
    environment = {"WINGCRACK_ALL_TESTS": "0", **variables}
    done = optional_tree.call("test", "fortitude", **environment)
    assert [line for line in done.stdout.splitlines() if line.startswith("== ")] == ["== fortitude"]
    wanted = [f"install {' '.join(installed)}"] if installed else []
    calls = [line for line in asked(machine) if line != "update"]
    assert calls == ["install alpha-tool beta-lib-5.10", *wanted]
    for name in installed:
        assert f"a thing {name.replace('-', ' ')}" in done.stderr


@pytest.mark.parametrize(("variable", "tested"), [("CI", True), ("WINGCRACK_ALL_TESTS", False)])
def test_what_cannot_be_had_is_told(optional_tree: Tree, variable: str, tested: bool) -> None:
    """CI goes on without it; where all tests are wanted, this is the end."""
    assert optional_tree.call("check", optional_tree.scene(), CI="").returncode == 0
    variables = {"CI": "", "WINGCRACK_ALL_TESTS": "0", variable: "true"}
    done = optional_tree.call("test", "fortitude", WINGCRACK_NO_INSTALL="1", **variables)
    assert "for-tests" in done.stderr
    assert ("== fortitude" in done.stdout) == tested
    assert done.returncode == (1 if tested else 3)
    assert ("going on without what optional tests take" in done.stderr) == tested
