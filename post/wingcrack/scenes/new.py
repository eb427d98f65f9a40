"""A template of a scene: the text of a kind, with the solver's description of each name."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import SimpleNamespace

from wingcrack.runs.parameter_table import Parameter
from wingcrack.scenes.errors import SceneError
from wingcrack.scenes.parameters import Group, groups

KINDS = Path(__file__).resolve().parent / "kinds"

_BEGIN = re.compile(r"&(\w+)")
_ENTRY = re.compile(r"  (\w+) = (.+)")
_COLUMN = 34  # where comments begin, at least
_WIDTH = 110


def annotated(text: str) -> str:
    """Add comments to a scene whose entries have a line each.

    The first time that a group stands there, its meaning, the meaning of its names and the names
    that it does not use are told. Raises `SceneError` if the table has no such group or name.
    """
    table = groups()
    told: set[str] = set()
    lines: list[str] = []
    group: Group | None = None
    used: list[str] = []
    for line in text.splitlines():
        begin, entry = _BEGIN.match(line), _ENTRY.fullmatch(line)
        if begin:
            group, used = _look_up(table, begin[1]), []
            lines.append("")
            if group.name not in told:
                lines.extend(_comment(_sentence(group.meaning, ".;"), ""))
        elif entry and group is not None:
            used.append(entry[1])
            if entry[1] not in group.parameters:
                raise SceneError(f"the solver knows no {entry[1]} in &{group.name}")
            if group.name not in told:  # the first one stands for the others
                line = f"{line:<{_COLUMN - 2}}  ! {_short(group.parameters[entry[1]])}"
        elif line == "/" and group is not None:
            others = [name for name in group.parameters if name not in used]
            if others and group.name not in told:
                lines.extend(_comment(f"also: {', '.join(others)}", "  "))
            told.add(group.name)
        lines.append(line)
    lines.append("")
    lines.append("! docs/input.md describes all groups and names. Groups that are not here:")
    absent = [f"&{name}" for name in table if name not in told]
    lines.extend(_comment(" ".join(absent), ""))
    return "\n".join(lines) + "\n"


def _look_up(table: dict[str, Group], name: str) -> Group:
    if name not in table:
        raise SceneError(f"the solver knows no group &{name}")
    return table[name]


def _short(parameter: Parameter) -> str:
    unit = f"[{parameter.unit}] " if parameter.unit not in ("-", "") else ""
    return f"{unit}{_sentence(parameter.meaning)}"


def _sentence(meaning: str, ends: str = ".;:") -> str:
    """Give what stands before one of these marks, if it ends a word outside of brackets."""
    plain, depth = meaning.replace("`", ""), 0
    for k, mark in enumerate(plain):
        depth += (mark == "(") - (mark == ")")
        if mark in ends and depth == 0 and plain[k + 1 : k + 2] in ("", " "):
            return plain[:k]
    return plain


def _comment(text: str, indent: str) -> list[str]:
    lines, line = [], f"{indent}!"
    for word in text.split():
        if len(line) + 1 + len(word) > _WIDTH:
            lines.append(line)
            line = f"{indent}!  "
        line = f"{line} {word}"
    return [*lines, line]


def new_scene(kind: str, name: str, water: float | None = None) -> str:
    """Text of a new scene.

    `kind`: one of the files in the folder ``kinds``. `name`: what the scene is called, after its
    file. `water`: the fluid is water, in rock of this temperature [K].
    """
    text = (KINDS / f"{kind}.nml").read_text(encoding="utf-8")
    if water is not None:
        from wingcrack.scenes.water import with_water

        text = with_water(text, water)
    head, _, rest = text.partition("&scene\n")
    rest = rest.replace(f"  name = '{kind}'\n", f"  name = '{name}'\n", 1)
    return head + annotated(f"&scene\n{rest}").lstrip("\n")


def new(given: SimpleNamespace) -> int:
    """Write the scene; give the exit status: 0 done, 2 bad input, 3 lacking solver."""
    try:
        text = new_scene(given.kind, given.out.stem, given.water)
        given.out.write_text(text, encoding="utf-8")
    except OSError as reason:
        said = f"{given.out}: it cannot be written: {reason.strerror}"
        print(f"wingcrack new: {said}", file=sys.stderr)
        return 2
    except SceneError as reason:
        print(f"wingcrack new: {reason}", file=sys.stderr)
        return 2
    print(f"{given.out} is written; ./wingcrack run {given.out} runs it.")
    return 0
