"""One walk through a figure draws the PNG that matplotlib draws, and the PDF."""

from __future__ import annotations

import re
import zlib
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patheffects import withStroke

from wingcrack_post import style
from wingcrack_post.fonts import small_fonts
from wingcrack_post.png import write_png
from wingcrack_post.twin import draw_twins

DPI = 150


@style.styled
def _figure() -> Figure:
    """Everything that figures here have: lines, markers, fills, hatches, text, maps, insets."""
    figure = style.new_figure(5.0, 4.0)
    (one, two), (three, four) = figure.subplots(2, 2)
    x = np.linspace(0.0, 3.0, 40)
    one.plot(x, np.sin(x), "o-", label="$K_I$")
    one.fill_between(x, x, hatch="////", alpha=0.5)
    one.set_title("a title of its own")
    one.legend()
    two.semilogy(x, np.exp(3.0 * x))
    two.text(1.0, 2.0, "halo", path_effects=[withStroke(linewidth=2, foreground="white")])
    places = np.array([[0, 0], [1, 0], [0, 1], [1, 1]], dtype=float)
    cells = [[0, 1, 2], [1, 3, 2]]
    shown = three.tripcolor(
        *places.T,
        cells,
        facecolors=np.array([1.0, 2.0]),
        rasterized=True,
        edgecolors="none",
        antialiased=False,
    )
    three.set_aspect("equal")
    figure.colorbar(shown, ax=three)
    four.scatter(x, x**2, c=x, s=10.0 * x)
    four.set_ylabel("rotated [m²]")
    return figure


def _plain(dpi: float) -> np.ndarray:
    """Give the pixels as matplotlib makes them."""
    with matplotlib.rc_context(style.RC):
        figure = _figure()
        figure.set_dpi(dpi)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        return np.array(canvas.buffer_rgba())


def _streams(path: Path) -> list[bytes]:
    content = path.read_bytes()
    found = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", content, flags=re.S)
    unpacked = []
    for stream in found:
        try:
            unpacked.append(zlib.decompress(stream))
        except zlib.error:
            unpacked.append(stream)
    return unpacked


def test_pixels_are_those_of_matplotlib(tmp_path: Path) -> None:
    style.styled(draw_twins)(_figure(), tmp_path / "a.png", tmp_path / "a.pdf", DPI)
    drawn = np.round(255.0 * imread(tmp_path / "a.png")).astype(int)
    plain = _plain(DPI)[:, :, :3].astype(int)
    assert drawn.shape == plain.shape == (600, 750, 3)
    assert np.abs(drawn - plain).max() <= 2  # a rasterized layer is blended once more


def test_the_pdf_has_the_same_in_points(tmp_path: Path) -> None:
    style.styled(draw_twins)(_figure(), tmp_path / "a.png", tmp_path / "a.pdf", DPI)
    style.styled(_figure().savefig)(tmp_path / "b.pdf", dpi=DPI)
    ours, theirs = (
        max(_streams(tmp_path / name), key=lambda s: s.count(b" Tf")) for name in ("a.pdf", "b.pdf")
    )
    for operator in (rb"\sTj", rb"\sTf", rb"\sre\s+W", rb"\sDo"):
        assert len(re.findall(operator, ours)) == len(re.findall(operator, theirs)) > 0, operator
    for operator in (rb"\sTm", rb"\sTd"):
        places = [
            np.array([[float(n) for n in line.split()[-2:]] for line in found])
            for found in (re.findall(rb"([-\d. ]+)" + operator, text) for text in (ours, theirs))
        ]
        assert places[0].shape == places[1].shape
        if places[0].size:
            assert np.abs(places[0] - places[1]).max() < 1.5, operator  # [point]
    assert b"/FontFile2" in (tmp_path / "a.pdf").read_bytes()  # text stays text


def test_png_keeps_what_shows_through(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    for opaque in (False, True):
        picture = random.integers(0, 256, (7, 5, 4), dtype=np.uint8)
        if opaque:
            picture[:, :, 3] = 255
        write_png(picture, tmp_path / "a.png", 300)
        read = np.round(255.0 * imread(tmp_path / "a.png")).astype(np.uint8)
        assert np.array_equal(read, picture[:, :, :3] if opaque else picture)


def test_png_tells_its_resolution(tmp_path: Path) -> None:
    pillow = pytest.importorskip("PIL.Image")
    write_png(np.full((2, 2, 4), 255, dtype=np.uint8), tmp_path / "a.png", 300)
    with pillow.open(tmp_path / "a.png") as picture:
        assert picture.info["dpi"] == pytest.approx((300, 300), rel=1e-3)


@style.styled
def _words(text: str, family: str | None = None) -> Figure:
    figure = style.new_figure(2.0, 1.0)
    axes = figure.subplots()
    axes.axis("off")
    axes.text(0.1, 0.5, text, fontfamily=family)
    return figure


@pytest.mark.parametrize("text", ["fi AV åéµ²", "трещина Ж", "∂₂→√"])
def test_small_fonts_leave_pictures_as_they_are(tmp_path: Path, text: str) -> None:
    """Letters of the small copies, and letters that only the whole font has."""
    assert small_fonts()
    pictures = []
    for family in (None, "DejaVu Sans whole"):
        style.save(_words(text, family), tmp_path / "a", ("png", "pdf"))
        pictures.append(imread(tmp_path / "a.png"))
    assert (pictures[0] < 0.5).any()
    assert np.array_equal(pictures[0], pictures[1])


def test_fonts_that_cannot_be_copied_are_taken_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setattr("matplotlib.get_cachedir", lambda: str(tmp_path / "file"))
    assert not small_fonts.__wrapped__()
