"""Small copies of the figures' fonts.

A PDF holds the letters that it uses. To take them out of a font, all of it has to be read; with the
few hundred letters that figures have, that takes a quarter of the time, and again a quarter without
the rules for setting letters side by side, which a PDF does not need: letters have their places.
The pictures stay the same.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
from matplotlib.artist import Artist
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.font_manager import FontPath, fontManager
from matplotlib.text import Text
from matplotlib.ticker import LogFormatter, ScalarFormatter

if TYPE_CHECKING:
    from fontTools.ttLib import TTFont

_FAMILY, _WHOLE = "DejaVu Sans", "DejaVu Sans whole"

# Latin with the accents of western Europe, Greek, punctuation, sub- and superscripts, arrows, some
# mathematics. What is beyond is taken from the whole font.
_LETTERS = (
    range(0x20, 0x7F),
    range(0xA0, 0x100),
    range(0x391, 0x3CA),
    range(0x2010, 0x2030),
    range(0x2070, 0x209D),
    range(0x2190, 0x2194),
    range(0x2200, 0x2270),
    range(0x27E6, 0x27EC),
)
_KNOWN = frozenset(chr(letter) for letters in _LETTERS for letter in letters)
_FEATURES = ["kern", "liga", "ccmp", "mark", "mkmk"]
_RULES = ("GDEF", "GPOS", "GSUB", "MATH")  # tables for setting letters side by side
_NUMBERS = (ScalarFormatter, LogFormatter)
_FILES = ("DejaVuSans.ttf", "DejaVuSans-Oblique.ttf")


def fall_back(figure: Figure) -> None:
    """Let texts with other letters, as names of a scene may have, look in the whole font too."""
    if not small_fonts():
        return
    for text in _texts(figure):
        if not _KNOWN.issuperset(text.get_text().replace("\n", "")):
            text.set_fontfamily([_FAMILY, _WHOLE])


def _texts(artist: Artist) -> Iterator[Text]:
    """Texts of a figure; of axes with numbers only their labels.

    Ticks are made when they are asked for, which takes long, and not all of those that there are
    now will be drawn.
    """
    if isinstance(artist, Text):
        yield artist
    if isinstance(artist, Axis) and isinstance(artist.get_major_formatter(), _NUMBERS):
        yield artist.label
        yield artist.offsetText
        return
    for child in artist.get_children():
        yield from _texts(child)


@cache
def small_fonts() -> bool:
    """Let matplotlib find the small copies, made once in its cache, in the place of the originals.

    Returns
    -------
    bool
        Whether it does. Where the cache cannot be written all stays as it is, and takes longer.
    """
    copies = []
    for entry in fontManager.ttflist:
        file = Path(entry.fname)
        if entry.name == _FAMILY and file.name in _FILES:
            try:
                copies.append((entry, _copy(file, _folder() / file.name)))
            except OSError:
                return False
    for entry, small in copies:
        fontManager.ttflist.insert(0, replace(entry, fname=str(small)))
        fontManager.ttflist.append(replace(entry, name=_WHOLE))
    return bool(copies)


def letters_alone(font: FontPath) -> FontPath:
    """Font with the same letters by the same numbers, for a page on which they have their places.

    The font itself where it is none of the small copies, or has no copy of its own yet and none can
    be written.
    """
    small = Path(font.path)
    if small.parent != _folder() or font.face_index != 0:
        return font
    try:
        return FontPath(str(_bare_copy(small, small.with_stem(f"{small.stem}-letters"))), 0)
    except OSError:
        return font


def _folder() -> Path:
    return Path(matplotlib.get_cachedir()) / f"wingcrack-fonts-{matplotlib.__version__}"


def _copy(whole: Path, small: Path) -> Path:
    """Give the small copy."""
    if small.exists():
        return small
    small.parent.mkdir(parents=True, exist_ok=True)
    from fontTools import subset

    options = subset.Options(glyph_names=True, recommended_glyphs=True)
    options.drop_tables += ["FFTM"]
    options.layout_features = _FEATURES
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[letter for letters in _LETTERS for letter in letters])
    with subset.load_font(str(whole), options) as font:
        subsetter.subset(font)
        _save(font, small)
    return small


def _bare_copy(small: Path, bare: Path) -> Path:
    """Give the copy without rules."""
    if bare.exists():
        return bare
    from fontTools.ttLib import TTFont

    with TTFont(small) as font:
        for rules in _RULES:
            if rules in font:
                del font[rules]
        _save(font, bare)
    return bare


def _save(font: TTFont, target: Path) -> None:
    """Write a font; it appears as a whole, as other calls may read it."""
    aside = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        font.save(str(aside))
        aside.replace(target)
    finally:
        aside.unlink(missing_ok=True)
