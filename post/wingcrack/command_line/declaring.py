"""Declarations of commands, from which Click makes the command line (`with_click`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from textwrap import indent
from types import SimpleNamespace
from typing import Any

TOP = Path(__file__).resolve().parents[3]
_STATUSES = """\
0 done; 1 it failed; 2 bad input or usage (nothing is written);
3 the environment lacks something; 130 and 143 interrupted by SIGINT and SIGTERM."""


class UsageError(Exception):
    """A call that cannot be understood; its command's help says more."""


class RefusedError(Exception):
    """What the call names cannot be used; the sentence says it all."""


@dataclass(frozen=True)
class Parameter:
    """An argument, or where its name begins with dashes an option."""

    name: str
    metavar: str = ""
    help: str = ""
    read: Callable[[str], Any] = str  # gives the value for a text, or raises ValueError
    default: Any = None
    many: bool = False  # whether there may be several: then the value is a list of them
    required: bool = False
    is_flag: bool = False
    choices: tuple[str, ...] = ()


def flag(name: str, help: str) -> Parameter:  # noqa: A002
    """An option without a value."""
    return Parameter(name, help=help, is_flag=True, default=False)


def choice(name: str, choices: tuple[str, ...], help: str, default: Any = None) -> Parameter:  # noqa: A002
    """An option with one of some values."""
    return Parameter(name, help=help, choices=choices, default=default)


@dataclass(frozen=True)
class Call:
    """What words ask for: a function and the values it is given by name, with `command`."""

    does: str
    given: SimpleNamespace

    def do(self) -> int:
        """Do it; give the exit status."""
        if not self.does:
            raise RefusedError(f"./wingcrack {self.given.command} does this, and nothing else")
        status: int = load(self.does)(self.given)
        return status


@dataclass(frozen=True)
class Command:
    """A command: `does` is the ``module:function`` that does it, empty where the launcher does."""

    name: str
    does: str
    parameters: tuple[Parameter, ...]
    judge: Callable[[SimpleNamespace], None]
    epilog: str

    @property
    def title(self) -> str:
        """What it does, in a line."""
        return self.judge.__doc__ or ""

    @property
    def is_here(self) -> bool:
        """Whether what does it is installed: not everywhere are all packages, and the tools."""
        if not self.does:
            return (TOP / "tools" / "lint.sh").is_file()
        package = self.does.partition(":")[0].rpartition(".")[0]
        try:
            return find_spec(package) is not None
        except ModuleNotFoundError:  # the package that it is a part of
            return False

    def call(self, **values: Any) -> Call:
        """Judge the values together; give what they ask for."""
        given = SimpleNamespace(command=self.name, **values)
        self.judge(given)
        return Call(self.does, given)


def command(
    name: str,
    does: str,
    *parameters: Parameter,
    example: str,
    about: str = "",
    statuses: str = _STATUSES,
) -> Callable[[Callable[[SimpleNamespace], None]], Command]:
    """Declare a command; what is decorated judges its values, and its text begins the help."""
    parts = (about, f"Exit status: {statuses}\n", f"example:\n{indent(example, '  ')}")
    epilog = "\n".join(part for part in parts if part)
    return lambda judge: Command(name, does, parameters, judge, epilog)


def load(place: str) -> Any:
    """Import what ``module:name`` says."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)
