"""Maps from gmsh's .geo files: points, lines, surfaces and physical groups; nothing is executed.

The whole grammar is in `_Reader.statement`. All other statements of gmsh's scripts (commands,
fields, options, loops, arithmetic) are refused with their line.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import NoReturn, TypeVar

import numpy as np
from shapely import unary_union
from shapely.geometry import Polygon

from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.physical import Groups, map_of_groups

T = TypeVar("T")

_MOST_CORNERS = 1_000_000  # of all surfaces
_TOKEN = re.compile(
    r"(?P<space>\s+|//[^\n]*|/\*.*?\*/)"
    r'|(?P<text>"[^"\n]*"|\'[^\'\n]*\')'
    r"|(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.]))"
    r"|(?P<word>[A-Za-z_]\w*)"
    r"|(?P<mark>[(){},;=])",
    re.DOTALL | re.ASCII,
)
_CURVE = ("Line", "Curve")
_MAY_HOLD = (
    "a .geo file may hold points, straight lines, curve loops, plane surfaces and physical groups,"
    " with plain numbers; mesh anything else with gmsh yourself and import the .msh file"
)


def read_geo(text: str, path: str) -> Map:
    """Read the physical groups of a geometry.

    Raises `SceneError`: with the line of what is no part of the grammar, is not there, or is there
    twice.
    """
    reader = _Reader(text, path)
    while not reader.at_end():
        reader.statement()
    return map_of_groups(reader.groups(), path)


class _Reader:
    """What the statements so far have given; tags are gmsh's numbers of entities."""

    def __init__(self, text: str, path: str) -> None:
        self.text, self.path, self.place = text, path, 0
        self.behind = 0  # the end of the token before the one at hand
        self.kind = self.token = ""
        self.numbers: dict[str, float] = {}
        self.points: dict[int, tuple[float, float]] = {}
        self.lines: dict[int, tuple[int, int]] = {}
        self.loops: dict[int, list[tuple[float, float]]] = {}
        self.surfaces: dict[int, Polygon] = {}
        self.physical: dict[str, dict[str, list[int]]] = {"Curve": {}, "Surface": {}}
        self.corners = 0
        self._advance()

    def at_end(self) -> bool:
        """Whether all is read."""
        return not self.kind

    def statement(self) -> None:
        """Read one statement."""
        word = self._word()
        if word == "Point" and self.token == "(":
            tag = self._tag(self.points)
            x, y, *_ = self._coordinates()
            self.points[tag] = (x, y)
        elif word in _CURVE and self.token == "Loop":
            self._advance()
            tag = self._tag(self.loops)
            self.loops[tag] = self._ring(self._tags(self.lines, "line"))
        elif word == "Line" and self.token == "(":
            tag = self._tag(self.lines)
            self.lines[tag] = self._ends()
        elif word == "Plane":
            self._expect("Surface")
            tag = self._tag(self.surfaces)
            self.surfaces[tag] = self._surface(self._tags(self.loops, "curve loop"))
        elif word == "Physical":
            self._physical()
        elif word in ("Point", *_CURVE) and self.token == "{":
            self._embedding()
        elif word == "SetFactory":  # points and lines are the same in both kernels
            self._expect("(")
            self._text()
            self._expect(")")
        elif self.token == "=" and self.kind == "mark":
            self._advance()
            self.numbers[word] = self._number()
        else:
            self._refuse(f"'{word}' is not read")
        self._expect(";")

    def groups(self) -> Groups:
        """Give the physical groups by their names."""
        found = Groups()
        for name, tags in self.physical["Curve"].items():
            edges = {tuple(sorted(self.lines[tag])): None for tag in tags}
            found.curves[name] = np.array([[self.points[end] for end in edge] for edge in edges])
        for name, tags in self.physical["Surface"].items():
            parts = [self.surfaces[tag] for tag in dict.fromkeys(tags)]
            self._count(sum(len(part.exterior.coords) for part in parts))
            found.surfaces[name] = unary_union(parts)
        return found

    def _physical(self) -> None:
        kind = self._word()
        kind = "Curve" if kind == "Line" else kind
        if kind not in ("Point", "Curve", "Surface"):
            self._refuse(f"'Physical {kind}' is not read")
        self._expect("(")
        if self.kind == "text":
            name = self._text()
            if self.token == ",":
                self._advance()
                self._whole()
        else:
            name = str(self._whole())
        self._expect(")")
        self._expect("=")
        if kind == "Point":
            self._tags(self.points, "point")
            return
        if name in self.physical[kind]:
            self._refuse(f"the physical group '{name}' is there twice")
        known: Mapping[int, object] = self.lines if kind == "Curve" else self.surfaces
        self.physical[kind][name] = [abs(tag) for tag in self._tags(known, kind.lower())]

    def _embedding(self) -> None:
        """``Curve {5} In Surface {1}``: says to gmsh that meshes keep to the line; so do ours."""
        self._list()
        for word in ("In", "Surface", "{"):
            self._expect(word)
        self._whole()
        self._expect("}")

    def _tag(self, known: Mapping[int, object]) -> int:
        """``(5) =`` of an entity that is not there yet."""
        self._expect("(")
        tag = self._whole()
        if tag in known:
            self._refuse(f"number {tag} is there twice")
        self._expect(")")
        self._expect("=")
        return tag

    def _coordinates(self) -> list[float]:
        numbers = self._list()
        if len(numbers) not in (3, 4):
            self._refuse(f"a point takes x, y, z and perhaps a size, not {len(numbers)} numbers")
        return numbers

    def _ends(self) -> tuple[int, int]:
        tags = self._tags(self.points, "point")
        if len(tags) != 2 or min(tags) < 0:
            self._refuse("a line takes two points")
        if self.points[tags[0]] == self.points[tags[1]]:
            self._refuse("the line has no length")
        return tags[0], tags[1]

    def _ring(self, tags: list[int]) -> list[tuple[float, float]]:
        """Corners of a closed loop, in the order of its lines, the first one not repeated."""
        edges = [self.lines[abs(tag)][:: 1 if tag > 0 else -1] for tag in tags]
        follows = zip(edges, [*edges[1:], edges[0]], strict=True)
        if len(edges) < 3 or any(edge[1] != after[0] for edge, after in follows):
            self._refuse("the lines of the loop do not follow one another around an area")
        return [self.points[edge[0]] for edge in edges]

    def _surface(self, tags: list[int]) -> Polygon:
        rings = [self.loops[abs(tag)] for tag in tags]
        self._count(sum(map(len, rings)))
        surface = Polygon(rings[0], rings[1:])
        if not surface.is_valid:
            self._refuse("the loops of the surface cross themselves or one another")
        return surface

    def _count(self, more: int) -> None:
        self.corners += more
        if self.corners > _MOST_CORNERS:
            self._refuse(f"the surfaces have more than {_MOST_CORNERS} corners")

    def _tags(self, known: Mapping[int, T], what: str) -> list[int]:
        """Read a list of numbers of entities, which are there; negative ones are turned round."""
        tags = []
        for number in self._list():
            tag = int(number)
            if tag != number or abs(tag) not in known:
                self._refuse(f"there is no {what} {number:.17g}")
            tags.append(tag)
        return tags

    def _list(self) -> list[float]:
        self._expect("{")
        numbers = [self._number()]
        while self.token == ",":
            self._advance()
            numbers.append(self._number())
        self._expect("}")
        return numbers

    def _whole(self) -> int:
        number = self._number()
        if number != int(number) or not 0 <= number < 2**31:
            self._refuse(f"{number:g} is no number of an entity")
        return int(number)

    def _number(self) -> float:
        """Read a number, or a word that stands for one."""
        if self.kind == "number":
            number = float(self.token)
        elif self.kind == "word" and self.token in self.numbers:
            number = self.numbers[self.token]
        else:
            self._refuse_token(f"there must be a number, not '{self.token}'")
        if not math.isfinite(number):
            self._refuse_token(f"{self.token[:20]} is too large")
        self._advance()
        return number

    def _word(self) -> str:
        if self.kind != "word":
            self._refuse_token(f"a statement cannot begin with '{self.token}'")
        word = self.token
        self._advance()
        return word

    def _text(self) -> str:
        if self.kind != "text":
            self._refuse_token(f"there must be a text, not '{self.token}'")
        text = self.token[1:-1]
        self._advance()
        return text

    def _expect(self, token: str) -> None:
        if self.kind not in ("mark", "word") or self.token != token:
            self._refuse_token(f"there must be '{token}', not '{self.token or 'the end'}'")
        self._advance()

    def _advance(self) -> None:
        """Go on to the next token; at the end it is of no kind."""
        self.behind = self.place
        while self.place < len(self.text):
            found = _TOKEN.match(self.text, self.place)
            if found is None:
                self.behind = self.place
                self._refuse(f"'{self.text[self.place]}' is not read")
            self.place = found.end()
            if found.lastgroup != "space":
                self.kind, self.token = str(found.lastgroup), found[0]
                return
        self.kind = self.token = ""

    def _refuse(self, why: str) -> NoReturn:
        """Refuse what was read last."""
        line = self.text.count("\n", 0, self.behind) + 1
        raise SceneError(f"{self.path}:{line}: {why}; {_MAY_HOLD}")

    def _refuse_token(self, why: str) -> NoReturn:
        """Refuse the token at hand."""
        self.behind = max(self.place - 1, 0)
        self._refuse(why)
