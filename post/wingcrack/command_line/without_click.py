"""Words understood before Click is installed, by argparse.

So a wrong call is refused, and help given, before anything is installed.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

from wingcrack.command_line.declaring import Call, Command, Parameter, UsageError, load


def understand(words: list[str], places: Mapping[str, str], title: str, epilog: str) -> Call | None:
    """Give what the words ask for, or None where that was help."""
    if not words:
        raise UsageError("missing command")
    if words[0] in ("-h", "--help"):
        commands = (load(place) for place in places.values())
        lines = (f"  {one.name:<9}{one.title}\n" for one in commands if one.is_here)
        print(f"{title}\n\nCommands:\n{''.join(lines)}\n{epilog}", end="")
        return None
    declared: Command | None = load(places[words[0]]) if words[0] in places else None
    if declared is None or not declared.is_here:
        raise UsageError(f"no such command '{words[0]}'")
    parser = _Parser(
        prog=f"./wingcrack {declared.name}",
        description=declared.title,
        epilog=declared.epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    for one in declared.parameters:
        _add(parser, one)
    if "--help" in words:
        parser.print_help()
        return None
    return declared.call(**vars(parser.parse_args(words[1:])))


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise UsageError(message)


def _add(parser: _Parser, one: Parameter) -> None:
    words: dict[str, Any] = {"help": one.help, "default": [] if one.many else one.default}
    if one.is_flag:
        words["action"] = "store_true"
    else:
        words |= {"type": _told(one.read), "metavar": one.metavar or None}
    if one.choices:
        words["choices"] = one.choices
    if one.name.startswith("--"):
        words["required"] = one.required
        if one.many:
            words["action"] = "append"
    elif one.many or not one.required:
        words["nargs"] = "*" if one.many else "?"
    parser.add_argument(one.name, **words)


def _told(read: Callable[[str], Any]) -> Callable[[str], Any]:
    """Let argparse say why a value cannot be read."""

    def convert(text: str) -> Any:
        try:
            return read(text)
        except ValueError as reason:
            raise argparse.ArgumentTypeError(str(reason)) from None

    return convert
