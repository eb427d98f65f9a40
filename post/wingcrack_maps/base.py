"""The scene that a network is added to."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from shapely.geometry import Polygon

from wingcrack.figures.text_files import namelist_groups, read_text
from wingcrack.scenes.errors import SceneError


@dataclass
class Base:
    """A scene file as far as it matters here."""

    text: str = ""  # the whole file, which is kept as it is
    # its groups by name, each a list
    groups: dict[str, list[dict[str, Any]]] = field(default_factory=dict)

    @property
    def names(self) -> set[str]:
        """Names of its fractures."""
        return {str(group.get("name")) for group in self.groups.get("fracture", [])}

    def number(self, group: str, name: str) -> float | None:
        """Give a number of a group that is given once, if it is there."""
        values = self.groups.get(group, [{}])[0]
        value = values.get(name)
        return float(value) if isinstance(value, int | float) else None

    def body(self) -> Polygon | None:
        """Give the body where it is a rectangle or a polygon; of a disc the solver must judge."""
        domain = self.groups.get("domain", [{}])[0]
        try:
            if domain.get("shape", "rectangle") == "rectangle" and domain:
                low_x, low_y, high_x, high_y = (
                    float(domain[name]) for name in ("x_min", "y_min", "x_max", "y_max")
                )
                corners = [(low_x, low_y), (high_x, low_y), (high_x, high_y), (low_x, high_y)]
            elif domain.get("shape") == "polygon":
                corners = [
                    (float(x), float(y)) for x, y in zip(domain["x"], domain["y"], strict=True)
                ]
            else:
                return None
            if all(math.isfinite(number) for corner in corners for number in corner):
                return Polygon(corners)
        except (KeyError, TypeError, ValueError):
            return None  # the solver says what is wrong with it
        return None


def read_base(path: Path | None) -> Base | None:
    """Read a scene file that need not be complete."""
    if path is None:
        return None
    try:
        text = read_text(path)
        scene = namelist_groups(text)
    except OSError as reason:
        raise SceneError(f"{path}: it cannot be read: {reason.strerror}") from None
    except ValueError as reason:
        raise SceneError(f"{path}: {reason}") from None
    found: dict[str, list[dict[str, Any]]] = {}
    for name, group in scene.items():
        for item in group if isinstance(group, list) else [group]:
            found.setdefault(str(name).lower(), []).append(dict(item))
    return Base(text, found)
