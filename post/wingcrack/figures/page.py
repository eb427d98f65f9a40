"""A run's figures as one page for a browser: the facts in words, then all pictures."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from string import Template
from urllib.parse import quote

from wingcrack.figures.captions import CAPTIONS, caption, captions
from wingcrack.figures.facts import Facts, gather_facts
from wingcrack.figures.read import Run
from wingcrack.figures.report import Cell, report_rows, write_report
from wingcrack.figures.slip import write_points
from wingcrack.figures.text_files import read_json, write_whole

NAME = "index.html"
_COSTS = (
    ("wall_s", "wall time", "s"),
    ("cpu_s", "processor time", "s"),
    ("peak_memory_mb", "memory", "MB"),
)
_REPORTED = {  # columns of report.csv on the page
    "begin_s": "from [s]",
    "end_s": "to [s]",
    "pressure_at_begin_pa": "pressure at first [MPa]",
    "pressure_at_end_pa": "at last [MPa]",
    "highest_pressure_pa": "highest [MPa]",
    "injected_m2": "injected [m²]",
    "produced_m2": "produced [m²]",
    "injectivity_m2_s_pa": "injectivity [m²/(s Pa)]",
    "stimulated_length_m": "stimulated [m]",
    "growth_events": "growth",
    "seismic_events": "seismic",
}
_PUMPED = ("injected", "produced")
_MATH = ((r"$K_\mathrm{eq}/K_\mathrm{IC}$", "K_eq/K_IC"), ("$M_w$", "M_w"), ("$", ""))

_PAGE = Template("""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$name</title>
<style>
body { font: 16px/1.45 sans-serif; color: #111; margin: 0 auto; max-width: 62rem; padding: 1rem; }
h1 { font-size: 1.3rem; margin: 0; }
h2 { font-size: 1rem; margin: 1rem 0 .2rem; }
.finished { color: #00724f; } .stopped { color: #8a5a00; } .failed, .warning { color: #b34700; }
.parts { display: grid; grid-template-columns: repeat(auto-fit, minmax(18rem, 1fr)); gap: 0 2rem; }
ul { margin: 0; padding-left: 1.1rem; overflow-wrap: anywhere; }
figure { margin: 1rem 0; break-inside: avoid; } figcaption { font-size: .85rem; }
img { max-width: 100%; height: auto; }
table { border-collapse: collapse; font-size: .85rem; display: block; overflow-x: auto; }
th, td { text-align: right; padding: .15rem .5rem; border-bottom: 1px solid #ddd; }
</style>
</head>
<body>
<h1>$title</h1>
<p class="$status">$ended</p>
<p><a href="captions.txt">Captions with the scene's parameters</a></p>
<div class="parts">
$parts
</div>
$report
$figures
</body>
</html>
""")


def write_page(run: Run, folder: Path, order: Sequence[str]) -> list[Path]:
    """Write the page, and the table of wells by stage that it shows, into a folder of figures.

    Each appears whole.

    `folder`: where the figures are. `order`: names of figures, or their beginnings, as they shall
    follow each other.
    """
    facts = gather_facts(run)

    def place(name: str) -> tuple[int, list[tuple[int, str]]]:
        kinds = [k for k, kind in enumerate(order) if name.startswith(kind)]
        return min(kinds, default=len(order)), _natural(name)

    pictures = sorted((path.name for path in folder.glob("[!.]*.png")), key=place)
    rows = report_rows(run)
    text = _PAGE.substitute(
        name=html.escape(run.name),
        title=html.escape(_plain(facts.title)),
        status=html.escape(facts.status, quote=True),
        ended=html.escape(facts.ended),
        parts="\n".join(_parts(facts, _costs(run.directory))),
        report=_report(rows),
        figures="\n".join(_figures(run, folder, pictures)),
    )
    folder.mkdir(parents=True, exist_ok=True)
    words = captions(run, [name.removesuffix(".png") for name in pictures])
    return [
        *write_report(rows, folder),
        *write_points(run, folder),
        write_whole(folder / CAPTIONS, words),
        write_whole(folder / NAME, text),
    ]


def _report(rows: Sequence[Mapping[str, Cell]]) -> str:
    """The wells by stage as a table, in units that are easy to read; nothing without wells."""
    if not rows:
        return ""
    reported = dict(_REPORTED)
    if any(row[f"{kind}_m3"] != row[f"{kind}_m2"] for row in rows for kind in _PUMPED):
        reported = {  # of the whole thickness
            column.replace("ed_m2", "ed_m3"): words.replace("[m²]", "[m³]")
            for column, words in _REPORTED.items()
        }
    head = "".join(f"<th>{words}</th>" for words in ("well", "stage", *reported.values()))
    lines = [
        f"<td>{html.escape(str(row['well']))}</td><td>{row['stage']}</td>"
        + "".join(f"<td>{_shown(column, row.get(column, ''))}</td>" for column in reported)
        for row in rows
    ]
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    link = '<a href="report.csv">report.csv</a>'
    return f"<h2>Wells by stage ({link})</h2><table><tr>{head}</tr>{body}</table>"


def _shown(column: str, value: Cell) -> str:
    if not isinstance(value, float):
        return str(value)
    return f"{1e-6 * value:.4g}" if "[MPa]" in _REPORTED.get(column, "") else f"{value:.4g}"


def _parts(facts: Facts, costs: Sequence[str]) -> Iterable[str]:
    for title, lines, look in (
        ("Results", facts.results, ""),
        ("Errors", [line.removeprefix("- ") for line in facts.errors if line != "errors:"], ""),
        ("Warnings", facts.warnings or ["none"], "warning" if facts.warnings else ""),
        ("Included", facts.used, ""),
        ("Left out", facts.left_out, ""),
        ("Cost", costs, ""),
    ):
        if lines:
            items = "".join(f"<li>{html.escape(_plain(line))}</li>" for line in lines)
            yield f'<section class="{look}"><h2>{title}</h2><ul>{items}</ul></section>'


def _figures(run: Run, folder: Path, pictures: Sequence[str]) -> Iterable[str]:
    for name in pictures:
        stem = name.removesuffix(".png")
        link = ""
        if (folder / f"{stem}.pdf").exists():
            link = f' (<a href="{quote(stem)}.pdf">PDF</a>)'
        words = html.escape(stem.replace("_", " "))
        said = html.escape(caption(run, stem))
        yield (
            f'<figure><a href="{quote(name)}"><img src="{quote(name)}" alt="{words}"'
            ' loading="lazy"></a>'
            f"<figcaption><b>{words}</b>{link}: {said}</figcaption></figure>"
        )


def _natural(name: str) -> list[tuple[int, str]]:
    """Key of a name in which numbers count as such: fracture_2 comes before fracture_10."""
    return [(int(part or 0), words) for words, part in re.findall(r"(\D*)(\d*)", name)]


def _costs(directory: Path) -> list[str]:
    """Time and memory; nothing while the run goes on."""
    try:
        record = read_json(directory / "run.json")
        return [f"{what}: {record[key]:.3g} {unit}" for key, what, unit in _COSTS if key in record]
    except (OSError, ValueError, TypeError):
        return []


def _plain(text: str) -> str:
    """Words without the marks of formulas."""
    for mark, word in _MATH:
        text = text.replace(mark, word)
    return text
