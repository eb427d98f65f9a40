"""Tests that were skipped, with the reasons: from the JUnit files of CTest and pytest in a folder.

`tools/skipped.py FOLDER` lists them. With WINGCRACK_ALL_TESTS=1 in the environment a test that was
skipped is a failure (status 1).
"""

from __future__ import annotations

import ast
import os
import sys
from pathlib import Path
from xml.etree import ElementTree


def skipped(folder: Path) -> dict[str, list[str]]:
    """Tests that were skipped, by reason; each with the file's name, which says who ran it."""
    found: dict[str, list[str]] = {}
    for file in sorted(folder.glob("*.xml")):
        for case in ElementTree.parse(file).iter("testcase"):
            skip = case.find("skipped")
            if skip is None:
                continue
            place = case.get("classname", "")
            name = case.get("name", "")
            whole = f"{place}.{name}" if place and place != name else name
            reason = skip.get("message") or "without a reason"
            if reason == "collection skipped" and skip.text:  # a whole file, by pytest
                reason = str(ast.literal_eval(skip.text)[-1]).removeprefix("Skipped: ")
            found.setdefault(reason, []).append(f"{file.stem}: {whole}")
    return found


def told(found: dict[str, list[str]], all_wanted: bool) -> str:
    """What there is to say of tests that were skipped, in lines."""
    if not found:
        return "no test was skipped"
    count = sum(map(len, found.values()))
    lines = [f"SKIPPED: {count} test{'s' if count > 1 else ''}"]
    for reason, tests in found.items():
        lines += [f"  {reason}", *(f"      {test}" for test in tests)]
    if all_wanted:
        lines.append("WINGCRACK_ALL_TESTS=1 wants them all")
    else:
        lines.append("WINGCRACK_ALL_TESTS=1 ./wingcrack test installs what they take")
    return "\n".join(lines)


if __name__ == "__main__":
    tests_skipped = skipped(Path(sys.argv[1]))
    everything = os.environ.get("WINGCRACK_ALL_TESTS", "0") not in ("", "0")
    print(told(tests_skipped, everything))
    sys.exit(1 if everything and tests_skipped else 0)
