"""The drawing of the body: arrows of the tractions, and where they are told in numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver

from wingcrack.figures import read_run
from wingcrack.figures.geometry import draw_geometry


def test_tractions_are_arrows_and_told_where_they_are_uniform(own_run: Path) -> None:
    """Stress in situ of a square of 2 m: 40 MPa below, 20 MPa above, 9 to 11 MPa on both sides."""
    with (own_run / "scene.nml").open("a", encoding="utf-8") as file:
        file.write(
            "&domain x_min = 0.0, x_max = 2.0, y_min = 0.0, y_max = 2.0 /\n"
            "&in_situ sxx = -1.0e7, sxx_per_y = 1.0e6, syy = -3.0e7, syy_per_y = 1.0e7,"
            " y_datum = 1.0 /\n"
        )
    axes = Figure().add_subplot()
    handles = draw_geometry(axes, read_run(own_run))
    assert "traction, largest 40 MPa" in [handle.get_label() for handle in handles]
    told = {text.get_text(): text.get_position() for text in axes.texts}
    assert set(told) == {"20 MPa", "40 MPa"}
    assert [told[value][0] for value in sorted(told)] == pytest.approx([1.0, 1.0])
    assert told["40 MPa"][1] < 0.0 < 2.0 < told["20 MPa"][1]
    (arrows,) = (one for one in axes.collections if isinstance(one, Quiver))
    tails, ways = np.asarray(arrows.get_offsets()), np.column_stack((arrows.U, arrows.V))
    assert len(tails) == 20
    heads = tails + ways  # on the boundary, from outside: compression
    on_side = np.isclose(np.abs(heads - 1.0), 1.0)
    assert on_side.any(axis=1).all()
    stress = np.where(on_side[:, 0], 11.0 - heads[:, 1], 40.0 - 10.0 * heads[:, 1])
    lengths = np.linalg.norm(ways, axis=1)
    assert lengths / lengths.max() == pytest.approx(stress / 40.0)
    assert (np.sum(ways * (heads - 1.0), axis=1) < 0.0).all()
