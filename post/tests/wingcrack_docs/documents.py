"""Pages of the documentation and what stands in them: blocks of code, commands, spans."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from wingcrack_docs.links import CODE, LINK, prose

TOP = Path(__file__).resolve().parents[3]
PAGES = (
    TOP / "README.md",
    TOP / "CONTRIBUTING.md",
    TOP / "CHANGELOG.md",
    TOP / "inputs" / "examples" / "README.md",
    *sorted((TOP / "docs").glob("*.md")),
)
NAMES = [page.relative_to(TOP).as_posix() for page in PAGES]

_SHELL = re.compile(
    r"(\./wingcrack|\.venv/bin/|build/release/|cmake |podman |python3 |[A-Z_]+=\S+ \S|/opt/)"
)
_HEADING = re.compile(r"^#{1,6} +(.*?)(?: +#+)? *$")
_SPAN = re.compile(r"(?<!`)`([^`]+)`(?!`)")


@dataclass(frozen=True)
class Block:
    """Code of a page: its first line in it, from 1, what the fence says it is, its text."""

    page: str
    line: int
    language: str
    text: str

    @property
    def is_shell(self) -> bool:
        """Whether these are commands; those that are only indented are known by how they begin."""
        return self.language == "sh" or (not self.language and _SHELL.match(self.text) is not None)

    @property
    def commands(self) -> list[list[str]]:
        """The words of each command; remarks are left out, lines that go on are joined."""
        lines = self.text.replace("\\\n", " ").splitlines()
        split = (shlex.split(line, comments=True) for line in lines)
        return [words for words in split if words]


def blocks(page: str) -> list[Block]:
    """All code of a page, in its order."""
    found: list[Block] = []
    lines: list[str] = []
    language, first, fenced = "", 0, False
    for number, line, is_prose in (*prose((TOP / page).read_text("utf-8")), (0, "", True)):
        mark = re.match(r" *```(\w*)", line)
        if is_prose or (mark and not fenced and lines):
            if any(text.strip() for text in lines):
                found.append(Block(page, first, language, _flush_left(lines)))
            lines, language, fenced = [], "", False
        if is_prose or (mark and fenced):
            continue
        if mark:
            language, fenced = mark[1], True
            continue
        if not lines:
            first = number
        lines.append(line)
    return found


def spans(page: str) -> Iterator[tuple[int, str]]:
    """Code within sentences, with its line."""
    for number, line, is_prose in prose((TOP / page).read_text("utf-8")):
        if is_prose:
            yield from ((number, match[1]) for match in _SPAN.finditer(line))


def _flush_left(lines: list[str]) -> str:
    margin = min(len(line) - len(line.lstrip()) for line in lines if line.strip())
    return "\n".join(line[margin:] for line in lines).strip("\n") + "\n"


class Link(NamedTuple):
    """A link: its line in the text, from 1, and where it leads."""

    line: int
    target: str


def find_links(text: str) -> list[Link]:
    """All links of a text that are not in code."""
    return [
        Link(number, match[2])
        for number, line, is_prose in prose(text)
        if is_prose
        for match in LINK.finditer(CODE.sub(lambda code: " " * len(code[0]), line))
    ]


def anchors(text: str) -> set[str]:
    """Anchors of a text's headings, as hosts of plain files and the site make them."""
    found: set[str] = set()
    for _, line, is_prose in prose(text):
        heading = _HEADING.match(line)
        if is_prose and heading:
            slug = _slug(heading[1])
            count, name = 0, slug
            while name in found:
                count += 1
                name = f"{slug}-{count}"
            found.add(name)
    return found


def _slug(heading: str) -> str:
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    kept = re.sub(r"[^\w\- ]", "", words.lower())
    return kept.strip().replace(" ", "-")
