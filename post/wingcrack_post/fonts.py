"""Small copies of the figures' fonts.

A PDF holds the letters that it uses. To take them out of a font, all of it has to be read; with the
few hundred letters that figures have, that takes a quarter of the time. The pictures stay the same.
"""

from __future__ import annotations

import os
from dataclasses import replace
from functools import cache
from pathlib import Path

import matplotlib
from fontTools import subset
from matplotlib.figure import Figure
from matplotlib.font_manager import fontManager
from matplotlib.text import Text

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
_FILES = ("DejaVuSans.ttf", "DejaVuSans-Oblique.ttf")


def fall_back(figure: Figure) -> None:
    """Let texts with other letters, as names of a scene may have, look in the whole font too."""
    if not small_fonts():
        return
    for text in figure.findobj(Text):
        assert isinstance(text, Text)
        if not _KNOWN.issuperset(text.get_text().replace("\n", "")):
            text.set_fontfamily([_FAMILY, _WHOLE])


@cache
def small_fonts() -> bool:
    """Let matplotlib find the small copies, made once in its cache, in the place of the originals.

    Returns
    -------
    bool
        Whether it does. Where the cache cannot be written all stays as it is, and takes longer.
    """
    folder = Path(matplotlib.get_cachedir()) / f"wingcrack-fonts-{matplotlib.__version__}"
    copies = []
    for entry in fontManager.ttflist:
        file = Path(entry.fname)
        if entry.name == _FAMILY and file.name in _FILES:
            try:
                copies.append((entry, _copy(file, folder / file.name)))
            except OSError:
                return False
    for entry, small in copies:
        fontManager.ttflist.insert(0, replace(entry, fname=str(small)))
        fontManager.ttflist.append(replace(entry, name=_WHOLE))
    return bool(copies)


def _copy(whole: Path, small: Path) -> Path:
    """Give the small copy; it appears as a whole, as other calls may read it."""
    if small.exists():
        return small
    small.parent.mkdir(parents=True, exist_ok=True)
    options = subset.Options(glyph_names=True, recommended_glyphs=True)
    options.drop_tables += ["FFTM"]
    options.layout_features = _FEATURES
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[letter for letters in _LETTERS for letter in letters])
    aside = small.with_name(f".{small.name}.{os.getpid()}")
    try:
        with subset.load_font(str(whole), options) as font:
            subsetter.subset(font)
            font.save(str(aside))
        aside.replace(small)
    finally:
        aside.unlink(missing_ok=True)
    return small
