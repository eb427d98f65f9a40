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
from matplotlib.font_manager import fontManager

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
)
_FEATURES = ["kern", "liga", "ccmp", "mark", "mkmk"]
_FILES = ("DejaVuSans.ttf", "DejaVuSans-Oblique.ttf")


@cache
def small_fonts() -> tuple[str, ...]:
    """Let matplotlib find the small copies, made once in its cache, in the place of the originals.

    Returns
    -------
    tuple of str
        Families to look for letters in, before others. None where the cache cannot be written:
        then all stays as it is, and takes longer.
    """
    folder = Path(matplotlib.get_cachedir()) / f"wingcrack-fonts-{matplotlib.__version__}"
    copies = []
    for entry in fontManager.ttflist:
        file = Path(entry.fname)
        if entry.name == _FAMILY and file.name in _FILES:
            try:
                copies.append((entry, _copy(file, folder / file.name)))
            except OSError:
                return ()
    for entry, small in copies:
        fontManager.ttflist.insert(0, replace(entry, fname=str(small)))
        fontManager.ttflist.append(replace(entry, name=_WHOLE))
    return (_FAMILY, _WHOLE)


def _copy(whole: Path, small: Path) -> Path:
    """Give the small copy; it appears as a whole, as other calls may read it."""
    if small.exists():
        return small
    small.parent.mkdir(parents=True, exist_ok=True)
    options = subset.Options(glyph_names=True, recommended_glyphs=True)
    options.drop_tables += ["FFTM"]
    options.layout_features = _FEATURES
    font = subset.load_font(str(whole), options)
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[letter for letters in _LETTERS for letter in letters])
    subsetter.subset(font)
    aside = small.with_name(f".{small.name}.{os.getpid()}")
    try:
        font.save(str(aside))
        aside.replace(small)
    finally:
        aside.unlink(missing_ok=True)
    return small
