"""The report as a PDF: the same words, tables and figures, for print."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
from fpdf import FPDF, FontFace, TextStyle

from wingcrack_verify.figures import Drawing
from wingcrack_verify.illustrate import Illustrations
from wingcrack_verify.judge import ERROR, FAILED, GAP, PASSED
from wingcrack_verify.page import number_text, readme_html, shortened
from wingcrack_verify.suite import JudgedSuite

_CELL = re.compile(r"(<t[dh](?:\s[^>]*)?>)(.*?)(</t[dh]>)", re.DOTALL)
_TAG = re.compile(r"<[^>]+>")
_FONTS = {"": "DejaVuSans", "B": "DejaVuSans-Bold", "I": "DejaVuSans-Oblique"}
_COLOURS = {PASSED: (26, 127, 55), GAP: (138, 90, 0), FAILED: (179, 38, 30), ERROR: (179, 38, 30)}
_HEAD = FontFace(emphasis="B", fill_color=(240, 243, 246))
_MARGIN, _GAP = 15.0, 6.0  # [mm]
_FIGURE_WIDTH = (210.0 - 2.0 * _MARGIN - _GAP) / 2.0  # [mm], two beside each other on A4


class _Book(FPDF):
    def footer(self) -> None:
        """Put the page's number below each page."""
        self.set_y(-10.0)
        self.set_font("body", size=7)
        self.cell(0, 5, f"{self.page_no()}/{{nb}}", align="C")


def write_booklet(
    judged: JudgedSuite, record: dict[str, Any], pictures: Illustrations, path: Path
) -> None:
    """Write the PDF."""
    book = _new_book()
    _title(book, record)
    _summary(book, record)
    _settings(book, record)
    folders = judged.folders
    for case in record["cases"]:
        _head(book, case, folders[case["name"]])
        _figures(book, pictures.by_case[case["name"]])
        for check in case["checks"]:
            _check(book, check)
    for item in record["stability"]:
        _head(book, item, folders[item["name"]])
        _trials(book, item)
        _figures(book, pictures.by_case[item["name"]])
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
    _heading(book, "Summary", 12)
    rows = [
        (
            row["case"],
            "\n".join([row["quantity"], *shortened(row["reasons"])]),
            row["error"],
            row["tolerance"],
            row["verdict"],
            number_text(row["cpu_s"]),
        )
        for row in record["summary"]
    ]
    names = ("case", "quantity", "error", "tolerance", "verdict", "CPU s")
    _table(book, names, rows, (24, 62, 28, 22, 20, 14), verdict=4)


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
    if book.will_page_break(60.0):
        book.add_page()
    _heading(book, f"{item['title']}: {item['verdict']}", 12)
    book.set_font("body", "I", 8)
    _words(book, f"{item['name']}. {item['source']}. All runs: {item['cpu_s']:.3g} CPU s.")
    if item["broken"]:
        _words(book, item["broken"])
    html = readme_html(folder, None)
    if html:
        book.set_font("body", "", 8)
        styles: dict[str, Any] = {
            f"h{level}": TextStyle("body", "B", 9, t_margin=3, b_margin=1) for level in range(1, 7)
        }
        styles["code"] = FontFace(family="code", size_pt=7.5)
        styles["pre"] = TextStyle("code", "", 7.5)
        book.write_html(
            _plain_cells(html.replace('<div class="scroll">', "").replace("</div>", "")),
            font_family="body",
            tag_styles=styles,
        )
        book.ln(2)


def _plain_cells(html: str) -> str:
    """Take emphasis and code off the cells of tables, which fpdf writes in one style only."""
    return _CELL.sub(lambda cell: cell[1] + _TAG.sub("", cell[2]) + cell[3], html)


