"""The features of a map, independent of its file format."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Points: TypeAlias = NDArray[np.float64]
"""(n, 2) places [m]."""

Attributes: TypeAlias = dict[str, object]


@dataclass(eq=False)
class Line:
    """A fracture; it is never changed, but replaced."""

    name: str
    points: Points  # (n, 2) vertices from one end to the other [m]
    attributes: Attributes = field(default_factory=dict)
    source: str = ""  # where the map says it, as ``row 7``

    @property
    def length(self) -> float:
        """Length along the line [m]."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum())


@dataclass
class Area:
    """A polygon without holes: the body or a region."""

    name: str
    points: Points  # (n, 2) corners, the first one not repeated [m]
    role: str = ""  # ``boundary``, ``region``, or nothing where the map does not say
    attributes: Attributes = field(default_factory=dict)
    source: str = ""


@dataclass
class Note:
    """Something that was noticed, left out or changed on the way; nothing happens without one."""

    kind: str  # in one or two words, as ``attribute left out``
    what: str  # the sentence


@dataclass
class Map:
    """All that was read."""

    lines: list[Line] = field(default_factory=list)
    areas: list[Area] = field(default_factory=list)
    wells: list[Line] = field(default_factory=list)  # of one place each
    notes: list[Note] = field(default_factory=list)
    system: str = ""  # coordinate system that the map states
    # places nearer than this are one [m]: numbers of the map's size have no more digits
    precision: float = 0.0

    @property
    def features(self) -> list[Line | Area]:
        """Lines, areas and wells."""
        return [*self.lines, *self.areas, *self.wells]

    def note(self, kind: str, what: str) -> None:
        """Add a note."""
        self.notes.append(Note(kind, what))
