"""The command line: `understand` makes a call of words, by Click; `main` does it."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence

from wingcrack.command_line.declaring import Call, RefusedError, UsageError
from wingcrack.errors import EnvironmentLacksError

try:
    from wingcrack.command_line import with_click as way
except ImportError as lacking:
    if lacking.name != "click":
        raise
    from wingcrack.command_line import without_click as way  # type: ignore[no-redef]

__all__ = ["main", "understand"]

_TITLE = "Fluid-driven slip, opening and growth of fractures in poroelastic rock (2D)."
_EPILOG = """\
The first call of ./wingcrack installs what is missing (system packages with apt, Python packages
in .venv) and builds the program; WINGCRACK_NO_INSTALL=1 forbids installing.

Exit status: 0 done; 1 the run or a test failed; 2 bad input or usage (nothing written);
3 the environment lacks something; 130 and 143 interrupted by SIGINT and SIGTERM.

example:
  ./wingcrack run inputs/paper_c/wing_crack.nml
"""
# Modules with the names of what is declared in them; each is imported when a command is named.
_MODULES = {
    "run_commands": ("run", "check", "plot", "analyse", "view", "study"),
    "scene_commands": ("new", "import"),
    "developer_commands": (
        "verify",
        "reproduce",
        "bench",
        "test",
        "build",
        "format",
        "lint",
        "docs",
    ),
}
_NAMED = {"import": "import_map", "format": "format_sources"}
_PLACES = {
    name: f"wingcrack.command_line.{module}:{_NAMED.get(name, name)}"
    for module, names in _MODULES.items()
    for name in names
}


def understand(words: Sequence[str]) -> Call | None:
    """Give what the words ask for, or None where that was help, which is printed.

    Raises `SystemExit`: with status 2, after a sentence on stderr, if they cannot be understood.
    """
    name = words[0] if words else ""
    if not {"-h", "--help"}.isdisjoint(words[1:]):
        words = [name, "--help"]  # help wins over what else is said
    try:
        return way.understand(list(words), _PLACES, _TITLE, _EPILOG)
    except RefusedError as reason:
        said = f"wingcrack: {reason}"
    except UsageError as reason:
        named = f"wingcrack {name}" if name in _PLACES else "wingcrack"
        message = " ".join(str(reason).split()).rstrip(".")
        message = re.sub(r"\. (D.*\?)$", r" (\1)", message)  # a guess at what was meant
        said = f"{named}: {message[:1].lower()}{message[1:]}; ./{named} --help says more"
    print(said, file=sys.stderr)
    raise SystemExit(2)


def main(words: Sequence[str] | None = None) -> int:
    """Do what the words ask for and return the exit status."""
    words = sys.argv[1:] if words is None else words
    call = understand(words)
    try:
        return call.do() if call is not None else 0
    except EnvironmentLacksError as reason:
        print(f"wingcrack {words[0]}: {reason}", file=sys.stderr)
        return 3
