"""From CommonMark, which the pages are written in, to what Python-Markdown understands by it.

Hosts of plain files read CommonMark. Python-Markdown differs where these pages make use of it: a
list needs a blank line before it, and what belongs to an item stands four columns further in.
"""

from __future__ import annotations

import re

from wingcrack_docs.links import prose

_ITEM = re.compile(r"^( *)([-*]|\d+\.)( +)(?=\S)")
_DEEPER = 4  # columns by which Python-Markdown wants content of an item further in


def to_python_markdown(text: str) -> str:
    """Give the text as Python-Markdown shall read it."""
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
