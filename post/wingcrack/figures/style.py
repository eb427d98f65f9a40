"""One look for all figures: legible in print and for colour-blind readers."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from pathlib import Path
from typing import Any, Literal, ParamSpec, TypeVar

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap, LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from PIL import Image

from wingcrack.figures.units import Unit

P = ParamSpec("P")
R = TypeVar("R")

_LAYOUT = ContextVar("layout", default="page")
_ENLARGED, _LARGER_TEXT = 1.25, 1.6  # of slides, compared with pages

_PAGE, _PAGE_DPI = 9.0, 200.0  # height from which on a figure is a page for the screen [inch]
_WHOLE = "whole"  # label of a figure that is all of a page
SINGLE_COLUMN = 3.5  # [inch], as most journals have it
DOUBLE_COLUMN = 7.1  # [inch]
_SLIDE = 10.6  # [inch on a page], 13.3 inches after enlargement
_SMALL, _LINE = 7.0, 0.133  # of small text: its size [point], height of its lines [inch]

# Okabe and Ito (2008), "Color universal design"; yellow is left out: too light on paper
CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
MARKERS = ("", "o", "s", "^", "v", "D", "x")  # in addition to the colours, for grey print
LINE_STYLES: tuple[Literal["-", "--", "-.", ":"], ...] = ("-", "--", "-.", ":")

STATES = ("stick", "slip", "open")  # in the order of their numbers in the VTU files
STATE_COLOURS = {"stick": "#000000", "slip": "#D55E00", "open": "#56B4E9"}

_LONG = 1.0e5  # coordinates with so many digits that their labels are long
STEADY = 1.0e-6  # share of the values below which their differences say nothing

FIELD_COLOURS = "cividis"
JUMP_COLOURS = "magma_r"  # of slip and aperture: what is zero is pale
_METADATA: dict[str, dict[str, Any]] = {"pdf": {"CreationDate": None}}
_PNG_LEVEL = 1  # of compression: a fifth more bytes, a tenth less time

RC: dict[Any, Any] = {
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,  # a tick says its whole value
    "axes.grid": True,
    "axes.labelsize": 8,
    "axes.linewidth": 0.6,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 8,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.h_pad": 0.05,
    "figure.constrained_layout.w_pad": 0.05,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with matplotlib, so it is the same everywhere
    "font.size": 8,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.4,
    "legend.fontsize": 7,
    "legend.edgecolor": "none",
    "legend.framealpha": 0.8,
    "legend.handlelength": 1.8,
    "lines.linewidth": 1.2,
    "lines.markersize": 3,
    "mathtext.fontset": "dejavusans",
    "pdf.fonttype": 42,  # TrueType: text in the PDF stays text
    "savefig.dpi": 300,
    "xtick.labelsize": 7,
    "xtick.major.width": 0.6,
    "ytick.labelsize": 7,
    "ytick.major.width": 0.6,
}


class _Column(Figure):
    """A figure of one column: all panels stand below each other."""

    def subplots(self, nrows: int = 1, ncols: int = 1, *, squeeze: bool = True, **more: Any) -> Any:
        width, height = self.get_size_inches()
        self.set_size_inches(
            SINGLE_COLUMN, height * (ncols if ncols > 1 else SINGLE_COLUMN / width)
        )
        found = super().subplots(nrows * ncols, 1, squeeze=False, **more).reshape(nrows, ncols)
        return np.squeeze(found)[()] if squeeze else found


@contextmanager
def layout(name: str) -> Iterator[None]:
    """Draw for a page, one of its columns, or a slide (`LAYOUTS` of choices)."""
    token = _LAYOUT.set(name)
    try:
        yield
    finally:
        _LAYOUT.reset(token)


def across(panels: int) -> int:
    """Panels side by side where a page has so many."""
    return 1 if _LAYOUT.get() == "column" else panels


def chosen(*, page: R, column: R, slide: R) -> R:
    """Choose what the layout takes."""
    return {"page": page, "column": column, "slide": slide}[_LAYOUT.get()]


def text_height(lines: float) -> float:
    """Height of small text [inch on a page]."""
    return chosen(page=1.0, column=1.0, slide=_LARGER_TEXT / _ENLARGED) * _LINE * lines


def text_size() -> float:
    """Size of small text [point]."""
    return chosen(page=1.0, column=1.0, slide=_LARGER_TEXT) * _SMALL


def whole_width() -> float:
    """Width of a figure that is all of a page, a column or a slide [inch on a page]."""
    return chosen(page=DOUBLE_COLUMN, column=SINGLE_COLUMN, slide=_SLIDE)


def _side_by_side(entries: int) -> int:
    """Entries of a legend in a row where a page has so many."""
    return chosen(page=entries, column=min(entries, 2), slide=(entries + 1) // 2)


def new_figure(width: float, height: float, *, whole: bool = False) -> Figure:
    """Empty figure in the common style; sizes in inches, as a page has them.

    `whole`: a figure for the screen, that is all of a page. No pyplot: a figure belongs to its
    caller and leaves no state behind.
    """
    kind = _Column if _LAYOUT.get() == "column" else Figure
    larger = _ENLARGED if _LAYOUT.get() == "slide" else 1.0
    figure = kind(figsize=(larger * width, larger * height))
    figure.set_label(_WHOLE if whole else "")
    return figure


def _settings() -> dict[Any, Any]:
    if _LAYOUT.get() != "slide":
        return RC
    sizes = ("size", "linewidth", "major.width")
    return {
        key: _LARGER_TEXT * value if key.endswith(sizes) else value for key, value in RC.items()
    }


def styled(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function that makes or saves a figure: it then does so in the common style."""

    @wraps(function)
    def within(*args: P.args, **kwargs: P.kwargs) -> R:
        with matplotlib.rc_context(_settings()):
            return function(*args, **kwargs)

    return within


