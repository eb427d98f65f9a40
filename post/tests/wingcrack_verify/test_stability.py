"""Stability trials: what counts as expected, and what is red."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from small_case import SmallCase, lines, small_case
from wingcrack_verify.judge import ERROR, FAILED, GAP, PASSED
from wingcrack_verify.stability import Stability, StabilityReport
from wingcrack_verify.suite import BrokenCase, read_suite

_TOML = """\
title = "Trials"
group = "stability"
source = "none"
scene = "base.nml"
mass_error_limit = 1.0e-8
contact_residual_limit = 1.0e-9

[[trial]]
name = "base"
expect = "converged"
set = { "scene.name" = "good" }

[[trial]]
name = "impossible"
expect = "refused"
set = { "scene.name" = "refused" }

[[map]]
title = "a x b"
set = { "scene.name" = "good" }
x = { label = "a [-]", names = ["m.a"], values = [1.0, 2.0] }
y = { label = "b [-]", names = ["m.b"], values = [1.0, 2.0, 3.0], multiples = { "m.c" = 5.0 } }
"""


@pytest.fixture
def case(tmp_path: Path) -> SmallCase:
    made = small_case(tmp_path, "absolute")
    folder = made.case.parent / "stability"
    folder.mkdir()
    (folder / "README.md").write_text("Trials.\n")
    (folder / "base.nml").write_text("&scene\n  name = 'none'\n/\n")
    (folder / "stability.toml").write_text(_TOML)
    for name in ("good", "refused"):
        (made.results / name).mkdir()
        record(made, name)
        history = lines("time_s,newton_iterations", ["0.0,2", "1.0,4", "2.0,3"])
        (made.results / name / "history.csv").write_text(history)
    made.ends_with("refused", "echo 'no storage' >&2; exit 2")
    return made


def record(case: SmallCase, name: str, **changes: object) -> None:
    good = {
        "status": "finished",
        "cpu_s": 0.1,
        "mass_error_relative": 1.0e-12,
        "contact_residual": 1.0e-14,
        "step_cuts": 1,
    }
    (case.results / name / "run.json").write_text(json.dumps(good | changes))


def judged(case: SmallCase) -> StabilityReport:
    return case.judge_all(("stability",)).stability[0]


def test_what_ends_as_expected_passes(case: SmallCase) -> None:
    report = judged(case)
    assert report.verdict == PASSED
    base, impossible = report.trials
    assert (base.status, base.newton_mean, base.newton_max) == ("converged", 3.0, 4.0)
    assert (base.step_cuts, base.mass_error, base.condition_estimate) == (1.0, 1.0e-12, None)
    assert (impossible.status, impossible.reason) == ("refused", "no storage")
    assert len(report.maps[0].cells) == 6


def test_multiples_follow_their_axis(case: SmallCase) -> None:
    last = judged(case).maps[0].cells[-1].trial.run.set
    assert (last["m.a"], last["m.b"], last["m.c"]) == (2.0, 3.0, 15.0)


@pytest.mark.parametrize(
    "changes",
    [{"mass_error_relative": 2.0e-8}, {"contact_residual": 2.0e-9}, {"status": "failed"}],
)
def test_beyond_the_limits_is_red(case: SmallCase, changes: dict[str, object]) -> None:
    record(case, "good", **changes)
    report = judged(case)
    assert report.trials[0].verdict == FAILED
    assert report.maps[0].verdict == FAILED


@pytest.mark.parametrize("value", [float("nan"), None, "small"])
def test_a_number_that_is_none_is_an_error(case: SmallCase, value: object) -> None:
    record(case, "good", contact_residual=value)
    assert judged(case).trials[0].verdict == ERROR


def test_a_missing_history_is_an_error(case: SmallCase) -> None:
    (case.results / "good" / "history.csv").unlink()
    assert judged(case).trials[0].verdict == ERROR


@pytest.mark.parametrize("script", ["true", "kill -SEGV $$", "exit 1"])
def test_only_a_refusal_with_a_reason_is_a_refusal(case: SmallCase, script: str) -> None:
    case.ends_with("refused", script)
    expected = PASSED if script == "exit 1" else FAILED
    assert judged(case).trials[1].verdict == expected


def test_a_known_gap_is_never_passed(case: SmallCase) -> None:
    file = case.case.parent / "stability" / "stability.toml"
    text = _TOML.replace('title = "a x b"', 'title = "a x b"\nknown_gap = "later"')
    file.write_text(text.replace('name = "base"', 'name = "base"\nknown_gap = "later"'))
    report = judged(case)
    assert (report.trials[0].verdict, report.maps[0].verdict) == (GAP, GAP)


def with_trial(case: SmallCase, text: str) -> None:
    file = case.case.parent / "stability" / "stability.toml"
    file.write_text(_TOML + text)


@pytest.mark.parametrize(
    ("expect", "cause", "verdict"),
    [
        ("refused", "", PASSED),
        ("refused", 'cause = ["storage"]', PASSED),
        ("refused", 'cause = ["gravity", "storage"]', PASSED),
        ("refused", 'cause = ["gravity"]', FAILED),
        ("stopped", 'cause = ["storage"]', FAILED),
        ("settled", 'cause = ["storage"]', PASSED),
        ("settled", 'cause = ["gravity"]', FAILED),
        ("converged", "", FAILED),
    ],
)
def test_a_cause_is_part_of_the_reason(
    case: SmallCase, expect: str, cause: str, verdict: str
) -> None:
    with_trial(
        case,
        f'[[trial]]\nname = "last"\nexpect = "{expect}"\n{cause}\n'
        'set = { "scene.name" = "refused", "m.a" = 3.0 }\n',
    )
    last = judged(case).trials[-1]
    assert (last.trial.run.name, last.verdict) == ("last", verdict), last.reason


def test_what_converges_settles(case: SmallCase) -> None:
    trial = '[[trial]]\nname = "last"\nexpect = "settled"\nset = { "scene.name" = "good" }\n'
    with_trial(case, trial)
    assert judged(case).trials[-1].verdict == PASSED


def test_what_settles_keeps_the_limits(case: SmallCase) -> None:
    trial = '[[trial]]\nname = "last"\nexpect = "settled"\nset = { "scene.name" = "good" }\n'
    with_trial(case, trial)
    record(case, "good", mass_error_relative=1.0)
    assert judged(case).trials[-1].verdict == FAILED


def test_a_trial_stands_for_several(case: SmallCase) -> None:
    with_trial(
        case,
        '[[trial]]\nover.a = [4.0, 5.0]\nname = "a {a:g}"\nexpect = "converged"\n'
        'set = { "scene.name" = "good", "m.a" = "{a}" }\n',
    )
    trials = judged(case).trials[2:]
    assert [(item.trial.run.name, item.trial.run.set["m.a"]) for item in trials] == [
        ("a 4", 4.0),
        ("a 5", 5.0),
    ]


_DRAW = """\
[[draw]]
count = 20
seed = 7
[draw.ranges]
a = { from = 1e-6, to = 1e2, log = true }
b = { from = 2.0, to = -2.0 }
c = { of = [1, 2] }
[draw.trial]
name = "drawn {number}"
expect = "settled"
set = { "scene.name" = "good", "m.a" = "{a}", "m.b" = "{b}", "m.c" = "{c}" }
"""


def test_each_part_of_a_range_is_drawn_from_once(case: SmallCase) -> None:
    with_trial(case, _DRAW)
    values = [item.trial.run.set for item in judged(case).trials[2:]]
    assert len(values) == 20
    decades = sorted(math.log10(item["m.a"]) for item in values)
    assert all(-6.0 + 0.4 * k <= x <= -6.0 + 0.4 * (k + 1) for k, x in enumerate(decades))
    places = sorted(item["m.b"] for item in values)
    assert all(-2.0 + 0.2 * k <= x <= -2.0 + 0.2 * (k + 1) for k, x in enumerate(places))
    assert sorted(item["m.c"] for item in values) == [1] * 10 + [2] * 10
    assert values == [item.trial.run.set for item in judged(case).trials[2:]]  # the seed is fixed


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ("count = 20", "count = 0", "'count' must be a whole number from 1 on"),
        ("from = 1e-6", "from = 0.0", "'log' needs numbers above 0"),
        ("of = [1, 2]", "of = []", "'of' must be a list"),
        ('"{c}"', "3", "nothing uses 'c'"),
        ("seed = 7", "", "'seed' is missing"),
    ],
)
def test_a_draw_that_cannot_be_is_red(case: SmallCase, old: str, new: str, found: str) -> None:
    with_trial(case, _DRAW.replace(old, new))
    report = judged(case)
    assert report.verdict == ERROR
    assert found in report.broken


def test_what_cannot_be_judged_from_files_is_an_error(case: SmallCase) -> None:
    file = case.case.parent / "stability" / "stability.toml"
    file.write_text(_TOML.replace("\n[[trial]]", "from_files = true\n\n[[trial]]", 1))
    report = judged(case)
    assert report.trials[0].trial.run.set["output.vtu"] is True
    assert report.trials[0].verdict == ERROR
    assert report.trials[1].verdict == PASSED  # refused: there are no files


def test_an_unknown_key_is_red(case: SmallCase) -> None:
    file = case.case.parent / "stability" / "stability.toml"
    file.write_text(_TOML.replace("expect =", "expected ="))
    report = judged(case)
    assert report.verdict == ERROR
    assert "'expect' is missing" in report.broken


def test_a_trial_may_be_too_long_for_the_quick_part(case: SmallCase) -> None:
    file = case.case.parent / "stability" / "stability.toml"
    text = _TOML.replace('source = "none"', 'source = "none"\nquick = true')
    drawn = """