def _check(book: _Book, check: dict[str, Any]) -> None:
    if book.will_page_break(25.0):
        book.add_page()
    book.ln(1)
    book.set_font("body", "B", 8)
    book.set_text_color(*_COLOURS[check["verdict"]])
    tolerance = f"tolerance {check['tolerance_text']} ({check['metric']})"
    _words(book, f"{check['quantity']}: {check['verdict']}, {tolerance}")
    book.set_text_color(0)
    book.set_font("body", "", 7)
    for text in (check["known_gap"], *check["reasons"]):
        if text:
            _words(book, text, 3.5)
    rows = []
    for run in check["runs"]:
        single = run["result"] is not None
        rows.append(
            (
                run["run"],
                run["method"],
                f"{run['result']:.6g}" if single else "profile",
                f"{run['reference']:.6g}" if single else "profile",
                run["error_text"] or run["reason"] or run["status"],
                number_text(run["unknowns"], ".0f"),
                number_text(run["cpu_s"]),
            )
        )
    unit = check["unit"]
    names = (
        "run",
        "method",
        f"result [{unit}]",
        f"reference [{unit}]",
        "error",
        "unknowns",
        "CPU s",
    )
    _table(book, names, rows, (40, 35, 26, 26, 22, 18, 13))
    for order in check["orders"]:
        wanted = check["order_expected"]
        _words(
            book,
            f"Observed order of {order['method']}: {number_text(order['observed'], '.2f')}, "
            f"expected {wanted['expected']:g} ± {wanted['within']:g}.",
        )
    rates = [f"{rate['method']} {rate['observed']:.2f}" for rate in check["rates"]]
    if rates:
        _words(book, f"Rates (error over unknowns): {', '.join(rates)}.", 3.5)
    if check["saving"]:
        _words(book, f"{check['saving']}.", 3.5)
    if check["front"]:
        _words(book, f"{check['front']}.", 3.5)


def _trials(book: _Book, item: dict[str, Any]) -> None:
    rows = [
        (
            "\n".join(text for text in (trial["name"], trial["note"], trial["reason"]) if text),
            trial["status"],
            number_text(trial["newton_mean"], ".1f"),
            number_text(trial["newton_max"], ".0f"),
            number_text(trial["step_cuts"], ".0f"),
            number_text(trial["mass_error"], ".0e"),
            number_text(trial["contact_residual"], ".0e"),
            trial["verdict"],
            number_text(trial["cpu_s"]),
        )
        for trial in item["trials"]
    ]
    names = ("trial", "ended", "Newton", "max", "cuts", "mass", "contact", "verdict", "CPU s")
    _table(book, names, rows, (60, 20, 14, 12, 12, 15, 15, 18, 14), verdict=7)


def _figures(book: _Book, drawings: Sequence[Drawing]) -> None:
    for index in range(0, len(drawings), 2):
        pair = drawings[index : index + 2]
        sizes = [_pixels(drawing) for drawing in pair]
        height = max(_FIGURE_WIDTH * tall / wide for wide, tall in sizes)
        if book.will_page_break(height + 14.0):
            book.add_page()
        top = book.get_y() + 2.0
        bottom = top
        for column, drawing in enumerate(pair):
            left = _MARGIN + column * (_FIGURE_WIDTH + _GAP)
            book.image(BytesIO(drawing.png), x=left, y=top, w=_FIGURE_WIDTH)
            book.set_xy(left, top + height + 1.0)
            book.set_font("body", "", 7)
            book.multi_cell(_FIGURE_WIDTH, 3.5, f"{drawing.title}. {drawing.caption}", align="L")
            bottom = max(bottom, book.get_y())
        book.set_xy(_MARGIN, bottom + 2.0)


def _pixels(drawing: Drawing) -> tuple[int, int]:
    """Width and height in the header of the PNG file."""
    head = drawing.png[16:24]
    return int.from_bytes(head[:4], "big"), int.from_bytes(head[4:], "big")


def _made_with(book: _Book, record: dict[str, Any]) -> None:
    _heading(book, "Made with", 12)
    facts = {**record["machine"], **record["call"], **record["packages"]}
    rows = [(name, str(value)) for name, value in facts.items()]
    _table(book, ("what", "which"), rows, (50, 120))


def _heading(book: _Book, text: str, size: int) -> None:
    book.ln(4)
    book.set_font("body", "B", size)
    book.start_section(text)
    _words(book, text, 6.0)


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
        line_height=4.0,
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
