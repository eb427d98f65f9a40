"""The report as one self-contained HTML file."""

from __future__ import annotations

import base64
import mimetypes
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2
from markdown_it import MarkdownIt
from markdown_it.token import Token

from wingcrack_verify.drawings import Sheet
from wingcrack_verify.figures import Drawing
from wingcrack_verify.illustrate import Illustration
from wingcrack_verify.suite import JudgedSuite

_MOST_REASONS = 2  # in the summary
_TEMPLATES = Path(__file__).parent / "templates"

# Heads of the tables; on narrow screens each row is a card, and they stand before its cells.
_STEPS = ("Newton mean", "Newton max", "cuts")
_TRIAL = ("trial", "ended", "expected", *_STEPS, "mass error", "contact res.")
_COLUMNS = {
    "groups": ("group", "passed", "gaps", "failed", "largest error", "CPU s"),
    "rows": ("case", "quantity", "error", "tolerance", "verdict"),
    "nearest": ("case", "quantity", "error", "tolerance", "share"),
    "runs": ("run", "method", "result", "reference", "error", "judged", "unknowns", "CPU s"),
    "trials": (*_TRIAL, "verdict", "CPU s"),
    "estimates": (*_TRIAL, "condition", "error bound", "verdict", "CPU s"),
}


def page_text(
    judged: JudgedSuite,
    record: dict[str, Any],
    pictures: Mapping[str, Illustration],
    folder: Path,
) -> str:
    """Text of index.html; `folder` is where it will be, for the links to the cases' files."""
    sheet = Sheet()
    figures = {
        name: {
            "of_case": [_figure(drawing, sheet) for drawing in picture.of_case],
            "of_checks": [[_figure(d, sheet) for d in drawings] for drawings in picture.of_checks],
        }
        for name, picture in pictures.items()
    }
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
    templates.filters["anchor"] = anchor
    templates.filters["shortened"] = shortened
    return templates.get_template("report.html.j2").render(
        record=record,
        texts={name: readme_html(path, folder) for name, path in judged.folders.items()},
        links={name: os.path.relpath(path, folder) for name, path in judged.folders.items()},
        items={item["name"]: item for item in (*record["cases"], *record["stability"])},
        figures=figures,
        shared=sheet.definitions(),
        columns=_COLUMNS | {"settings": _setting_columns(record)},
        script=(_TEMPLATES / "report.js").read_text(encoding="utf-8"),
    )


def _setting_columns(record: dict[str, Any]) -> tuple[str, ...]:
    targets = record["settings"][0]["targets"] if record["settings"] else ()
    return ("case", "quantity", "default", *(f"{100 * item['target']:g} %" for item in targets))


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


def anchor(case: str) -> str:
    """Name of the place of a case, which other pages may link to."""
    return f"case-{case}"


def _figure(drawing: Drawing, sheet: Sheet) -> dict[str, str]:
    return {
        "title": drawing.title,
        "caption": drawing.caption,
        "svg": sheet.take(drawing.svg, drawing.title),
    }


def readme_html(case: Path, folder: Path) -> str:
    """README.md of a case as HTML.

    Headings move down below those of the report; a link to a file leads there from `folder`, and
    pictures are put in.
    """
    file = case / "README.md"
    if not file.is_file():
        return ""
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = parser.parse(file.read_text(encoding="utf-8"))
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(int(token.tag[1]) + 2, 6)}"
        for child in token.children or []:
            _embed_target(child, case, folder)
    html = str(parser.renderer.render(tokens, parser.options, {}))
    return html.replace("<table>", '<div class="scroll"><table>').replace(
        "</table>", "</table></div>"
    )


def _embed_target(token: Token, case: Path, folder: Path) -> None:
    if token.type == "image":
        path = case / str(token.attrs["src"])
        if path.is_file():
            kind = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
            data = base64.b64encode(path.read_bytes()).decode()
            token.attrs["src"] = f"data:{kind};base64,{data}"
    elif token.type == "link_open":
        target = str(token.attrs["href"])
        if re.match(r"[a-z]+:|#", target) is None:
            token.attrs["href"] = os.path.relpath(case / target, folder)
