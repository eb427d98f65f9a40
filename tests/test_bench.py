"""The parts of the performance measurements: their list, exponents, stored counts, verdicts."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from wingcrack.command_line import main, understand
from wingcrack_verify.bench import cli
from wingcrack_verify.bench.catalogue import TOP, read_benchmarks
from wingcrack_verify.bench.measure import Measurement, Run, write_scene
from wingcrack_verify.bench.table import (
    Baseline,
    as_growth,
    as_phases,
    as_table,
    differences,
    exponents,
    fit,
    made_with,
    read_baseline,
    store,
)


def _run(cpu_s: float, cells: int = 100) -> Run:
    phases = {"mesh": 0.25 * cpu_s, "remesh": 0.0, "transfer": 0.0, "rest": 0.75 * cpu_s}
    sizes = {"cells": cells, "fracture_cells": 10, "unknowns": 3 * cells}
    return Run(cpu_s, phases, 5, 0, sizes, 80.0)


def _measured(name: str = "b1", seconds: tuple[float, ...] = (1.0,), **more: object) -> Measurement:
    middle = sorted(seconds)[len(seconds) // 2]
    return Measurement(name, "a title", _run(middle), seconds, **more)  # type: ignore[arg-type]


def test_every_listed_scene_can_be_written(tmp_path: Path) -> None:
    known, kinds = read_benchmarks()
    for benchmark in known.values():
        assert benchmark.title
        assert (benchmark.scene is None) != (benchmark.many_fractures == ())
        text = write_scene(benchmark, tmp_path).read_text().lower()
        assert "&scene" in text
        if benchmark.one_step:
            first = write_scene(benchmark, tmp_path, benchmark.one_step).read_text().lower()
            assert first != text
    for kind in kinds:
        assert len(kind.names) >= 3
        assert all(known[name].one_step for name in kind.names)
    assert {name for name, entry in known.items() if entry.quick} >= {"b1", "quick_fluid"}


def test_changes_reach_the_scene(tmp_path: Path) -> None:
    known, _ = read_benchmarks()
    text = write_scene(known["c1_10600"], tmp_path).read_text().lower().replace(" ", "")
    assert "size_boundary=0.045" in text
    assert "intensities=.false." in text
    assert "vtu=.false." in text


def test_what_is_measured_without_names() -> None:
    known, _ = read_benchmarks()
    quick, whole = (
        call.given.names
        for call in (understand(["bench", "--quick"]), understand(["bench"]))
        if call is not None
    )
    assert all(known[name].quick for name in quick)
    assert {"c1", "c1_k", "c1_10600", "b4", "b6", "c2", "c6", "s200k", "n1000", "b1"} <= set(whole)
    assert not {name for name in whole if name.startswith("quick")}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no_such"], "there is no measurement 'no_such' (there are: c1, "),
        (["--against", "/no/such/program"], "there is no program /no/such/program to compare"),
        (["--against", __file__, "--store"], "--store keeps counts, which --against does not make"),
        (["b1", "--quick"], "--quick has measurements of its own"),
        (["--against"], "requires an argument"),
    ],
)
def test_wrong_use_is_one_sentence_and_status_2(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        understand(["bench", *arguments])
    assert stop.value.code == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("power", [1.0, 1.23, 2.0])
def test_the_exponent_of_a_power_is_found(power: float) -> None:
    sizes = (1000, 3700, 20000)
    found = fit("cells", sizes, tuple(2.0e-4 * n**power for n in sizes))
    assert found.fitted == pytest.approx(power, rel=1e-12)
    assert found.fourfold == pytest.approx([4.0**power] * 2, rel=1e-12)


def test_growth_needs_two_sizes() -> None:
    _, kinds = read_benchmarks()
    small = Measurement("n100", "", _run(1.0), (1.0,))
    assert exponents(kinds, {"n100": small}) == ()
    large = Measurement("n400", "", Run(8.0, {}, 5, 0, {"fracture_cells": 40}, 1.0), (8.0,))
    (found,) = exponents(kinds, {"n100": small, "n400": large})
    assert found.fourfold == pytest.approx([8.0])
    assert as_growth([found]) == (
        "CPU time over fracture cells (10, 40): exponent 1.50; CPU(4n)/CPU(n) 8.00"
    )


def test_median_spread_and_steps() -> None:
    found = _measured(seconds=(2.2, 2.0, 1.8), first_step_s=1.2, other_s=(1.0, 4.0, 2.0))
    assert found.median_s == 2.0
    assert found.spread == pytest.approx(0.2)
    assert found.further_step_s == pytest.approx(0.2)  # of five states, four follow the first
    assert found.ratio == pytest.approx(1.0)
    table = as_table([found], Baseline({}, {})).splitlines()
    assert "first [s]" in table[0]
    assert "growths" not in table[0]  # nobody has any
    assert table[1].split()[:4] == ["b1", "2", "20", "%"]
    assert as_phases([found]).splitlines()[1] == "  b1: rest 1.5, mesh 0.5"


def test_stored_counts_stay_with_what_they_were_made_with(tmp_path: Path) -> None:
    path = tmp_path / "baseline.json"
    assert read_baseline(path) == Baseline({}, {})
    store(path, Baseline({"compiler": "1"}, {"b1": 10}))
    store(path, Baseline({"compiler": "1"}, {"b4": 20}))
    assert read_baseline(path) == Baseline({"compiler": "1"}, {"b1": 10, "b4": 20})
    store(path, Baseline({"compiler": "2"}, {"b4": 30}))
    assert read_baseline(path) == Baseline({"compiler": "2"}, {"b4": 30})
    assert differences({"a": "1", "b": "2"}, {"b": "3"}) == [
        "a (1 then, none here)",
        "b (2 then, 3 here)",
    ]


def test_the_stored_counts_are_of_listed_measurements() -> None:
    known, _ = read_benchmarks()
    content = json.loads((TOP / "tools" / "bench_baseline.json").read_text())
    assert set(content["instructions"]) >= {name for name, entry in known.items() if entry.quick}
    assert set(content["instructions"]) <= set(known)


@pytest.mark.parametrize(
    ("counted", "status"), [(1000, 0), (1099, 0), (1101, 1), (500, 0), (None, 0)]
)
def test_more_instructions_are_a_loss(
    counted: int | None, status: int, capsys: pytest.CaptureFixture[str]
) -> None:
    measured = [_measured(instructions=counted)]
    assert cli._judge(measured, Baseline({"c": "1"}, {"b1": 1000}), {"c": "1"}) == status
    error = capsys.readouterr().err
    assert ("a loss: b1 takes 1.101 times the stored instructions" in error) == (status == 1)


def test_counts_made_otherwise_are_not_judged(capsys: pytest.CaptureFixture[str]) -> None:
    measured = [_measured(instructions=9999)]
    assert cli._judge(measured, Baseline({"c": "1"}, {"b1": 1000}), {"c": "2"}) == 0
    assert capsys.readouterr().out == (
        "instructions are not judged: the stored counts were made with other c (1 then, 2 here)\n"
    )


@pytest.mark.parametrize(("seconds", "status"), [(1.2, 0), (1.3, 1), (0.5, 0)])
def test_more_paired_time_is_a_loss(seconds: float, status: int) -> None:
    measured = [_measured(seconds=(seconds,), other_s=(1.0,))]
    assert cli._judge(measured, Baseline({}, {}), {}) == status


def test_without_valgrind_the_short_form_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)
    monkeypatch.setattr(cli, "measure", lambda item, *_: _measured(item.name))
    baseline = tmp_path / "baseline.json"
    store(baseline, Baseline({}, {"b1": 1}))
    options = ["--out", str(tmp_path / "out"), "--baseline", str(baseline)]
    assert main(["bench", "--quick", *options]) == 0
    assert (
        "b1: no instructions: instructions are counted by valgrind, which is not installed"
        in capsys.readouterr().out
    )
    assert main(["bench", "b1", "--instructions", *options]) == 3
    assert main(["bench", "b1", "--store", *options]) == 3


def test_what_a_solver_was_made_with(tmp_path: Path) -> None:
    solver = tmp_path / "fortran" / "app" / "solver"
    solver.parent.mkdir(parents=True)
    solver.touch()
    cache = tmp_path / "CMakeCache.txt"
    for flags in ("-march=x86-64-v3", "-march=native"):
        cache.write_text(f"CMAKE_BUILD_TYPE:STRING=Release\nWINGCRACK_PROCESSOR:STRING={flags}\n")
        found = made_with(solver)
        assert found["build type"] == "Release"
        assert found["processor"].startswith(flags)
        # for whom "native" is, matters too
        assert ("," in found["processor"]) == ("native" in flags)
