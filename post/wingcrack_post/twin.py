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
from matplotlib.backend_bases import FigureCanvasBase, RendererBase
from matplotlib.backends import backend_agg, backend_pdf
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D, Bbox, Transform, TransformedPath

from wingcrack_post.png import write_png

# matplotlib gives these no types
_Pixels: Any = backend_agg.RendererAgg
_Vectors: Any = backend_pdf.RendererPdf
_File: Any = backend_pdf.PdfFile

_POINTS_PER_INCH = 72.0
_CLEAR = np.array([255, 255, 255, 0], dtype=np.uint8).view(np.uint32)[0]  # where nothing is drawn


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
    pixels = _Pixels(*(int(size * dpi + 1.0e-6) for size in (width, height)), dpi)
    file = _File(pdf, metadata={"CreationDate": None})
    try:
        file.newPage(width, height)
        vectors = _Vectors(file, dpi, height, width)
        renderer = TwinRenderer(pixels, vectors)
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
        self._onto = pixels  # a layer of its own while something is rasterized
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
        width, height, descent = self._pixels.get_text_width_height_descent(s, prop, ismath)
        return float(width), float(height), float(descent)

    def points_to_pixels(self, points: Any) -> Any:
        """Turn points into pixels."""
        return self._pixels.points_to_pixels(points)

    @property
    def _rasterizes(self) -> bool:
        return self._onto is not self._pixels

    def start_rasterizing(self) -> None:
        """What follows becomes an image, in both pictures the same."""
        self._onto = _Pixels(self.width, self.height, self._pixels.dpi)

    def stop_rasterizing(self) -> None:
        """Put the image of what was drawn since `start_rasterizing` into both pictures."""
        image = np.asarray(self._onto.buffer_rgba())
        self._onto = self._pixels
        # each pixel as one number, which is compared faster than its opacity
        shown = image.view(np.uint32)[:, :, 0] != _CLEAR
        rows, columns = np.flatnonzero(shown.any(axis=1)), np.flatnonzero(shown.any(axis=0))
        if rows.size == 0:
            return
        top, bottom = int(rows[0]), int(rows[-1]) + 1
        left, right = int(columns[0]), int(columns[-1]) + 1
        part = np.ascontiguousarray(image[top:bottom, left:right][::-1])
        x, y = left, image.shape[0] - bottom
        self._pixels.draw_image(self._pixels.new_gc(), x, y, part)
        self._vectors.draw_image(self._vectors.new_gc(), x * self._factor, y * self._factor, part)

    def draw_path(self, gc: Any, path: Any, transform: Transform, rgbFace: Any = None) -> None:  # noqa: N803
        """Draw a path; `RendererBase.draw_path` has the arguments, and so on for those below."""
        self._onto.draw_path(gc, path, transform, rgbFace)
        if not self._rasterizes:
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
        self._onto.draw_markers(gc, marker_path, marker_trans, path, trans, rgbFace)
        if self._rasterizes:
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
        self._onto.draw_path_collection(
            gc, master_transform, paths, all_transforms, offsets, offset_trans, *rest, **named
        )
        if self._rasterizes:
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
        self._onto.draw_quad_mesh(
            gc, master_transform, mesh_width, mesh_height, coordinates, offsets, offset_trans, *rest
        )
        if self._rasterizes:
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
        self._onto.draw_image(gc, x, y, im, transform)
        if self._rasterizes:
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
        self._onto.draw_text(gc, x, y, s, prop, angle, ismath, mtext)
        if self._rasterizes:
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
