"""`wingcrack new`: a scene to start from."""

from __future__ import annotations

import sys
from types import SimpleNamespace

from wingcrack.scenes.errors import SceneError
from wingcrack.scenes.new import new_scene


def new(given: SimpleNamespace) -> int:
    """Write the scene; give the exit status: 0 done, 2 bad input, 3 lacking solver."""
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
    print(f"{given.out} is written; ./wingcrack run {given.out} runs it.")
    return 0
