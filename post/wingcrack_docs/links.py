"""Links and headings in a Markdown text, as hosts of plain files and the site understand them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import PurePosixPath

_FENCE = re.compile(r"^ *(```|~~~)")
CODE = re.compile(r"(`+)(?:.*?[^`])?\1(?!`)")
LINK = re.compile(r"(!?\[(?:[^\[\]]|\[[^\]]*\])*\]\()([^()\s]+)(\))")


def prose(text: str) -> Iterator[tuple[int, str, bool]]:
    """Give each line with its number, from 1, and whether it is prose and no code."""
    fence, after_blank, in_code = "", True, False
    for number, line in enumerate(text.splitlines(), 1):
        opening = _FENCE.match(line)
        if fence:
            yield number, line, False
            if line.strip() == fence:
                fence = ""
            continue
        if opening:
            fence = opening[1]
            yield number, line, False
            continue
        if line.strip():
            in_code = line.startswith("    ") and (after_blank or in_code)
        yield number, line, not in_code
        after_blank = not line.strip() or line.startswith("#")


def change_links(text: str, change: Callable[[str], str]) -> str:
    """Put `change(target)` in place of the target of each link that is not in code."""
    lines = []
    for _, line, is_prose in prose(text):
        lines.append(_change_line(line, change) if is_prose else line)
    return "\n".join(lines) + "\n"


def _change_line(line: str, change: Callable[[str], str]) -> str:
    covered = CODE.sub(lambda code: "\0" * len(code[0]), line)
    for match in reversed(list(LINK.finditer(covered))):
        begin, end = match.span(2)
        line = line[:begin] + change(match[2]) + line[end:]
    return line


def is_elsewhere(target: str) -> bool:
    """Whether a link leads to another machine."""
    return re.match(r"[a-z][a-z0-9+.-]*:", target) is not None


def resolve(page: PurePosixPath, path: str) -> PurePosixPath | None:
    """Where a relative path leads from a page, both from the top of the tree; None: out of it."""
    parts: list[str] = []
    for part in (page.parent / path).parts:
        if part == "..":
            if not parts:
                return None
            parts.pop()
        elif part != ".":
            parts.append(part)
    return PurePosixPath(*parts)


_ITEM = re.compile(r"^( *)([-*]|\d+\.)( +)(?=\S)")
_DEEPER = 4  # columns by which Python-Markdown wants content of an item further in


def to_python_markdown(text: str) -> str:
    """The text in the dialect of Python-Markdown.

    It differs from CommonMark, which hosts of plain files read, where these pages make use of it: a
    list needs a blank line before it, and what belongs to an item stands four columns further in.
    """
    lines: list[str] = []
    contents: list[int] = []  # columns where the contents of the open items begin
    before = ""
    for _, line, is_prose in prose(text):
        item = _ITEM.match(line) if is_prose or contents else None
        if item:
            column = len(item[1])
            contents = [content for content in contents if content <= column]
            if before.strip() and not contents and not _belongs_to_item(before):
                lines.append("")
            depth = len(contents)
            contents.append(item.end())
            lines.append(" " * (_DEEPER * depth) + item[2] + " " + line[item.end() :])
        elif contents and line.strip():
            column = len(line) - len(line.lstrip())
            if not before.strip():
                contents = [content for content in contents if content <= column]
            inner = min(contents[-1], column) if contents else 0
            lines.append(" " * (_DEEPER * len(contents)) + line[inner:] if contents else line)
        else:
            lines.append(line)
        before = line
    return "\n".join(lines) + "\n"


def _belongs_to_item(line: str) -> bool:
    return _ITEM.match(line) is not None or line.startswith(("#", " "))
