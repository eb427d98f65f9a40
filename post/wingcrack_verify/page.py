"""The report as one HTML file that needs nothing else."""

from __future__ import annotations

import base64
import mimetypes
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jinja2
from markdown_it import MarkdownIt
from markdown_it.token import Token

from wingcrack_verify.figures import Drawing
from wingcrack_verify.illustrate import Illustrations
from wingcrack_verify.suite import JudgedSuite

_MOST_REASONS = 2  # in the summary
_TEMPLATES = Path(__file__).parent / "templates"


def page_text(
    judged: JudgedSuite, record: dict[str, Any], pictures: Illustrations, folder: Path
) -> str:
    """Text of index.html; `folder` is where it will be, for the links to the cases' files."""
    loader = jinja2.FileSystemLoader(_TEMPLATES)
    templates = jinja2.Environment(
        loader=loader,
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.filters["number"] = number_text
    templates.filters["slug"] = slug
    templates.filters["shortened"] = shortened
    return templates.get_template("report.html.j2").render(
        record=record,
        texts={name: readme_html(path, folder) for name, path in judged.folders.items()},
        links={name: os.path.relpath(path, folder) for name, path in judged.folders.items()},
        figures={
            name: [_embedded(drawing) for drawing in drawings]
            for name, drawings in pictures.by_case.items()
        },
    )


def number_text(value: float | None, form: str = ".3g") -> str:
    """Number for a table; a dash where there is none."""
    return "-" if value is None else format(value, form)


def shortened(reasons: Sequence[str]) -> list[str]:
    """First few reasons; the section of the case has all of them."""
    more = len(reasons) - _MOST_REASONS
    return [*reasons[:_MOST_REASONS], *([f"and {more} more, see the case"] if more > 0 else [])]


def slug(text: str) -> str:
    """Text as part of an anchor's name."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")


def _embedded(drawing: Drawing) -> dict[str, str]:
    data = base64.b64encode(drawing.svg).decode()
    return {
        "title": drawing.title,
        "caption": drawing.caption,
        "source": f"data:image/svg+xml;base64,{data}",
    }


def readme_html(case: Path, folder: Path | None) -> str:
    """README.md of a case as HTML.

    Headings move down below those of the report; a link to a file leads there from `folder`, and
    pictures are put in. Without a folder (for the PDF) links to files become plain text.
    """
    file = case / "README.md"
    if not file.is_file():
        return ""
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = parser.parse(file.read_text(encoding="utf-8"))
    for token in tokens:
        if folder is None and token.type.startswith("paragraph") and token.level > 0:
            token.hidden = True  # in a list: the PDF would set its bullets apart from the words
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(int(token.tag[1]) + 2, 6)}"
        for child in token.children or []:
            _embed_target(child, case, folder)
    html = str(parser.renderer.render(tokens, parser.options, {}))
    return html.replace("<table>", '<div class="scroll"><table>').replace(
        "</table>", "</table></div>"
    )


def _embed_target(token: Token, case: Path, folder: Path | None) -> None:
    if token.type == "image":
        path = case / str(token.attrs["src"])
        if path.is_file():
            kind = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
            data = base64.b64encode(path.read_bytes()).decode()
            token.attrs["src"] = f"data:{kind};base64,{data}"
    elif token.type == "link_open":
        target = str(token.attrs["href"])
        if re.match(r"[a-z]+:|#", target) is None and folder is not None:
            token.attrs["href"] = os.path.relpath(case / target, folder)
