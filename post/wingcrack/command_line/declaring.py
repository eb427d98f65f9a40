"""How commands are declared: by Click, or before it is installed by what stands in for it."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from textwrap import indent
from types import SimpleNamespace
from typing import TYPE_CHECKING

from wingcrack.command_line.call import Call

try:
    import click as _click  # noqa: F401
except ImportError:
    _HAS_CLICK = False
else:
    _HAS_CLICK = True

if TYPE_CHECKING or _HAS_CLICK:
    from wingcrack.command_line import with_click as way
else:
    from wingcrack.command_line import without_click as way

Choice, Place, Reader, UsageError = way.Choice, way.Place, way.Reader, way.UsageError
Group = way.Group
argument, option = way.argument, way.option
_Judge = Callable[[SimpleNamespace], None]


_STATUSES = """\
0 done; 1 it failed; 2 bad input or usage (nothing is written);
3 the environment lacks something; 130 and 143 interrupted by SIGINT and SIGTERM."""


def command(
    name: str, does: str, *, example: str, about: str = "", statuses: str = _STATUSES
) -> Callable[[_Judge], way.Command]:
    """Declare a command; what is decorated judges its values, and its text begins the help.

    Parameters
    ----------
    does : str
        ``module:function`` that does it.
    example, about, statuses : str
        The rest of the help, line by line as it is shown.
    """
    parts = (about, f"Exit status: {statuses}\n", f"example:\n{indent(example, '  ')}")
    epilog = "\n".join(part for part in parts if part)

    def declare(judge: _Judge) -> way.Command:
        @wraps(judge)
        def call(**values: object) -> Call:
            given = SimpleNamespace(command=name, **values)
            judge(given)
            return Call(does, given)

        return way.command(name, call, does, epilog)

    return declare
