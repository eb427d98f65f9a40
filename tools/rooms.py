"""Hold the arrows between rooms: what each room uses is what its CMakeLists.txt lists.

The compiler refuses a `use` of a room that is not listed. This finds the rest: a room that is
listed in vain, a room that lists one standing after it in the order of the top CMakeLists.txt (a
circle), and a C++ file that includes a header of a folder which is not its own.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
USE = re.compile(r"^\s*use\s+(?:,\s*non_intrinsic\s*::\s*)?([a-z0-9_]+)", re.MULTILINE)
ROOM = re.compile(r"add_room\((\w+)(?:\s+THREADS)?(?:\s+USES\s+([^)]*))?\)")
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def order_of_rooms() -> list[str]:
    """The rooms, each after those that it may use."""
    found = re.search(r"set\(\s*rooms\s+([^)]*)\)", (ROOT / "CMakeLists.txt").read_text())
    if found is None:
        raise SystemExit("CMakeLists.txt: no set(rooms ...)")
    return found.group(1).split()


def listed_rooms(room: str) -> list[str]:
    """What the room's CMakeLists.txt says that it uses, libraries left out."""
    found = ROOM.search((ROOT / "fortran" / room / "CMakeLists.txt").read_text())
    if found is None or found.group(1) != room:
        return []
    return [word for word in (found.group(2) or "").split() if ":" not in word]


def used_rooms(room: str, rooms: list[str]) -> set[str]:
    """The rooms whose modules the sources of a room use."""
    used = set()
    for source in (ROOT / "fortran" / room).glob("*.f90"):
        used |= {module.split("_")[0] for module in USE.findall(source.read_text())}
    return (used & set(rooms)) - {room}


def faults_of_rooms(rooms: list[str]) -> list[str]:
    """What the list of rooms and their USES do not say, or say in vain."""
    faults = []
    for place, room in enumerate(rooms):
        listed = set(listed_rooms(room)) & set(rooms)
        used = used_rooms(room, rooms)
        faults += [f"{room} uses {name}, which its USES lacks" for name in sorted(used - listed)]
        faults += [f"{room} lists {name} in USES in vain" for name in sorted(listed - used)]
        faults += [
            f"{room} uses {name}, which stands after it in CMakeLists.txt"
            for name in sorted(used)
            if rooms.index(name) > place
        ]
        if room != "testing" and "testing" in used:
            faults.append(f"{room} uses testing, which only tests may")
    return faults


def faults_of_includes() -> list[str]:
    """The mesh library is C++; its own folder and its public header are all it includes."""
    own = {path.name for path in (ROOT / "cpp_mesh" / "src").glob("*.hpp")}
    faults = []
    for source in sorted((ROOT / "cpp_mesh" / "src").glob("*.?pp")):
        for header in INCLUDE.findall(source.read_text()):
            if header not in own and not header.startswith("cpp_mesh/"):
                faults.append(f"{source.name} includes {header}, which is not of this library")
    return faults


def main() -> int:
    """Print the faults; 1 if there are any."""
    faults = faults_of_rooms(order_of_rooms()) + faults_of_includes()
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
