"""Which verification cases run a shipped scene."""

from __future__ import annotations

from functools import cache

from wingcrack_docs.places import TOP
from wingcrack_verify.suite import read_suite


def cases_of(scene: str) -> list[str]:
    """Names of the cases that run a scene, given by its path in the tree."""
    return sorted(_runs().get(scene, ()))


@cache
def _runs() -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for job in read_suite(TOP / "verification", (), quick=False).jobs:
        if job.run.scene is not None:
            path = job.run.scene.resolve()
            if path.is_relative_to(TOP):
                found.setdefault(path.relative_to(TOP).as_posix(), set()).add(job.case)
    return found
