"""The one-page figure of an injection: what its panels show, and when there is none."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from synthetic_run import LENGTH, STEPS, polyline, times, wing_length
from wingcrack.command_line import main
from wingcrack.figures import AbsentError, read_run, style
from wingcrack.figures.story import story

TITLES = [
    "(a)  network at the end",
    "(b)  well pressure and rate",
    "(c)  injectivity: rate over rise of pressure",
    "(d)  where the fluid is",
    "(e)  length: connected with a well, stimulated",
    "(f)  seismic moment of all slip",
    "(g)  slip events: seismic (orange), aseismic",
]
HEAD = (
    "event,time_s,end_s,fracture,x_m,y_m,s_from_m,s_to_m,area_m2,mean_slip_m,moment_nm,"
    "magnitude,open_share,sudden_share,ended_by,kind\n"
)
MET = 10 * 3600.0  # when the second fracture is met [s]


@pytest.fixture
def stimulated(own_run: Path) -> Path:
    """Add to the synthetic run what an injection into a network has."""
    with (own_run / "history.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for step, row in enumerate(rows):
        injected = float(row["injected_m2"])
        row |= {
            "injection_rate_m2_s": "5e-09",
            "injectivity_m2_s_pa": str(5e-9 / (0.2e6 + 0.5e6 * step)),
            "fracture_fluid_m2": str(0.4 * injected),
            "rock_fluid_m2": str(0.5 * injected),
            "rock_outflow_m2": str(0.1 * injected),
            "stimulated_length_m": str(2.0 * wing_length(step) + 0.5 * LENGTH),
            "connected_length_m": str(2.0 * wing_length(step) + LENGTH),
            "connected_stimulated_m": str(2.0 * wing_length(step)),
            "n_clusters": "1",
            "connections_per_branch": "0.75",
        }
    with (own_run / "history.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    (own_run / "slip_events.csv").write_text(
        HEAD
        + "1,3600.0,36000.0,1,0.98,0.98,0.0,0.05,0.5,1e-05,1e5,-2.73,0.0,0.0,stick,aseismic\n"
        + "2,72000.0,234000.0,1,1.02,1.02,0.0,0.1,1.0,1e-04,1e7,-1.4,0.5,0.1,run,seismic\n",
        encoding="utf-8",
    )
    with (own_run / "scene.nml").open("a", encoding="utf-8") as file:
        file.write(
            "&domain x_min = 0.0, x_max = 2.0, y_min = 0.0, y_max = 2.0 /\n"
            "&material permeability = 1.0e-18 /\n"
            "&injection fracture = 'flaw', x = 1.0, y = 1.0, rate = 5.0e-9 /\n"
            "&output out_of_plane_length = 10.0 /\n"
        )
    steps = [
        {"time_s": float(time), "fractures": [_fracture(step)]} for step, time in enumerate(times())
    ]
    joint = {"kind": "X", "time_s": MET, "x_m": 1.1, "y_m": 1.0, "fractures": [1, 1]}
    network = {"fractures": [_fracture(STEPS - 1)], "steps": steps, "joints": [joint]}
    (own_run / "network.json").write_text(json.dumps(network), encoding="utf-8")
    return own_run


def _fracture(step: int) -> dict[str, object]:
    x, y = polyline(step).T.tolist()
    length = LENGTH + 2.0 * wing_length(step)
    start = {"fracture": 1, "name": "flaw", "s_start_m": -wing_length(step), "length_m": length}
    return start | {"x_m": x, "y_m": y}


def panel(figure: Figure, title: str) -> Axes:
    (axes,) = (axes for axes in figure.axes if title in axes.get_title(loc="left"))
    return axes


def labels(axes: Axes) -> dict[str, np.ndarray]:
    return {str(line.get_label()): np.asarray(line.get_ydata(), float) for line in axes.lines}


def test_panels_with_their_curves(stimulated: Path) -> None:
    figure = story(read_run(stimulated))
    assert [t for axes in figure.axes if (t := axes.get_title(loc="left"))] == TITLES
    curves = labels(panel(figure, "length:"))
    assert curves["connected"][-1] == pytest.approx(LENGTH + 2.0 * wing_length(STEPS - 1))
    assert curves["both"][-1] == pytest.approx(2.0 * wing_length(STEPS - 1))
    # 10 m thick: ten times the moment per metre
    moment = np.asarray(panel(figure, "moment").lines[0].get_ydata(), float)
    assert moment[-1] == pytest.approx(10.0 * 1.0e3 * (STEPS - 1))


def test_the_fluid_adds_up_to_what_was_injected(stimulated: Path) -> None:
    figure = story(read_run(stimulated))
    axes = panel(figure, "fluid")
    injected = labels(axes)["injected"]
    stacked = [
        float(np.asarray(item.get_paths()[0].vertices)[:, 1].max()) for item in axes.collections
    ]
    assert stacked == pytest.approx([0.4 * injected[-1], 0.9 * injected[-1], injected[-1]])


def test_marks_tell_what_happened(stimulated: Path) -> None:
    figure = story(read_run(stimulated))
    marks = [text.get_text() for text in panel(figure, "injectivity").texts]
    assert marks == ["1", "g"]
    words = "\n".join(text.get_text() for axes in figure.axes for text in axes.texts)
    assert "1: flaw and flaw meet, 10 h\n" in words + "\n"
    assert "g: growth begins" in words
    assert "1 seismic event, largest $M_w$ = $-1.40$\n1 aseismic slip, moment 1e+05 N m\n" in words


def test_a_well_along_a_fracture_stands_on_what_the_scene_has_of_it(stimulated: Path) -> None:
    scene = stimulated / "scene.nml"
    scene.write_text(scene.read_text().replace(", x = 1.0, y = 1.0, rate", ", rate"))
    axes = panel(story(read_run(stimulated)), "network")
    (well,) = (line for line in axes.lines if line.get_marker() == "v")
    first, last = polyline(0)[[0, -1]]
    assert np.asarray(well.get_xydata())[0] == pytest.approx(first + 0.6 * (last - first), abs=1e-9)


def test_the_map_has_states_wells_and_events(stimulated: Path) -> None:
    figure = story(read_run(stimulated))
    axes = panel(figure, "network")
    circles = [
        line for line in axes.lines if line.get_marker() == "o" and line.get_markersize() > 5.0
    ]
    assert len(circles) == 2
    assert (
        circles[0].get_markersize() > circles[1].get_markersize()
    )  # the larger one is drawn first
    (well,) = (line for line in axes.lines if line.get_marker() == "v")
    assert np.asarray(well.get_xydata()).tolist() == [[1.0, 1.0]]
    # the pieces of the fracture, in whatever state, are all of it
    pieces = [line.get_xydata() for line in axes.lines if line.get_path_effects()]
    length = sum(np.linalg.norm(np.diff(piece, axis=0), axis=1).sum() for piece in pieces)
    assert length == pytest.approx(LENGTH + 2.0 * wing_length(STEPS - 1))


@pytest.mark.parametrize("flat", [False, True])
@pytest.mark.parametrize(("layout", "width"), [("page", 7.1), ("column", 3.5), ("slide", 13.25)])
def test_legend_facts_and_panels_lie_apart(
    stimulated: Path, layout: str, width: float, flat: bool
) -> None:
    scene = stimulated / "scene.nml"
    if flat:
        text = scene.read_text()
        scene.write_text(text.replace("y_min = 0.0, y_max = 2.0", "y_min = 0.8, y_max = 1.2"))
    with style.layout(layout):
        figure = story(read_run(stimulated))
    assert figure.get_figwidth() == pytest.approx(width)
    figure.draw_without_rendering()
    legend, facts = (axes for axes in figure.axes if not axes.axison)
    found = [legend.get_legend(), *facts.texts, *(axes for axes in figure.axes if axes.axison)]
    boxes = [item.get_window_extent() for item in found if item is not None]
    whole = figure.bbox.padded(1.0)
    for k, box in enumerate(boxes):
        assert whole.x0 <= box.x0 and whole.y0 <= box.y0 and box.y1 <= whole.y1
        # the pressure and its rate share a place
        assert not [b for b in boxes[:k] if box.overlaps(b) and not np.allclose(box, b)]


def test_files_and_what_is_missing(
    stimulated: Path, wet_run: Path, dry_run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plot", str(stimulated), "--only", "story", "--quiet"]) == 0
    names = sorted(path.name for path in (stimulated / "figures").glob("[!.]*"))
    assert names == ["story.png"]
    (stimulated / "slip_events.csv").write_text(HEAD, encoding="utf-8")
    figure = story(read_run(stimulated))
    assert not [axes for axes in figure.axes if "slip events" in axes.get_title(loc="left")]
    with pytest.raises(AbsentError, match="no well, or an earlier version"):
        story(read_run(wet_run))
    with pytest.raises(AbsentError, match="mechanics only"):
        story(read_run(dry_run))
    capsys.readouterr()
