"""The network's figure: what was there, what has grown and in which order, joints, the body."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from wingcrack.figures import AbsentError, RunError, read_run
from wingcrack.figures.growth import read_growth
from wingcrack.figures.network import THICK, network_figure


def fracture(x: list[float], s_start: float) -> dict[str, Any]:
    return {"fracture": 1, "name": "flaw", "s_start_m": s_start, "x_m": x, "y_m": [1.0] * len(x)}


def network(*steps: tuple[float, list[float], float]) -> dict[str, Any]:
    history = [{"time_s": t, "fractures": [fracture(x, s)]} for t, x, s in steps]
    joint = {"kind": "T", "time_s": 2.0, "x_m": 1.75, "y_m": 1.0, "fractures": [1]}
    return {"fractures": history[-1]["fractures"], "steps": history, "joints": [joint]}


GROWN = network(
    (0.0, [1.0, 1.5], 0.0),
    (1.0, [1.0, 1.5, 1.6], 0.0),
    (2.0, [0.8, 0.9, 1.0, 1.5, 1.6, 1.75], -0.2),
)


def drawn(run: Path, content: dict[str, Any]) -> Figure:
    (run / "network.json").write_text(json.dumps(content), encoding="utf-8")
    return network_figure(read_run(run))


def map_of(figure: Figure) -> Axes:
    return figure.axes[0]


def test_wings_lead_outwards_with_their_times() -> None:
    (flaw,) = read_growth(GROWN)
    assert flaw.initial[:, 0].tolist() == [1.0, 1.5]
    assert flaw.start[:, 0].tolist() == [1.0, 0.9, 0.8]
    assert flaw.end[:, 0].tolist() == [1.5, 1.6, 1.75]
    assert flaw.start_steps.tolist() == [2.0, 2.0]
    assert flaw.end_steps.tolist() == [1.0, 2.0]


def test_the_initial_fracture_is_thick_and_growth_is_coloured_by_its_order(own_run: Path) -> None:
    axes = map_of(drawn(own_run, GROWN))
    thick = [line for line in axes.lines if line.get_linewidth() == THICK]
    assert [np.asarray(line.get_xdata()).tolist() for line in thick] == [[1.0, 1.5]]
    wings = [item for item in axes.collections if isinstance(item, LineCollection)]
    assert [len(item.get_segments()) for item in wings] == [2, 2]
    start, end = (np.asarray(item.get_colors()).tolist() for item in wings)
    # increment 1: at the end; at the second load one segment at each end, then one more
    assert start[0] == end[1]
    assert len({tuple(colour) for colour in (*start, *end)}) == 3


def test_body_joint_labels_and_legend(own_run: Path) -> None:
    figure = drawn(own_run, GROWN)
    axes = map_of(figure)
    assert axes.get_xlabel() == "$x$ [m]"
    assert axes.get_ylabel() == "$y$ [m]"
    assert axes.get_aspect() == 1.0
    places = [np.asarray(line.get_xydata()).tolist() for line in axes.lines]
    assert [[1.75, 1.0]] in places
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["at the start", "grown", "joint"]


def test_a_damaged_network_is_one_sentence(own_run: Path) -> None:
    with pytest.raises(RunError, match="network"):
        drawn(own_run, network((0.0, [1.0, 1.5], 0.0), (1.0, [1.0, 1.5], -0.3)))


def test_nothing_to_draw_is_said(own_run: Path) -> None:
    with pytest.raises(AbsentError, match="does not tell"):
        drawn(own_run, {"fractures": []})
    with pytest.raises(AbsentError, match="no fractures"):
        drawn(own_run, {"fractures": [], "steps": [{"time_s": 0.0, "fractures": []}]})


def test_nothing_grown_is_not_in_the_legend(own_run: Path) -> None:
    figure = drawn(own_run, network((0.0, [1.0, 1.5], 0.0)))
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["at the start", "joint"]


def test_the_unit_is_that_of_the_body(own_run: Path) -> None:
    with (own_run / "scene.nml").open("a", encoding="utf-8") as scene:
        scene.write("&domain x_min = 0.0, x_max = 2.0, y_min = 0.0, y_max = 2.0 /\n")
    axes = map_of(drawn(own_run, network((0.0, [1.0, 1.1], 0.0))))
    assert axes.get_xlabel() == "$x$ [m]"
    assert axes.get_xlim()[1] < 1.2  # a close view


def test_ticks_say_the_load_only_where_it_changes(dry_run: Path, tmp_path: Path) -> None:
    for item in dry_run.iterdir():
        (tmp_path / item.name).symlink_to(item)
    for name in ("history.csv", "network.json"):
        (tmp_path / name).unlink()
    text = (dry_run / "history.csv").read_text(encoding="utf-8").replace("time_s", "load_factor")
    (tmp_path / "history.csv").write_text(text, encoding="utf-8")
    load = read_run(tmp_path).history.number("load_factor")
    ends = [1.5 + 0.1 * k for k in range(21)]
    moments = [0.0, *load[:2], *[float(load[2])] * 18]
    content = network(*((moment, [1.0, *ends[: k + 1]], 0.0) for k, moment in enumerate(moments)))
    for step in content["steps"]:
        step["load_factor"] = step.pop("time_s")
    figure = drawn(tmp_path, content)
    ticks = [label.get_text() for label in figure.axes[1].get_yticklabels()]
    assert ticks[0] == f"1 ({load[0]:.3g})"
    assert sum("(" in tick for tick in ticks) == 2
    assert figure.axes[1].get_ylabel() == ("increment of growth (load factor, constant from 3 on)")


def test_growth_at_one_load_says_it_once(own_run: Path) -> None:
    figure = drawn(own_run, network((0.0, [1.0, 1.5], 0.0), (18000.0, [1.0, 1.5, 1.6, 1.7], 0.0)))
    assert figure.axes[1].get_ylabel() == "increment of growth (all at 5 h)"
    ticks = [label.get_text() for label in figure.axes[1].get_yticklabels()]
    assert ticks == ["1", "2"]
