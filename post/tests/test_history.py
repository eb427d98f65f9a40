"""Figures against time: values in their units, labels, what a run without fluid lacks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from synthetic_run import GROWTH_STEP, LENGTH, STATES, STEPS, fracture_cells, times, wing_length
from wingcrack_post import AbsentError, read_run, style
from wingcrack_post.history import balance, development, intensities
from wingcrack_post.probes import probe_histories


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
    assert growth == pytest.approx(times()[GROWTH_STEP] / 3600.0, rel=1e-14)


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
    assert volumes.get_ylabel() == "volume per metre of thickness [cm²]"
    injected, leaked, kept = (np.asarray(line.get_ydata()) for line in volumes.lines)
    assert injected[-1] == pytest.approx(5e-9 * times()[-1] * 1e4, rel=1e-12)
    assert np.allclose(leaked, 0.6 * injected, rtol=1e-12)
    assert np.allclose(kept, 0.4 * (injected - injected[0]), rtol=1e-10, atol=1e-12)
    # a step without any error stands at the round-off unit, not at minus infinity
    assert errors.get_yscale() == "log"
    assert np.asarray(errors.lines[0].get_ydata())[0] == np.finfo(float).eps


def test_prefilled_volume_is_shown_where_there_is_one(own_run: Path) -> None:
    path = own_run / "history.csv"
    header, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    column = header.index("prefilled_m2")
    for row in rows:
        row[column] = "2e-5"
    text = "\n".join(",".join(row) for row in [header, *rows])
    path.write_text(text + "\n", encoding="utf-8")
    volumes = balance(read_run(own_run)).axes[0]
    labels = [str(line.get_label()) for line in volumes.lines]
    assert labels[-1] == "prefilled new cells"
    assert np.asarray(volumes.lines[-1].get_ydata())[0] == pytest.approx(0.2, rel=1e-12)


def test_single_step_is_seen_as_a_point(own_run: Path) -> None:
    for file, rows in (("history.csv", 1), ("tips.csv", 2), ("probes.csv", 1)):
        path = own_run / file
        lines = path.read_text(encoding="utf-8").splitlines()
        path.write_text("\n".join(lines[: 1 + rows]) + "\n", encoding="utf-8")
    run = read_run(own_run)
    for figure in (intensities(run), development(run), balance(run), probe_histories(run)):
        assert figure.axes[0].lines[0].get_marker() == "."


def test_probes(wet_run: Path) -> None:
    figure = probe_histories(read_run(wet_run))
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "pressure [MPa]",
        "displacement [mm]",
        "stress [MPa]",
    ]
    assert [len(axes.lines) for axes in figure.axes] == [2, 4, 6]
    second = np.asarray(figure.axes[0].lines[1].get_ydata())
    assert np.allclose(second, 6.8 + 0.1 * np.arange(STEPS), rtol=1e-13)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        "probe c",
        "probe d",
        r"$p$, $u_x$, $\sigma_{xx}$",
        r"$u_y$, $\sigma_{yy}$",
        r"$\sigma_{xy}$",
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