def line_look(index: int) -> dict[str, Any]:
    """Colour and dash pattern of the line with this number: 28 that differ.

    Neighbours differ in both, so that a line on top of another one lets it be seen.
    """
    return {"color": CYCLE[index % len(CYCLE)], "linestyle": LINE_STYLES[index % len(LINE_STYLES)]}


def ordered_colours(count: int) -> list[tuple[float, float, float, float]]:
    """Give colours from dark to light for lines in order; the palest part is left out."""
    colours = time_colours()
    return [colours(index / max(count - 1, 1)) for index in range(count)]


def time_colours() -> Colormap:
    """Sequential map whose light end is still seen on white paper."""
    base = matplotlib.colormaps["viridis"]
    return LinearSegmentedColormap.from_list("time", [base(0.88 * i / 63) for i in range(64)])


def lone_marker(points: int) -> str:
    """Marker for a line of so many points: a single one would leave nothing to see."""
    return "." if points == 1 else ""


def letter(axes: Sequence[Axes]) -> None:
    """Put (a), (b), ... before the titles of panels, for the caption to refer to."""
    for index, axis in enumerate(axes):
        title = axis.get_title(loc="left")
        axis.set_title(f"({chr(ord('a') + index)})  {title}".rstrip(), loc="left")


def steady(axes: Axes, values: Sequence[npt.ArrayLike]) -> None:
    """Limits for curves that are zero, or that differ by round-off only: not those of the noise."""
    found = np.concatenate([np.ravel(np.asarray(value, dtype=float)) for value in values])
    found = found[np.isfinite(found)]
    if found.size == 0:
        return
    largest = float(np.abs(found).max())
    if largest == 0.0:
        axes.set_ylim(-1.0, 1.0)
        axes.text(0.5, 0.6, "zero", transform=axes.transAxes, ha="center", color="#555555")
    elif float(np.ptp(found)) <= STEADY * largest:
        axes.set_ylim(*sorted((0.9 * found[0], 1.1 * found[0])))


def state_handles(line_width: float = 2.0) -> list[Line2D]:
    """Entries of the legend that tells stick, slip and open."""
    return [
        handle(color=STATE_COLOURS[state], linewidth=line_width, label=state) for state in STATES
    ]


def handle(**look: Any) -> Line2D:
    """Entry of a legend that stands for lines or marks of a look."""
    return Line2D([], [], **look)


def map_axes(axes: Axes, unit: Unit) -> None:
    """Axes of a map: both of one scale, in this unit, without a grid."""
    axes.set(aspect="equal", xlabel=f"$x$ [{unit.name}]", ylabel=f"$y$ [{unit.name}]")
    axes.grid(visible=False)
    place_ticks(axes)


def place_ticks(axes: Axes) -> None:
    """Coordinates far from the origin in all digits, so few of them side by side."""
    axes.ticklabel_format(style="plain")
    if max(map(abs, axes.get_xlim())) >= _LONG:
        axes.xaxis.set_major_locator(MaxNLocator(2))


def outside_legend(figure: Figure, handles: Sequence[Any], columns: int) -> None:
    """Legend below all panels; none without entries."""
    if not handles:
        return
    figure.legend(handles=list(handles), loc="outside lower center", ncols=_side_by_side(columns))


@styled
def save(figure: Figure, stem: Path, formats: Sequence[str]) -> list[Path]:
    """Write a figure in each format and return the files.

    A file appears whole (written aside, then renamed) and holds no date, so that the same run
    gives the same bytes.
    """
    stem.parent.mkdir(parents=True, exist_ok=True)
    for axes in figure.axes:
        for spine in axes.spines.values():
            spine.set_in_layout(False)  # it lies on the edge of its axes, and takes time to measure
    written = []
    for form in formats:
        aside = stem.with_name(f".{stem.name}.{os.getpid()}.{form}")
        try:
            if form == "png":
                is_page = figure.get_figheight() > _PAGE or figure.get_label() == _WHOLE
                figure.set_dpi(min(RC["savefig.dpi"], _PAGE_DPI if is_page else np.inf))
                # savefig draws twice, first for the layout; this draws once
                canvas: Any = FigureCanvasAgg(figure)
                canvas.draw()
                image = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
                image.save(aside, dpi=(figure.dpi, figure.dpi), compress_level=_PNG_LEVEL)
            else:
                figure.savefig(aside, metadata=_METADATA.get(form))
            written.append(aside.replace(stem.with_name(f"{stem.name}.{form}")))
        finally:
            aside.unlink(missing_ok=True)
    return written
