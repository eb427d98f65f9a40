"""Parts of a case, and entries that are like another one: what is read, and every fault."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from small_case import CHECKS, SmallCase, small_case
from wingcrack.sweeps.likes import NAMED_BY
from wingcrack_verify.case import read_case
from wingcrack_verify.contents import Case
from wingcrack_verify.judge import ERROR, FAILED, PASSED
from wingcrack_verify.suite import BrokenCase, read_suite

TOP = Path(__file__).resolve().parents[3]

# A second part, whose checks see its own runs alone.
PART = """
[[part]]
name = "steep"
[part.constants]
factor = 4.0
[part.defaults.run]
scene = "scene.nml"
method = "steep"
[[part.run]]
name = "fine"
default = true
set = { "scene.name" = "fine" }
[[part.check]]
quantity = "largest pressure"
unit = "Pa"
result = { file = "profile.csv", column = "2*p_pa", take = "max" }
reference = { expression = "factor" }
metric = "relative"
tolerance = 0.01
[[part.figure]]
title = "pressure"
x_label = "x [m]"
y_label = "p [Pa]"
lines = [
  { label = "ours", run = "fine", file = "profile.csv", x = "x_m", column = "factor*p_pa" },
  { label = "exact", file = "reference.csv", x = "x_m", column = "factor*p_pa" },
]
"""

# An entry of its own, for others to be like.
LIKE = """
[[check]]
like = "largest pressure"
quantity = "smallest pressure"
result = { take = "min" }
reference = 0.0025
metric = "relative"
"""


def parted_case(root: Path) -> SmallCase:
    """Small case with a part behind what is the file's own."""
    case = small_case(root, "relative")
    case.toml += PART
    return case


def liked_case(root: Path) -> SmallCase:
    """Small case with a check that is like the one before."""
    case = small_case(root, "relative")
    case.toml += LIKE
    return case


def read(case: SmallCase) -> Case:
    """The case as it is read."""
    (case.case / "check.toml").write_text(case.toml)
    return read_case(case.case)


def share(case: SmallCase, text: str) -> None:
    """Write what cases share."""
    (case.case.parent / "like.toml").write_text(text)


def only_reason(case: SmallCase) -> str:
    """All that is wrong with the case."""
    report = case.judge()
    assert report.verdict == ERROR
    return " ".join([report.broken, *(reason for item in report.checks for reason in item.reasons)])


