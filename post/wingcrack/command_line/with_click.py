"""Words understood by Click."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from wingcrack import __version__
from wingcrack.command_line.declaring import Call, Command, Parameter, UsageError, load
from wingcrack.command_line.values import absolute, place

_SETTINGS = {"help_option_names": ["-h", "--help"], "max_content_width": 100}
_ASKING = "_WINGCRACK_COMPLETE"  # set where a shell asks how words could be completed


def understand(words: list[str], places: Mapping[str, str], title: str, epilog: str) -> Call | None:
    """Give what the words ask for, or None where that was help."""
    called = "wingcrack" if _ASKING in os.environ else "./wingcrack"
    group = _Group(places, help=title, epilog=epilog, context_settings=_SETTINGS)
    try:
        asked = group.main(words, called, _ASKING, standalone_mode=False)
    except click.UsageError as reason:
        raise UsageError(reason.format_message()) from None
    return asked if isinstance(asked, Call) else None


class _AsWritten(click.Command):
    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        formatter.write(f"\n{self.epilog}")


class _Group(_AsWritten, click.Group):
    """Commands by name, each with its place, from where it is imported when it is named."""

    def __init__(self, places: Mapping[str, str], **words: Any) -> None:
        super().__init__(no_args_is_help=False, **words)
        self._places = places
        click.version_option(__version__, message="wingcrack %(version)s")(self)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self._places:
            return None
        declared: Command = load(self._places[cmd_name])
        if not declared.is_here:
            return None
        return _AsWritten(
            cmd_name,
            params=[_parameter(one) for one in declared.parameters],
            callback=declared.call,
            help=declared.title,
            epilog=declared.epilog,
            context_settings=_SETTINGS,
        )

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [name for name in self._places if self.get_command(ctx, name)]


def _parameter(one: Parameter) -> click.Parameter:
    kind = click.Choice(one.choices) if one.choices else _Value(one)
    words: dict[str, Any] = {"required": one.required, "metavar": one.metavar or None}
    if one.default is not None:
        words["default"] = one.default
    if not one.name.startswith("--"):
        return click.Argument([one.name], type=kind, nargs=-1 if one.many else 1, **words)
    if one.is_flag:
        return click.Option([one.name], is_flag=True, help=one.help, **words)
    return click.Option([one.name], type=kind, multiple=one.many, help=one.help, **words)


class _Value(click.ParamType):  # type: ignore[type-arg]  # which older ones do not take
    name = "value"

    def __init__(self, one: Parameter) -> None:
        self._read = one.read

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read what was given as text; a default is taken as it is."""
        if not isinstance(value, str):
            return value
        try:
            return self._read(value)
        except ValueError as reason:
            self.fail(str(reason), param, ctx)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Let the shell offer files where one is meant."""
        is_place = self._read in (Path, absolute, place)
        return [CompletionItem(incomplete, type="file")] if is_place else []
