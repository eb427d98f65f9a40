"""Hold the walks of docs/architecture.md against the code.

A step of a walk is a list item "- `module: procedure`". The procedure has to stand in that module,
the module of the step that it is indented under has to name it, and no step may lie in a room above
that of the step before it: a walk never goes back up. A walk of a number is a heading that ends in
`NAME`; its steps are items "- `module`", each of which has to hold that name.
"""

import re
import sys

from rooms import ROOT, order_of_rooms

HEADING = re.compile(r"^### (.*?)(?:`(\w+)`)?$")
STEP = re.compile(r"^( *)- `(\w+)(?:: (\w+))?`")


def source_of(module: str) -> str | None:
    """The text of a module or of the program without its comments."""
    for path in ROOT.glob(f"fortran/*/{module}.f90"):
        return re.sub(r"!.*", "", path.read_text())
    for path in ROOT.glob(f"fortran/*/program/{module}.f90"):
        return re.sub(r"!.*", "", path.read_text())
    return None


def has_word(word: str, text: str) -> bool:
    """Whether a text holds a word."""
    return re.search(rf"\b{word}\b", text) is not None


def is_named(procedure: str, module: str, caller: str) -> bool:
    """Whether a module names a procedure of another one, or what a type there calls it."""
    bound = re.findall(rf"\b(\w+)\s*=>\s*{procedure}\b", source_of(module) or "")
    text = source_of(caller) or ""
    return has_word(procedure, text) or any(f"%{name}(" in text for name in bound)


def defines(procedure: str, text: str) -> bool:
    """Whether a procedure of this name stands in a module."""
    return re.search(rf"\b(?:subroutine|function)\s+{procedure}\b", text) is not None


def rank(module: str, rooms: list[str]) -> int:
    """The place of a module's room; the program stands above all."""
    room = module.split("_")[0]
    return rooms.index(room) if room in rooms else len(rooms)


class Walks:
    """The faults found so far, and the steps that lead to the present one."""

    def __init__(self) -> None:
        self.rooms = order_of_rooms()
        self.faults: list[str] = []
        self.steps = 0
        self.above: list[tuple[int, str]] = []  # indentation and module

    def step(self, indent: int, module: str, procedure: str | None, number: str | None) -> None:
        """Judge a step by itself and against the one that it is indented under."""
        self.steps += 1
        text = source_of(module)
        if text is None:
            self.faults.append(f"there is no module {module}")
            return
        if procedure is None:
            if number is None or not has_word(number, text):
                self.faults.append(f"{module} does not hold {number}")
            return
        if not defines(procedure, text):
            self.faults.append(f"{module} has no procedure {procedure}")
        while self.above and self.above[-1][0] >= indent:
            self.above.pop()
        if self.above:
            caller = self.above[-1][1]
            if not is_named(procedure, module, caller):
                self.faults.append(f"{caller} does not name {procedure} of {module}")
            if rank(module, self.rooms) > rank(caller, self.rooms):
                self.faults.append(f"from {caller} to {module} the walk goes up")
        self.above.append((indent, module))


def main() -> int:
    """Print the faults of all walks; 1 if there are any."""
    walks = Walks()
    number: str | None = None
    for line in (ROOT / "docs" / "architecture.md").read_text().splitlines():
        if heading := HEADING.match(line):
            number = heading.group(2)
            walks.above.clear()
        elif step := STEP.match(line):
            walks.step(len(step.group(1)), step.group(2), step.group(3), number)
    if walks.steps < 20:
        walks.faults.append("docs/architecture.md has lost its walks")
    for fault in walks.faults:
        print(f"walks: {fault}", file=sys.stderr)
    return 1 if walks.faults else 0


if __name__ == "__main__":
    sys.exit(main())
