"""Maps and figures of many fractures: which of them are named or drawn, and where names stand."""

from __future__ import annotations

from io import BytesIO
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from wingcrack.command_line import main
from wingcrack.figures import catalogue, profiles
from wingcrack.figures import growth as growth_module
from wingcrack.figures.growth import MOST, Growth, foremost
from wingcrack.figures.scene import Scene, Well
from wingcrack.figures.story_map import Names, _candidates
from wingcrack.figures.table import FloatArray


def drawn(lines: dict[str, FloatArray], points: FloatArray | None = None) -> Names:
    """Names of lines in axes of 3 by 3 inches from 0 to 1."""
    figure = Figure(figsize=(4.0, 4.0))
    axes = figure.add_axes((0.125, 0.125, 0.75, 0.75), xlim=(0, 1), ylim=(0, 1))
    marks = np.empty((0, 2)) if points is None else points
    names = Names(list(lines.items()), list(lines.values()), marks)
    axes.add_artist(names)
    FigureCanvasAgg(figure).print_figure(BytesIO())
    for _, box in names.placed:
        assert axes.bbox.x0 <= box.x0 <= box.x1 <= axes.bbox.x1
        assert axes.bbox.y0 <= box.y0 <= box.y1 <= axes.bbox.y1
    for (one, box), (other, taken) in combinations(names.placed, 2):
        assert not box.overlaps(taken), (one, other)
    return names


def test_a_single_fracture_has_its_name_beside_its_first_end() -> None:
    ((name, box),) = drawn({"flaw": np.array([[0.4, 0.4], [0.6, 0.6]])}).placed
    middle = np.array([(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2])
    assert name == "flaw"
    assert np.linalg.norm(middle - (50 + 0.4 * 300)) < 25.0  # [pixel], at 100 per inch


def test_names_of_many_fractures_overlap_nothing() -> None:
    rng = np.random.default_rng(3)
    starts = rng.random((60, 2))
    lines = {f"Kluft_{k}": np.stack((p, p + np.array([0.1, 0.05]))) for k, p in enumerate(starts)}
    placed = [name for name, _ in drawn(lines).placed]
    assert 12 <= len(placed) < 60
    assert placed[0] == "Kluft_0"


def test_a_name_without_room_is_left_out() -> None:
    here = np.array([[0.5, 0.5], [0.51, 0.5]])
    assert [name for name, _ in drawn({f"fracture {k}": here for k in range(9)}).placed][:1] == [
        "fracture 0"
    ]
    assert len(drawn({f"fracture {k}": here for k in range(9)}).placed) < 9
    assert drawn({"a" * 80: here}).placed == []
    assert drawn({"outside": here + 1.0}).placed == []
    well = np.array([[0.48, 0.5], [0.52, 0.52], [0.5, 0.48], [0.5, 0.53]])
    for _, box in drawn({"f": here}, well).placed:
        assert not any(box.contains(*(50 + 300 * place)) for place in well)


def fracture(name: str, length: float, wing: float = 0.0) -> Growth:
    ends = np.array([[0.0, 0.0], [length, 0.0]])
    grown = np.array([[length, 0.0], [length + wing, 0.0]])[: 2 if wing else 1]
    steps = np.zeros(len(grown) - 1, dtype=np.int64)
    return Growth(1, name, ends, ends[:1], grown, steps[:0], steps)


def test_wells_come_first_then_growth_then_length() -> None:
    fractures = [fracture(f"f{k}", 1.0 + k) for k in range(20)]
    fractures += [fracture("grown", 0.2, 0.1), fracture("fed", 0.1)]
    scene = Scene("", "", None, (), wells=(Well(0.0, None, "fed"),))
    found = [item.name for item in foremost(fractures, scene)]
    assert found[:4] == ["fed", "grown", "f19", "f18"]
    assert len(found) == MOST
    assert [item.name for item in foremost(fractures[:2], None)] == ["f1", "f0"]


def test_of_many_fractures_some_get_a_figure_unless_all_are_asked_for(
    own_run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(profiles, "MOST", 2)
    monkeypatch.setattr(growth_module, "MOST", 2)
    only = [kind for kind in catalogue._FIGURES if kind.group == "fractures"]
    monkeypatch.setattr(catalogue, "_FIGURES", only)
    path = own_run / "fractures.csv"
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    place = head.split(",").index("fracture")
    more = [
        ",".join(number if k == place else cell for k, cell in enumerate(row.split(",")))
        for number in ("2", "3")
        for row in rows
    ]
    path.write_text("\n".join([head, *rows, *more]) + "\n", encoding="utf-8")
    call = ["plot", str(own_run)]

    def pictures() -> list[str]:
        return sorted(file.name for file in (own_run / "figures").glob("fracture*"))

    assert main(call) == 0
    assert "1 of 3 fractures: they stick without a well" in capsys.readouterr().out
    assert pictures() == ["fracture_1.png", "fracture_2.png"]
    assert main([*call, "--only", "fractures"]) == 0
    assert pictures() == ["fracture_1.png", "fracture_2.png", "fracture_3.png"]
    assert main(call) == 0
    assert pictures() == ["fracture_1.png", "fracture_2.png"]
    capsys.readouterr()
    assert main(call) == 0
    assert "(unchanged)" in capsys.readouterr().out


@pytest.mark.parametrize("way", [(1.0, 0.0), (0.0, 1.0), (3.0, 4.0), (-3.0, 4.0)])
def test_names_stand_on_one_side_whichever_way_it_is_drawn(
    way: tuple[float, float],
) -> None:
    """Beside its middle: above it, and of an upright one to the right."""
    line = np.array([[0.0, 0.0], way])
    for drawn in (line, line[::-1]):
        middle = list(_candidates(drawn, 1.0))[2] - drawn.mean(axis=0)
        assert middle @ np.array(way) == pytest.approx(0.0, abs=1e-12)
        assert middle[1] > 1e-9 or (abs(middle[1]) <= 1e-9 and middle[0] > 0.0)
