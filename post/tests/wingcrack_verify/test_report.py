"""The files of the report, and the exit status."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from small_case import CHECKS, SmallCase, small_case
from wingcrack.command_line import main
from wingcrack_verify import report as report_module
from wingcrack_verify.judge import ERROR

INSTALLED = report_module.BROWSERS


@pytest.fixture(scope="module", autouse=True)
def no_browser() -> Iterator[None]:
    """Find no browser, whether there is one or not: printing takes seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_module, "BROWSERS", ())
        yield


@pytest.fixture
def case(tmp_path: Path) -> SmallCase:
    return small_case(tmp_path, "absolute", "ratio", "l2_relative")


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the report of a sound case, which several tests read."""
    case = small_case(tmp_path_factory.mktemp("sound"), "absolute", "ratio", "l2_relative")
    with (case.case / "README.md").open("a") as file:
        file.write("\nSee [the scene](scene.nml) <script>alert(1)</script>.\n")
    assert verify(case) == 0
    return case.root / "report"


def verify(case: SmallCase, *arguments: str) -> int:
    (case.case / "check.toml").write_text(case.toml)
    root = case.root
    places = [
        word
        for name, folder in (
            ("cases", "verification"),
            ("build", "build"),
            ("cache", "cache"),
            ("report", "report"),
        )
        for word in (f"--{name}", str(root / folder))
    ]
    return main(["verify", *arguments, *places])


def test_a_sound_case_gives_a_green_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = small_case(tmp_path)
    assert verify(case) == 0
    counts = f"{len(CHECKS)} passed, 0 known gap, 0 failed, 0 error; 3 runs"
    assert counts in capsys.readouterr().out
    page = (case.root / "report" / "index.html").read_text()
    assert '<div class="banner passed">' in page
    record = json.loads((case.root / "report" / "report.json").read_text())
    assert record["verdict"] == "passed"
    assert record["counts"] == {"passed": len(CHECKS), "known gap": 0, "failed": 0, "error": 0}
    row = next(row for row in record["summary"] if row["quantity"] == "pressure at the end")
    assert (row["error"], row["tolerance"]) == ("0.005 Pa", "0.02 Pa")
    assert row["cpu_s"] == pytest.approx(0.2)


def test_the_page_needs_nothing_else_and_its_links_lead_somewhere(report: Path) -> None:
    page = (report / "index.html").read_text()
    assert not re.search(r"https?://", page)
    assert page.count("<script") == 1  # our own; words of a case are never code
    assert "alert(1)</script" not in page
    assert all(source.startswith("data:") for source in re.findall(r'src="([^"]*)"', page))
    targets = re.findall(r'href="([^"]*)"', page)
    assert "../verification/parabola/scene.nml" in targets
    for target in targets:
        if target.startswith("#"):
            assert f'id="{target[1:]}"' in page
        else:
            assert (report / target).exists()


def test_the_report_says_what_the_errors_cost(report: Path) -> None:
    record = json.loads((report / "report.json").read_text())
    (settings,) = record["settings"]
    # size^2 |1 + x| over |2 x^2|: 1.7 times size^2, in all three runs
    runs = [item["setting"] and item["setting"]["run"] for item in settings["targets"]]
    assert runs == ["middle", "fine", None]
    assert settings["default"]["run"] == "fine"
    (order,) = next(
        check["orders"] for check in record["cases"][0]["checks"] if check["quantity"] == "profile"
    )
    assert order["observed"] == pytest.approx(2.0)


def test_the_readme_is_rendered(report: Path) -> None:
    page = (report / "index.html").read_text()
    assert "<h3>Parabola</h3>" in page
    assert "<td>2</td>" in page


def test_a_failure_is_red_at_the_top_and_exits_with_1(
    case: SmallCase, capsys: pytest.CaptureFixture[str]
) -> None:
    case.toml = case.toml.replace("reference = 2.0", "reference = 3.0")
    assert verify(case) == 1
    page = (case.root / "report" / "index.html").read_text()
    assert '<div class="banner failed">' in page
    assert "FAILED  parabola: pressure at the end" in capsys.readouterr().out


def test_a_broken_case_is_red_and_exits_with_1(case: SmallCase) -> None:
    case.toml = "title = 3"
    assert verify(case) == 1
    page = (case.root / "report" / "index.html").read_text()
    assert '<div class="banner error">' in page
    assert "must be a text" in page


def test_a_known_gap_is_said_and_not_passed(case: SmallCase) -> None:
    case.toml = 'known_gap = "not built yet"\n' + case.toml
    assert verify(case) == 0
    record = json.loads((case.root / "report" / "report.json").read_text())
    assert record["counts"]["passed"] == 0
    page = (case.root / "report" / "index.html").read_text()
    assert '<div class="banner known-gap">' in page
    assert "not built yet" in page


def test_an_infinite_error_is_still_json(case: SmallCase) -> None:
    case.toml = case.toml.replace('column = "factor*x_m**2"', 'column = "-factor*x_m**2"')
    assert verify(case) == 1
    text = (case.root / "report" / "report.json").read_text()
    assert "Infinity" not in text
    assert "NaN" not in text


def test_quick_leaves_the_long_cases_out(case: SmallCase) -> None:
    case.toml = case.toml.replace("quick = true", "quick = false")
    assert verify(case, "--quick") == 2
    assert verify(case) == 0


def test_quick_draws_what_did_not_pass(case: SmallCase, capsys: pytest.CaptureFixture[str]) -> None:
    assert verify(case, "--quick") == 0
    assert "report.pdf" not in capsys.readouterr().out
    assert '<svg viewBox="' not in (case.root / "report" / "index.html").read_text()
    case.toml = case.toml.replace("expected = 2.0", "expected = 1.0")
    assert verify(case, "--quick") == 1
    drawn = (case.root / "report" / "index.html").read_text().count('<svg viewBox="')
    assert verify(case) == 1
    whole = (case.root / "report" / "index.html").read_text().count('<svg viewBox="')
    assert 0 < drawn <= whole


@pytest.mark.parametrize("arguments", [["no_such_case"], ["--jobs", "0"], ["--fast"]])
def test_bad_usage_exits_with_2(
    case: SmallCase, arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        status = verify(case, *arguments)
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 1
    assert status == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not (case.root / "report").exists()


def test_without_a_solver_it_exits_with_3(case: SmallCase) -> None:
    (case.root / "build" / "fortran" / "app" / "wingcrack-solver").unlink()
    assert verify(case) == 3


def test_without_a_browser_a_sentence_says_what_is_missing(
    case: SmallCase, capsys: pytest.CaptureFixture[str]
) -> None:
    printed = case.root / "report" / "report.pdf"
    printed.parent.mkdir()
    printed.write_bytes(b"of an earlier report")
    assert verify(case) == 0
    assert not printed.exists()
    assert capsys.readouterr().out.splitlines()[-2] == (
        "no report.pdf was written: printing it takes Chromium or Chrome"
        " (Debian: apt install chromium)."
    )


@pytest.mark.parametrize(
    ("does", "told"), [("cp {page} {target}", ""), ("exit 3", "ended with 3."), ("true", "with 0.")]
)
def test_a_browser_prints_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, does: str, told: str
) -> None:
    browser = tmp_path / "browser"
    does = does.format(page='"${!#}"', target='"$target"')
    browser.write_text(
        "#!/bin/bash\n"
        "for word; do case $word in --print-to-pdf=*) target=${word#*=} ;; esac; done\n"
        f'set -- "${{!#}}"; set -- "${{1#file://}}"\n{does}\n'
    )
    browser.chmod(0o755)
    monkeypatch.setattr(report_module, "BROWSERS", (str(browser),))
    page, target = tmp_path / "index.html", tmp_path / "report.pdf"
    page.write_text("the page")
    reason = report_module.print_page(page, target)
    assert reason.endswith(told)
    assert target.exists() == (told == "") == (reason == "")
    assert told or target.read_text() == "the page"
    assert sorted(tmp_path.glob(".print*")) == []


def test_pages_of_the_pdf_hold_the_words(report: Path, tmp_path: Path) -> None:
    if not any(map(shutil.which, INSTALLED)) or shutil.which("pdftotext") is None:
        pytest.skip("chromium or pdftotext (Debian: poppler-utils) is not installed")
    target = tmp_path / "report.pdf"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_module, "BROWSERS", INSTALLED)
        assert report_module.print_page(report / "index.html", target) == ""
    call = ["pdftotext", "-layout", str(target), "-"]
    words = subprocess.run(call, capture_output=True, text=True, check=True).stdout
    assert "Parabola" in words
    assert "pressure half way" in words
    # a table of the page, not the cards of a narrow screen
    heads = next(line for line in words.splitlines() if "quantity" in line and "error" in line)
    assert "tolerance" in heads


def test_cases_stand_in_their_groups_at_places_that_stay(report: Path) -> None:
    page = (report / "index.html").read_text()
    group = page.index('<h2 id="flow">Flow in fractures</h2>')
    assert page.index('<section class="case" id="case-parabola" data-verdict="passed">') > group
    record = json.loads((report / "report.json").read_text())
    (told,) = record["groups"]
    assert (told["name"], told["verdict"]) == ("flow", "passed")
    assert told["counts"] == record["counts"]
    assert [item["name"] for item in told["cases"]] == ["parabola"]
    shares = [row["share"] for row in record["nearest"]]
    assert shares == sorted(shares, reverse=True)
    assert told["worst"]["share"] == shares[0]
    row = next(row for row in record["nearest"] if row["error"] == "0.005 Pa")
    assert row["share"] == pytest.approx(0.005 / 0.02)


def test_a_file_that_cannot_be_used_stands_first(case: SmallCase) -> None:
    case.toml = case.toml.replace('group = "flow"', 'group = "cooking"')
    assert verify(case) == 1
    page = (case.root / "report" / "index.html").read_text()
    assert "Files that cannot be used" in page
    assert "is no group; there are: elasticity, contact" in page
    assert 'id="case-parabola"' in page


def test_without_code_everything_is_shown(report: Path) -> None:
    page = (report / "index.html").read_text()
    assert re.findall(r"<(\w+)[^>]* hidden", page) == ["form"]  # the filter alone, which takes code


def test_what_drawings_share_stands_once(report: Path) -> None:
    page = (report / "index.html").read_text()
    names = re.findall(r' id="([^"]+)"', page)
    assert len(names) == len(set(names))
    figures = page.count("<figure>")
    assert figures >= 2
    assert page.count('<svg viewBox="') == figures
    used = set(re.findall(r'(?:href="#|url\(#)(d\d+)', page))
    assert used
    assert used <= set(names)
    looks = set(re.findall(r' class="(s\d+)"', page))
    assert looks
    assert all(f".{look}{{" in page for look in looks)


@pytest.mark.parametrize(
    ("picture", "lacking"),
    [("pressure", "matrix.pvd"), ("states", "fractures.csv"), ("network", "network.json")],
)
def test_a_picture_needs_its_files(case: SmallCase, picture: str, lacking: str) -> None:
    case.toml += f'\n[[figure]]\ntitle = "Seen"\npicture = "{picture}"\nrun = "fine"\n'
    (figure,) = case.judge().figures
    assert lacking in figure.broken
    assert case.judge().verdict == ERROR


def test_an_unknown_picture_is_an_error(case: SmallCase) -> None:
    case.toml += '\n[[figure]]\ntitle = "Seen"\npicture = "taste"\nrun = "fine"\n'
    assert "is no picture; there are: network, states, pressure" in case.judge().broken