def test_a_part_stands_beside_the_rest_with_its_name_in_front(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    found = read(case)
    assert [run.name for run in found.runs] == ["coarse", "middle", "fine", "steep: fine"]
    first, second = found.checks
    assert (first.quantity, second.quantity) == ("largest pressure", "steep: largest pressure")
    assert (first.judged, second.runs) == (("fine",), ("steep: fine",))
    assert [run.constants["factor"] for run in found.runs] == [2.0, 2.0, 2.0, 4.0]
    report = case.judge()
    assert report.verdict == PASSED
    (figure,) = report.figures
    assert figure.request.title == "steep: pressure"
    assert [line.values.values[-1] for line in figure.lines] == [4.0 * 2.005, 4.0 * 2.0]


def test_a_check_of_a_part_fails_alone(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    case.toml = case.toml.replace('"2*p_pa"', '"3*p_pa"')
    assert [check.verdict for check in case.judge().checks] == [PASSED, FAILED]


def test_a_case_may_be_nothing_but_parts(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    case.toml = case.toml[: case.toml.index("[[run]]")] + PART
    assert [run.name for run in read(case).runs] == ["steep: fine"]
    assert case.judge().verdict == PASSED


def test_a_reference_run_of_a_part_is_one_of_it(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    case.toml = case.toml.replace(
        'reference = { expression = "factor" }',
        'runs = ["fine"]\nreference = { run = "coarse", file = "profile.csv", '
        'column = "2*p_pa", take = "max" }',
    ).replace(
        '[[part.run]]\nname = "fine"',
        '[[part.run]]\nname = "coarse"\nset = { "scene.name" = "coarse" }\n\n'
        '[[part.run]]\nname = "fine"',
    )
    check = read(case).checks[1]
    assert (check.runs, check.reference.other_run) == (("steep: fine",), "steep: coarse")


def test_only_quick_parts_are_part_of_quick(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    case.toml = case.toml.replace('name = "steep"', 'name = "steep"\nquick = false')
    report = case.judge_all(quick=True).cases[0]
    assert [check.check.quantity for check in report.checks] == ["largest pressure"]
    assert len(case.calls) == 3


def test_only_quick_runs_are_part_of_quick(tmp_path: Path) -> None:
    case = liked_case(tmp_path)
    case.toml = case.toml.replace("size = 0.2", "size = 0.2\nquick = false")
    report = case.judge_all(quick=True).cases[0]
    assert [item.run.name for item in report.checks[0].measured] == ["middle", "fine"]
    assert len(case.calls) == 2
    case.toml = case.toml.replace("size = 0.05", "size = 0.05\nquick = false")
    assert case.judge_all(quick=True).cases[0].checks == ()


def test_a_case_without_quick_parts_is_no_part_of_quick(tmp_path: Path) -> None:
    case = small_case(tmp_path, "relative")
    case.toml = case.toml.replace("quick = true\n", "")
    (case.case / "check.toml").write_text(case.toml)
    assert not read_case(case.case).quick


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('name = "steep"', "", "part 1: 'name' is missing"),
        ('name = "steep"', 'name = "steep"\nfudge = 1', "part 'steep': check.toml: 'fudge' is unk"),
        ("[[part.check]]", "[[part.checks]]", "'checks' is unknown; did you mean 'check'?"),
        ("[[part.run]]", "[[part.runs]]", "part 'steep': check.toml: 'runs' is unknown; did you"),
        (PART, "[[part]]\nname = 'steep'\n", "part 'steep': check.toml: a case needs at least"),
        ("[[part]]", "[part]", "'part' must be a list of tables"),
        ('run = "fine"', 'run = "middle"', "part 'steep': figure 'pressure': line 1: there is no"),
        ("[part.defaults.run]", "[part.defaults.runs]", "defaults: 'runs' is unknown"),
        ("[part.constants]", "[part.defaults.check]\nscale = 1.0\n[part.constants]", "scale"),
        (
            "[part.constants]",
            "[part.defaults.figure]\nx_label = 'x'\n[part.constants]",
            "part 'steep': defaults.figure: no figure needs 'x_label'",
        ),
    ],
)
def test_a_part_that_cannot_be_read_is_an_error(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    case = parted_case(tmp_path)
    assert old in PART
    case.toml = case.toml.replace(PART, PART.replace(old, new, 1))
    assert reason in only_reason(case)


def test_names_of_two_parts_may_not_be_the_same(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    case.toml += PART
    assert "the run 'steep: fine' stands twice" in only_reason(case)


def test_parts_share_the_defaults_and_constants_of_the_file(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    case.toml = (
        case.toml.replace("[part.constants]\nfactor = 4.0\n", "")
        .replace('metric = "relative"\n', "")
        .replace("factor = 2.0\n", 'factor = 2.0\n\n[defaults.check]\nmetric = "relative"\n')
    )
    found = read(case)
    assert [check.metric for check in found.checks] == ["relative", "relative"]
    assert found.runs[-1].constants == {"factor": 2.0}


def test_a_check_takes_what_it_does_not_say_from_the_one_that_it_is_like(tmp_path: Path) -> None:
    case = liked_case(tmp_path)
    first, second = read(case).checks
    assert (second.unit, second.judged, second.tolerance) == ("Pa", ("fine",), first.tolerance)
    assert (second.result.take, second.result.column) == ("min", first.result.column)
    assert case.judge().verdict == PASSED


def test_a_check_can_be_like_one_that_is_like_another(tmp_path: Path) -> None:
    case = liked_case(tmp_path)
    case.toml += '[[check]]\nlike = "smallest pressure"\nquantity = "again"\ntolerance = 0.02\n'
    check = read(case).checks[2]
    assert (check.result.take, check.tolerance, check.unit) == ("min", 0.02, "Pa")


def test_known_gaps_and_defaults_are_those_of_one_entry(tmp_path: Path) -> None:
    case = liked_case(tmp_path)
    case.toml = case.toml.replace("[[check]]", '[[check]]\nknown_gap = "reason"', 1)
    case.toml = case.toml.replace(
        "[[check]]", '[[run]]\nlike = "fine"\nname = "finer"\n\n[[check]]', 1
    )
    found = read(case)
    assert [check.known_gap for check in found.checks] == ["reason", None]
    assert [run.default for run in found.runs[2:]] == [True, False]
    assert found.runs[3].set == {"scene.name": "fine"}


def test_cases_share_entries(tmp_path: Path) -> None:
    case = small_case(tmp_path, "relative")
    share(case, CHECKS["residual"] + '\n[[check]]\nlike = "mass error"\nquantity = "tighter"\n')
    case.toml += '\n[[check]]\nlike = "mass error"\n\n[[check]]\nlike = "tighter"\n'
    assert [check.quantity for check in read(case).checks[1:]] == ["mass error", "tighter"]
    assert case.judge().verdict == PASSED


def test_an_entry_can_be_like_a_shared_one_of_its_own_name(tmp_path: Path) -> None:
    case = small_case(tmp_path, "relative")
    share(case, CHECKS["residual"])
    case.toml += '\n[[check]]\nlike = "mass error"\nquantity = "mass error"\ntolerance = 1e-9\n'
    assert read(case).checks[1].tolerance == 1e-9


def test_a_part_can_be_like_the_rest_of_the_file(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    case.toml += '\n[[part.check]]\nlike = "largest pressure"\nquantity = "b"\ntolerance = 0.02\n'
    case.toml += '\n[[part.check]]\nlike = "b"\nquantity = "c"\n'
    second, third = read(case).checks[2:]
    assert (second.reference.expression, third.tolerance) == ("factor", 0.02)  # the part's own
    assert third.runs == ("steep: fine",)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (
            'like = "largest pressure"',
            'like = "larges pressure"',
            "check.toml: check 2: like: no other check 'larges pressure' is in check.toml or "
            "like.toml; did you mean 'largest pressure'?",
        ),
        (
            'like = "largest pressure"',
            'like = "smallest pressure"',
            "check.toml: check 2: like: no other check 'smallest pressure' is in",
        ),
        ('like = "largest pressure"', "like = 1", "check 2: like must be a text, the quantity of"),
        ('like = "largest pressure"', 'like = "fine"', "no other check 'fine' is in check.toml"),
        ('quantity = "smallest pressure"', "", "the quantity 'largest pressure' stands twice"),
        (
            "[[check]]",
            '[[check]]\nlike = "b"\nquantity = "a"\n\n[[check]]\nlike = "a"\nquantity = "b"\n\n'
            "[[check]]",
            "check.toml: check 2: like: the check 'a' is, in the end, like itself",
        ),
        (
            "[[check]]",
            '[[check]]\nquantity = "largest pressure"\n\n[[check]]',
            "check.toml: check 3: like: 2 entries are a check 'largest pressure'",
        ),
        ("[[check]]", '[[figure]]\nlike = "fine"\n[[check]]', "figure 1: like: no other figure"),
        ("[[check]]", '[[run]]\nlike = "far"\n[[check]]', "run 4: like: no other run 'far' is in"),
    ],
)
def test_an_entry_that_is_like_none_is_an_error(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    case = liked_case(tmp_path)
    assert old in LIKE
    case.toml = case.toml.replace(LIKE, LIKE.replace(old, new, 1))
    assert reason in only_reason(case)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[[check]\n", "like.toml: "),
        ("[[checks]]\nquantity = 'a'\n", "like.toml: 'checks' is unknown; there are: run, sweep"),
        ("[[check]]\nunit = 'Pa'\n", "like.toml: check 1: 'quantity' must be a text"),
    ],
)
def test_shared_entries_that_cannot_be_read_are_an_error(
    tmp_path: Path, text: str, reason: str
) -> None:
    case = small_case(tmp_path, "relative")
    share(case, text)
    assert reason in only_reason(case)


def test_defaults_of_figures_complete_them(tmp_path: Path) -> None:
    case = parted_case(tmp_path)
    case.toml = case.toml.replace('x_label = "x [m]"\n', "").replace(
        "[part.constants]", '[part.defaults.figure]\nx_label = "x"\n[part.constants]'
    )
    assert read(case).figures[0].x_label == "x"


def test_all_cases_can_be_read_and_every_shared_entry_is_used() -> None:
    suite = read_suite(TOP / "verification", (), quick=False)
    items = (*suite.cases, *suite.stability)
    assert [item.reason for item in items if isinstance(item, BrokenCase)] == []
    texts = [path.read_text() for path in (TOP / "verification").glob("*/*.toml")]
    shared = tomllib.loads((TOP / "verification" / "like.toml").read_text())
    for kind, entries in shared.items():
        for entry in entries:
            name = entry[NAMED_BY[kind]]
            assert any(f'like = "{name}"' in text for text in texts), f"nobody is like '{name}'"
