"""The report as a PDF: the same words, tables and figures, for print."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
from fpdf import FPDF, FontFace, TextStyle
from fpdf.outline import OutlineSection

from wingcrack_verify.figures import Drawing
from wingcrack_verify.illustrate import Illustration
from wingcrack_verify.judge import ERROR, FAILED, GAP, PASSED
from wingcrack_verify.page import number_text, readme_html, shortened
from wingcrack_verify.suite import JudgedSuite

_CELL = re.compile(r"(<t[dh](?:\s[^>]*)?>)(.*?)(</t[dh]>)", re.DOTALL)
_HEADING = re.compile(r"<h\d>(.*?)</h\d>", re.DOTALL)
_TAG = re.compile(r"<[^>]+>")
_FONTS = {"": "DejaVuSans", "B": "DejaVuSans-Bold", "I": "DejaVuSans-Oblique"}
_COLOURS = {PASSED: (26, 127, 55), GAP: (138, 90, 0), FAILED: (179, 38, 30), ERROR: (179, 38, 30)}
_HEAD = FontFace(emphasis="B", fill_color=(240, 243, 246))
_MARGIN, _GAP = 15.0, 6.0  # [mm]
_FIGURE_HEIGHT = 100.0  # [mm], at most
_LINE = 4.2  # [mm], between those of the contents
_FIGURE_WIDTH = (210.0 - 2.0 * _MARGIN - _GAP) / 2.0  # [mm], two beside each other on A4


class _Book(FPDF):
    def footer(self) -> None:
        """Put the page's number below each page."""
        self.set_y(-10.0)
        self.set_font("body", size=7)
        self.cell(0, 5, f"{self.page_no()}/{{nb}}", align="C")


def write_booklet(
    judged: JudgedSuite, record: dict[str, Any], pictures: Mapping[str, Illustration], path: Path
) -> None:
    """Write the PDF: per check its largest error; all runs are in the page and in report.json."""
    book = _new_book()
    _title(book, record)
    _summary(book, record)
    book.add_page()
    book.insert_toc_placeholder(_contents)
    folders = judged.folders
    items = {item["name"]: item for item in (*record["cases"], *record["stability"])}
    for group in record["groups"]:
        _heading(book, group["title"], 14)
        for name in (case["name"] for case in group["cases"]):
            item = items[name]
            _head(book, item, folders[name])
            if "trials" in item:
                _trials(book, item)
            else:
                _checks(book, item["checks"])
            _figures(book, pictures[name].all)
    _settings(book, record)
    _made_with(book, record)
    book.output(str(path))


def _new_book() -> _Book:
    book = _Book(format="A4")
    fonts = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    for style, name in _FONTS.items():
        book.add_font("body", style, fonts / f"{name}.ttf")
    book.add_font("body", "BI", fonts / "DejaVuSans-BoldOblique.ttf")
    for style in ("", "B", "I", "BI"):
        book.add_font("code", style, fonts / "DejaVuSansMono.ttf")
    book.set_margins(_MARGIN, _MARGIN)
    book.set_auto_page_break(auto=True, margin=_MARGIN)
    book.set_title("wingcrack: verification")
    book.add_page()
    return book


def _title(book: _Book, record: dict[str, Any]) -> None:
    book.set_font("body", "B", 16)
    book.cell(0, 10, "wingcrack: verification", new_x="LMARGIN", new_y="NEXT")
    book.set_font("body", "B", 11)
    book.set_text_color(*_COLOURS[record["verdict"]])
    counts = ", ".join(f"{number} {word}" for word, number in record["counts"].items())
    _words(book, f"{record['verdict'].capitalize()}: {counts}", 6.0)
    book.set_text_color(0)
    book.set_font("body", "", 8)
    _words(book, f"Revision {record['revision']}; {record['scope']}; {record['made']}.")


def _summary(book: _Book, record: dict[str, Any]) -> None:
    rows = []
    for group in record["groups"]:
        counts, worst = group["counts"], group["worst"]
        most = "-" if worst is None else f"{worst['case']}: {worst['quantity']}"
        error = "-" if worst is None else f"{worst['error']} of {worst['tolerance']}"
        bad = counts["failed"] + counts["error"]
        numbers = (str(counts["passed"]), str(counts["known gap"]), str(bad))
        rows.append((group["title"], *numbers, most, error, number_text(group["cpu_s"])))
    names = ("group", "passed", "gaps", "failed", "largest error", "of its tolerance", "CPU s")
    _table(book, names, rows, (34, 12, 10, 10, 66, 36, 12))
    bad_rows = [row for row in record["summary"] if row["verdict"] != PASSED]
    if bad_rows:
        _part(book, "Gaps and failures")
        shown = [
            (
                row["case"],
                "\n".join([row["quantity"], *shortened(row["reasons"])]),
                row["error"],
                row["tolerance"],
                row["verdict"],
            )
            for row in bad_rows
        ]
        heads = ("case", "quantity", "error", "tolerance", "verdict")
        _table(book, heads, shown, (30, 88, 24, 20, 18), verdict=4)
    if record["nearest"]:
        _part(book, "Passed, and nearest to the tolerance")
        shown = [
            (
                row["case"],
                row["quantity"],
                row["error"],
                row["tolerance"],
                f"{100 * row['share']:.3g} %",
            )
            for row in record["nearest"]
        ]
        heads = ("case", "quantity", "error", "tolerance", "share")
        _table(book, heads, shown, (34, 86, 24, 20, 16))


