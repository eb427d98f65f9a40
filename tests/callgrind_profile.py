"""What a run of the solver executes: instructions by function, counted by valgrind's callgrind."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from system_scene import TOP

# The debug build: nothing is inlined there, so that every call shows.
SOLVER = TOP / "build" / "debug" / "fortran" / "app" / "wingcrack-solver"

# One thread, and instructions that valgrind knows on any processor.
ONE_KIND = {
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_CORETYPE": "Haswell",
}

_LOADER = re.compile(r"_dl_|do_lookup_x|check_match|strcmp|__cxa_finalize")
_ALLOCATOR = re.compile(r"_int_malloc|_int_free|_int_realloc|malloc_consolidate|unlink_chunk")
_PROCEDURE = re.compile(r"__([a-z]\w*)_MOD_(?!_)(\w*)")


def why_not() -> str:
    """Say why nothing can be counted here; empty if it can."""
    if shutil.which("valgrind") is None:
        return "valgrind is not installed, and nothing else of wingcrack needs it"
    if not SOLVER.exists():
        return "there is no debug build; ./wingcrack test makes it"
    return ""


@dataclass(frozen=True)
class Profile:
    """Instructions of one run, by function of the program; libraries are counted as one."""

    functions: dict[str, int]
    total: int

    def executed(self, *modules: str) -> set[str]:
        """Give the functions executed whose "module: procedure" begins in one of these ways."""
        return {name for name in self.functions if _procedure_of(name).startswith(modules)}

    def loading(self) -> int:
        """Instructions that find libraries and their names, before and after the program."""
        return sum(count for name, count in self.functions.items() if _LOADER.match(name))

    def searching(self) -> int:
        """Instructions that look for free memory: they depend on what libraries have left."""
        return sum(count for name, count in self.functions.items() if _ALLOCATOR.match(name))

    def components(self) -> Counter[str]:
        """Instructions by component: the first word of a module's name."""
        count: Counter[str] = Counter()
        for name, instructions in self.functions.items():
            if _procedure_of(name):
                count[_procedure_of(name).split("_")[0]] += instructions
        return count


def _procedure_of(function: str) -> str:
    """Name a Fortran procedure with its module; none for what gfortran adds to copy or end."""
    found = _PROCEDURE.match(function)
    return f"{found.group(1)}: {found.group(2)}" if found else ""


def profile(scene: str, place: Path, program: Path = SOLVER) -> Profile:
    """Run a scene and count."""
    place.mkdir()
    (place / "scene.nml").write_text(scene)
    counts = place / "callgrind.out"
    done = subprocess.run(
        [
            "valgrind",
            "--tool=callgrind",
            f"--callgrind-out-file={counts}",
            "--compress-strings=no",
            "--compress-pos=no",
            program,
            *("run", "scene.nml", "--out", "out", "--quiet"),
        ],
        cwd=place,
        env=os.environ | ONE_KIND,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return _read(counts)


def _read(path: Path) -> Profile:
    """Read the format of callgrind (its manual, section "Callgrind Format")."""
    functions: Counter[str] = Counter()
    name = ""
    is_call = False
    for line in path.read_text().splitlines():
        if line.startswith("fn="):
            name = line[3:]
        elif line.startswith("calls="):
            is_call = True  # the next line is the cost of the call, which the callee has too
        elif line[:1].isdigit():
            if not is_call:
                functions[name] += int(line.split()[1])
            is_call = False
    return Profile(dict(functions), functions.total())
