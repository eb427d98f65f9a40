"""The gallery: every scene of inputs/ with its picture, cost and errors."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import wingcrack
from wingcrack_docs.cases import cases_of
from wingcrack_docs.errors import PicturesError
from wingcrack_docs.errors_of_run import describe_errors
from wingcrack_docs.places import DOCS, PICTURES, TOP
from wingcrack_docs.thumbnail import draw_thumbnail

_SECTIONS = {
    "paper_a": "Cracks in specimens under compression (Paper A)",
    "paper_b": "Stress intensity factors and paths, without fluid (Paper B)",
    "paper_c": "Injection into a fracture: slip and wing cracks (Paper C)",
    "paper_d": "Fractures that cross and join (Paper D)",
    "examples": "Examples",
    "benchmarks": "Benchmark",
}

_HEAD = """\
# Gallery

This page shows the final state, cost and estimated errors of every shipped scene. It is written by
`./wingcrack docs --pictures`, which runs the scenes. CPU times are those of one core of the machine
used ({processor}) under other load.

Pictures show the pore pressure, or without a fluid the mean stress, and the fractures coloured by
state: black stick, orange slip, blue open. **Errors** are estimates of the run
([K and its error](howto_intensities.md)) at its end; for K the largest of all growing tips,
relative to K. The verification cases that run the scene, with its settings or others, measure the
reliability of these estimates.
"""


def write_gallery(runs: Mapping[Path, wingcrack.Run]) -> None:
    """Draw the pictures and write the page.

    Parameters
    ----------
    runs : mapping of Path to Run
        Every scene of inputs/ with its run.

    Raises
    ------
    PicturesError
        If a scene's folder is not known here.
    """
    pictures = PICTURES / "gallery"
    pictures.mkdir(parents=True, exist_ok=True)
    entries: dict[str, list[str]] = {folder: [] for folder in _SECTIONS}
    for scene, run in sorted(runs.items()):
        folder = scene.parent.name
        if folder not in entries:
            raise PicturesError(f"the gallery has no section for inputs/{folder}")
        picture = pictures / _picture(scene)
        draw_thumbnail(run, picture)
        entries[folder].append(_entry(scene, run, picture.name))
    known = {_picture(scene) for scene in runs}
    for old in pictures.glob("*.png"):
        if old.name not in known:
            old.unlink()
    (DOCS / "gallery.md").write_text(_page(entries), encoding="utf-8")


def _picture(scene: Path) -> str:
    return f"{scene.parent.name}_{scene.stem}.png"


def _page(entries: dict[str, list[str]]) -> str:
    sections = (
        f"\n## {title}\n\n" + "\n".join(entries[folder])
        for folder, title in _SECTIONS.items()
        if entries[folder]
    )
    return _HEAD.format(processor=_processor()) + "".join(sections)


def _entry(scene: Path, run: wingcrack.Run, picture: str) -> str:
    place = scene.relative_to(TOP).as_posix()
    record = run.record
    title = str(run.scene["scene.title"] or scene.stem)
    held = ", ".join(f"[{case}](../verification/{case}/README.md)" for case in cases_of(place))
    lines = [
        f"### {scene.parent.name}/{scene.stem}\n",
        f"![{title}](pictures/gallery/{picture})\n",
        f"{title}. [{place}](../{place})\n",
        f"- **Cost**: {_cost(record)}",
        f"- **Errors**: {describe_errors(run)}",
        f"- **Verification cases**: {held or 'none'}",
    ]
    return "\n".join(lines) + "\n"


def _cost(record: dict[str, object]) -> str:
    cpu_s, memory = float(str(record["cpu_s"])), float(str(record["peak_memory_mb"]))
    states = record["steps"]
    cells = f"{record['cells']:,} cells, " if record.get("cells") else ""
    return f"{cpu_s:.2g} CPU s, {memory:.0f} MB, {cells}{states} states"


def _processor() -> str:
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return "of a kind that it does not tell"
