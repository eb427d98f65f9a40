"""Commands by Click, with the ends of their help as they are written."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click
from click import Choice, UsageError, argument, option
from click.shell_completion import CompletionItem

from wingcrack.command_line.call import Call, is_here, load
from wingcrack_post import __version__

__all__ = [
    "Choice",
    "Command",
    "Group",
    "Place",
    "Reader",
    "UsageError",
    "argument",
    "command",
    "option",
]

_SETTINGS = {"help_option_names": ["-h", "--help"], "max_content_width": 100, "show_default": True}


class Reader(click.ParamType[Any]):
    """A value that a function reads from text, or refuses by a ValueError."""

    name = "value"

    def __init__(self, read: Callable[[str], Any]) -> None:
        self._read = read

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read what was given as text; a default is taken as it is."""
        if not isinstance(value, str):
            return value
        try:
            return self._read(value)
        except ValueError as reason:
            self.fail(str(reason), param, ctx)


class Place(Reader):
    """A file or a folder."""

    def __init__(self, read: Callable[[str], Any] = Path) -> None:
        super().__init__(read)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Let the shell offer files."""
        return [CompletionItem(incomplete, type="file")]


class _AsWritten(click.Command):
    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write it line by line."""
        formatter.write(f"\n{self.epilog}")


class Command(_AsWritten):
    """A command that tells what does it."""

    does = ""


def command(name: str, callback: Callable[..., Call], does: str, epilog: str) -> Command:
    """Make a command of a callback with its arguments and options."""
    made = click.command(name, Command, epilog=epilog, context_settings=_SETTINGS)(callback)
    made.does = does
    return made


class Group(_AsWritten, click.Group):
    """Commands by name, each with its place, from where it is imported when it is named."""

    def __init__(self, places: Mapping[str, str], title: str, epilog: str) -> None:
        super().__init__(
            help=title, epilog=epilog, context_settings=_SETTINGS, no_args_is_help=False
        )
        click.version_option(__version__, message="wingcrack %(version)s")(self)
        self.places = places

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import a command, if what does it is here."""
        if cmd_name not in self.places:
            return None
        found: Command = load(self.places[cmd_name])
        return found if is_here(found.does) else None

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Those that are here, in the order of the help."""
        return [name for name in self.places if self.get_command(ctx, name)]

    def understand(self, words: list[str]) -> Call | None:
        """Give what the words ask for, or None where that was help."""
        asking = "_WINGCRACK_COMPLETE"  # set where a shell asks how words could be completed
        called = "wingcrack" if asking in os.environ else "./wingcrack"
        asked = self.main(words, called, asking, standalone_mode=False)
        return asked if isinstance(asked, Call) else None
