"""Check the call sequences of docs/architecture.md against the code.

A step is a list item "- `module: procedure`". The procedure must be defined in that module, the
module of the step under which it is indented must name it, and no step may be in a component above
that of the step before. The sequence of a number is a heading that ends in `NAME`; its steps are
items "- `module`", each of which must contain that name.
"""

import re
import sys

from components import ROOT, order_of_components

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
    return bool(re.search(rf"\b(?:subroutine|function|module procedure)\s+{procedure}\b", text))


def rank(module: str, components: list[str]) -> int:
    """The place of a module's component; the program stands above all."""
    component = module.split("_")[0]
    return components.index(component) if component in components else len(components)


class CallSequences:
    """The faults found so far, and the steps that lead to the present one."""

    def __init__(self) -> None:
        self.components = order_of_components()
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
            if rank(module, self.components) > rank(caller, self.components):
                self.faults.append(f"from {caller} to {module} the call sequence goes up")
        self.above.append((indent, module))


def main() -> int:
    """Print the faults of all call sequences; 1 if there are any."""
    sequences = CallSequences()
    number: str | None = None
    for line in (ROOT / "docs" / "architecture.md").read_text().splitlines():
        if heading := HEADING.match(line):
            number = heading.group(2)
            sequences.above.clear()
        elif step := STEP.match(line):
            sequences.step(len(step.group(1)), step.group(2), step.group(3), number)
    if sequences.steps < 20:
        sequences.faults.append("docs/architecture.md has lost its call sequences")
    for fault in sequences.faults:
        print(f"call sequences: {fault}", file=sys.stderr)
    return 1 if sequences.faults else 0


if __name__ == "__main__":
    sys.exit(main())
