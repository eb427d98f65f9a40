"""The gallery: every scene of inputs/ with its picture, cost and errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import numpy as np

import wingcrack
from wingcrack.closing import pressure_text
from wingcrack.figures.units import displacement_unit
from wingcrack_docs.places import DOCS, PICTURES, TOP, DocsError
from wingcrack_docs.thumbnail import draw_thumbnail
from wingcrack_verify.suite import read_suite

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

    Raises `DocsError` if a scene's folder is not known here.

    `runs`: every scene of inputs/ with its run.
    """
    pictures = PICTURES / "gallery"
    pictures.mkdir(parents=True, exist_ok=True)
    entries: dict[str, list[str]] = {folder: [] for folder in _SECTIONS}
    for scene, run in sorted(runs.items()):
        folder = scene.parent.name
        if folder not in entries:
            raise DocsError(f"the gallery has no section for inputs/{folder}")
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
    return f"{float(f'{cpu_s:.2g}'):g} CPU s, {memory:.0f} MB, {cells}{states} states"


def _processor() -> str:
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return "of a kind that it does not tell"


def cases_of(scene: str) -> list[str]:
    """Names of the cases that run a scene, given by its path in the tree."""
    return sorted(_runs().get(scene, ()))


@cache
def _runs() -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for job in read_suite(TOP / "verification", (), quick=False).jobs:
        if job.run.scene is not None:
            path = job.run.scene.resolve()
            if path.is_relative_to(TOP):
                found.setdefault(path.relative_to(TOP).as_posix(), set()).add(job.case)
    return found


_KEPT = 1.0e-3  # tips with less than this share of the largest K_eq are at rest


def describe_errors(run: wingcrack.Run) -> str:
    """Give the run's own estimates: of K, of length and pressure, of the fluid's balance."""
    said = [*_of_intensities(run), *_of_history(run)]
    energy = run.record.get("energy_error_relative")
    if energy is not None:
        said.append(f"energy norm {percent(float(energy))}")
    return ", ".join(said) or "none: no stress intensity factors"


def _of_intensities(run: wingcrack.Run) -> Iterator[str]:
    try:
        tips = run.tips
    except wingcrack.AbsentError:
        return
    size = np.hypot(tips["k1_pa_sqrtm"], tips["k2_pa_sqrtm"])
    error = np.hypot(tips["k1_error_pa_sqrtm"], tips["k2_error_pa_sqrtm"])
    loaded = size > _KEPT * size.max() if size.size else np.zeros(0, dtype=bool)
    if not loaded.any():
        return
    growing = loaded & (tips["advance_m"] > 0.0)
    if growing.any():
        yield f"K {percent(float((error / size)[growing].max()))} where tips grow"
    else:
        last = loaded & (tips["history_row"] == tips["history_row"][loaded].max())
        yield f"K {percent(float((error / size)[last].max()))} at the end"


def _of_history(run: wingcrack.Run) -> Iterator[str]:
    last = run.history.iloc[-1]
    length = last.get("fracture_length_error_m", -1.0)
    if length > 0.0:
        unit = displacement_unit(length)
        said = f"length {float(unit.of(length)):.2g} {unit.name}"
        yield f"{said} of {last['fracture_length_m']:.3g} m"
    pressure = last.get("well_pressure_error_pa", -1.0)
    if pressure > 0.0:
        said = f"well pressure {pressure_text(pressure, 2)}"
        # of several wells it is the error of their mean
        yield (
            f"{said} of {1e-6 * whole:.3g} MPa" if (whole := last.get("well_pressure_pa")) else said
        )
    if "mass_error_relative" in last:
        yield f"fluid {run.record['mass_error_relative']:.0e}"


def percent(share: float) -> str:
    """A share in per cent with two digits, and what is too small to matter as less than 0.01 %."""
    return "below 0.01 %" if share < 1.0e-4 else f"{100.0 * share:.2g} %"
