"""The list of the measurements, tools/benchmarks.toml; needs only Python."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

TOP = Path(__file__).resolve().parents[3]


@dataclass(frozen=True)
class Benchmark:
    """A scene that is measured."""

    name: str
    title: str
    scene: Path | None = None  # the file, or None if tools/many_fractures.py writes it
    many_fractures: tuple[str, ...] = ()  # its arguments then
    # entries of the scene that differ from the file, by address
    changes: Mapping[str, Any] = field(default_factory=dict)
    # further ones with which only the first step is left; empty if that is not measured
    one_step: Mapping[str, Any] = field(default_factory=dict)
    once: bool = False  # whether it takes too long to be repeated
    quick: bool = False  # whether it is part of the short form


@dataclass(frozen=True)
class Growth:
    """Measurements of one kind in different sizes."""

    of: str  # what their size is counted in: a key of run.json
    names: tuple[str, ...]  # the measurements, from small to large


def read_benchmarks() -> tuple[dict[str, Benchmark], tuple[Growth, ...]]:
    """Read the measurements by name, and which of them are one kind in different sizes."""
    content = tomllib.loads((TOP / "tools" / "benchmarks.toml").read_text(encoding="utf-8"))
    found = {
        name: Benchmark(
            name=name,
            title=entry["title"],
            scene=TOP / entry["scene"] if "scene" in entry else None,
            many_fractures=tuple(entry.get("many_fractures", ())),
            changes=entry.get("set", {}),
            one_step=entry.get("one_step", {}),
            once=entry.get("once", False),
            quick=entry.get("quick", False),
        )
        for name, entry in content["measurement"].items()
    }
    kinds = tuple(
        Growth(entry["of"], tuple(entry["measurements"])) for entry in content["growth"].values()
    )
    return found, kinds
