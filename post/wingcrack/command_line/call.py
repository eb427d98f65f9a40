"""What a command line asks for, once it is understood."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

TOP = Path(__file__).resolve().parents[3]


class RefusedError(Exception):
    """What the call names cannot be used; the sentence says it all."""


@dataclass(frozen=True)
class Call:
    """A function, imported when it is called and not before, and what it is given.

    Attributes
    ----------
    does : str
        ``module:function``; the function returns the exit status. Empty for what ./wingcrack does.
    given : SimpleNamespace
        The values of arguments and options by name, and `command`.
    """

    does: str
    given: SimpleNamespace

    def do(self) -> int:
        """Do it; give the exit status."""
        if not self.does:
            raise RefusedError(f"./wingcrack {self.given.command} does this, and nothing else")
        status: int = load(self.does)(self.given)
        return status


def load(place: str) -> Any:
    """Import what ``module:name`` says."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def is_here(does: str) -> bool:
    """Whether what does it is installed: not everywhere are all packages, and the tools."""
    if not does:
        return (TOP / "tools" / "lint.sh").is_file()
    return find_spec(does.partition(".")[0]) is not None
