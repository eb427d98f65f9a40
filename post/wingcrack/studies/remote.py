"""The one function that is sent to workers; it requires only Python there."""

from __future__ import annotations

from typing import Any


def run_there(post: str, task: dict[str, Any]) -> dict[str, Any]:
    """Run a task in this process' machine; `post` is where the runner's package lies."""
    import sys
    from dataclasses import asdict
    from importlib import import_module

    if post not in sys.path:
        sys.path.insert(0, post)
    tasks: Any = import_module("wingcrack.runner.task")
    return asdict(tasks.run_task(tasks.Task(**task)))
