"""The version stands in several places, which agree; who cites the program finds what is needed."""

from __future__ import annotations

import re

import yaml  # type: ignore[import-untyped]
from launcher_tree import TOP

from wingcrack import __version__


def test_the_version_is_the_same_everywhere() -> None:
    places = {
        "CMakeLists.txt": r"^project\(wingcrack VERSION (\S+)",
        "CITATION.cff": r"^version: (\S+)",
        "packaging/spack/package.py": r'^    version\("([^"]+)"',
        "packaging/conda/meta.yaml": r'^{% set version = "([^"]+)"',
        "CHANGELOG.md": r"^## ([0-9.]+) - ",
    }
    for place, pattern in places.items():
        found = re.search(pattern, (TOP / place).read_text("utf-8"), re.MULTILINE)
        assert found is not None, place
        assert found[1] == __version__, place


def test_the_citation_names_program_and_thesis() -> None:
    citation = yaml.safe_load((TOP / "CITATION.cff").read_text("utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert citation["authors"] == [{"name": "The wingcrack developers"}]
    assert citation["license"] == "GPL-3.0-or-later"
    thesis = citation["references"][0]
    assert (thesis["type"], thesis["year"]) == ("thesis", 2023)
    date = re.search(r"^## \S+ - (\S+)", (TOP / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE)
    assert date is not None
    assert str(citation["date-released"]) == date[1]
