"""Command line: ``python -m wingcrack_scenes new [KIND]``."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from wingcrack_scenes.arguments import parse
from wingcrack_scenes.errors import SceneError, SolverLackingError
from wingcrack_scenes.new import new_scene


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status: 0 done, 2 bad input, 3 lacking solver."""
    given = parse(arguments)
    try:
        text = new_scene(given.kind, given.out.stem)
        given.out.write_text(text, encoding="utf-8")
    except OSError as reason:
        said = f"{given.out}: it cannot be written: {reason.strerror}"
        print(f"wingcrack new: {said}", file=sys.stderr)
        return 2
    except SceneError as reason:
        print(f"wingcrack new: {reason}", file=sys.stderr)
        return 2
    except SolverLackingError as reason:
        print(f"wingcrack new: {reason}", file=sys.stderr)
        return 3
    print(f"{given.out} is written; ./wingcrack run {given.out} runs it.")
    return 0
