"""The page of a run: loads from the scene, facts, the figure of any run, and the browser's page."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from wingcrack.command_line import main
from wingcrack.figures import read_run
from wingcrack.figures.facts import gather_facts
from wingcrack.figures.geometry import read_loading
from wingcrack.figures.page import write_page
from wingcrack.figures.summary import summary

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]])
ANGLES = np.linspace(0.0, 2.0 * np.pi, 361)
RIM = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))


def test_tractions_and_supports_of_a_rectangle(tmp_path: Path) -> None:
    path = tmp_path / "scene.nml"
    path.write_text(
        "&side name = 'left', x_displacement = 0.0 /\n"
        "&side name = 'right', x_traction = -2.0D7, -1.0e7, y_spring = 1e9 /\n"
        "&side name = 'top', normal_traction = -1.0e7, shear_traction = 3.0e6 /\n"
        "&side name = 'bottom', x_displacement = 0.0, y_displacement = 0.0 /\n",
        encoding="utf-8",
    )
    found = read_loading(path, SQUARE)
    on_top = np.array([place[1] == 2.0 for place in found.traction_places])
    tractions = np.array(found.tractions)
    # the body lies on the left of who walks along its top towards -x
    assert tractions[on_top] == pytest.approx(np.tile([-3.0e6, -1.0e7], (5, 1)))
    assert tractions[~on_top] == pytest.approx(np.tile([-2.0e7, 0.0], (5, 1)))
    assert found.changes
    assert [(one.in_x, one.in_y) for one in found.held].count((True, True)) == 5
    assert [(one.in_x, one.in_y) for one in found.held].count((True, False)) == 5
    assert len(found.springs) == 5


def test_stress_in_situ_presses_on_every_side(tmp_path: Path) -> None:
    path = tmp_path / "scene.nml"
    path.write_text(
        "&in_situ sxx = -1.0e7, syy = -3.0e7, syy_per_y = 1.0e7, y_datum = 1.0 /\n", "utf-8"
    )
    found = read_loading(path, SQUARE)
    middles = {
        tuple(place): traction
        for place, traction in zip(found.traction_places, found.tractions, strict=True)
    }
    assert middles[1.0, 2.0] == pytest.approx([0.0, -2.0e7])
    assert middles[1.0, 0.0] == pytest.approx([0.0, 4.0e7])
    assert middles[0.0, 1.0] == pytest.approx([1.0e7, 0.0])


def test_an_arc_of_a_disc_and_an_edge_of_a_polygon(tmp_path: Path) -> None:
    path = tmp_path / "scene.nml"
    path.write_text(
        "&domain shape = 'disc' /\n"
        "&side name = 'a', arc_from_deg = -30, arc_to_deg = 30, normal_traction = -1 /\n",
        encoding="utf-8",
    )
    found = read_loading(path, RIM)
    assert len(found.tractions) == 4
    assert np.array(found.tractions) == pytest.approx(-np.array(found.traction_places))
    for turned in (SQUARE, SQUARE[::-1]):  # corners may go either way round
        edge = 1 + next(k for k in range(4) if np.all(turned[k : k + 2, 0] == 2.0))
        path.write_text(
            f"&domain shape = 'polygon' /\n&side name = 'a', edges = {edge},"
            " normal_traction = -5 /\n",
            encoding="utf-8",
        )
        found = read_loading(path, turned)
        assert np.array(found.tractions) == pytest.approx(np.tile([-5.0, 0.0], (5, 1)))


def test_facts_are_those_of_the_files(own_run: Path) -> None:
    record = {
        "scene": "synthetic",
        "status": "failed",
        "reason": "no convergence",
        "keq_over_kic": 1.25,
        "mass_error_relative": 3.0e-9,
        "warnings": ["first <b>", "second"],
        "left_out": ["regions: uniform rock"],
        "wall_s": 12.5,
    }
    (own_run / "run.json").write_text(json.dumps(record), encoding="utf-8")
    facts = gather_facts(read_run(own_run))
    assert (facts.status, facts.ended) == ("failed", "failed: no convergence")
    assert "highest well pressure: 13 MPa at 65 h" in facts.results
    assert any(line.endswith("of a state: 1.25") for line in facts.results)
    assert "- mass error, relative: 3.0e-09" in facts.errors
    assert facts.warnings == ["first <b>", "second"]
    (own_run / "run.json").unlink()
    assert gather_facts(read_run(own_run)).status == "running"


@pytest.mark.parametrize("fluid", [True, False])
def test_any_run_has_its_page(fluid: bool, wet_run: Path, dry_run: Path) -> None:
    figure = summary(read_run(wet_run if fluid else dry_run))
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert [title[:5] for title in titles if title.startswith("(")] == [
        f"({letter})  "
        for letter in "abcd"  # without a network no map of it
    ]
    driven = "(b)  well pressure" if fluid else "(b)  largest slip and opening"
    assert driven in titles
    assert "results" in titles


def test_a_long_list_of_warnings_is_counted(own_run: Path) -> None:
    record = {"status": "finished", "warnings": [f"warning {k}" for k in range(60)]}
    (own_run / "run.json").write_text(json.dumps(record), encoding="utf-8")
    figure = summary(read_run(own_run))
    words = "\n".join(text.get_text() for axes in figure.axes for text in axes.texts)
    assert "warning 5\n" in words
    assert "lines more: see run.json" in words


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.links += [value for name, value in attrs if name in ("src", "href") and value]

    def handle_data(self, data: str) -> None:
        self.text += data


def test_the_page_shows_what_is_there(own_run: Path) -> None:
    path = own_run / "run.json"
    record = json.loads(path.read_text(encoding="utf-8")) | {"warnings": ["a <script>"]}
    path.write_text(json.dumps(record), encoding="utf-8")
    assert main(["plot", str(own_run), "--only", "summary", "--format", "png,pdf"]) == 0
    page = own_run / "figures" / "index.html"
    first = _Page()
    first.feed(page.read_text(encoding="utf-8"))
    assert first.links == ["captions.txt", "summary.png", "summary.png", "summary.pdf"]
    assert "a <script>" in first.text
    assert "<script>" not in page.read_text(encoding="utf-8")
    assert main(["plot", str(own_run), "--only", "tips,summary", "--quiet"]) == 0
    second = _Page()
    second.feed(page.read_text(encoding="utf-8"))
    assert "balance.png" in second.links
    assert all((page.parent / link).is_file() for link in second.links)


def test_figures_follow_each_other_by_kind_and_number(wet_run: Path, tmp_path: Path) -> None:
    for name in ("fracture_10", "balance", "fracture_2", "of_a_user", "story", "summary"):
        (tmp_path / f"{name}.png").touch()
    page = _Page()
    order = ("summary", "story", "fracture", "balance")
    *_, file = write_page(read_run(wet_run), tmp_path, order)
    page.feed(file.read_text(encoding="utf-8"))
    assert [link.removesuffix(".png") for link in page.links[1::2]] == [
        "summary",
        "story",
        "fracture_2",
        "fracture_10",
        "balance",
        "of_a_user",
    ]
