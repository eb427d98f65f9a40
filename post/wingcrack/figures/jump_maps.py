"""Where a network slips and opens: its fractures coloured by slip, and by aperture or opening."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.fields import FractureField
from wingcrack.figures.frames import (
    CHANGED,
    draw_fractures_by,
    extent,
    line_width,
    read_frame,
    set_window,
    value_scale,
    written_states,
    zoom_window,
)
from wingcrack.figures.load import moment_label
from wingcrack.figures.read import Run
from wingcrack.figures.scales import run_length_unit
from wingcrack.figures.states import last_settled
from wingcrack.figures.units import displacement_unit

_WIDTH = 2.6  # [point] of few fractures


@style.styled
def jump_maps(run: Run, wanted_s: Sequence[float] = ()) -> Figure:
    """Draw slip, and aperture or without a fluid opening, of all fractures in the last state.

    Raises `AbsentError` if the run wrote no fields, or has no fractures.

    `wanted_s`: the written state nearest to the first of these moments is drawn instead.
    """
    written, rows = written_states(run)
    place = last_settled(run, written, rows)
    if len(wanted_s):
        place = int(np.argmin(np.abs(np.array(written) - wanted_s[0])))
    frame = read_frame(run, place)
    fractures = frame.fractures
    if fractures is None or not len(fractures.segments):
        raise AbsentError("the run has no fractures")
    names = ["slip", "aperture" if "aperture" in fractures.cell else "opening"]
    body = extent([frame.matrix])
    jump = np.hypot(*fractures.cell["jump"].T[:2])
    changed = FractureField(fractures.segments[jump >= CHANGED * jump.max()], fractures.state)
    view = zoom_window(body, [changed], small=np.inf) or body
    unit = run_length_unit(run)
    panel = min(3.0, 2.6 * view.ratio)
    figure = style.new_figure(style.DOUBLE_COLUMN, panel + 0.7)
    panels = list(figure.subplots(1, len(names)))
    for axes, name in zip(panels, names, strict=True):
        values = fractures.of(name)
        fitting = displacement_unit(values)
        drawn = fitting.of(values)
        norm = Normalize(0.0, float(drawn.max()) or 1.0)
        if name == "aperture":
            norm = value_scale([drawn])
        draw_fractures_by(axes, fractures, drawn, norm, line_width(run, _WIDTH), unit)
        set_window(axes, view, unit)
        style.map_axes(axes, unit)
        axes.set_title(f"{name}, {moment_label(run, frame.moment, frame.row)}")
        bar = figure.colorbar(
            ScalarMappable(norm, style.JUMP_COLOURS), ax=axes, aspect=25, pad=0.03, shrink=0.9
        )
        bar.set_label(f"{name} [{fitting.name}]")
    style.letter(panels)
    return figure
