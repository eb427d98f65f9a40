"""Captions of a run's figures with the scene's parameters, as text to copy."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from wingcrack.figures.read import Run
from wingcrack.figures.scene import read_groups
from wingcrack.figures.text_files import read_text
from wingcrack.names import table

CAPTIONS = "captions.txt"

# By the beginning of a figure's name.
_ABOUT = {
    "summary": "Body, loads and wells; fractures at the end by contact state; histories.",
    "story": "Network at the end by contact state; histories of wells, fluid, lengths, slip.",
    "network": "Fractures at the start (thick) and what has grown, coloured by its order.",
    "pressure_maps": "Pore pressure, or its change, in the rock; fractures by contact state.",
    "jump_maps": "Fractures at the end, coloured by slip and by opening or aperture.",
    "stress_maps": "Mean stress (tension positive) and largest shear stress in the plane.",
    "fracture": "Aperture, opening, slip, fluid pressure and tractions along a fracture; dotted: "
    "its ends at the start; dashed: bound of friction.",
    "intensities": "Stress intensity factors of the tips: interaction integral (lines), "
    "displacement correlation (circles), estimated errors (bands); dashed: toughness.",
    "load": "Load factor and length of all fractures.",
    "equilibrium": "Equilibrium path of growth in length control.",
    "development": "Length of all fractures, pressure of the wells, largest slip and opening, "
    "contact states of the fracture cells.",
    "balance": "Where the injected fluid is, and the error of its balance.",
    "wells": "Pressure, flow, volume and injectivity of the wells.",
    "seismicity": "Seismic events by magnitude, time and place; numbers of events by magnitude.",
    "probes": "Pressure, displacement and stress at the probe points.",
    "temperature": "Temperature along the fracture in which it differs most, by time at its ends "
    "and in the wells.",
    "mesh": "Mesh of the body, with the windows of the tips, and the elements of one if written.",
    "view": "Deformed body, displacements enlarged.",
}
_GROUPS = ("material", "fluid", "injection", "fracture")
_MOST = 2  # wells or fractures whose values are listed
_LEFT_OUT = ("x", "y", "name", "fracture")  # places are seen in the figure


def caption(run: Run, stem: str) -> str:
    """Give what a figure shows, of which scene."""
    kinds = [kind for kind in _ABOUT if stem.startswith(kind)]
    title = run.scene.title if run.scene and run.scene.title else run.name
    return f"{title.rstrip('.')}. {_ABOUT[max(kinds, key=len)]}" if kinds else f"{title}."


def parameters(run: Run) -> str:
    """Give rock, fluid, wells and fractures in the names of the scene, with units; else nothing.

    Values that are what they are by default are left out.
    """
    try:
        groups = read_groups(read_text(run.directory / "scene.nml"))
    except (OSError, ValueError):
        return ""
    parts = []
    for wanted in _GROUPS:
        found = [values for group, values in groups if group == wanted]
        if len(found) > _MOST:
            parts.append(f"{len(found)} groups &{wanted}")
            continue
        for values in found:
            said = [
                f"{name} = {', '.join(value)} {_unit(wanted, name)}".rstrip(" -")
                for name, value in values.items()
                if name not in _LEFT_OUT and not _is_default(wanted, name, value)
            ]
            parts.append(f"&{wanted}: {', '.join(said)}" if said else f"&{wanted}")
    return "; ".join(parts)


def captions(run: Run, stems: Sequence[str]) -> str:
    """Give the text of the file: a paragraph for each figure, then the parameters."""
    lines = [f"{stem}: {caption(run, stem)}" for stem in stems]
    said = parameters(run)
    return "\n\n".join([*lines, *([f"Parameters (docs/input.md). {said}."] if said else [])]) + "\n"


@cache
def _known() -> dict[tuple[str, str], tuple[str, str]]:
    return {
        (group["name"], row["name"]): (row.get("unit", ""), str(row.get("default", "")))
        for group in table()["groups"]
        for row in group["parameters"]
    }


def _unit(group: str, name: str) -> str:
    return _known().get((group, name), ("", ""))[0]


def _is_default(group: str, name: str, value: Sequence[str]) -> bool:
    default = _known().get((group, name), ("", ""))[1]
    try:
        return len(value) == 1 and float(value[0]) == float(default)
    except ValueError:
        return len(value) == 1 and value[0].strip("'") == default.strip("'")
