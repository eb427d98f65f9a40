"""The command line as a program, with its errors and interruptions."""

from __future__ import annotations

import errno
import io
import os
import signal
import sys
from collections.abc import Sequence
from typing import NoReturn

from wingcrack.command_line import main, understand
from wingcrack.command_line.declaring import TOP, RefusedError

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


def program(words: Sequence[str] | None = None, *, only_understands: bool = False) -> int:
    """Do what the words ask for and return the exit status, 3 if a package lacks for it.

    `words`: those that Python was called with, unless they are given. `only_understands`: refuse or
    print help, and do nothing else: that takes nothing but Python.
    """
    for name in ("stdout", "stderr"):
        old = getattr(sys, name)
        if old is not None:  # else it is closed, and print does nothing
            encoding, by_line = old.encoding, old.line_buffering
            new = _Output(old.detach(), encoding, "backslashreplace", line_buffering=by_line)
            setattr(sys, name, new)
    signal.signal(signal.SIGTERM, lambda *_: os._exit(128 + signal.SIGTERM))
    try:
        words = sys.argv[1:] if words is None else words
        return _without_traceback(words, only_understands=only_understands)
    finally:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()


def _without_traceback(words: Sequence[str], *, only_understands: bool) -> int:
    for word in words:
        try:
            word.encode()
        except UnicodeEncodeError:
            return _say(f"the argument '{word}' is not UTF-8 text", 2)
    try:
        if not only_understands:
            return main(words)
        understand(words)
        return 0
    except RefusedError as reason:
        return _say(str(reason), 2)
    except OSError as reason:
        if reason.errno != errno.ENAMETOOLONG:
            raise
        return _say(f"{reason.filename}: {reason.strerror}", 2)
    except ImportError as reason:
        if reason.name is None or reason.name.startswith("wingcrack"):
            raise
        return _say(
            f"a Python package cannot be loaded ({str(reason).splitlines()[0]}); remove the folder"
            f" {TOP / '.venv'} and call again, which installs all of them",
            3,
        )
    except KeyboardInterrupt:
        return _say("interrupted", 128 + signal.SIGINT)


def _say(text: str, status: int) -> int:
    print(f"wingcrack: {text}", file=sys.stderr)
    return status
