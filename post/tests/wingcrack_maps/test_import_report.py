"""The table for the terminal: all faults, and of many notes of one kind the first."""

from __future__ import annotations

import numpy as np

from wingcrack_maps.faults import Fault
from wingcrack_maps.features import Line, Note
from wingcrack_maps.report import Report, terminal_text


def test_of_many_notes_of_one_kind_the_first_is_shown() -> None:
    report = Report("m.csv", 0.1, 5.0, counts={"fractures": 1})
    line = Line("f1", np.array([[0.0, 0.0], [1.0, 0.0]]))
    report.add_faults([Fault("short fracture", (0,), (0.0, 0.25), 0.05)], [line])
    report.add_notes([Note("few", f"few {k}") for k in range(4)])
    report.add_notes([Note("many", f"many {k}") for k in range(5)])
    head, _, fault, _, *notes = terminal_text(report).splitlines()
    assert head.split() == ["fractures", "1"]
    assert fault.split()[:6] == ["left", "short", "fracture", "f1", "(0.00,", "0.25)"]
    assert [" ".join(note.split()[1:]) for note in notes] == [
        "few few 0",
        "few few 1",
        "few few 2",
        "few few 3",
        "many many 0",
        "many and 4 more, in the files",
    ]
