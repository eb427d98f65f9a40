"""Every command that a page shows is run, or at least understood, and what it names is there."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from calls import launch, short_form, stand_in, understand, understand_other
from documents import NAMES, TOP, blocks, spans
from wingcrack.scenes import solver
from workplaces import make_workplace

# Subcommands that cannot be understood without more: their names are enough in a sentence.
_ALONE = ("plot", "analyse", "study", "import", "view")
_WRITTEN = re.compile(r"Write this into `([\w.]+)`")


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder where the pages' code is run."""
    return make_workplace(tmp_path_factory.mktemp("workplace"))


@pytest.mark.parametrize("page", NAMES)
def test_commands_of_a_page(page: str, workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(workplace)
    lines = (TOP / page).read_text("utf-8").splitlines()
    for block in blocks(page):
        before = " ".join(lines[max(0, block.line - 4) : block.line])
        written = _WRITTEN.search(before)
        if written:
            (workplace / written[1]).write_text(block.text)
        if block.is_shell:
            for words in block.commands:
                _try(words, workplace, f"{page}:{block.line}")


def test_commands_within_sentences_are_understood(
    workplace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(workplace)
    seen = 0
    for page in NAMES:
        for line, span in spans(page):
            if span.startswith("./wingcrack "):
                words = stand_in(shlex.split(span)[1:])
                seen += 1
                try:
                    if len(words) > 1 and "--help" not in words:
                        understand(words)
                    elif words[0] not in _ALONE:
                        understand(words[:1])
                except (AssertionError, SystemExit) as reason:
                    pytest.fail(f"{page}:{line}: `{span}` is not understood: {reason}")
    assert seen > 15


def test_a_command_that_is_not_there_is_found(workplace: Path) -> None:
    for words in (["verify", "no_such_case"], ["run", "x.nml", "--no-such"], ["nothing"]):
        with pytest.raises((AssertionError, SystemExit)):
            understand(words)
    with pytest.raises(AssertionError):
        _try(["./wingcrack", "check", "inputs/none.nml"], workplace, "here")
    with pytest.raises(AssertionError):
        understand_other(["no_such_program"])


def _try(words: list[str], place: Path, where: str) -> None:
    while re.fullmatch(r"[A-Z_]+=\S+", words[0]) and len(words) > 1:
        words = words[1:]
    words = stand_in(words)
    if words[0] == "build/release/fortran/app/wingcrack-solver":
        arguments = [word for word in words[1:] if not word.startswith(">")]
        assert solver.call(*arguments).returncode == 0, where
    elif words[0] != "./wingcrack":
        understand_other(words)
    else:
        _try_launcher(words[1:], place, where)


def _try_launcher(words: list[str], place: Path, where: str) -> None:
    short = short_form(words)
    if short is None:
        try:
            understand(words)
        except SystemExit as ended:
            pytest.fail(f"{where}: {' '.join(words)} is not understood: {ended}")
        return
    if short[0] == "check" and words[0] == "run":
        understand(words)
    done = launch(place, *short)
    assert done.returncode == 0, f"{where}: {' '.join(words)}: {done.stderr}"
