"""Drawing a figure as PNG and PDF at once.

matplotlib walks through a figure anew for each format: it places ticks and sets text each time,
which takes most of the time of a drawing. Here it walks once, for pixels, and what it draws goes to
the PDF too, scaled to points.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.backend_bases import FigureCanvasBase, RendererBase
from matplotlib.backends import backend_pdf
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D, Bbox, Transform, TransformedPath

from wingcrack_post.fonts import letters_alone
from wingcrack_post.letters import FontLetters
from wingcrack_post.png import write_png
from wingcrack_post.texts import FormulasInPoints, Pixels, Vectors, texts

_POINTS_PER_INCH = 72.0


_PdfFile: Any = backend_pdf.PdfFile
_fonts: Any = backend_pdf._backend_pdf_ps  # type: ignore[attr-defined]


class _File(_PdfFile):  # type: ignore[misc]
    """A PDF that takes its letters from the smallest fonts there are."""

    def embedTTF(self, filename: Any, subset_index: int, charmap: Any) -> Any:  # noqa: N802
        """Write what is used of a font; matplotlib's name for it."""
        letters = letters_alone(filename)
        if letters is filename:
            return super().embedTTF(filename, subset_index, charmap)
        numbers = self._character_tracker.glyph_maps
        numbers[letters] = numbers[filename]
        theirs = _fonts.get_glyphs_subset, _fonts.font_as_file
        _fonts.get_glyphs_subset = lambda font, glyphs: _Taken(FontLetters(Path(font.path), glyphs))
        _fonts.font_as_file = FontLetters.file
        try:
            return super().embedTTF(letters, subset_index, charmap)
        finally:
            _fonts.get_glyphs_subset, _fonts.font_as_file = theirs


class _Taken:
    """Letters of a font as matplotlib's PDF takes them."""

    def __init__(self, font: FontLetters) -> None:
        self.font = font
        self.glyph_index_map = font.glyph_index_map

    def __enter__(self) -> _Taken:
        return self

    def __exit__(self, *_: object) -> None: ...


def draw_twins(figure: Figure, png: Path, pdf: Path, dpi: float) -> None:
    """Lay a figure out and draw it; without a date, so that it gives the same bytes again.

    Parameters
    ----------
    figure : Figure
        Without a layout engine afterwards.
    png, pdf : Path
        Where the pictures go.
    dpi : float
        Pixels per inch, of the PNG and of what is rasterized in the PDF.
    """
    width, height = figure.get_size_inches()
    figure.set_dpi(dpi)
    pixels = Pixels(int(width * dpi + 1.0e-6), int(height * dpi + 1.0e-6), dpi)
    file = _File(pdf, metadata={"CreationDate": None})
    try:
        file.newPage(width, height)
        vectors = Vectors(file, dpi, height, width)
        renderer = TwinRenderer(pixels, vectors)
        with texts(dpi).boxes_kept():
            _lay_out(figure, renderer)
            figure.draw(renderer)
        vectors.finalize()
        file.finalize()
    finally:
        file.close()
    write_png(np.asarray(pixels.buffer_rgba()), png, dpi)


