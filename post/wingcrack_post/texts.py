"""How large texts are and where their letters are: found once for all figures.

matplotlib forgets both from figure to figure, looks for the font each time that it asks for the
height of a line, and reads a formula anew for each picture that it goes to.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from matplotlib.backends import backend_agg
from matplotlib.font_manager import FontProperties, fontManager, get_font
from matplotlib.mathtext import MathTextParser

_Pen: Any = backend_agg.RendererAgg  # matplotlib gives it no types
_POINTS_PER_INCH = 72.0


class Texts:
    """Texts in pixels.

    Parameters
    ----------
    dpi : float
        Pixels per inch.
    """

    def __init__(self, dpi: float) -> None:
        self._dpi = dpi
        self._pen = _Pen(1, 1, dpi)
        self.formulas = Formulas()
        self._pen.mathtext_parser = self.formulas
        self._sizes: dict[Any, tuple[float, float, float]] = {}
        self._lines: dict[Any, tuple[float | None, float | None, float | None]] = {}

    def size(self, text: str, look: FontProperties, ismath: Any) -> tuple[float, float, float]:
        """Width and height of a text, and how far it goes below its line [pixel]."""
        key = text, look, ismath
        found = self._sizes.get(key)
        if found is None:
            found = self._pen.get_text_width_height_descent(text, look, ismath)
            self._sizes[text, look.copy(), ismath] = found  # a look may change later
        return found

    def line(self, look: FontProperties) -> tuple[float | None, float | None, float | None]:
        """How far letters of a font may go above and below their line, and the gap between lines.

        In pixels; without numbers where the font does not tell.
        """
        found = self._lines.get(look)
        if found is None:
            font: Any = get_font(fontManager._find_fonts_by_props(look))
            table = font.get_sfnt_table("OS/2")
            if table is None:
                found = None, None, None
            else:
                pixels = look.get_size_in_points() * self._dpi / _POINTS_PER_INCH
                scale = pixels / font.units_per_EM
                found = (
                    table["sTypoAscender"] * scale,
                    -table["sTypoDescender"] * scale,
                    table["sTypoLineGap"] * scale,
                )
            self._lines[look.copy()] = found
        return found


class Formulas:
    """Reads formulas; what `MathTextParser` does, each of them once."""

    def __init__(self) -> None:
        self._parser: Any = MathTextParser("path")
        self._known: dict[Any, Any] = {}

    def parse(
        self, s: str, dpi: float, prop: FontProperties, *, antialiased: bool | None = None
    ) -> Any:
        """Width, height and depth, letters and lines with their places, in pixels."""
        key = s, dpi, prop, antialiased
        if key not in self._known:
            parsed = self._parser.parse(s, dpi, prop, antialiased=antialiased)
            self._known[s, dpi, prop.copy(), antialiased] = parsed
        return self._known[key]


class FormulasInPoints:
    """Formulas that were read for pixels, for a page in points.

    Parameters
    ----------
    formulas : Formulas
    dpi : float
        Pixels per inch.
    """

    def __init__(self, formulas: Formulas, dpi: float) -> None:
        self._formulas = formulas
        self._dpi = dpi

    def parse(self, s: str, _dpi: float, prop: FontProperties) -> Any:
        """Width, height and depth, letters and lines with their places, in points."""
        factor = _POINTS_PER_INCH / self._dpi
        width, height, depth, glyphs, rects = self._formulas.parse(s, self._dpi, prop)
        return (
            width * factor,
            height * factor,
            depth * factor,
            [(*letter, x * factor, y * factor) for *letter, x, y in glyphs],
            [tuple(side * factor for side in rect) for rect in rects],
        )


@cache
def texts(dpi: float) -> Texts:
    """Texts of all figures with this resolution."""
    return Texts(dpi)
