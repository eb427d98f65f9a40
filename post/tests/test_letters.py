"""Letters of a PDF: those kept look as before, the others are gone; readers can load the font."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fontTools.ttLib import TTFont
from matplotlib.font_manager import findfont
from matplotlib.ft2font import FT2Font, LoadFlags

from wingcrack_post.cli import main
from wingcrack_post.letters import FontLetters

POST = Path(__file__).resolve().parents[1]


def outline(font: FT2Font, number: Any) -> tuple[list[list[float]], float]:
    glyph = font.load_glyph(number, flags=LoadFlags.NO_SCALE | LoadFlags.NO_HINTING)
    return np.asarray(font.get_path()[0]).tolist(), glyph.horiAdvance


@pytest.mark.parametrize("text", ["Kluft 7", "éÄç ½", "K", ""])
def test_letters_of_a_text_look_as_in_the_font(text: str) -> None:
    path = Path(findfont("DejaVu Sans", fallback_to_default=False))
    whole = FT2Font(str(path))
    numbers = [whole.get_char_index(ord(letter)) for letter in text]
    taken = FontLetters(path, numbers)
    written = taken.file()
    assert set(numbers) <= set(taken.glyph_index_map)
    found = FT2Font(written)
    for number in numbers:
        assert outline(found, taken.glyph_index_map[number]) == outline(whole, number)
    other = whole.get_char_index(ord("W"))
    assert outline(whole, other)[0] != []
    assert outline(found, other)[0] == []
    written.seek(0)
    with TTFont(written, checkChecksums=2) as font:  # which a wrong sum ends
        assert font["maxp"].numGlyphs == whole.num_glyphs
    assert len(written.getvalue()) < path.stat().st_size


def test_figures_do_not_load_what_they_do_not_need(own_run: Path) -> None:
    code = (
        "import sys\n"
        "from wingcrack_post.cli import main\n"
        f"assert main(['plot', {str(own_run)!r}, '--only', 'tips', '--quiet']) == 0\n"
        "print([n for n in ('pandas', 'jinja2', 'vtk', 'fontTools.varLib') if n in sys.modules])\n"
        "import fontTools.subset\n"
        "print(fontTools.subset.Options.__name__)\n"
    )
    # the small fonts are there then; the call below draws it all anew
    assert main(["plot", str(own_run), "--only", "tips", "--quiet"]) == 0
    shutil.rmtree(own_run / "figures")
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=POST, capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("[]\nOptions\n", "")