def _lay_out(figure: Figure, renderer: RendererBase) -> None:
    """Place the panels, once: with an engine left, drawing would do it again."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    canvas = _Canvas(figure, renderer)
    engine.execute(figure)
    canvas.renderer = None  # else the figure would keep its pixels
    with matplotlib.rc_context({"figure.constrained_layout.use": False}):
        figure.set_layout_engine(None)


class _Canvas(FigureCanvasBase):
    """Lets the layout measure text with the renderer that draws it, so that it is measured once."""

    def __init__(self, figure: Figure, renderer: RendererBase) -> None:
        super().__init__(figure)
        self.renderer: RendererBase | None = renderer

    def get_renderer(self) -> RendererBase | None:
        """What matplotlib asks for to measure."""
        return self.renderer


class TwinRenderer(RendererBase):
    """Draws with two renderers.

    Parameters
    ----------
    pixels : matplotlib.backends.backend_agg.RendererAgg
        Measures text, too.
    vectors : matplotlib.backends.backend_pdf.RendererPdf
        Of a page of the same size.
    """

    def __init__(self, pixels: Any, vectors: Any) -> None:
        super().__init__()
        self._pixels = pixels
        self._vectors = vectors
        self._texts = texts(pixels.dpi)
        pixels.mathtext_parser = self._texts.formulas
        vectors._text2path.mathtext_parser = FormulasInPoints(self._texts.formulas, pixels.dpi)
        self._covered: list[npt.NDArray[np.float64]] | None = None  # while something is rasterized
        self._factor = _POINTS_PER_INCH / pixels.dpi
        self._scale = Affine2D().scale(self._factor)
        self._clips: dict[int, tuple[Any, Bbox]] = {}  # of the figure, and as the PDF has them

    @property
    def height(self) -> float:
        """Of the picture [pixel]."""
        return float(self._pixels.height)

    @property
    def width(self) -> float:
        """Of the picture [pixel]."""
        return float(self._pixels.width)

    def flipy(self) -> bool:
        """Whether the places of text and images count from above."""
        return bool(self._pixels.flipy())

    def get_canvas_width_height(self) -> tuple[float, float]:
        """Size [pixel]."""
        width, height = self._pixels.get_canvas_width_height()
        return float(width), float(height)

    def get_text_width_height_descent(
        self, s: str, prop: Any, ismath: Any
    ) -> tuple[float, float, float]:
        """Size of a text, and how far it goes below its line [pixel]."""
        return self._texts.size(s, prop, ismath)

    def _get_font_height_metrics(
        self, prop: Any
    ) -> tuple[float | None, float | None, float | None]:
        """What matplotlib asks a renderer for that knows it better [pixel]."""
        return self._texts.line(prop)

    def points_to_pixels(self, points: Any) -> Any:
        """Turn points into pixels."""
        return self._pixels.points_to_pixels(points)

    def start_rasterizing(self) -> None:
        """What follows becomes an image in the PDF: a part of the pixels."""
        self._covered = []

    def stop_rasterizing(self) -> None:
        """Put the pixels where something was drawn since `start_rasterizing` into the PDF.

        What lies below it there is part of the image, as it was drawn before.
        """
        covered, self._covered = self._covered, None
        if not covered:
            return
        image = np.asarray(self._pixels.buffer_rgba())
        corners = np.concatenate(covered)
        limits = (self.width, self.height)
        left, bottom = (int(x) for x in np.clip(np.floor(corners.min(axis=0)), 0, limits))
        right, top = (int(x) for x in np.clip(np.ceil(corners.max(axis=0)), 0, limits))
        if left == right or bottom == top:
            return
        height = image.shape[0]
        # what comes later is drawn into the same pixels
        part = image[height - top : height - bottom, left:right][::-1].copy()
        x, y = left * self._factor, bottom * self._factor
        self._vectors.draw_image(self._vectors.new_gc(), x, y, part)

    def _rasterized(self, gc: Any) -> bool:
        """Whether what is drawn with this pen has to be in pixels; where is noted."""
        if self._covered is None:
            return False
        clip = gc.get_clip_rectangle()
        page = np.array([[0.0, 0.0], [self.width, self.height]])
        self._covered.append(page if clip is None else np.asarray(clip.get_points()))
        return True

    def draw_path(self, gc: Any, path: Any, transform: Transform, rgbFace: Any = None) -> None:  # noqa: N803
        """Draw a path; `RendererBase.draw_path` has the arguments, and so on for those below."""
        self._pixels.draw_path(gc, path, transform, rgbFace)
        if not self._rasterized(gc):
            self._vectors.draw_path(self._context(gc), path, transform + self._scale, rgbFace)

    def draw_markers(
        self,
        gc: Any,
        marker_path: Any,
        marker_trans: Transform,
        path: Any,
        trans: Transform,
        rgbFace: Any = None,  # noqa: N803
    ) -> None:
        """Draw a marker at each point of a path."""
        self._pixels.draw_markers(gc, marker_path, marker_trans, path, trans, rgbFace)
        if self._rasterized(gc):
            return
        self._vectors.draw_markers(
            self._context(gc),
            marker_path,
            marker_trans + self._scale,
            path,
            trans + self._scale,
            rgbFace,
        )

    def draw_path_collection(
        self,
        gc: Any,
        master_transform: Transform,
        paths: Any,
        all_transforms: Any,
        offsets: Any,
        offset_trans: Transform,
        *rest: Any,
        **named: Any,
    ) -> None:
        """Draw paths, each with a look of its own."""
        self._pixels.draw_path_collection(
            gc, master_transform, paths, all_transforms, offsets, offset_trans, *rest, **named
        )
        if self._rasterized(gc):
            return
        self._vectors.draw_path_collection(
            self._context(gc),
            (Affine2D(master_transform.get_matrix()) + self._scale).frozen(),
            paths,
            all_transforms,
            offsets,
            (Affine2D(offset_trans.get_matrix()) + self._scale).frozen(),
            *rest,
            **named,
        )

    def draw_quad_mesh(
        self,
        gc: Any,
        master_transform: Transform,
        mesh_width: int,
        mesh_height: int,
        coordinates: Any,
        offsets: Any,
        offset_trans: Transform,
        *rest: Any,
    ) -> None:
        """Draw a mesh of quadrilaterals."""
        self._pixels.draw_quad_mesh(
            gc, master_transform, mesh_width, mesh_height, coordinates, offsets, offset_trans, *rest
        )
        if self._rasterized(gc):
            return
        self._vectors.draw_quad_mesh(
            self._context(gc),
            (Affine2D(master_transform.get_matrix()) + self._scale).frozen(),
            mesh_width,
            mesh_height,
            coordinates,
            offsets,
            (Affine2D(offset_trans.get_matrix()) + self._scale).frozen(),
            *rest,
        )

    def draw_image(self, gc: Any, x: float, y: float, im: Any, transform: Any = None) -> None:
        """Draw an image that has the size of its pixels."""
        self._pixels.draw_image(gc, x, y, im, transform)
        if self._rasterized(gc):
            return
        scaled = None if transform is None else transform + self._scale
        self._vectors.draw_image(self._context(gc), x * self._factor, y * self._factor, im, scaled)

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
        """Draw text; pixels count `y` from above, points from below."""
        self._pixels.draw_text(gc, x, y, s, prop, angle, ismath, mtext)
        if self._rasterized(gc):
            return
        place = x * self._factor, (self.height - y) * self._factor
        self._vectors.draw_text(self._context(gc), *place, s, prop, angle, ismath, mtext)

    def _context(self, gc: Any) -> Any:
        """The same pen for the PDF, with its clipping in points."""
        twin = self._vectors.new_gc()
        twin.copy_properties(gc)
        rectangle = gc.get_clip_rectangle()
        if rectangle is not None:
            twin.set_clip_rectangle(self._rectangle(rectangle))
        path, transform = gc.get_clip_path()
        if path is not None:
            twin.set_clip_path(TransformedPath(path, transform + self._scale))
        return twin

    def _rectangle(self, rectangle: Any) -> Bbox:
        """One and the same for a panel: the PDF begins a new clipping for each that differs."""
        points = np.asarray(rectangle.get_points()) * self._factor
        known = self._clips.get(id(rectangle))
        if known is None or not np.array_equal(known[1].get_points(), points):
            known = rectangle, Bbox(points)
            self._clips[id(rectangle)] = known
        return known[1]