def _contents(book: FPDF, outline: Sequence[OutlineSection]) -> None:
    """A page in two columns, its lines as close as it takes to hold them all."""
    book.set_xy(_MARGIN, _MARGIN)
    book.set_font("body", "B", 12)
    book.cell(0, 8, "Contents", new_x="LMARGIN", new_y="NEXT")
    top, rows = book.get_y(), -(-len(outline) // 2)
    height = min(_LINE, (book.eph + _MARGIN - top) / max(rows, 1))
    for index, section in enumerate(outline):
        column, row = divmod(index, rows)
        indent, page = 3.0 * section.level, str(section.page_number)
        book.set_xy(_MARGIN + column * (_FIGURE_WIDTH + _GAP) + indent, top + row * height)
        book.set_font("body", "" if section.level else "B", min(7.0, 1.8 * height))
        words = _cut(book, section.name, _FIGURE_WIDTH - indent - 8.0)
        link = book.add_link(page=section.page_number)
        book.cell(_FIGURE_WIDTH - indent - 6.0, height, words, link=link)
        book.cell(6.0, height, page, align="R", link=link)


def _cut(book: FPDF, text: str, width: float) -> str:
    """Text, or as much of it as there is room for."""
    while book.get_string_width(text) > width:
        text = text.removesuffix("...")[:-1] + "..."
    return text


def _settings(book: _Book, record: dict[str, Any]) -> None:
    if not record["settings"]:
        return
    _heading(book, "Which setting for which error", 12)
    targets = [100.0 * item["target"] for item in record["settings"][0]["targets"]]
    rows = []
    for row in record["settings"]:
        cells = [f"{row['case']}: {row['quantity']}"]
        for item in row["targets"]:
            setting = item["setting"]
            if setting is None:
                cells.append("-")
            else:
                cells.append(f"{setting['cpu_s']:.3g} s: {setting['label']}")
        rows.append(tuple(cells))
    names = ("quantity", *(f"{target:g} %" for target in targets))
    _table(book, names, rows, (60, 40, 40, 40))


def _head(book: _Book, item: dict[str, Any], folder: Path) -> None:
    _heading(book, f"{item['title']}: {item['verdict']}", 11, 1)
    book.set_font("body", "I", 7)
    _words(book, f"{item['name']}. {item['source']}. All runs: {item['cpu_s']:.3g} CPU s.", 3.5)
    if item["broken"]:
        _words(book, item["broken"])
    html = readme_html(folder, None)
    if html:
        book.set_font("body", "", 7.5)
        styles: dict[str, Any] = {
            "code": FontFace(family="code", size_pt=7),
            "pre": TextStyle("code", "", 7),
        }
        book.write_html(
            _plain_html(html),
            font_family="body",
            tag_styles=styles,
        )
        book.ln(1)


def _plain_html(html: str) -> str:
    """HTML as fpdf writes it well.

    Cells of tables are in one style only; headings would be among the contents of the PDF.
    """
    html = html.replace('<div class="scroll">', "").replace("</div>", "")
    html = _CELL.sub(lambda cell: cell[1] + _TAG.sub("", cell[2]) + cell[3], html)
    return _HEADING.sub(r"<p><b>\1</b></p>", html)


def _checks(book: _Book, checks: Sequence[dict[str, Any]]) -> None:
    """A row per check, and all runs of those that did not pass."""
    if not checks:
        return
    rows = [
        (
            "\n".join([check["quantity"], *_remarks(check)]),
            check["worst"] or "-",
            f"{check['tolerance_text']} ({check['metric']})",
            check["verdict"],
        )
        for check in checks
    ]
    names = ("quantity", "largest error", "tolerance", "verdict")
    _table(book, names, rows, (98, 26, 38, 18), verdict=3)
    for check in checks:
        if check["verdict"] != PASSED:
            _runs(book, check)


def _remarks(check: dict[str, Any]) -> list[str]:
    """What is said of a check beside its error."""
    found = [text for text in (check["known_gap"], *check["reasons"]) if text]
    wanted = check["order_expected"]
    for order in check["orders"]:
        of = f" of {order['method']}" if order["method"] else ""
        observed = number_text(order["observed"], ".2f")
        found.append(
            f"order{of}: {observed}, expected {wanted['expected']:g} ± {wanted['within']:g}"
        )
    rates = [f"{rate['method']} {rate['observed']:.2f}" for rate in check["rates"]]
    if rates:
        found.append(f"rates, error over unknowns: {', '.join(rates)}")
    return [*found, *(text for text in (check["saving"], check["front"]) if text)]


def _runs(book: _Book, check: dict[str, Any]) -> None:
    _part(book, check["quantity"])
    rows = []
    for run in check["runs"]:
        single = run["result"] is not None
        rows.append(
            (
                run["run"],
                f"{run['result']:.6g}" if single else "profile",
                f"{run['reference']:.6g}" if single else "profile",
                run["error_text"] or run["reason"] or run["status"],
                number_text(run["cpu_s"]),
            )
        )
    unit = check["unit"]
    names = ("run", f"result [{unit}]", f"reference [{unit}]", "error", "CPU s")
    _table(book, names, rows, (70, 34, 34, 28, 14))


def _trials(book: _Book, item: dict[str, Any]) -> None:
    """A row per trial that is no pass; the others by their names."""
    passed = [trial["name"] for trial in item["trials"] if trial["verdict"] == PASSED]
    book.set_font("body", "", 7)
    count = f"{len(passed)} of {len(item['trials'])} trials as expected"
    _words(book, f"{count}: {'; '.join(passed)}." if passed else f"{count}.", 3.3)
    rows = [
        (
            "\n".join(text for text in (trial["name"], trial["note"], trial["reason"]) if text),
            trial["status"],
            trial["expect"],
            number_text(trial["mass_error"], ".0e"),
            number_text(trial["contact_residual"], ".0e"),
            trial["verdict"],
        )
        for trial in item["trials"]
        if trial["verdict"] != PASSED
    ]
    if rows:
        names = ("trial", "ended", "expected", "mass", "contact", "verdict")
        _table(book, names, rows, (86, 24, 22, 15, 15, 18), verdict=5)


def _figures(book: _Book, drawings: Sequence[Drawing]) -> None:
    """Two beside each other, those of like height together."""
    drawings = sorted(drawings, key=lambda drawing: -_size(drawing)[1])
    for index in range(0, len(drawings), 2):
        pair = drawings[index : index + 2]
        sizes = [_size(drawing) for drawing in pair]
        height = max(tall for _, tall in sizes)
        if book.will_page_break(height + 14.0):
            book.add_page()
        top = book.get_y() + 2.0
        bottom = top
        for column, drawing in enumerate(pair):
            left = _MARGIN + column * (_FIGURE_WIDTH + _GAP)
            book.image(BytesIO(drawing.png), x=left, y=top, w=sizes[column][0])
            book.set_xy(left, top + height + 1.0)
            book.set_font("body", "", 7)
            book.multi_cell(_FIGURE_WIDTH, 3.5, f"{drawing.title}. {drawing.caption}", align="L")
            bottom = max(bottom, book.get_y())
        book.set_xy(_MARGIN, bottom + 2.0)


def _size(drawing: Drawing) -> tuple[float, float]:
    """Width and height on the page [mm], by those in the header of the PNG file."""
    head = drawing.png[16:24]
    wide, tall = int.from_bytes(head[:4], "big"), int.from_bytes(head[4:], "big")
    width = min(_FIGURE_WIDTH, _FIGURE_HEIGHT * wide / tall)
    return width, width * tall / wide


def _made_with(book: _Book, record: dict[str, Any]) -> None:
    _heading(book, "Made with", 12)
    facts = {**record["machine"], **record["call"], **record["packages"]}
    rows = [(name, str(value)) for name, value in facts.items()]
    _table(book, ("what", "which"), rows, (50, 120))


def _heading(book: _Book, text: str, size: int, level: int = 0) -> None:
    if book.will_page_break(60.0):
        book.add_page()
    book.ln(3)
    book.set_font("body", "B", size)
    book.start_section(text, level)
    _words(book, text, 6.0)


def _part(book: _Book, text: str) -> None:
    """A heading that the contents do not list."""
    if book.will_page_break(25.0):
        book.add_page()
    book.ln(1)
    book.set_font("body", "B", 8)
    _words(book, text)


def _words(book: _Book, text: str, height: float = 4.5) -> None:
    book.multi_cell(0, height, text, align="L", new_x="LMARGIN", new_y="NEXT")


def _table(
    book: _Book,
    names: Sequence[str],
    rows: Iterable[Sequence[str]],
    widths: tuple[int, ...],
    verdict: int | None = None,
) -> None:
    book.set_font("body", "", 7)
    with book.table(
        col_widths=widths,
        text_align="LEFT",
        line_height=3.4,
        headings_style=_HEAD,
        borders_layout="HORIZONTAL_LINES",
    ) as table:
        head = table.row()
        for name in names:
            head.cell(name)
        for values in rows:
            row = table.row()
            for column, text in enumerate(values):
                coloured = column == verdict and text in _COLOURS
                style = FontFace(color=_COLOURS[text], emphasis="B") if coloured else None
                row.cell(text, style=style)
    book.ln(1)
