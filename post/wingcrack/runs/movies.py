"""Movies of a run: every written state as a picture, into a GIF or an MP4 file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import numpy.typing as npt

from wingcrack.errors import EnvironmentLacksError, RunError
from wingcrack.runs.pictures import Picture

if TYPE_CHECKING:
    from wingcrack.runs.results import Results

_Image: TypeAlias = npt.NDArray[np.uint8]
_Writer: TypeAlias = Callable[[Path, Iterator[_Image], Picture, float], None]

_SIZES = (64, 4096)  # [pixel]
_FASTEST = 50.0  # [1/s]: what players of GIF know


def write_movie(
    run: Results,
    path: Path,
    field: str | None,
    frames_per_second: float,
    size: tuple[int, int],
    *,
    progress: bool,
) -> Path:
    """Write a movie of all written states; the file appears whole."""
    write = _writer(path)
    if not path.parent.is_dir():
        raise RunError(f"{path}: there is no folder {path.parent}")
    if not 0.0 < frames_per_second <= _FASTEST:
        raise RunError(
            f"{frames_per_second:g} states per second are not between 0 and {_FASTEST:g}"
        )
    if not all(_SIZES[0] <= length <= _SIZES[1] for length in size):
        raise RunError(f"a movie is {_SIZES[0]} to {_SIZES[1]} pixels wide and high, not {size}")
    width, height = (length - length % 2 for length in size)  # players know no odd ones
    aside = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    picture = Picture(run, field, off_screen=True, size=(width, height))
    try:
        images = _images(picture, len(run.field_moments), progress=progress)
        write(aside, images, picture, frames_per_second)
        aside.replace(path)
    except OSError as reason:
        raise RunError(f"{path}: the movie cannot be written ({reason})") from None
    finally:
        picture.plotter.close()
        aside.unlink(missing_ok=True)
    return path


def _images(picture: Picture, count: int, *, progress: bool) -> Iterator[_Image]:
    """Draw one state after the other; a bar on stderr tells how far it is."""
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    for place in track(range(count), "drawing states", console=console, disable=not progress):
        picture.put(place)
        yield np.asarray(picture.plotter.screenshot(return_img=True), dtype=np.uint8)


def _writer(path: Path) -> _Writer:
    writers: dict[str, _Writer] = {".gif": _write_gif, ".mp4": _write_mp4}
    if path.suffix.lower() not in writers:
        raise RunError(f"{path}: a movie's name ends with {' or '.join(writers)}")
    return writers[path.suffix.lower()]


def _write_gif(
    path: Path, images: Iterator[_Image], picture: Picture, frames_per_second: float
) -> None:
    from PIL import Image

    palette = Image.new("P", (1, 1))
    palette.putpalette([part for colour in picture.palette() for part in colour])
    pictures = [
        Image.fromarray(image).quantize(palette=palette, dither=Image.Dither.NONE)
        for image in images
    ]
    pictures[0].save(
        path,
        format="GIF",
        save_all=True,
        append_images=pictures[1:],
        duration=1000.0 / frames_per_second,
        loop=0,
    )


def _write_mp4(
    path: Path, images: Iterator[_Image], picture: Picture, frames_per_second: float
) -> None:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise EnvironmentLacksError(
            "an MP4 needs imageio-ffmpeg: .venv/bin/pip install -r requirements_movies.txt"
            " (68 MB); a GIF needs nothing more"
        ) from None
    size = tuple(picture.plotter.window_size)
    writer = imageio_ffmpeg.write_frames(
        str(path),
        size,
        fps=frames_per_second,
        quality=7,
        macro_block_size=2,
        ffmpeg_log_level="error",
    )
    writer.send(None)
    try:
        for image in images:
            writer.send(np.ascontiguousarray(image[:, :, :3]))
    finally:
        writer.close()
