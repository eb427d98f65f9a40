"""The command line: files, messages and exit status."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from matplotlib.image import imread

from wingcrack.command_line import main
from wingcrack.figures import style
from wingcrack.figures.catalogue import Outcome
from wingcrack.figures.read import Run

POST = Path(__file__).resolve().parents[2]


@pytest.mark.usefixtures("full_size")
def test_all_figures_of_some_groups(own_run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", str(own_run), "--only", "maps,fractures,tips,probes"]) == 0
    names = ["pressure_maps", "jump_maps", "fracture_1", "intensities", "development"]
    names += ["balance", "probes"]
    files = [own_run / "figures" / f"{name}.png" for name in names]
    out = capsys.readouterr().out.splitlines()
    assert [line for line in out if "left out" not in line] == [str(file) for file in files]
    assert [line for line in out if "left out" in line] == [
        "stress_maps: left out: the run has a pore pressure: see its maps.",
        "load: left out: no load factor drives the run.",
        "equilibrium: left out: growth does not control the load.",
    ]
    assert sorted((own_run / "figures").glob("[!.]*")) == sorted(files)
    for file in files:
        content = file.read_bytes()
        assert content.startswith(b"\x89PNG")
        assert len(content) > 5000
    # the widest figures fill a page of 7.1 inches at 300 dots per inch
    assert imread(own_run / "figures" / "probes.png").shape[1] == 2130


def test_same_run_gives_the_same_bytes(own_run: Path) -> None:
    contents = []
    for _ in range(2):
        shutil.rmtree(own_run / "figures", ignore_errors=True)
        assert main(["plot", str(own_run), "--only", "maps", "--format", "png,pdf"]) == 0
        drawn = sorted((own_run / "figures").glob("[!.]*"))
        names = [
            f"{name}.{form}" for name in ("jump_maps", "pressure_maps") for form in ("pdf", "png")
        ]
        assert [file.name for file in drawn] == names
        contents.append([file.read_bytes() for file in drawn])
    assert contents[0] == contents[1]
    assert contents[0][0].startswith(b"%PDF")
    assert b"/FontFile2" in contents[0][0]  # text in it stays text


def test_quiet_prints_nothing(own_run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", str(own_run), "--only", "probes", "--format", "png", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert [p.name for p in (own_run / "figures").glob("[!.]*")] == ["probes.png"]


def test_fonts_that_lack_are_nobodys_business(
    own_run: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(style.RC, "font.sans-serif", ["No Such Font", "DejaVu Sans"])
    assert main(["plot", str(own_run), "--only", "probes", "--format", "png", "--quiet"]) == 0
    assert [record.getMessage() for record in caplog.records if "font" in record.name] == []


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the figures that would be drawn; empty files are written in their place."""
    names: list[str] = []

    def pretend(_run: Run, kind: Any, folder: Path, *_: object, **__: object) -> Outcome:
        names.append(kind.name)
        folder.mkdir(exist_ok=True)
        file = folder / f"{kind.name}.png"
        file.touch()
        return Outcome(kind.name, (file,))

    monkeypatch.setattr("wingcrack.figures.catalogue._drawn", pretend)
    return names


_WELLS = "time_s,well,stage\n0.0,a,0\n1.0,a,1\n"
_ALWAYS = ["summary", "story", "load", "equilibrium", "probes"]  # where the run has them
_MOTION = ["pressure_maps", "stress_maps", "fracture"]


def _zero(run: Path, columns: Sequence[str]) -> None:
    """Let columns of the history be zero in all rows."""
    path = run / "history.csv"
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    names = head.split(",")
    assert set(columns) <= set(names)
    changed = [
        ",".join("0" if n in columns else c for n, c in zip(names, row.split(","), strict=True))
        for row in rows
    ]
    path.write_text("\n".join([head, *changed]) + "\n", encoding="utf-8")


