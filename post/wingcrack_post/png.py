"""Pixels as a PNG file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

_EFFORT = 3  # of the compression; more gains a tenth of the size and doubles the time


def write_png(picture: npt.NDArray[np.uint8], target: Path, dpi: float) -> None:
    """Write a picture; where nothing shows through, without its opacity.

    Parameters
    ----------
    picture : (height, width, 4) array
        Red, green, blue and opacity.
    target : Path
    dpi : float
        Pixels per inch.
    """
    if np.all(picture[:, :, 3] == 255):
        picture = np.ascontiguousarray(picture[:, :, :3])
    Image.fromarray(picture).save(target, format="PNG", dpi=(dpi, dpi), compress_level=_EFFORT)