[[draw]]
count = 5
quick = 2
seed = 1
ranges = { a = { from = 0.0, to = 1.0 } }
trial = { name = "drawn {number}", expect = "settled", set = { "m.a" = "{a}" } }
"""
    file.write_text(text.replace('expect = "refused"', 'expect = "refused"\nquick = false') + drawn)
    folder = file.parent.parent
    (whole,) = read_suite(folder, ["stability"], quick=False).stability
    (quick,) = read_suite(folder, ["stability"], quick=True).stability
    assert isinstance(whole, Stability) and isinstance(quick, Stability)
    names = [trial.run.name for trial in whole.trials]
    assert names == ["base", "impossible", *(f"drawn {number}" for number in range(1, 6))]
    assert [trial.run.name for trial in quick.trials] == ["base", "drawn 1", "drawn 2"]
    assert quick.trials[1] == whole.trials[2]
    assert quick.maps == whole.maps


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('expect = "', 'quick = false\nexpect = "', "must be quick"),
        ("count = 5", "count = 5\nquick = 6", "at most 'count'"),
        ('group = "stability"', 'group = "cooking"', "is no group"),
    ],
)
def test_a_quick_part_that_is_none_is_an_error(
    case: SmallCase, old: str, new: str, reason: str
) -> None:
    text = _TOML.replace('source = "none"', 'source = "none"\nquick = true')
    drawn = """
[[draw]]
count = 5
seed = 1
ranges = { a = { from = 0.0, to = 1.0 } }
trial = { name = "drawn {number}", expect = "settled", set = { "m.a" = "{a}" } }
"""
    file = case.case.parent / "stability" / "stability.toml"
    text += drawn if "count" in old else ""
    file.write_text(text.replace(old, new))
    (broken,) = read_suite(file.parent.parent, ["stability"], quick=True).stability
    assert isinstance(broken, BrokenCase)
    assert reason in broken.reason
