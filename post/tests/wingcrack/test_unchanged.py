"""A figure is drawn again when, and only when, something that it was drawn from has changed."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from wingcrack.command_line import main
from wingcrack.figures import unchanged

POST = Path(__file__).resolve().parents[2]
ALL = ["probes", "view"]


def _drawn(run: Path, capsys: pytest.CaptureFixture[str], *options: str) -> list[str]:
    """Draw, and tell which figures were drawn and not kept."""
    assert main(["plot", str(run), "--only", "probes,view", *options]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if "left out" not in line]
    return sorted({Path(line).stem for line in lines if "(unchanged)" not in line})


def _states(run: Path) -> dict[str, int]:
    return {file.name: file.stat().st_mtime_ns for file in (run / "figures").glob("[!.]*")}


@pytest.fixture
def drawn_run(own_run: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    """Give a run whose figures are drawn."""
    assert _drawn(own_run, capsys) == ALL
    return own_run


def test_nothing_is_drawn_twice(drawn_run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = _states(drawn_run)
    assert _drawn(drawn_run, capsys) == []
    assert _states(drawn_run) == before


def test_what_was_left_out_is_told_again(
    drawn_run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for _ in range(2):
        main(["plot", str(drawn_run), "--only", "tips,probes"])
        out = capsys.readouterr().out
        assert "load: left out: no load factor drives the run.\n" in out


def test_it_takes_no_library_to_see_that_nothing_changed(drawn_run: Path) -> None:
    code = (
        "import sys\n"
        "from wingcrack.command_line import main\n"
        "assert main(['plot', sys.argv[1], '--only', 'probes,view', '--quiet']) == 0\n"
        "assert not {'matplotlib', 'pyvista', 'vtk'} & set(sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(drawn_run)],
        cwd=POST,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def _change(name: str, old: str, new: str) -> Callable[[Path], None]:
    def change(run: Path) -> None:
        path = run / name
        stamp = path.stat()
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="utf-8")
        os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))  # times tell nothing

    return change


def _other_field(run: Path) -> None:
    """One bit of one value of one state, with the time and the size of the file as they were."""
    path = run / "matrix_0012.vtu"
    stamp, content = path.stat(), bytearray(path.read_bytes())
    content[content.index(b"_", content.index(b"<AppendedData")) + 8 + 3] ^= 1
    path.write_bytes(content)
    os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))


def _no_probes(run: Path) -> None:
    shutil.copy(run / "probes.csv", run / "wells.csv")


@pytest.mark.parametrize(
    ("change", "again"),
    [
        (_change("history.csv", "0", "1"), ALL),
        (_change("network.json", "{", "{ "), ALL),
        (_change("run.json", '"scene"', '"scene" '), []),  # the same record
        (_no_probes, ALL),  # a file that was not there
        (_other_field, ["view"]),
    ],
)
def test_what_changed_is_drawn_again(
    drawn_run: Path,
    capsys: pytest.CaptureFixture[str],
    change: Callable[[Path], None],
    again: list[str],
) -> None:
    change(drawn_run)
    assert _drawn(drawn_run, capsys) == again
    assert _drawn(drawn_run, capsys) == []


def test_another_run_time_changes_nothing(
    drawn_run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = drawn_run / "run.json"
    record = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(record | {"cpu_s": 77.0, "timers_s": {"mesh": 5.0}}))
    assert _drawn(drawn_run, capsys) == []
    path.write_text(json.dumps(record | {"status": "stopped"}))
    assert _drawn(drawn_run, capsys) == ALL


def test_pictures_that_are_not_as_they_were_left(
    drawn_run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    figures = drawn_run / "figures"
    (figures / "probes.png").unlink()
    assert _drawn(drawn_run, capsys) == ["probes"]
    (figures / "view.png").write_bytes(b"something else")
    assert _drawn(drawn_run, capsys) == ["view"]
    assert (figures / "view.png").read_bytes().startswith(b"\x89PNG")
    (figures / unchanged.RECORD).write_text('{"probes": {"fingerprint": 3}, "view": []', "utf-8")
    assert _drawn(drawn_run, capsys) == ALL
    for nonsense in ('{"probes": {"fingerprint": 3}, "view": [], "more": null}', "[1]", "{}"):
        (figures / unchanged.RECORD).write_text(nonsense, "utf-8")
        assert _drawn(drawn_run, capsys) == ALL


def test_another_way_of_drawing(drawn_run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert _drawn(drawn_run, capsys, "--times", "20h") == ALL
    assert _drawn(drawn_run, capsys, "--times", "20h", "--format", "pdf") == ALL
    assert _drawn(drawn_run, capsys) == ALL


def test_another_program(
    drawn_run: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wingcrack.figures.catalogue.program", lambda: "of tomorrow")
    assert _drawn(drawn_run, capsys) == ALL


def test_the_program_is_all_of_its_files_and_libraries(monkeypatch: pytest.MonkeyPatch) -> None:
    unchanged.program.cache_clear()
    before = unchanged.program()
    unchanged.program.cache_clear()
    monkeypatch.setattr(unchanged, "version", lambda name: f"another {name}")
    assert unchanged.program() != before
    unchanged.program.cache_clear()


def test_a_drawing_that_fails_leaves_no_word_that_it_was_drawn(
    drawn_run: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wingcrack.figures.catalogue.program", lambda: "of tomorrow")

    def failing(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as broken:
        broken.setattr("wingcrack.figures.style.save", failing)
        with pytest.raises(KeyboardInterrupt):
            main(["plot", str(drawn_run), "--only", "probes"])
    entries = json.loads((drawn_run / "figures" / unchanged.RECORD).read_text())
    assert "probes" not in entries
    assert "probes" in _drawn(drawn_run, capsys)


def test_fields_too_large_to_look_at_are_drawn_every_time(
    drawn_run: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(unchanged, "_LARGEST", 1000)
    for _ in range(2):
        assert _drawn(drawn_run, capsys) == ["view"]
    assert unchanged.fields_of([drawn_run / "no such file"]) == ""


def test_parts_of_a_fingerprint_do_not_run_together() -> None:
    assert unchanged.fingerprint_of(["ab", "c"]) != unchanged.fingerprint_of(["a", "bc"])
