"""Deliberate faults: each of them turns its check red, and only a sound case is green."""

from __future__ import annotations

from pathlib import Path

import pytest

from small_case import CHECKS, SmallCase, small_case
from wingcrack_verify.judge import ERROR, FAILED, GAP, PASSED

PROFILE = "fine/profile.csv"
LAST = "1.0,2.005"  # the last row of the finest result
COMPARING = sorted(set(CHECKS) - {"residual", "monotonic", "at_least", "at_most"})


def replace_last(case: SmallCase, value: str) -> None:
    case.edit(PROFILE, LAST, f"1.0,{value}")


def scale_column(case: SmallCase, factor: float) -> None:
    file = case.results / PROFILE
    head, *rows = file.read_text().split()
    pairs = [row.split(",") for row in rows]
    text = "\n".join(f"{x},{factor * float(p)}" for x, p in pairs)
    file.write_text(f"{head}\n{text}\n")


def only_reason(case: SmallCase) -> str:
    report = case.judge()
    return " ".join([report.broken, *(reason for item in report.checks for reason in item.reasons)])


def test_the_sound_case_passes_every_check(tmp_path: Path) -> None:
    report = small_case(tmp_path).judge()
    assert {check.check.quantity: check.verdict for check in report.checks} == {
        check.check.quantity: PASSED for check in report.checks
    }
    assert len(report.checks) == len(CHECKS)
    assert report.verdict == PASSED


@pytest.mark.parametrize("name", COMPARING)
@pytest.mark.parametrize("factor", [-1.0, 2.0, 0.5, 1.0e-6], ids=["sign", "two", "half", "unit"])
def test_sign_factor_and_unit_fail(tmp_path: Path, name: str, factor: float) -> None:
    case = small_case(tmp_path, name)
    scale_column(case, factor)
    assert case.judge().verdict == FAILED


@pytest.mark.parametrize("factor", [-1.0, 0.5, 1.0e-6], ids=["sign", "half", "unit"])
def test_less_than_the_least_fails(tmp_path: Path, factor: float) -> None:
    case = small_case(tmp_path, "at_least")
    scale_column(case, factor)
    assert case.judge().verdict == FAILED


def test_more_than_the_most_fails(tmp_path: Path) -> None:
    case = small_case(tmp_path, "at_most")
    scale_column(case, 10.0)
    assert case.judge().verdict == FAILED


def test_a_run_is_never_compared_with_itself(tmp_path: Path) -> None:
    case = small_case(tmp_path, "of another run")
    case.toml = case.toml.replace('run = "middle"', 'run = "fine"')
    assert case.judge().verdict == ERROR
    assert "compared with itself" in only_reason(case)


def test_comparing_with_an_unknown_run_is_an_error(tmp_path: Path) -> None:
    case = small_case(tmp_path, "of another run")
    case.toml = case.toml.replace('run = "middle"', 'run = "finest"')
    assert case.judge().verdict == ERROR
    assert "there is no run 'finest'" in only_reason(case)


def test_comparing_with_a_run_that_failed_is_an_error(tmp_path: Path) -> None:
    case = small_case(tmp_path, "of another run")
    case.write_record("middle", status="failed")
    assert case.judge().verdict == ERROR
    assert "has not finished" in only_reason(case)


def test_a_falling_profile_is_not_rising(tmp_path: Path) -> None:
    case = small_case(tmp_path, "monotonic")
    scale_column(case, -1.0)
    assert case.judge().verdict == FAILED


def test_a_dip_is_not_monotonic(tmp_path: Path) -> None:
    case = small_case(tmp_path, "monotonic")
    replace_last(case, "1.5")
    assert case.judge().verdict == FAILED


def test_a_large_residual_fails(tmp_path: Path) -> None:
    case = small_case(tmp_path, "residual")
    case.write_record("fine", mass_error_relative=2.0e-8)
    assert case.judge().verdict == FAILED


@pytest.mark.parametrize("value", ["nan", "inf", ""])
@pytest.mark.parametrize("name", sorted(set(CHECKS) - {"residual", "ratio"}))
def test_a_number_that_is_none_in_the_result_is_an_error(
    tmp_path: Path, name: str, value: str
) -> None:
    case = small_case(tmp_path, name)
    replace_last(case, value)
    assert case.judge().verdict == ERROR
    assert "NaN or infinite" in only_reason(case)


def test_a_nan_between_the_rows_of_an_interpolation_is_an_error(tmp_path: Path) -> None:
    case = small_case(tmp_path, "ratio")
    replace_last(case, "nan")
    assert case.judge().verdict == ERROR


@pytest.mark.parametrize("value", [float("nan"), float("inf"), None, "0", True])
def test_a_residual_that_is_no_number_is_an_error(tmp_path: Path, value: object) -> None:
    case = small_case(tmp_path, "residual")
    case.write_record("fine", mass_error_relative=value)
    assert case.judge().verdict == ERROR


