"""The command line: `understand` makes a call of words, by Click; `main` does it."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence

from wingcrack.command_line.call import Call, RefusedError
from wingcrack.command_line.declaring import Group, UsageError

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
# Each command is imported when it is named; they stand in the order of the help.
_GROUP = Group(
    {
        name: f"wingcrack.command_line.{place}"
        for name, place in {
            "run": "solver_commands:run",
            "check": "solver_commands:check",
            "plot": "run_commands:plot",
            "view": "run_commands:view",
            "study": "run_commands:study",
            "new": "scene_commands:new",
            "import": "scene_commands:import_map",
            "network": "scene_commands:network",
            "verify": "developer_commands:verify",
            "bench": "developer_commands:bench",
            "test": "developer_commands:test",
            "build": "developer_commands:build",
            "format": "developer_commands:format_sources",
            "lint": "developer_commands:lint",
            "docs": "developer_commands:docs",
        }.items()
    },
    _TITLE,
    _EPILOG,
)


def understand(words: Sequence[str]) -> Call | None:
    """Give what the words ask for, or None where that was help, which is printed.

    Raises
    ------
    SystemExit
        With status 2, after a sentence on stderr, if they cannot be understood.
    """
    name = words[0] if words else ""
    if not {"-h", "--help"}.isdisjoint(words[1:]):
        words = [name, "--help"]  # help wins over what else is said
    try:
        return _GROUP.understand(list(words))
    except RefusedError as reason:
        said = f"wingcrack: {reason}"
    except UsageError as reason:
        named = f"wingcrack {name}" if name in _GROUP.places else "wingcrack"
        message = " ".join(reason.format_message().split()).rstrip(".")
        message = re.sub(r"\. (D.*\?)$", r" (\1)", message)  # a guess at what was meant
        said = f"{named}: {message[:1].lower()}{message[1:]}; ./{named} --help says more"
    print(said, file=sys.stderr)
    raise SystemExit(2)


def main(words: Sequence[str] | None = None) -> int:
    """Do what the words ask for and return the exit status."""
    call = understand(sys.argv[1:] if words is None else words)
    return call.do() if call is not None else 0
