"""Sweeps, checks over lists, patterns of names, defaults: what they expand to, and every fault."""

from __future__ import annotations

from pathlib import Path

import pytest

from small_case import CHECKS, SmallCase, small_case
from wingcrack_verify.case import read_case
from wingcrack_verify.contents import Case
from wingcrack_verify.judge import ERROR, FAILED, PASSED

# The first two runs of the small case, as a sweep; the third stays.
SWEEP = """\
[[sweep]]
over.run = { run = ["coarse", "middle"], size = [0.2, 0.1] }
name = "{run}"
method = "plain"
scene = "scene.nml"
set = { "scene.name" = "{run}" }

"""

# A profile has a place per row, as tips.csv has a tip.
PER_PLACE = """\
[[check]]
over.place = [
  { place = 1.0, where = "the end", reference = 2.0 },
  { place = 0.5, where = "half way", reference = "{factor}", factor = 0.5, tolerance = 0.01 },
]
quantity = "pressure at {where}, {place:.2f} m"
unit = "Pa"
judged = ["f*"]
result = { file = "profile.csv", column = "p_pa", at = { x_m = "{place}" } }
metric = "absolute"
tolerance = 0.02
"""

HEAD = CHECKS["absolute"]


def swept_case(root: Path, *checks: str) -> SmallCase:
    """Small case with a sweep among its runs."""
    case = small_case(root, "absolute")
    start, fine = case.toml.index("[[run]]"), case.toml.index('[[run]]\nname = "fine"')
    first_check = case.toml.index("[[check]]")
    own = "\n".join(checks) or case.toml[first_check:]
    case.toml = case.toml[:start] + SWEEP + case.toml[fine:first_check] + own
    return case


def read(case: SmallCase) -> Case:
    """The case as it is read."""
    (case.case / "check.toml").write_text(case.toml)
    return read_case(case.case)


def only_reason(case: SmallCase) -> str:
    """All that is wrong with the case."""
    report = case.judge()
    return " ".join([report.broken, *(reason for item in report.checks for reason in item.reasons)])


def test_a_sweep_reads_as_the_runs_that_it_stands_for(tmp_path: Path) -> None:
    swept = read(swept_case(tmp_path / "swept"))
    plain = read(small_case(tmp_path / "plain", "absolute"))
    for one, other in zip(swept.runs, plain.runs, strict=True):
        assert (one.name, one.method, one.size, one.default, one.set) == (
            other.name,
            other.method,
            other.size,
            other.default,
            other.set,
        )
    assert swept.checks == plain.checks


def test_a_sweep_is_a_product_and_its_last_axis_changes_first(tmp_path: Path) -> None:
    case = swept_case(tmp_path)
    case.toml = case.toml.replace(
        'over.run = { run = ["coarse", "middle"], size = [0.2, 0.1] }\nname = "{run}"',
        'over.run = ["a", { run = "b", set = { "fe.order" = 2 } }]\n'
        "over.cells = [4, { cells = 8, size = 0.5 }]\n"
        'name = "{run}, {cells:d} cells of {100/cells:g} %"\n'
        'constants = { cells = "{cells}", width = "{1/cells}" }',
    ).replace('set = { "scene.name" = "{run}" }', 'set = { "scene.name" = "{run}" }\nunset = []')
    runs = read(case).runs[:4]
    assert [run.name for run in runs] == [
        "a, 4 cells of 25 %",
        "a, 8 cells of 12.5 %",
        "b, 4 cells of 25 %",
        "b, 8 cells of 12.5 %",
    ]
    assert [run.size for run in runs] == [None, 0.5, None, 0.5]
    assert runs[1].constants == {"factor": 2.0, "size": 0.5, "cells": 8.0, "width": 0.125}
    assert runs[3].set == {"scene.name": "b", "fe.order": 2}


def test_a_check_per_place_has_its_own_reference_and_tolerance(tmp_path: Path) -> None:
    case = swept_case(tmp_path, PER_PLACE)
    checks = read(case).checks
    assert [check.quantity for check in checks] == [
        "pressure at the end, 1.00 m",
        "pressure at half way, 0.50 m",
    ]
    assert [check.reference.numbers for check in checks] == [(2.0,), (0.5,)]
    assert [check.tolerance for check in checks] == [0.02, 0.01]
    assert [check.judged for check in checks] == [("fine",), ("fine",)]
    assert case.judge().verdict == PASSED


