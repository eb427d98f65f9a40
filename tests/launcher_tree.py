"""A small tree with the real launcher and everything behind it replaced, to see what it calls."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent

_PROJECT = """\
cmake_minimum_required(VERSION 3.22)
project(wingcrack VERSION 9.8.7 LANGUAGES NONE)
file(GLOB parts CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/fortran/*.sh)
foreach(name wingcrack-solver wingcrack-ranks)
  set(program ${PROJECT_BINARY_DIR}/fortran/app/${name})
  add_custom_command(
    OUTPUT ${program}
    COMMAND sh ${PROJECT_SOURCE_DIR}/cmake/assemble.sh ${program} ${parts}
    DEPENDS ${parts}
  )
  add_custom_target(${name} DEPENDS ${program})
endforeach()
add_custom_target(everything ALL)
add_dependencies(everything wingcrack-solver)
"""

_ASSEMBLE = """\
program=$1
shift
mkdir -p "${program%/*}" && cat "$@" >"$program" && chmod +x "$program"
"""

# The stand-in for the solver tells how it was called; then the scene file, as a shell script, says
# what happens and with which status it ends.
_SOLVER = """\
#!/usr/bin/env bash
if [[ $1 == name ]]; then
    sed -n 's/^# name //p' "$2"
    grep -q '^# bad scene' "$2" && { echo 'what is bad about it' >&2; exit 2; }
    exit 0
fi
if [[ $1 == ranks ]]; then
    grep -q '^# no fluid' "$2" && { echo 'it has no fluid' >&2; exit 2; }
    exit 0
fi
[[ $1 == run ]] && mkdir -p "$4"
printf 'solver %s\\n' "$*"
printf 'threads %s\\n' "$OPENBLAS_NUM_THREADS"
if [[ $OMP_NUM_THREADS != "$OPENBLAS_NUM_THREADS" ]]; then
    printf 'loops on %s\\n' "$OMP_NUM_THREADS"
fi
source "$2"
"""

_POST = """\
import os
import sys


def do(given):
    print("post", *sys.argv[1:])
    return int(os.environ.get("POST_STATUS", "0"))


plot = view = study = verify = reproduce = bench = new = make_scene = do
module = os.environ.get("POST_IMPORTS")
if module:
    __import__(module)
if os.environ.get("POST_WAITS_FOR"):
    import pathlib, time
    pathlib.Path("post started").touch()
    while not os.path.exists(os.environ["POST_WAITS_FOR"]):
        time.sleep(0.02)
"""

PACKAGES = """\
# a remark
alpha-tool | command alpha-tool | first thing
beta-lib-5* | command beta-tool | second thing
always     | command sh | here anyway
"""

# A stand-in for apt-get: it writes down what it is asked, and what it "installs" appears on PATH.
APT_GET = """\
here=${0%/*}
words=$*
case " $words " in
    *' update '*) echo update >>"$here/asked"; touch "$here/updated" ;;
    *' install '*)
        echo "install ${words#*--no-install-recommends }" >>"$here/asked"
        if [[ -e $here/stale && ! -e $here/updated ]]; then exit 100; fi
        if [[ -e $here/broken ]]; then echo 'E: no such package' >&2; exit 100; fi
        ln -sf "$(type -P true)" "$here/alpha-tool"
        ln -sf "$(type -P true)" "$here/beta-tool"
        if [[ $words == *gamma-mpi* ]]; then ln -sf "$(type -P true)" "$here/gamma-mpi"; fi ;;
esac
"""
# Of the names that it knows, one is of no package: what another one provides.
APT_CACHE = """\
case $1 in
    pkgnames) printf '%s\\n' beta-lib-5.10 beta-lib-5.7 beta-lib-5.11 beta-lib-5.9 ;;
    show) if [[ $2 != *.11 ]]; then echo "Package: $2"; fi ;;
esac
"""
SUDO = 'exec "$@"'


def _heed_interrupts() -> None:
    """Undo an ignored SIGINT, which a shell would inherit and could not undo."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@dataclass
class Tree:
    """A folder with the launcher, and a place to call it from."""

    root: Path
    place: Path
    environment: dict[str, str] = field(default_factory=dict)

    @property
    def log(self) -> str:
        """What the set-up ran so far."""
        file = self.root / "build" / "setup.log"
        return file.read_text() if file.exists() else ""

    def scene(self, text: str = "", name: str = "scene.nml") -> Path:
        """Write a scene file whose text is what the stand-in solver does."""
        file = self.place / name
        file.write_text(text)
        return file

    def start(self, *arguments: str | Path, **variables: str) -> subprocess.Popen[str]:
        """Start the launcher, and leave it running."""
        return subprocess.Popen(
            [self.root / "wingcrack", *arguments],
            cwd=self.place,
            env={**os.environ, **self.environment, **variables},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=_heed_interrupts,
        )

    def call(self, *arguments: str | Path, **variables: str) -> subprocess.CompletedProcess[str]:
        """Run the launcher to its end."""
        with self.start(*arguments, **variables) as process:
            out, error = process.communicate(timeout=300)
        return subprocess.CompletedProcess(process.args, process.returncode, out, error)


def make_tree(folder: Path, packages: str = "", requirements: str = "") -> Tree:
    """Make a tree in a new folder, with its own lists of system and Python packages."""
    root = folder / "tree"
    for name in ("fortran", "cpp_mesh", "cmake", "verification"):
        (root / name).mkdir(parents=True)
    shutil.copy(TOP / "wingcrack", root)
    shutil.copy(TOP / "CMakePresets.json", root)
    shutil.copytree(TOP / "tools", root / "tools")
    (root / "tools" / "system_packages.txt").write_text(packages)
    for use in ("ranks", "tests", "browser"):
        (root / "tools" / f"system_packages_{use}.txt").write_text("")
    (root / "requirements.txt").write_text(requirements)
    for use in ("developer", "study", "water", "maps", "maps_gis", "docs", "browser"):
        (root / f"requirements_{use}.txt").write_text("")
    (root / "CMakeLists.txt").write_text(_PROJECT)
    (root / "cmake" / "assemble.sh").write_text(_ASSEMBLE)
    (root / "fortran" / "a_solver.sh").write_text(_SOLVER)
    # The real command line understands the arguments; what is done with them is replaced.
    for package in ("wingcrack", "wingcrack_verify", "wingcrack_maps"):
        shutil.copytree(TOP / "post" / package, root / "post" / package)
    for file in [*(root / "post").rglob("cli.py"), root / "post/wingcrack/scenes/new.py"]:
        file.write_text(_POST)
    place = folder / "place"
    place.mkdir()
    return Tree(root, place)


def add_environment(tree: Tree) -> None:
    """Make the tree's Python environment beforehand, without pip, which would take seconds."""
    command = ["python3", "-m", "venv", "--without-pip", str(tree.root / ".venv")]
    subprocess.run(command, check=True)


def add_program(folder: Path, name: str, text: str) -> None:
    """Put a shell script into a folder that is to stand on PATH."""
    folder.mkdir(exist_ok=True)
    program = folder / name
    program.write_text(f"#!/bin/bash\n{text}\n")
    program.chmod(0o755)


def asked(machine: Path) -> list[str]:
    """What the stand-in for apt-get was asked."""
    file = machine / "asked"
    return file.read_text().splitlines() if file.exists() else []
