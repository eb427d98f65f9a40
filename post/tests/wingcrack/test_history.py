"""Figures against time: values in their units, labels, what a run without fluid lacks."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from synthetic_run import (
    GROWTH_STEP,
    HOUR,
    LENGTH,
    STATES,
    STEPS,
    fracture_cells,
    polyline,
    times,
    wing_length,
)
from wingcrack.figures import AbsentError, read_run, style
from wingcrack.figures.history import balance, development, intensities
from wingcrack.figures.probes import probe_histories


def test_intensities_of_both_methods(wet_run: Path) -> None:
    figure = intensities(read_run(wet_run))
    assert [axes.get_ylabel().split(" [")[0] for axes in figure.axes] == [
        r"$K_\mathrm{I}$",
        r"$K_\mathrm{II}$",
        r"$K_\mathrm{eq}$",
    ]
    assert {axes.get_ylabel().split(" [")[1] for axes in figure.axes} == {
        r"MPa$\,\sqrt{\mathrm{m}}$]"
    }
    assert {axes.get_xlabel() for axes in figure.axes} == {"time [h]"}
    mode_one = figure.axes[0].lines
    assert len(mode_one) == 4  # two tips, two methods
    integral, correlation = (np.asarray(line.get_ydata()) for line in mode_one[:2])
    assert integral[0] == pytest.approx(0.01, rel=1e-12)
    assert integral[-1] == pytest.approx(0.02 * (STEPS - 1) + 0.36, rel=1e-12)
    assert np.allclose(correlation, 1.02 * integral, rtol=1e-12)
    assert mode_one[1].get_marker() == "o"
    assert np.allclose(np.asarray(mode_one[0].get_xdata()), times() / 3600.0, rtol=1e-14)


def test_toughness_is_drawn_where_the_scene_tells_it(wet_run: Path, own_run: Path) -> None:
    figure = intensities(read_run(wet_run))
    assert np.asarray(figure.axes[-1].lines[-1].get_ydata()).tolist() == [0.7, 0.7]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        "tip 1 (flaw)",
        "tip 2 (flaw)",
        "lines: interaction integral",
        "circles: displacement correlation",
        r"toughness $K_\mathrm{IC}$",
    ]
    (own_run / "scene.nml").unlink()
    figure = intensities(read_run(own_run))
    assert len(figure.axes[-1].lines) == 2
    assert len(figure.legends[0].get_texts()) == 4


def test_development(wet_run: Path) -> None:
    figure = development(read_run(wet_run))
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "total length [m]",
        "pressure [MPa]",
        "displacement jump [mm]",
        "fracture cells [-]",
    ]
    length = np.asarray(figure.axes[0].lines[0].get_ydata())
    expected = [LENGTH + 2.0 * wing_length(step) for step in range(STEPS)]
    assert np.allclose(length, expected, rtol=1e-14)
    pressure = np.asarray(figure.axes[1].lines[0].get_ydata())
    assert np.allclose(pressure, 7.0 + 0.5 * np.arange(STEPS), rtol=1e-14)
    growth = np.asarray(figure.axes[0].lines[1].get_xdata())[0]
    assert growth == pytest.approx(times()[GROWTH_STEP - 1] / 3600.0, rel=1e-14)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["first growth"]


def test_counts_of_states_have_their_colours(wet_run: Path) -> None:
    axes = development(read_run(wet_run)).axes[-1]
    lines = {str(line.get_label()): line for line in axes.lines}
    for number, state in enumerate(STATES):
        assert lines[state].get_color() == style.STATE_COLOURS[state]
        counts = [int(np.sum(fracture_cells(step).state == number)) for step in range(STEPS)]
        assert np.asarray(lines[state].get_ydata()).tolist() == counts


def test_mechanics_only_has_no_pressure_and_no_balance(dry_run: Path) -> None:
    run = read_run(dry_run)
    titles = [axes.get_title(loc="left") for axes in development(run).axes]
    assert titles == ["(a)  fracture length", "(b)  largest slip and opening", "(c)  contact state"]
    with pytest.raises(AbsentError, match="no fluid \\(mechanics only\\)"):
        balance(run)


def test_balance_adds_up_as_written(wet_run: Path) -> None:
    figure = balance(read_run(wet_run))
    volumes, errors = figure.axes
    assert volumes.get_ylabel() == "volume per thickness [cm²]"
    injected, leaked, kept = (np.asarray(line.get_ydata()) for line in volumes.lines[:3])
    assert injected[-1] == pytest.approx(5e-9 * times()[-1] * 1e4, rel=1e-12)
    assert np.allclose(leaked, 0.6 * injected, rtol=1e-12)
    assert np.allclose(kept, 0.4 * (injected - injected[0]), rtol=1e-10, atol=1e-12)
    # a step without any error stands at the round-off unit, not at minus infinity
    assert errors.get_yscale() == "log"
    assert np.asarray(errors.lines[0].get_ydata())[0] == np.finfo(float).eps


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("prefilled_m2", "prefilled new cells"),
        ("outflow_m2", "out through ends of fractures"),
    ],
)
def test_rarer_volumes_are_shown_where_there_are_some(name: str, label: str, own_run: Path) -> None:
    path = own_run / "history.csv"
    header, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    column = header.index(name)
    for row in rows:
        row[column] = "2e-5"
    text = "\n".join(",".join(row) for row in [header, *rows])
    path.write_text(text + "\n", encoding="utf-8")
    volumes = balance(read_run(own_run)).axes[0]
    labels = [str(line.get_label()) for line in volumes.lines]
    assert labels[3] == label
    assert np.asarray(volumes.lines[3].get_ydata())[0] == pytest.approx(0.2, rel=1e-12)


def test_starts_and_stops_of_the_well_are_marked(own_run: Path) -> None:
    with (own_run / "scene.nml").open("a", encoding="utf-8") as scene:
        scene.write(f"&injection start = {10 * HOUR}, end = {35 * HOUR} /\n")
    run = read_run(own_run)
    for figure in (development(run), balance(run), probe_histories(run)):
        for axes in figure.axes:
            marks = [
                float(np.asarray(line.get_xdata())[0])
                for line in axes.lines
                if line.get_transform() != axes.transData and line.get_color() == "#555555"
            ]
            assert {10.0, 35.0} <= set(marks)
        names = [text.get_text() for text in figure.legends[0].get_texts()]
        assert names[-1] == "well starts or stops"


def _scale_columns(path: Path, factors: dict[str, float], *, tip: str = "") -> None:
    header, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    for row in rows:
        if not tip or row[header.index("tip")] == tip:
            for name, factor in factors.items():
                row[header.index(name)] = str(factor * float(row[header.index(name)]))
    lines = [",".join(row) for row in [header, *rows]]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def test_neighbouring_tips_differ_in_dashes(wet_run: Path) -> None:
    first, second = intensities(read_run(wet_run)).axes[0].lines[0:4:2]
    assert first.get_linestyle() != second.get_linestyle()
    assert first.get_color() != second.get_color()


def test_twins_are_one_line_with_both_names(own_run: Path) -> None:
    path = own_run / "tips.csv"
    header, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    for one, two in zip(rows[::2], rows[1::2], strict=True):
        two[5:] = [str(1.0001 * float(value)) for value in one[5:]]
    text = "\n".join(",".join(row) for row in [header, *rows])
    path.write_text(text + "\n", encoding="utf-8")
    figure = intensities(read_run(own_run))
    assert len(figure.axes[1].lines) == 2  # both methods
    assert figure.legends[0].get_texts()[0].get_text() == "tips 1, 2 (flaw)"


def test_small_intensities_have_a_unit_and_no_offset(own_run: Path) -> None:
    names = [f"k{n}_pa_sqrtm" for n in ("1", "2", "1_dc", "2_dc", "eq")]
    _scale_columns(own_run / "tips.csv", dict.fromkeys(names, 1.0e-6))
    figure = intensities(read_run(own_run))
    for axes in figure.axes:
        assert axes.get_ylabel().endswith(r" [Pa$\,\sqrt{\mathrm{m}}$]")
        axes.figure.canvas.draw()
        assert axes.yaxis.get_major_formatter().get_offset() == ""


def test_a_constant_has_no_scale_of_its_round_off(own_run: Path) -> None:
    path = own_run / "history.csv"
    header, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    for step, row in enumerate(rows):
        row[header.index("fracture_length_m")] = repr(LENGTH * (1.0 + 1e-15 * step))
    text = "\n".join(",".join(row) for row in [header, *rows])
    path.write_text(text + "\n", encoding="utf-8")
    low, high = development(read_run(own_run)).axes[0].get_ylim()
    assert high - low == pytest.approx(0.2 * LENGTH)


def _shown(figure: Figure) -> list[list[str]]:
    """Cells of the only table, by rows."""
    (table,) = figure.axes[0].tables
    cells = table.get_celld()
    width = 1 + max(column for _, column in cells)
    texts = [cells[place].get_text().get_text() for place in sorted(cells)]
    return [texts[first : first + width] for first in range(0, len(texts), width)]


def test_one_state_is_a_table(own_run: Path) -> None:
    for file, rows in (("history.csv", 1), ("tips.csv", 2), ("probes.csv", 1)):
        path = own_run / file
        lines = path.read_text(encoding="utf-8").splitlines()
        path.write_text("\n".join(lines[: 1 + rows]) + "\n", encoding="utf-8")
    run = read_run(own_run)
    head, first, second = _shown(intensities(run))
    assert head[-1] == r"$K_\mathrm{eq}/K_\mathrm{IC}$"
    assert first[0] == "1 (flaw)"
    assert float(first[1]) == pytest.approx(0.01)
    assert float(second[-1]) == pytest.approx((0.02 + 0.19) / 0.7, rel=1e-3)
    assert _shown(development(run))[1] == ["total fracture length", "0.1", "m"]
    assert [row[0] for row in _shown(probe_histories(run))] == ["probe", "c", "d"]
    with pytest.raises(AbsentError, match="one state"):
        balance(run)


def test_one_state_under_a_load_is_normalized(dry_run: Path, tmp_path: Path) -> None:
    run_folder = Path(shutil.copytree(dry_run, tmp_path / "one"))
    for file, rows in (("history.csv", 1), ("tips.csv", 2)):
        path = run_folder / file
        lines = path.read_text(encoding="utf-8").replace("time_s", "load_factor").splitlines()
        path.write_text("\n".join(lines[: 1 + rows]) + "\n", encoding="utf-8")
    with (run_folder / "scene.nml").open("a", encoding="utf-8") as scene:
        scene.write("&side name = 'top', y_traction = -2.0e6 /\n")
    head, first, _ = _shown(intensities(read_run(run_folder)))
    assert head[6] == r"$K_\mathrm{I}/K_0$"
    x, y = polyline(STEPS - 1).T  # network.json's
    half = float(np.hypot(np.diff(x), np.diff(y)).sum()) / 2.0
    expected = 0.01e6 / (2.0e6 * times()[0] * np.sqrt(np.pi * half))
    assert float(first[6]) == pytest.approx(expected, rel=1e-3)


def test_probes(wet_run: Path) -> None:
    figure = probe_histories(read_run(wet_run))
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "pressure [MPa]",
        "displacement [mm]",
        "stress [MPa]",
    ]
    # with the mark of first growth
    assert [len(axes.lines) for axes in figure.axes] == [2 + 1, 4 + 1, 6 + 1]
    second = np.asarray(figure.axes[0].lines[1].get_ydata())
    assert np.allclose(second, 6.8 + 0.1 * np.arange(STEPS), rtol=1e-13)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        "probe c",
        "probe d",
        r"$p$, $u_x$, $\sigma_{xx}$",
        r"$u_y$, $\sigma_{yy}$",
        r"$\sigma_{xy}$",
        "first growth",
    ]


def test_probes_of_mechanics_only(dry_run: Path) -> None:
    figure = probe_histories(read_run(dry_run))
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "(a)  displacement",
        "(b)  total stress",
    ]


def test_no_tips_no_probes(own_run: Path) -> None:
    (own_run / "probes.csv").write_text("time_s\n1.0\n", encoding="utf-8")
    (own_run / "tips.csv").write_text("time_s,tip\n", encoding="utf-8")
    run = read_run(own_run)
    with pytest.raises(AbsentError, match="has no probe points"):
        probe_histories(run)
    with pytest.raises(AbsentError, match=r"tips\.csv has no rows"):
        intensities(run)
