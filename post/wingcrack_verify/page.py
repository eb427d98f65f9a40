"""The report as one self-contained HTML file."""

from __future__ import annotations

import base64
import html
import mimetypes
import os
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import jinja2
from markdown_it import MarkdownIt
from markdown_it.token import Token

from wingcrack_verify.figures import Drawing, check_drawings, map_drawing, requested_drawing
from wingcrack_verify.judge import PASSED, CaseReport
from wingcrack_verify.stability import StabilityReport
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
    judged: JudgedSuite, record: dict[str, Any], pictures: Mapping[str, Illustration], folder: Path
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
    return (
        templates()
        .get_template("report.html.j2")
        .render(
            record=record,
            texts={name: readme_html(path, folder) for name, path in judged.folders.items()},
            links={name: os.path.relpath(path, folder) for name, path in judged.folders.items()},
            items={item["name"]: item for item in (*record["cases"], *record["stability"])},
            figures=figures,
            shared=sheet.definitions(),
            columns=_COLUMNS | {"settings": _setting_columns(record)},
            script=(_TEMPLATES / "report.js").read_text(encoding="utf-8"),
        )
    )


def templates() -> jinja2.Environment:
    """Templates of pages, with the filters that they use."""
    loader = jinja2.FileSystemLoader(_TEMPLATES)
    found = jinja2.Environment(
        loader=loader,
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters["number"] = number_text
    found.filters["slug"] = slug
    found.filters["anchor"] = anchor
    found.filters["shortened"] = shortened
    return found


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


@dataclass(frozen=True)
class Illustration:
    """Figures of a case: those that it asks for, and those of each of its checks."""

    of_case: Sequence[Drawing]
    of_checks: Sequence[Sequence[Drawing]]


def illustrate(judged: JudgedSuite, jobs: int, passed: bool = True) -> dict[str, Illustration]:
    """Draw the figures of all cases, several cases at a time; by the case's name.

    Without those of what has `passed`, only checks, maps and cases that did not are drawn.
    """
    items: list[CaseReport | StabilityReport] = [*judged.stability, *judged.cases]
    found = {item.name: Illustration((), [()] * len(getattr(item, "checks", ()))) for item in items}
    drawn = [item for item in items if passed or item.verdict != PASSED]
    if drawn:
        with ProcessPoolExecutor(min(jobs, len(drawn))) as pool:
            pictures = pool.map(partial(_drawings, passed=passed), drawn)
            found |= zip((item.name for item in drawn), pictures, strict=True)
    return found


def _drawings(item: CaseReport | StabilityReport, passed: bool) -> Illustration:
    if isinstance(item, StabilityReport):
        maps = [chart for chart in item.maps if passed or chart.verdict != PASSED]
        return Illustration([map_drawing(chart) for chart in maps], ())
    requested = [requested_drawing(figure) for figure in item.figures]
    return Illustration(
        [drawing for drawing in requested if drawing is not None],
        [
            check_drawings(check) if passed or check.verdict != PASSED else ()
            for check in item.checks
        ],
    )


_SPACE = "{http://www.w3.org/2000/svg}"
_LINK = "{http://www.w3.org/1999/xlink}href"
_NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
_AROUND_COMMANDS = re.compile(r"\s*([A-Za-z])\s*")
_DROPPED = ("metadata", "style", "title")
_SHAPED = ("d", "x", "y", "width", "height", "transform", "points", "cx", "cy", "r")


class Sheet:
    """Common parts of the drawings of a page, which are written once.

    matplotlib writes the shapes of all letters into every drawing, a style at every line, and
    places to a millionth of a point. That is three quarters of a drawing and more.
    """

    def __init__(self) -> None:
        self._shapes: dict[str, str] = {}
        self._styles: dict[str, str] = {}

    def take(self, svg: bytes, title: str) -> str:
        """Give a drawing as a part of the page; its `title` is for those who cannot see it."""
        root = ElementTree.fromstring(svg)
        names: dict[str, str] = {}
        for definitions in root.iter(f"{_SPACE}defs"):
            for shape in list(definitions):
                name = shape.attrib.pop("id", None)
                if name is not None:
                    names[name] = self._share(shape)
        inside = "".join(self._text(child, names) for child in root)
        box = root.attrib["viewBox"]
        _, _, width, height = box.split()
        return (
            f'<svg viewBox="{box}" width="{width}" height="{height}" role="img" '
            f'aria-label="{html.escape(title)}">{inside}</svg>'
        )

    def definitions(self) -> str:
        """What the drawings refer to, to stand anywhere in the page."""
        styles = "".join(f".{name}{{{style}}}" for style, name in self._styles.items())
        shapes = "".join(
            shape.replace(" ", f' id="{name}" ', 1) for shape, name in self._shapes.items()
        )
        return (
            f"<style>{styles}</style>"
            f'<svg width="0" height="0" style="position:absolute"><defs>{shapes}</defs></svg>'
        )

    def _share(self, shape: ElementTree.Element) -> str:
        return self._shapes.setdefault(self._text(shape, {}), f"d{len(self._shapes)}")

    def _text(self, element: ElementTree.Element, names: dict[str, str]) -> str:
        """Element without what is not seen; `names` are the new ones of what it refers to."""
        tag = element.tag.removeprefix(_SPACE)
        if tag in (*_DROPPED, "defs"):
            return ""
        attributes = self._attributes(element, names)
        inside = "".join(self._text(child, names) for child in element)
        if tag == "g" and not attributes:
            return inside
        end = f">{inside}</{tag}>" if inside else "/>"
        # a blank even where there is no attribute: the name of a shared one is put there
        return f"<{tag} {attributes}{end}"

    def _attributes(self, element: ElementTree.Element, names: dict[str, str]) -> str:
        found = []
        for name, value in element.attrib.items():
            if name == "id":
                continue
            if name == _LINK:
                name = "href"
                value = f"#{names[value[1:]]}" if value.startswith("#") else value
            elif name == "clip-path":
                value = f"url(#{names[value[5:-1]]})"
            elif name == "style":
                name, value = "class", self._style(value)
            elif name in _SHAPED:
                value = _shortened(value)
            found.append(f'{name}="{html.escape(value)}"')
        return " ".join(found)

    def _style(self, style: str) -> str:
        short = re.sub(r"\s*([:;])\s*", r"\1", style).rstrip(";")
        return self._styles.setdefault(short, f"s{len(self._styles)}")


def _shortened(numbers: str) -> str:
    """Numbers to a hundredth of a point, small ones to four digits."""
    return _AROUND_COMMANDS.sub(r"\1", _NUMBER.sub(_short, numbers)).strip()


def _short(match: re.Match[str]) -> str:
    value = float(match[0])
    text = f"{value:.2f}".rstrip("0").rstrip(".") if abs(value) >= 1.0 else f"{value:.4g}"
    return "0" if text == "-0" else text