def test_by_default_only_figures_in_which_something_happens(
    own_run: Path, drawn: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    (own_run / "wells.csv").write_text(_WELLS, encoding="utf-8")
    call = ["plot", str(own_run)]
    assert main(call) == 0
    assert sorted(drawn) == sorted([*_ALWAYS, *_MOTION, "network", "intensities"])
    out = capsys.readouterr().out
    assert "balance: left out: drawn on request (--only tips).\n" in out
    assert "wells: left out: drawn on request (--only wells).\n" in out
    shutil.rmtree(own_run / "figures")
    drawn.clear()
    (own_run / "events.csv").unlink()
    _zero(own_run, ("n_slip", "n_open", "fracture_length_m"))
    (own_run / "wells.csv").write_text(f"{_WELLS}2.0,a,2\n", encoding="utf-8")
    assert main(call) == 0
    assert sorted(drawn) == sorted([*_ALWAYS, "wells"])


def test_what_was_asked_for_once_is_kept_up_to_date(own_run: Path, drawn: list[str]) -> None:
    assert main(["plot", str(own_run), "--only", "view"]) == 0
    assert drawn == ["view"]
    _zero(own_run, ("n_slip",))
    assert main(["plot", str(own_run)]) == 0
    assert drawn.count("view") == 2
    assert "balance" not in drawn
    assert main(["plot", str(own_run), "--only", "all"]) == 0
    assert "balance" in drawn


def test_mechanics_only_names_what_it_leaves_out(
    dry_run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plot", str(dry_run), "--only", "maps,tips", "--format", "png"]) == 0
    out = capsys.readouterr().out
    assert "pressure_maps: left out: the run has no pore pressure (mechanics only).\n" in out
    assert "balance: left out: the run has no fluid (mechanics only).\n" in out
    assert "development.png\n" in out


@pytest.mark.parametrize("style", ["column", "slide"])
def test_styles_have_folders_of_their_own(own_run: Path, style: str) -> None:
    assert main(["plot", str(own_run), "--style", style, "--only", "tips,maps"]) == 0
    assert not (own_run / "figures").exists()
    pictures = list((own_run / f"figures_{style}").glob("*.png"))
    assert pictures
    widths = {imread(picture).shape[1] for picture in pictures}
    # 3.5 inches, or a quarter more than 7.1, at 80 dots per inch
    assert widths == {280} if style == "column" else max(widths) == 710


def test_running_run_draws_what_is_there(own_run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("run.json", "network.json", "matrix.pvd", "tips.csv", "probes.csv"):
        (own_run / name).unlink()
    assert main(["plot", str(own_run), "--format", "png"]) == 0
    out = capsys.readouterr().out
    assert "intensities: left out: the run has no tips.csv (stress intensity factors).\n" in out
    figures = sorted(path.name for path in (own_run / "figures").glob("[!.]*"))
    assert figures == [
        "captions.txt",
        "development.png",
        "fracture_1.png",
        "index.html",
        "summary.png",
    ]


def test_nothing_to_draw_is_an_error(
    dry_run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = shutil.copytree(dry_run, tmp_path / "run")
    (run / "matrix.pvd").unlink()
    assert main(["plot", str(run), "--only", "maps", "--quiet"]) == 2
    assert capsys.readouterr().err == (
        f"wingcrack plot: {run}: nothing was drawn: the run has no matrix.pvd (VTU output"
        " off, or no step written yet).\n"
    )


def _empty(run: Path) -> None:
    (run / "history.csv").write_text("", encoding="utf-8")


def _without_history(run: Path) -> None:
    (run / "history.csv").unlink()


def _without_column(run: Path) -> None:
    path = run / "probes.csv"
    path.write_text(path.read_text(encoding="utf-8").replace("d_syy_pa", "d_s"), encoding="utf-8")


def _without_vtu(run: Path) -> None:
    (run / "matrix_0000.vtu").unlink()


def _not_xml(run: Path) -> None:
    (run / "matrix_0000.vtu").write_text("nonsense", encoding="utf-8")


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (_empty, "history.csv: the file is empty, a header line was expected."),
        (_without_history, "history.csv is missing, so this is no directory that 'wingcrack run'"),
        (_without_column, "probes.csv: the column 'd_syy_pa' is missing (there are: time_s,"),
        (_without_vtu, "matrix_0000.vtu: the file is missing, though its PVD collection names it."),
        (_not_xml, "matrix_0000.vtu: the file is damaged ("),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(
    own_run: Path, damage: object, message: str
) -> None:
    assert callable(damage)
    damage(own_run)
    done = _called("plot", str(own_run), "--format", "png", "--only", "maps,probes")
    assert done.returncode == 2
    assert done.stderr.startswith("wingcrack plot: ")
    assert message in done.stderr
    assert done.stderr.count("\n") == 1


def test_missing_directory() -> None:
    done = _called("plot", "no/such/place")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "wingcrack plot: there is no directory no/such/place; ./wingcrack plot --help says more\n"
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "missing command"),
        (["plot"], "plot needs the directory of a run"),
        (
            ["plot", "d", "--only", "map"],
            "'map' is none of summary, story, network, maps, fractures, tips, wells, seismicity,",
        ),
        (["plot", "d", "--format", "svg"], "'svg' is none of png, pdf"),
        (["plot", "d", "--times", "noon"], "'noon' is no time"),
        (["plot", "d", "--color"], "no such option '--color'"),
    ],
)
def test_wrong_use_is_one_sentence_and_status_2(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_help_has_an_example() -> None:
    done = _called("plot", "--help")
    assert done.returncode == 0
    assert "example:\n  ./wingcrack plot out/wing_crack" in done.stdout


def test_figure_libraries_are_loaded_only_when_needed() -> None:
    code = (
        "import sys, wingcrack.command_line, wingcrack.figures.cli\n"
        "assert not {'matplotlib', 'pyvista', 'vtk'} & set(sys.modules)\n"
        "import wingcrack.figures.catalogue\n"
        "assert not {'pyvista', 'vtk', 'matplotlib.pyplot'} & set(sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=POST, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def _called(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "wingcrack", *arguments],
        cwd=POST,
        capture_output=True,
        text=True,
        check=False,
    )


def test_captions_name_the_scene_and_its_parameters(own_run: Path) -> None:
    assert main(["plot", str(own_run), "--only", "summary,probes", "--quiet"]) == 0
    text = (own_run / "figures" / "captions.txt").read_text(encoding="utf-8")
    paragraphs = text.split("\n\n")
    assert [words.partition(":")[0] for words in paragraphs[:-1]] == ["summary", "probes"]
    assert paragraphs[-1].startswith("Parameters")
    assert "young = " in paragraphs[-1]
    assert " Pa" in paragraphs[-1]