@pytest.mark.parametrize("name", ["relative", "l2_relative"])
def test_a_nan_in_the_reference_is_an_error(tmp_path: Path, name: str) -> None:
    case = small_case(tmp_path, name)
    case.edit("reference.csv", "1.0,2.0", "1.0,nan")
    assert case.judge().verdict == ERROR


def test_a_formula_that_gives_no_number_is_an_error(tmp_path: Path) -> None:
    case = small_case(tmp_path, "max_relative")
    case.toml = case.toml.replace("factor*x**2", "sqrt(x - 0.5)")
    assert case.judge().verdict == ERROR
    assert "NaN" in only_reason(case)


@pytest.mark.parametrize("name", ["absolute", "range"])
def test_a_missing_row_is_an_error(tmp_path: Path, name: str) -> None:
    case = small_case(tmp_path, name)
    case.edit(PROFILE, f"{LAST}\n", "")
    assert case.judge().verdict == ERROR
    assert "no row where x_m = 1.0" in only_reason(case)


def test_rows_beyond_the_reference_are_an_error(tmp_path: Path) -> None:
    case = small_case(tmp_path, "l2_relative")
    case.edit("reference.csv", "1.0,2.0\n", "")
    assert case.judge().verdict == ERROR
    assert "is wanted" in only_reason(case)


def test_a_row_that_stands_twice_is_an_error(tmp_path: Path) -> None:
    for name in ("absolute", "l2_relative"):
        case = small_case(tmp_path / name, name)
        case.edit(PROFILE, f"{LAST}\n", f"{LAST}\n{LAST}\n")
        assert case.judge().verdict == ERROR


def test_a_last_line_that_is_cut_off_is_an_error(tmp_path: Path) -> None:
    case = small_case(tmp_path, "monotonic")
    case.edit(PROFILE, f"{LAST}\n", "1.0")
    assert case.judge().verdict == ERROR
    assert "cut off" in only_reason(case)


@pytest.mark.parametrize("name", COMPARING)
def test_a_missing_column_is_an_error(tmp_path: Path, name: str) -> None:
    case = small_case(tmp_path, name)
    case.edit(PROFILE, "x_m,p_pa", "x_m,q_pa")
    assert case.judge().verdict == ERROR
    assert "'p_pa' is missing" in only_reason(case)


def test_a_missing_file_or_key_is_an_error(tmp_path: Path) -> None:
    case = small_case(tmp_path / "file", "monotonic")
    (case.results / PROFILE).unlink()
    assert case.judge().verdict == ERROR
    case = small_case(tmp_path / "key", "residual")
    case.toml = case.toml.replace("mass_error_relative", "mass_error")
    assert case.judge().verdict == ERROR


@pytest.mark.parametrize(
    ("key", "verdict"),
    [
        ("mass_error_relative*1e-3 + 0*cpu_s", PASSED),
        ("cpu_s + mass_error_relative", FAILED),
        ("mass_error_relative/cpu", ERROR),
        ("mass_error_relative/0", ERROR),
        ("mass_error_relative +", ERROR),
    ],
)
def test_a_key_may_be_arithmetic(tmp_path: Path, key: str, verdict: str) -> None:
    case = small_case(tmp_path, "residual")
    case.toml = case.toml.replace("mass_error_relative", key)
    assert case.judge().verdict == verdict


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('metric = "absolute"', 'metric = "eyeballed"', "'eyeballed' is no metric"),
        ('metric = "absolute"', 'metric = "absolute"\nfudge = 2', "'fudge' is unknown"),
        ("tolerance = 0.02", "tolerence = 0.02", "'tolerance' is missing"),
        ("tolerance = 0.02", "tolerance = nan", "must be a finite number"),
        ('judged = ["fine"]', 'judged = ["finest"]', "no such run"),
        ('judged = ["fine"]', "judged = []", "is empty"),
        ("at = { x_m = 1.0 }", 'at = { x_m = 1.0 }, take = "max"', "exclude each other"),
        ("at = { x_m = 1.0 }", 'take = "median"', "'median' is no take"),
        ('scene = "scene.nml"', 'scene = "other.nml"', "no scene file"),
        ("reference = 2.0", 'reference = "upwards"', "neither"),
        ('quantity = "pressure at the end"\n', "", "'quantity' is missing"),
    ],
)
def test_a_case_that_says_what_nobody_knows_is_an_error(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    case = small_case(tmp_path, "absolute")
    assert old in case.toml
    case.toml = case.toml.replace(old, new)
    assert case.judge().verdict == ERROR
    assert reason in only_reason(case)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("absolute", "tolerance = 0.02", "tolerance = 0.21"),
        ("relative", "tolerance = 0.01", "tolerance = 0.11"),
        ("ratio", "tolerance = 0.02", "tolerance = 0.11"),
        ("max_relative", "tolerance = 0.01", "tolerance = 0.11"),
        ("l2_relative", "tolerance = 0.01", "tolerance = 0.11"),
        ("range", "lower = 1.9", "lower = 1.6"),
        ("monotonic", "tolerance = 1.0e-6", "tolerance = 0.11"),
        ("residual", "tolerance = 1.0e-8", "tolerance = 0.11"),
        ("at_least", "tolerance = 1.0e-6", "tolerance = 0.11"),
        ("at_most", "tolerance = 1.0e-6", "tolerance = 0.11"),
    ],
)
def test_a_tolerance_above_a_tenth_of_the_signal_is_an_error(
    tmp_path: Path, name: str, old: str, new: str
) -> None:
    case = small_case(tmp_path, name)
    assert old in case.toml
    case.toml = case.toml.replace(old, new)
    assert case.judge().verdict == ERROR
    assert "more than a tenth" in only_reason(case)