def test_each_check_of_a_list_can_fail_alone(tmp_path: Path) -> None:
    case = swept_case(tmp_path, PER_PLACE)
    case.edit("fine/profile.csv", "1.0,2.005", "1.0,2.5")
    assert [check.verdict for check in case.judge().checks] == [FAILED, PASSED]


def test_a_place_that_no_row_has_is_an_error(tmp_path: Path) -> None:
    case = swept_case(tmp_path, PER_PLACE.replace("place = 0.5", "place = 0.55"))
    assert [check.verdict for check in case.judge().checks] == [PASSED, ERROR]
    assert "no row where" in only_reason(case)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('run = ["coarse", "middle"]', "run = []", "sweep 1: over.run.run must be a list of at"),
        ('["coarse", "middle"], size', '["coarse"], size', "equally long (run has 1, size has 2)"),
        ("over.run = {", "over.run = [] #", "sweep 1: over.run must be a list of at least one"),
        ("over.run = {", "over = {} #", "sweep 1: over must be a table of lists"),
        ("over.run = {", "#", "a [[sweep]] needs 'over'"),
        ("[[sweep]]", "[[run]]", "a [[run]] has none"),
        ("[[sweep]]", "[[sweeps]]", "'sweeps' is unknown"),
        ("size = [0.2, 0.1]", "sise = [0.2, 0.1]", "sweep 1: over: nothing uses 'sise'"),
        (
            'name = "{run}"',
            'name = "{runs}"',
            "'runs' in '{runs}' is no name here (there are: run, size)",
        ),
        ('name = "{run}"', 'name = "{run"', "a brace in '{run' has no partner"),
        ('name = "{run}"', 'name = "{}"', "a brace in '{}' has no partner"),
        ('name = "{run}"', 'name = "one"', "the run 'one' stands twice"),
        ('name = "{run}"', 'name = "{run:.2f}"', "'.2f' is no format for 'run'"),
        ('name = "{run}"', 'name = "{run:2000000000}"', "is no format for 'run'"),
        ('name = "{run}"', 'name = "{1/(size - 0.2)}"', "is inf"),
        ('name = "{run}"', 'name = "{2*run}"', "'run' in '{2*run}' is no number"),
        ('name = "{run}"', 'name = "{size +}"', "is no arithmetic expression"),
        ('name = "{run}"', 'name = "{run}*"', "are for patterns of names"),
        ('name = "{run}"', 'name = "{run}"\nfudge = 1', "'fudge' is unknown"),
        ("name = ", 'over.more = [{ run = "a" }]\nname = ', "two axes give 'run'"),
    ],
)
def test_a_sweep_that_cannot_be_expanded_is_an_error(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    case = swept_case(tmp_path)
    assert old in case.toml
    case.toml = case.toml.replace(old, new, 1)
    assert case.judge().verdict == ERROR
    assert reason in only_reason(case)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('judged = ["f*"]', 'judged = ["g*"]', "names 'g*', which is no such run"),
        ('judged = ["f*"]', 'judged = ["f*", "!fine"]', "'judged' is empty"),
        ('judged = ["f*"]', 'judged = ["fine", "!middle"]', "takes away '!middle'"),
        ('judged = ["f*"]', 'judged = ["fine", "!last"]', "names '!last', which is no such run"),
        ('judged = ["f*"]', 'judged = ["f"]', "names 'f', which is no such run"),
        ('where = "half way", ', "", "'where' in '{where}' is no name here"),
        ('where = "half way"', 'where = "half way", tolerence = 1', "nothing uses 'tolerence'"),
        ("factor = 0.5", 'factor = "half"', "'half' is neither"),
        ("{where}, ", "", "nothing uses 'where'"),
        ("{where}, {place:.2f} m", "{factor}", "'factor' in '{factor}' is no name here"),
        ("over.place = [", "over.place = []\nover.other = [", "over.place must be a list"),
        ("over.place = [", "places = [", "is no name here (there are: none)"),
    ],
)
def test_a_check_over_a_list_that_cannot_be_expanded_is_an_error(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    case = swept_case(tmp_path, PER_PLACE)
    assert old in case.toml
    case.toml = case.toml.replace(old, new, 1)
    assert case.judge().verdict == ERROR
    assert reason in only_reason(case)


def test_patterns_choose_runs_in_their_order(tmp_path: Path) -> None:
    checks = [
        HEAD.replace("pressure at the end", name).replace('judged = ["fine"]', f"runs = {runs}")
        for name, runs in (
            ("all", '["*"]'),
            ("two", '["fine", "c*"]'),
            ("without", '["*", "!*d*e"]'),
            ("ends", '["*e"]'),
        )
    ]
    case = read(swept_case(tmp_path, *checks))
    assert [check.runs for check in case.checks] == [
        ("coarse", "middle", "fine"),
        ("coarse", "fine"),
        ("coarse", "fine"),
        ("coarse", "middle", "fine"),
    ]


DEFAULTS = """\
[defaults.run]
method = "plain"
scene = "scene.nml"
set = { "scene.remark" = "of the defaults" }

[defaults.check]
metric = "absolute"
result = { file = "profile.csv" }

"""


def test_defaults_complete_what_is_not_given(tmp_path: Path) -> None:
    case = swept_case(tmp_path)
    case.toml = (
        case.toml.replace('method = "plain"\nscene = "scene.nml"\n', "", 1)
        .replace('metric = "absolute"\n', "")
        .replace('file = "profile.csv", ', "")
        .replace("[[sweep]]", DEFAULTS + "[[sweep]]")
    )
    found = read(case)
    assert found.runs[0].set == {"scene.remark": "of the defaults", "scene.name": "coarse"}
    assert found.checks[0].metric == "absolute"
    assert found.checks[0].result.file == "profile.csv"
    assert case.judge().verdict == PASSED


@pytest.mark.parametrize(
    ("defaults", "reason"),
    [
        ("[defaults.check]\ntolerance = 0.02", "defaults.check: no check needs 'tolerance'"),
        ("[defaults.check]\nfudge = 2", "'fudge' is unknown"),
        ("[defaults.check]\nscale = 2.0", "scale"),
        ("[defaults.run]\nprogram = 'none'", "either 'scene' or 'program'"),
        ("[defaults.runs]\nmethod = 'plain'", "'runs' is unknown"),
        ("[defaults.run]\nmethod = '{run}'", "defaults.run: no run needs 'method'"),
    ],
)
def test_a_default_that_nobody_needs_or_knows_is_an_error(
    tmp_path: Path, defaults: str, reason: str
) -> None:
    case = swept_case(tmp_path)
    case.toml = case.toml.replace("[[sweep]]", f"{defaults}\n\n[[sweep]]")
    assert case.judge().verdict == ERROR
    assert reason in only_reason(case)


FIGURE = """
[[figure]]
over.what = [
  { title = "pressure", column = "p_pa" },
  { title = "twice the pressure", column = "2*p_pa" },
]
x_label = "x [m]"
y_label = "p [Pa]"
lines = [
  { label = "reference", file = "reference.csv", x = "x_m", column = "{column}" },
  { over = { run = ["middle", "fine"] }, label = "{run}", column = "{column}", FROM },
]
""".replace("FROM", 'file = "profile.csv", x = "x_m"')


def test_figures_and_their_lines_can_be_lists(tmp_path: Path) -> None:
    case = swept_case(tmp_path)
    case.toml += FIGURE
    figures = read(case).figures
    assert [figure.title for figure in figures] == ["pressure", "twice the pressure"]
    assert [line.run for line in figures[1].lines] == [None, "middle", "fine"]
    assert [line.all_columns for line in figures[1].lines] == [("2*p_pa",)] * 3
    assert case.judge().verdict == PASSED


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('run = ["middle", "fine"]', "run = []", "figure 1: a line: over.run must be a list"),
        ('run = ["middle", "fine"]', 'run = ["finest"]', "there is no run 'finest'"),
        ('run = ["middle", "fine"]', 'column = ["p_pa"]', "'column' is given around it already"),
        ('column = "2*p_pa"', 'column = "2*p_pa", unused = 1', "nothing uses 'unused'"),
    ],
)
def test_a_figure_that_cannot_be_expanded_is_an_error(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    case = swept_case(tmp_path)
    assert old in FIGURE
    case.toml += FIGURE.replace(old, new)
    assert case.judge().verdict == ERROR
    assert reason in only_reason(case)
