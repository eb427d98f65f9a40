"""How large texts are and where their letters are: found once for all figures.

matplotlib forgets both from figure to figure, looks for the font each time that it asks for the
height of a line, and reads a formula anew for each picture that it goes to.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
from matplotlib.font_manager import FontProperties, fontManager, get_font
from matplotlib.ft2font import LoadFlags
from matplotlib.mathtext import MathTextParser

# matplotlib gives these no types
backend_agg: Any = import_module("matplotlib.backends.backend_agg")
backend_pdf: Any = import_module("matplotlib.backends.backend_pdf")
_Pen: Any = backend_agg.RendererAgg
_Page: Any = backend_pdf.RendererPdf
_Text: Any = import_module("matplotlib.text").Text
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
        self._boxes: dict[Any, Any] = {}

    @contextmanager
    def boxes_kept(self) -> Iterator[None]:
        """Let matplotlib find once, within, how a text lies around its place; it asks often."""
        find = _Text._get_layout

        def box(text: Any, renderer: Any) -> Any:
            if text.get_wrap() or renderer is None:
                return find(text, renderer)
            key = (
                text.get_text(),
                text.get_fontproperties(),
                text.get_rotation(),
                text.get_rotation_mode(),
                text.get_horizontalalignment(),
                text.get_verticalalignment(),
                text._get_multialignment(),
                text._linespacing,
                text.get_parse_math(),
                text.get_usetex(),
            )
            found = self._boxes.get(key)
            if found is None:
                found = find(text, renderer)
                self._boxes[key[0], key[1].copy(), *key[2:]] = found  # a look may change later
            return found

        _Text._get_layout = box
        try:
            yield
        finally:
            _Text._get_layout = find

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


class Pixels(_Pen):  # type: ignore[misc]
    """Draws into pixels as matplotlib does, and sets each text once for all figures.

    Parameters
    ----------
    width, height : int
        Of the picture [pixel].
    dpi : float
        Pixels per inch.
    """

    def __init__(self, width: int, height: int, dpi: float) -> None:
        super().__init__(width, height, dpi)
        self._letters = letters_of(dpi)

    def draw_text(
        self,
        gc: Any,
        x: float,
        y: float,
        s: str,
        prop: Any,
        angle: float,
        ismath: Any = False,
        mtext: Any = None,
    ) -> None:
        """Draw a text; matplotlib's arguments."""
        if ismath:
            self.draw_mathtext(gc, x, y, s, prop, angle)
            return
        size = prop.get_size_in_points()
        letters = self._letters.of(s, prop, mtext, backend_agg.get_hinting_flag())
        glyphs = [(i.ft_object, size, i.glyph_index, 0, 1, i.x, i.y) for i in letters]
        self._draw_text_glyphs_and_boxes(gc, x, y, angle, glyphs, [])

    def _draw_text_glyphs_and_boxes(
        self, gc: Any, x: float, y: float, angle: float, glyphs: Any, boxes: Any
    ) -> None:
        """Put letters where they belong; what matplotlib asks for each is the same for most."""
        cos, sin = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        flags, smooth = backend_agg.get_hinting_flag(), gc.get_antialiased()
        if not smooth:
            super()._draw_text_glyphs_and_boxes(gc, x, y, angle, glyphs, boxes)
            return
        before: Any = None
        for font, size, index, slant, extend, dx, dy in glyphs:
            if (font, size) != before:
                font.set_size(size, self.dpi)
                before = font, size
            font._set_transform(
                _turned(angle, slant, extend),
                [
                    round(0x40 * (x + dx * cos - dy * sin)),
                    round(0x40 * (self.height - y + dx * sin + dy * cos)),
                ],
            )
            bitmap = font._render_glyph(index, flags, backend_agg.RenderMode.NORMAL)
            below = int(self.height) - bitmap.top + bitmap.buffer.shape[0]
            self._renderer.draw_text_image(bitmap.buffer, bitmap.left, below, 0, gc)
        if boxes:
            super()._draw_text_glyphs_and_boxes(gc, x, y, angle, (), boxes)


class Vectors(_Page):  # type: ignore[misc]
    """Writes a page as matplotlib does, and sets each text once for all figures."""

    def draw_text(
        self,
        gc: Any,
        x: float,
        y: float,
        s: str,
        prop: Any,
        angle: float,
        ismath: Any = False,
        mtext: Any = None,
    ) -> None:
        """Write a text; matplotlib's arguments."""
        theirs = backend_pdf._text_helpers
        if not ismath:
            # theirs loads each letter from its font, of which a page only takes the number
            letters = letters_of(_POINTS_PER_INCH).of(s, prop, mtext, LoadFlags.NO_HINTING)
            backend_pdf._text_helpers = _Found(letters)
        try:
            super().draw_text(gc, x, y, s, prop, angle, ismath, mtext)
        finally:
            backend_pdf._text_helpers = theirs


class _Found:
    """Stands in for what matplotlib's PDF asks for the letters of a text."""

    def __init__(self, letters: list[Any]) -> None:
        self._letters = letters

    def layout(self, *_: Any, **__: Any) -> list[Any]:
        """Letters with their places [point]."""
        return self._letters


class _Letters:
    """Letters of texts with their places.

    Parameters
    ----------
    dpi : float
        Units of the places per inch.
    """

    def __init__(self, dpi: float) -> None:
        self._dpi = dpi
        self._known: dict[Any, list[Any]] = {}

    def of(self, text: str, look: FontProperties, artist: Any, flags: Any) -> list[Any]:
        """Letters of a text; the artist may have wishes about how they go together."""
        features = artist.get_fontfeatures() if artist is not None else None
        language = artist.get_language() if artist is not None else None
        key = text, look, features, language, flags
        found = self._known.get(key)
        if found is None:
            font: Any = get_font(fontManager._find_fonts_by_props(look))
            font.clear()
            font.set_size(look.get_size_in_points(), self._dpi)
            found = list(font._layout(text, flags=flags, features=features, language=language))
            self._known[text, look.copy(), features, language, flags] = found
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


@cache
def letters_of(dpi: float) -> _Letters:
    """Letters of all figures in this unit."""
    return _Letters(dpi)


@cache
def _turned(angle: float, slant: float, extend: float) -> Any:
    """Letters that are turned, as their library takes it."""
    cos, sin = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    turn = 0x10000 * np.array([[cos, -sin], [sin, cos]])
    return (turn @ [[extend, extend * slant], [0, 1]]).round().astype(int)
