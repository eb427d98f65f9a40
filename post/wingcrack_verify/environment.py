"""The environment of the numbers: revision, machine, compiler, packages."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import re
import shutil
import subprocess
from pathlib import Path

PYTHON_PACKAGES = ("numpy", "matplotlib", "gmsh", "f90nml", "jinja2", "markdown-it-py")
SYSTEM_PACKAGES = ("libmumps-seq-dev", "libmumps-seq-5.5", "libopenblas0-pthread", "liblapack3")


def revision(top: Path) -> str:
    """Commit of the tree, and whether it was changed since."""
    commit = _output(["git", "log", "-1", "--format=%h of %cs"], top)
    if not commit:
        return "unknown (no git repository)"
    changed = _output(["git", "status", "--porcelain", "--untracked-files=no"], top)
    return f"{commit}, with changes not committed" if changed else commit


def machine() -> dict[str, str]:
    """Processor, memory and system."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return {
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "memory": f"{memory:.1f} GiB",
        "system": f"{_distribution()}, {platform.system()} {platform.machine()}",
    }


def packages(build: Path) -> dict[str, str]:
    """Versions of compiler and packages, where they can be found."""
    found = {"Python": platform.python_version()} | _compilers(build)
    for name in PYTHON_PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    if shutil.which("dpkg-query"):
        for name in SYSTEM_PACKAGES:
            version = _output(["dpkg-query", "-W", "-f=${Version}", name], Path())
            if version:
                found[name] = version
    return found


def _compilers(build: Path) -> dict[str, str]:
    found = {}
    for language in ("Fortran", "CXX"):
        for file in build.glob(f"CMakeFiles/*/CMake{language}Compiler.cmake"):
            text = file.read_text(encoding="utf-8")
            parts = [
                re.search(rf'set\(CMAKE_{language}_COMPILER_{key} "([^"]+)"\)', text)
                for key in ("ID", "VERSION")
            ]
            if all(parts):
                found[f"{language} compiler"] = " ".join(part[1] for part in parts if part)
    cache = build / "CMakeCache.txt"
    if cache.is_file():
        kind = re.search(r"CMAKE_BUILD_TYPE:\w+=(\w+)", cache.read_text(encoding="utf-8"))
        if kind:
            found["build type"] = kind[1]
    return found


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or platform.machine()
    model = re.search(r"model name\s*:\s*(.+)", text)
    return model[1].strip() if model else platform.machine()


def _distribution() -> str:
    try:
        return platform.freedesktop_os_release().get("PRETTY_NAME", "")
    except OSError:
        return platform.release()


def _output(command: list[str], place: Path) -> str:
    try:
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
