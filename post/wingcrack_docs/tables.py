"""Pages that list names: the texts of ``pages/`` with the tables of the solver in them."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from pathlib import Path

from wingcrack.names import table
from wingcrack.scenes.parameters import groups
from wingcrack_docs.places import DOCS

_PAGES = Path(__file__).with_name("pages")
_WIDTH = 110
# Names that scenes rarely need, in a section of their own: numerics, the thesis' growth law.
_EXPERT = {
    "time": {"growth_factor"},
    "coarse": {"newton_max", "newton_tolerance", "condensation"},
    "growth": {"exponent", "threshold"},
}


def pages() -> dict[Path, str]:
    """Text of each page, as it should be."""
    tables = {
        "groups": _groups(),
        "expert": _expert(),
        "files": _files(),
        "limits": _limits(),
        "checks": _checks(),
    }
    found = {}
    for page in sorted(_PAGES.glob("*.md")):
        text = page.read_text(encoding="utf-8")
        for name, lines in tables.items():
            text = text.replace(f"{{{{ {name} }}}}", lines)
        found[DOCS / page.name] = text
    return found


def write_pages() -> None:
    """Write the pages that are not as they should be."""
    for page, text in pages().items():
        if page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")


def _rows(head: str, rows: Iterable[tuple[str, ...]]) -> str:
    columns = head.split(", ")
    lines = [columns, *rows]
    ruled = ["| " + " | ".join(line) + " |" for line in lines]
    return "\n".join([ruled[0], "|" + "---|" * len(columns), *ruled[1:]])


def _groups() -> str:
    return "\n\n".join(
        f"## &{group.name}{' (repeated)' if group.is_repeated else ''}\n\n{group.meaning}\n\n"
        + _rows(
            "name, kind, unit, default, allowed, meaning",
            (
                (f"`{p.name}`", p.kind, p.unit, p.default, p.allowed, p.meaning)
                for p in group.parameters.values()
                if p.name not in _EXPERT.get(group.name, ())
            ),
        )
        for group in groups().values()
    )


def _expert() -> str:
    return _rows(
        "group, name, kind, unit, default, allowed, meaning",
        (
            (f"`&{name}`", f"`{p.name}`", p.kind, p.unit, p.default, p.allowed, p.meaning)
            for name, group in groups().items()
            for p in group.parameters.values()
            if p.name in _EXPERT.get(name, ())
        ),
    )


def _files() -> str:
    sections = []
    for file in table()["files"]:
        rows = (
            (f"`{r['name']}`", r["unit"], r["runs"], r["meaning"], _error(r["error"]))
            for r in file["columns"]
        )
        meaning = textwrap.fill(
            file["meaning"], _WIDTH, break_long_words=False, break_on_hyphens=False
        )
        head = "name, unit, in runs, meaning, error"
        sections.append(f"## {file['name']}\n\n{meaning}\n\n{_rows(head, rows)}")
        sections += [
            f"`{entry['name']}` is one of these:\n\n"
            + "\n".join(f"* `{word}`: {meant}" for word, meant in entry["words"].items())
            for entry in table()["words"]
            if entry["file"] == file["name"]
        ]
    return "\n\n".join(sections)


def _error(text: str) -> str:
    """Name of the column with the error as code; a reason as it is."""
    if text.startswith("none: "):
        return text
    name, *rest = re.split("(;| of )", text, maxsplit=1)
    return f"`{name}`" + "".join(rest)


def _limits() -> str:
    return _rows(
        "quantity, unit, runs, warning, stop, meaning, remedy",
        (
            (
                row["name"],
                row["unit"],
                row["runs"],
                *("never" if row[key] is None else f"{row[key]:g}" for key in ("warning", "stop")),
                row["meaning"],
                row["remedy"],
            )
            for row in table()["limits"]
        ),
    )


def _checks() -> str:
    return _rows(
        "group, name, unit, condition, reason",
        (
            (f"`&{r['group']}`", f"`{r['name']}`", r["unit"], r["condition"], r["meaning"])
            for r in table()["checks"]
        ),
    )