def test_scale_is_only_for_a_reference_of_zero(tmp_path: Path) -> None:
    case = small_case(tmp_path / "given", "absolute")
    case.toml += "scale = 100.0\n"
    assert case.judge().verdict == ERROR
    case = small_case(tmp_path / "missing", "residual")
    case.toml = case.toml.replace("scale = 1.0\n", "")
    assert case.judge().verdict == ERROR


@pytest.mark.parametrize("expected", ["1.0", "3.0"])
def test_an_order_is_bounded_on_both_sides(tmp_path: Path, expected: str) -> None:
    case = small_case(tmp_path, "l2_relative")
    case.toml = case.toml.replace("expected = 2.0", f"expected = {expected}")
    assert case.judge().verdict == FAILED
    assert "2.00 is not" in only_reason(case)


def test_an_order_needs_two_sizes_and_errors_above_round_off(tmp_path: Path) -> None:
    case = small_case(tmp_path / "sizes", "l2_relative")
    case.toml = case.toml.replace('judged = ["fine"]', 'runs = ["fine"]')
    assert case.judge().verdict == ERROR
    case = small_case(tmp_path / "exact", "l2_relative")
    (case.results / PROFILE).write_text((case.case / "reference.csv").read_text())
    assert case.judge().verdict == ERROR
    assert "round-off" in only_reason(case)


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("echo 'no convergence' >&2; exit 1", "failed: no convergence"),
        ("echo 'bad scene' >&2; exit 2", "refused: bad scene"),
        ("kill -SEGV $$", "crashed: ended by SIGSEGV"),
        ("rm run.json", "failed: run.json says 'nothing'"),
        ("""echo '{"status": "stopped", "cpu_s": 1}' >run.json""", "says 'stopped'"),
        ("""echo '{"status": "finished"}' >run.json""", "no cpu_s"),
    ],
)
def test_a_run_that_does_not_finish_fails_its_checks(
    tmp_path: Path, script: str, reason: str
) -> None:
    case = small_case(tmp_path, "absolute")
    case.ends_with("fine", script)
    assert case.judge().verdict == FAILED
    assert reason in only_reason(case)


def test_a_run_that_takes_too_long_is_ended_and_fails(tmp_path: Path) -> None:
    case = small_case(tmp_path, "absolute")
    case.toml = case.toml.replace("default = true", "default = true\ntime_limit_s = 0.5")
    case.ends_with("fine", "exec sleep 60")
    assert "not done after 0.5 s" in only_reason(case)


def test_an_order_without_one_of_its_runs_fails(tmp_path: Path) -> None:
    case = small_case(tmp_path, "l2_relative")
    case.ends_with("coarse", "exit 1")
    assert case.judge().verdict == FAILED


def test_a_known_gap_never_passes(tmp_path: Path) -> None:
    case = small_case(tmp_path, "absolute")
    case.toml += 'known_gap = "not yet"\n'
    report = case.judge()
    assert report.verdict == GAP
    assert "the mark of a known gap can go" in report.checks[0].reasons[0]
    scale_column(case, 2.0)
    case.forget()
    assert case.judge().verdict == GAP


def test_a_known_gap_excuses_a_run_that_fails_but_no_broken_check(tmp_path: Path) -> None:
    case = small_case(tmp_path, "absolute")
    case.toml = 'known_gap = "does not converge yet"\n' + case.toml
    case.ends_with("fine", "exit 1")
    assert case.judge().verdict == GAP
    case.toml = case.toml.replace('column = "p_pa"', 'column = "q_pa"')
    assert case.judge().verdict == ERROR


def test_a_scene_that_cannot_be_changed_as_asked_is_an_error(tmp_path: Path) -> None:
    case = small_case(tmp_path, "absolute")
    case.toml = case.toml.replace(
        '"scene.name" = "fine"', '"scene.name" = "fine", "side.left.x_traction" = 1.0'
    )
    case.toml += 'known_gap = "no excuse"\n'
    assert case.judge().verdict == ERROR


def test_no_case_at_all_is_red(tmp_path: Path) -> None:
    case = small_case(tmp_path, "absolute")
    (case.case / "README.md").unlink()
    assert case.judge().verdict == ERROR
    assert "README.md is missing" in only_reason(case)
