"""Start a Python package of post/: start.py [--ask] PACKAGE [ARGUMENT ...].

With --ask it only understands the arguments: it prints the help that they ask for, or refuses them
with status 2. That takes nothing but Python itself, so the launcher asks before it installs or
builds anything. To be called with `python -I`: modules come from post/ and from the environment of
that Python, never from the folder where the user happens to be.
"""

import errno
import importlib
import io
import os
import runpy
import sys
from pathlib import Path
from typing import NoReturn

TOP = Path(__file__).resolve().parent.parent

_BROKEN_PIPE = 141  # as of a program that SIGPIPE has ended


class _Output(io.TextIOWrapper):
    """Text for the terminal: what cannot be written ends the call in order, without a traceback."""

    def write(self, text: str) -> int:
        """Write, whatever letters the terminal lacks."""
        try:
            return super().write(text)
        except OSError as reason:
            self._end(reason)

    def flush(self) -> None:
        """Hand over what was written."""
        try:
            super().flush()
        except OSError as reason:
            self._end(reason)

    def _end(self, reason: OSError) -> NoReturn:
        """End, as a `SystemExit` that tidies up on its way; the rest goes nowhere."""
        os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())
        if isinstance(reason, BrokenPipeError):
            sys.exit(_BROKEN_PIPE)
        sys.exit(f"wingcrack: the output cannot be written: {reason.strerror}")


def main() -> int:
    """Return the exit status of what is started, or 3 if the environment lacks a package for it."""
    for name in ("stdout", "stderr"):
        old = getattr(sys, name)
        if old is not None:  # else it is closed, and print does nothing
            encoding, by_line = old.encoding, old.line_buffering
            new = _Output(old.detach(), encoding, "backslashreplace", line_buffering=by_line)
            setattr(sys, name, new)
    try:
        return start()
    finally:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()


def start() -> int:
    """Do what `main` says."""
    asks = sys.argv[1] == "--ask"
    package, *arguments = sys.argv[2 if asks else 1 :]
    for argument in arguments:
        try:
            argument.encode()
        except UnicodeEncodeError:
            print(f"wingcrack: the argument '{argument}' is not UTF-8 text", file=sys.stderr)
            return 2
    sys.path.insert(0, str(TOP / "post"))
    try:
        if asks:
            importlib.import_module(f"{package}.arguments").parse(arguments)
        else:
            sys.argv[1:] = arguments
            runpy.run_module(package, run_name="__main__", alter_sys=True)
    except OSError as reason:
        if reason.errno != errno.ENAMETOOLONG:
            raise
        print(f"wingcrack: {reason.filename}: {reason.strerror}", file=sys.stderr)
        return 2
    except ImportError as reason:
        if reason.name is None or reason.name.startswith("wingcrack"):
            raise
        said = str(reason).splitlines()[0]
        print(
            f"wingcrack: a Python package cannot be loaded ({said}); remove the folder"
            f" {TOP / '.venv'} and call again, which installs all of them",
            file=sys.stderr,
        )
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main())
