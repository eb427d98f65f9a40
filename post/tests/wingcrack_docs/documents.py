"""Pages of the documentation and what stands in them: blocks of code, commands, spans."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from wingcrack_docs.links import prose

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
