"""Check the dependencies between components: each uses exactly what its CMakeLists.txt lists.

The compiler refuses a `use` of a component that is not listed. This finds the rest: a component
that is listed but not used, one that lists a component after it in the order of the top
CMakeLists.txt, and a C++ file that includes a header of another folder.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
USE = re.compile(r"^\s*use\s+(?:,\s*non_intrinsic\s*::\s*)?([a-z0-9_]+)", re.MULTILINE)
COMPONENT = re.compile(r"add_component\((\w+)(?:\s+THREADS)?(?:\s+USES\s+([^)]*))?\)")
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def order_of_components() -> list[str]:
    """The components, each after those that it may use."""
    found = re.search(r"set\(\s*components\s+([^)]*)\)", (ROOT / "CMakeLists.txt").read_text())
    if found is None:
        raise SystemExit("CMakeLists.txt: no set(components ...)")
    return found.group(1).split()


def listed_components(component: str) -> list[str]:
    """What the component's CMakeLists.txt says that it uses, libraries left out."""
    found = COMPONENT.search((ROOT / "fortran" / component / "CMakeLists.txt").read_text())
    if found is None or found.group(1) != component:
        return []
    return [word for word in (found.group(2) or "").split() if ":" not in word]


def used_components(component: str, components: list[str]) -> set[str]:
    """The components whose modules the sources of a component use."""
    used = set()
    for source in (ROOT / "fortran" / component).glob("*.f90"):
        used |= {module.split("_")[0] for module in USE.findall(source.read_text())}
    return (used & set(components)) - {component}


def faults_of_components(components: list[str]) -> list[str]:
    """What the list of components and their USES do not say, or say in vain."""
    faults = []
    for place, component in enumerate(components):
        listed = set(listed_components(component)) & set(components)
        used = used_components(component, components)
        faults += [
            f"{component} uses {name}, which its USES lacks" for name in sorted(used - listed)
        ]
        faults += [f"{component} lists {name} in USES in vain" for name in sorted(listed - used)]
        faults += [
            f"{component} uses {name}, which stands after it in CMakeLists.txt"
            for name in sorted(used)
            if components.index(name) > place
        ]
        if component != "testing" and "testing" in used:
            faults.append(f"{component} uses testing, which only tests may")
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
    faults = faults_of_components(order_of_components()) + faults_of_includes()
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
