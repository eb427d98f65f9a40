"""What a scene can hold: the solver's own table of groups and names."""

from __future__ import annotations

import difflib
import os
import re
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from wingcrack.errors import EnvironmentLacksError, SceneError

TOP = Path(__file__).resolve().parents[3]
_SOLVER = TOP / "build" / "release" / "fortran" / "app" / "wingcrack-solver"
_GROUP = re.compile(r"## &(\w+)( \(repeated\))?")
_ROW = re.compile(r"\| `(\w+)` \| ([^|]*) \| ([^|]*) \| ([^|]*) \| ([^|]*) \| (.*) \|")


@dataclass(frozen=True)
class Parameter:
    """A name of a group of the scene file, as docs/input.md has it.

    Attributes
    ----------
    group, name : str
    repeated : bool
        Whether the group may be given once per item.
    kind : str
        text, number, whole number, logical, or a list of these.
    unit : str
        ``-`` where it has none.
    default, allowed, meaning : str
        In words.
    """

    group: str
    name: str
    repeated: bool
    kind: str
    unit: str
    default: str
    allowed: str
    meaning: str


def solver() -> Path:
    """Place of the solver: what ``WINGCRACK_SOLVER`` names, or what ``./wingcrack build`` built.

    Raises
    ------
    EnvironmentLacksError
        If it is not there.
    """
    found = Path(os.environ.get("WINGCRACK_SOLVER") or _SOLVER)
    if not os.access(found, os.X_OK) or found.is_dir():
        raise EnvironmentLacksError(f"there is no solver {found}; ./wingcrack build makes it")
    return found


def parameters() -> dict[str, Parameter]:
    """Every name that a scene may hold, by ``group.name``.

    >>> wingcrack.parameters()["fracture.friction"].unit  # doctest: +SKIP
    '-'
    """
    return _table(solver())


@cache
def _table(program: Path) -> dict[str, Parameter]:
    done = subprocess.run(
        [program, "--describe-input"], capture_output=True, text=True, check=False
    )
    found = read_description(done.stdout) if done.returncode == 0 else {}
    if not found:
        said = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        raise EnvironmentLacksError(f"{program} does not tell what a scene may hold ({said})")
    return found


def read_description(text: str) -> dict[str, Parameter]:
    """Parameters by ``group.name`` from what ``wingcrack-solver --describe-input`` prints."""
    found: dict[str, Parameter] = {}
    group, repeated = "", False
    for line in text.splitlines():
        if head := _GROUP.fullmatch(line):
            group, repeated = head[1], head[2] is not None
        elif group and (row := _ROW.fullmatch(line)):
            name, *rest = (part.strip() for part in row.groups())
            found[f"{group}.{name}"] = Parameter(group, name, repeated, *rest)
    return found


def parameter(group: str, name: str) -> Parameter:
    """One of them.

    Raises
    ------
    SceneError
        If there is no such group, or no such name in it; it tells the nearest one.
    """
    table = parameters()
    if f"{group}.{name}" in table:
        return table[f"{group}.{name}"]
    groups = {entry.group for entry in table.values()}
    if group not in groups:
        raise SceneError(f"there is no group &{group}{_near(group, sorted(groups))}")
    names = [entry.name for entry in table.values() if entry.group == group]
    raise SceneError(f"&{group} has no name '{name}'{_near(name, names)}")


def _near(word: str, known: list[str]) -> str:
    near = difflib.get_close_matches(word, known, n=1)
    return f"; did you mean '{near[0]}'?" if near else f"; there are {', '.join(known)}"
