"""The table of groups and names that a scene may hold, read from what the solver says of itself."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

from wingcrack.figures.errors import EnvironmentLacksError
from wingcrack.scenes.solver import description

_GROUP = re.compile(r"## &(\w+)( \(repeated\))?")
_BAR = re.compile(r"(?<!\\)\|")


@dataclass(frozen=True)
class Parameter:
    """One name of a group.

    Attributes
    ----------
    kind : str
        ``number``, ``whole number``, ``text``, ``logical``, ``list of numbers`` and so on.
    unit : str
        As ``Pa``; ``-`` for none.
    default, allowed, meaning : str
        In the words of docs/input.md.
    """

    name: str
    kind: str
    unit: str
    default: str
    allowed: str
    meaning: str


@dataclass(frozen=True)
class Group:
    """A group of a scene file with its names in the order of the table."""

    name: str
    is_repeated: bool
    meaning: str
    parameters: dict[str, Parameter]


@cache
def groups() -> dict[str, Group]:
    """Give all groups by name, in the order of the table."""
    found = parse(description())
    if "fracture" not in found:
        raise EnvironmentLacksError("the solver's description of its input has no group &fracture")
    return found


def parse(page: str) -> dict[str, Group]:
    """Read the groups from the page docs/input.md.

    Parameters
    ----------
    page : str
        Markdown with a heading ``## &group`` and a table of six columns for each group.
    """
    found: dict[str, Group] = {}
    for section in re.split(r"^(?=## )", page, flags=re.MULTILINE):
        heading, _, body = section.partition("\n")
        match = _GROUP.fullmatch(heading.strip())
        if match is None:
            continue
        meaning, _, table = body.strip().partition("\n\n|")
        rows = [_BAR.split(line.strip("| \n")) for line in table.splitlines()[2:]]
        parameters = [_parameter([cell.strip() for cell in row]) for row in rows if len(row) == 6]
        found[match[1]] = Group(
            match[1], bool(match[2]), meaning.strip(), {p.name: p for p in parameters}
        )
    return found


def _parameter(cells: list[str]) -> Parameter:
    name, kind, unit, default, allowed, meaning = cells
    return Parameter(name.strip("`"), kind, unit, default.strip("`"), allowed, meaning)
