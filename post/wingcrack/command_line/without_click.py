"""What commands take of Click, by argparse: for calls before Click is installed.

A wrong call is refused, and help is given, before anything is installed.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

from wingcrack.command_line.call import Call, is_here, load

_Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


class UsageError(Exception):
    """A call that cannot be understood."""

    def format_message(self) -> str:
        """Say why."""
        return str(self)


class Reader:
    """A value that a function reads from text, or refuses by a ValueError."""

    def __init__(self, read: Callable[[str], Any]) -> None:
        self._read = read

    def __call__(self, text: str) -> Any:
        """Read it."""
        try:
            return self._read(text)
        except ValueError as reason:
            raise argparse.ArgumentTypeError(str(reason)) from None


class Place(Reader):
    """A file or a folder."""

    def __init__(self, read: Callable[[str], Any] = Path) -> None:
        super().__init__(read)


class Choice(tuple[str, ...]):
    """The values that there are."""


def option(*names: str, **words: Any) -> _Decorator:
    """Declare an option."""
    for ours in ("show_default", "hidden"):
        words.pop(ours, None)
    if words.pop("is_flag", False):
        words["action"] = "store_true"
    if words.pop("multiple", False):
        words |= {"action": "append", "default": []}
    return _parameter(names, words)


def argument(name: str, **words: Any) -> _Decorator:
    """Declare an argument."""
    count, required = words.pop("nargs", 1), words.pop("required", True)
    if count == -1:
        words["nargs"] = "+" if required else "*"
    elif not required:
        words["nargs"] = "?"
    return _parameter((name,), words)


def _parameter(names: Sequence[str], words: dict[str, Any]) -> _Decorator:
    if isinstance(words.get("type"), Choice):
        words["choices"] = words.pop("type")

    def declare(function: Any) -> Any:
        function.__dict__.setdefault("parameters", []).insert(0, (names, words))
        return function

    return declare


class Command(argparse.ArgumentParser):
    """A command that tells what does it."""

    does = ""
    call: Callable[..., Call]

    def error(self, message: str) -> NoReturn:
        """Say it in one sentence, without the usage lines."""
        raise UsageError(message)


def command(name: str, callback: Callable[..., Call], does: str, epilog: str) -> Command:
    """Make a command of a callback with its arguments and options."""
    made = Command(
        prog=f"./wingcrack {name}",
        description=callback.__doc__,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    made.does, made.call = does, callback
    for names, words in callback.__dict__.get("parameters", ()):
        made.add_argument(*names, **words)
    return made


class Group:
    """Commands by name, each with its place, from where it is imported when it is named."""

    def __init__(self, places: Mapping[str, str], title: str, epilog: str) -> None:
        self.places = places
        self._title, self._epilog = title, epilog

    def understand(self, words: list[str]) -> Call | None:
        """Give what the words ask for, or None where that was help."""
        if not words:
            raise UsageError("missing command")
        name = words[0]
        if name in ("-h", "--help"):
            commands = "".join(
                f"  {name:<9}{self._command(name).description.splitlines()[0]}\n"
                for name in self.places
            )
            print(f"{self._title}\n\nCommands:\n{commands}\n{self._epilog}", end="")
            return None
        found = self._command(name) if name in self.places else None
        if found is None or not is_here(found.does):
            raise UsageError(f"no such command '{name}'")
        if "--help" in words:
            found.print_help()
            return None
        call: Call = found.call(**vars(found.parse_args(words[1:])))
        return call

    def _command(self, name: str) -> Any:
        return load(self.places[name])
