"""Python, TOML and scene snippets of the pages work."""

from __future__ import annotations

import tomllib
from pathlib import Path

import f90nml
import matplotlib
import pytest

import wingcrack
from calls import launch
from documents import NAMES, TOP, Block, blocks, spans
from wingcrack.scenes import solver
from workplaces import make_workplace

SNIPPETS = [block for page in NAMES for block in blocks(page)]
PYTHON = [block for block in SNIPPETS if block.language == "python"]
TOML = [block for block in SNIPPETS if block.language == "toml"]
SCENES = [
    block
    for block in SNIPPETS
    if block.language == "fortran" or (not block.language and block.text.startswith("&"))
]


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder where the pages' code is run."""
    return make_workplace(tmp_path_factory.mktemp("workplace"))


def _last_two(run: wingcrack.Run) -> list[float]:
    return [snapshot.time_s for snapshot in run._matrix][-2:]


def _name(block: Block) -> str:
    return f"{block.page}:{block.line}"


def test_there_are_snippets_of_each_kind() -> None:
    assert min(len(PYTHON), len(TOML), len(SCENES)) >= 6


@pytest.mark.filterwarnings("ignore::ResourceWarning")  # files that a snippet leaves open
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("block", PYTHON, ids=_name)
def test_python_runs(block: Block, workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(workplace)
    matplotlib.use("agg")
    from matplotlib import pyplot

    # a movie of two states shows as much
    monkeypatch.setattr(wingcrack.Run, "field_moments", property(_last_two))
    mine = workplace / "out" / "mine"
    if not mine.exists():
        mine.symlink_to(workplace / "out" / "onset")
    try:
        exec(compile(block.text, _name(block), "exec"), {})
    except wingcrack.EnvironmentLacksError as reason:
        pytest.skip(str(reason))
    finally:
        pyplot.close("all")


@pytest.mark.parametrize("block", TOML, ids=_name)
def test_toml_is_read(block: Block, tmp_path: Path) -> None:
    content = tomllib.loads(block.text)
    if ("over" in content or "draw" in content) and "source" not in content:  # a study
        folder = tmp_path / "studies"
        folder.mkdir()
        (tmp_path / "paper_d").symlink_to(TOP / "inputs" / "paper_d")
        assert launch(tmp_path, "new", "injection", "--out", "studies/mine.nml").returncode == 0
        if "from" in content:  # of a run, which is not repeated here
            assert "at" in content
            return
        (folder / "shown.toml").write_text(block.text.replace("count = 40", "count = 4"))
        done = launch(tmp_path, "study", "studies/shown.toml", "--check")
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("block", SCENES, ids=_name)
def test_names_of_scenes_are_known(block: Block, tmp_path: Path) -> None:
    groups = f90nml.reads(block.text)
    assert groups, block.text
    if "domain" in groups and "material" in groups:
        whole = tmp_path / "whole.nml"
        whole.write_text(block.text)
        good, said = solver.check(whole)
        assert good, said
    for group, items in groups.items():
        for item in items if isinstance(items, list) else [items]:
            for name in item if group != "define" else ():
                assert f"{group}.{name}" in wingcrack.parameters(), f"&{group} has no {name}"


def test_groups_within_sentences_are_known() -> None:
    known = {address.partition(".")[0] for address in wingcrack.parameters()} | {"define"}
    for page in NAMES:
        for line, span in spans(page):
            if span.startswith("&") and not span.startswith("&&"):
                words = span[1:].replace("/", " ").replace("(", " ").split()
                assert words[0].rstrip(",.") in known, f"{page}:{line}: {span}"
