"""Stored instruction counts, with the compilers and libraries of their measurement."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from wingcrack.figures.text_files import write_whole
from wingcrack_verify.environment import machine, packages

MOST_INSTRUCTIONS = 1.10  # over the stored count: more is a loss
MOST_CPU = 1.25  # over the CPU time of the other program: more is a loss
_OURS = ("Fortran compiler", "CXX compiler", "build type")  # of what `packages` tells
_LIBRARIES = re.compile(
    r"\s(lib(?:gmsh|dmumps|mumps|metis|pord|scotch|\w*blas|gfortran|stdc|m\.|c\.)\S*) => (/\S+)"
)


@dataclass(frozen=True)
class Baseline:
    """What was stored."""

    made_with: dict[str, str]  # compilers, libraries and the processor that the code was made for
    instructions: dict[str, int]  # by measurement


def made_with(solver: Path) -> dict[str, str]:
    """What the count of a solver's instructions depends on, apart from its own source."""
    build = next((p for p in solver.resolve().parents if (p / "CMakeCache.txt").is_file()), None)
    found: dict[str, str] = {}
    if build is not None:
        known = packages(build)
        found |= {name: known[name] for name in _OURS if name in known}
        cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
        target = re.search(r"^WINGCRACK_PROCESSOR:\w+=(.*)$", cache, flags=re.M)
        found["processor"] = target[1] if target else "unknown"
        if "native" in found["processor"]:
            found["processor"] += f", {machine()['processor']}"
    found["valgrind"] = _said("valgrind", "--version")
    for name, path in _LIBRARIES.findall(_said("ldd", str(solver))):
        digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()[:12]
        found[name] = f"{Path(path).resolve().name} {digest}"
    return found


def read_baseline(path: Path) -> Baseline:
    """Read what was stored; nothing if there is no such file."""
    if not path.exists():
        return Baseline({}, {})
    content = json.loads(path.read_text(encoding="utf-8"))
    return Baseline(content["made_with"], content["instructions"])


def store(path: Path, new: Baseline) -> None:
    """Store counts; others of before stay if they were made with the same."""
    old = read_baseline(path)
    counts = old.instructions if old.made_with == new.made_with else {}
    content = {
        "made_with": new.made_with,
        "instructions": dict(sorted({**counts, **new.instructions}.items())),
    }
    write_whole(path, json.dumps(content, indent=2) + "\n")


def differences(stored: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """Name what the stored counts were made with, and these are not."""
    return [
        f"{name} ({stored.get(name, 'none')} then, {here.get(name, 'none')} here)"
        for name in sorted({*stored, *here})
        if stored.get(name) != here.get(name)
    ]


def _said(*command: str) -> str:
    """Give what a program prints; nothing where it is not there."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return done.stdout.strip()
