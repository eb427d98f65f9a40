"""Links of the pages lead somewhere, in the plain files and in the site alike."""

from __future__ import annotations

from pathlib import PurePosixPath

import pytest

from documents import NAMES, TOP, anchors, find_links
from wingcrack_docs.links import (
    change_links,
    is_elsewhere,
    resolve,
    to_python_markdown,
)

CASES = [
    page.relative_to(TOP).as_posix() for page in sorted((TOP / "verification").glob("*/README.md"))
]


def broken_links(page: str, text: str) -> list[str]:
    """What is wrong with the links of a page, by line."""
    wrong = []
    for link in find_links(text):
        if is_elsewhere(link.target):
            continue
        path, _, anchor = link.target.partition("#")
        meant = resolve(PurePosixPath(page), path) if path else PurePosixPath(page)
        if meant is None or not (TOP / meant).exists():
            wrong.append(f"{page}:{link.line}: there is no {link.target}")
        elif anchor and anchor not in anchors((TOP / meant).read_text("utf-8")):
            wrong.append(f"{page}:{link.line}: {meant} has no heading #{anchor}")
    return wrong


@pytest.mark.parametrize("page", [*NAMES, *CASES])
def test_links_lead_somewhere(page: str) -> None:
    assert broken_links(page, (TOP / page).read_text("utf-8")) == []


def test_broken_links_are_found() -> None:
    text = "[a](none.md) `[b](not.md)` [c](maps.md#nowhere) [d](maps.md#faults-and-repairs)\n"
    text += "\n    [e](x)\n"
    assert [fault.partition(": ")[2] for fault in broken_links("docs/x.md", text)] == [
        "there is no none.md",
        "docs/maps.md has no heading #nowhere",
    ]
    assert broken_links("README.md", "[out](../../x)") == ["README.md:1: there is no ../../x"]


def test_links_are_changed_outside_of_code_only() -> None:
    text = "![p](a.png) and [q](a.md#b) `[r](a.md)`\n\n    [s](a.md)\n\n```\n[t](a.md)\n```\n"
    changed = change_links(text, lambda target: f"to/{target}")
    assert find_links(changed) == [(1, "to/a.png"), (1, "to/a.md#b")]
    assert changed.count("to/") == 2


def test_equal_headings_get_numbers() -> None:
    text = "# A `b` c, d\n## One\n## One\n```\n# no\n```\n## [Link](x.md) & more\n"
    assert anchors(text) == {"a-b-c-d", "one", "one-1", "link--more"}


def test_lists_become_those_of_python_markdown() -> None:
    text = "Words:\n- one\n  goes on\n  - within\n- two\n\n       code\n\nAfter.\n"
    assert to_python_markdown(text) == (
        "Words:\n\n- one\n    goes on\n    - within\n- two\n\n         code\n\nAfter.\n"
    )


def test_text_without_lists_stays() -> None:
    text = "# A\n\n| a | b |\n|---|---|\n| - | 1. |\n\n    - code\n\n```\n- x\n  - y\n```\n"
    assert to_python_markdown(text) == text
