"""Scenes of pyvista: fractures by state over a field of the rock, in any written state."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeAlias

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb

from wingcrack.errors import EnvironmentLacksError, RunError
from wingcrack.figures import style
from wingcrack.figures.durations import moment_of
from wingcrack.figures.fields import FractureField
from wingcrack.figures.frames import Window, extent, zoom_window
from wingcrack.figures.load import abscissa
from wingcrack.runs.colours import colouring, default_field, rock_of, values_of

if TYPE_CHECKING:
    import pyvista

    from wingcrack.runs.fields import Fields
    from wingcrack.runs.results import Results

_EGL = "libEGL.so.1"
_WIDTH = 5.0  # [pixel] of a fracture
_LIFT = 1.0e-3  # share of the view by which fractures lie above the rock, to be seen
_BAR: dict[str, Any] = {
    "vertical": False,
    "color": "black",
    "fmt": "%.3g",
    "n_labels": 4,
    "title_font_size": 16,
    "label_font_size": 13,
    "position_x": 0.2,
    "position_y": 0.02,
    "width": 0.6,
    "height": 0.08,
}


class Picture:
    """A scene whose state can be changed; colours and view stay.

    Parameters
    ----------
    field : str or None
        As for `Run.plot_map`; None: pressure, without a fluid the mean stress.
    off_screen : bool
        Whether to draw without a window.
    size : tuple of int
        Width and height [pixel].
    """

    def __init__(
        self, run: Results, field: str | None, *, off_screen: bool, size: tuple[int, int]
    ) -> None:
        last = run.fields()
        self._run = run
        self._moments = run.field_moments
        self._field = field or default_field(last)
        self._look = colouring(map(run.fields, self._moments), self._field)
        self._pyvista = _load_pyvista(off_screen=off_screen)
        self.plotter: Any = self._pyvista.Plotter(  # its types do not fit to its decorators
            off_screen=off_screen, window_size=list(size)
        )
        self.plotter.set_background("white")
        self._view = _view(last)

    def put(self, place: int) -> None:
        """Show the written state at this place in the series."""
        found = self._run.fields(self._moments[place])
        self._put_rock(found)
        self._put_fractures(found)
        title = f"{self._run.name}, {self._when(found.moment)}"
        self.plotter.add_text(
            title, position="upper_left", font_size=10, color="black", name="title"
        )
        self._set_camera()

    def palette(self) -> list[tuple[int, int, int]]:
        """Colours of a picture, for formats that can hold few: the scale, states, grey letters."""
        scale = matplotlib.colormaps.get_cmap(self._look.colours)(np.linspace(0.0, 1.0, 200))
        states = [to_rgb(style.STATE_COLOURS[state]) for state in style.STATES]
        greys = np.linspace(0.0, 1.0, 24)[:, None] * np.ones(3)
        every = np.concatenate((scale[:, :3], states, greys))
        return [(int(r), int(g), int(b)) for r, g, b in np.round(255.0 * every)]

    def add_slider(self, place: int) -> None:
        """Add a slider for the states, numbered from 1."""

        def slide(value: float) -> None:
            self.put(round(value) - 1)

        self.plotter.add_slider_widget(
            slide,
            (1, len(self._moments)),
            value=place + 1,
            title="state",
            color="black",
            pointa=(0.55, 0.92),
            pointb=(0.95, 0.92),
            fmt="%.0f",
        )

    def _put_rock(self, found: Fields) -> None:
        corners = np.column_stack((found.points, np.zeros(len(found.points))))
        rock = self._pyvista.PolyData.from_regular_faces(corners, found.triangles)
        rock.cell_data[self._look.label] = self._look.unit.of(values_of(found, self._field))
        self.plotter.add_mesh(
            rock,
            name="rock",
            scalars=self._look.label,
            cmap=self._look.colours,
            clim=(self._look.norm.vmin, self._look.norm.vmax),
            lighting=False,
            scalar_bar_args=_BAR,
        )

    def _put_fractures(self, found: Fields) -> None:
        """Lines above the rock, in the colours of all figures."""
        if not len(found.segments):
            return
        ends = found.segments.reshape(-1, 2)
        lift = _LIFT * (self._view.x_max - self._view.x_min)
        points = np.column_stack((ends, np.full(len(ends), lift)))
        lines = np.insert(np.arange(len(ends)).reshape(-1, 2), 0, 2, axis=1)
        fractures = self._pyvista.PolyData(points, lines=lines.ravel())
        colours = np.array([to_rgb(style.STATE_COLOURS[state]) for state in style.STATES])
        states = np.asarray(found.fractures["state"], dtype=np.int64)
        fractures.cell_data["colour"] = np.round(255.0 * colours[states]).astype(np.uint8)
        self.plotter.add_mesh(
            fractures,
            name="fractures",
            scalars="colour",
            rgb=True,
            line_width=_WIDTH,
            lighting=False,
        )
        entries = [(state, style.STATE_COLOURS[state]) for state in style.STATES]
        self.plotter.add_legend(
            entries, bcolor=None, face="-", size=(0.12, 0.12), loc="upper right"
        )

    def _when(self, moment: float) -> str:
        value, below = abscissa(self._run.files, np.array([moment]))
        name, _, unit = below.partition(" [")
        return f"{name} {value[0]:.4g} {unit.strip('-]')}".rstrip()

    def _set_camera(self) -> None:
        """Look from straight above at what is near the fractures."""
        middle = (
            0.5 * (self._view.x_min + self._view.x_max),
            0.5 * (self._view.y_min + self._view.y_max),
        )
        height = self._view.y_max - self._view.y_min
        width = (self._view.x_max - self._view.x_min) * (
            self.plotter.window_size[1] / self.plotter.window_size[0]
        )
        scale = 0.66 * max(height, width)  # room for the title, and below for the bar
        middle = (middle[0], middle[1] - 0.1 * scale)
        camera = self.plotter.camera
        camera.parallel_projection = True
        camera.focal_point = (*middle, 0.0)
        camera.position = (*middle, 10.0 * max(height, width))
        camera.up = (0.0, 1.0, 0.0)
        camera.parallel_scale = scale
        self.plotter.camera_set = True
        self.plotter.reset_camera_clipping_range()


def build_scene(run: Results, field: str | None, time: float | None) -> pyvista.Plotter:
    """Scene of a state, with a slider for the others where there is a display."""
    off_screen = not _has_display()
    picture = Picture(run, field, off_screen=off_screen, size=(960, 720))
    moments = np.array(run.field_moments)
    place = moments.size - 1 if time is None else int(np.argmin(np.abs(moments - moment_of(time))))
    picture.put(place)
    if moments.size > 1 and not off_screen:
        picture.add_slider(place)
    plotter: pyvista.Plotter = picture.plotter
    return plotter


def _view(last: Fields) -> Window:
    """What is near the fractures at the end of the run; the body, where these are large in it."""
    body = extent([rock_of(last)])
    states = np.asarray(last.fractures.get("state", ()), dtype=np.int64)
    return zoom_window(body, [FractureField(last.segments, states)]) or body


def _has_display() -> bool:
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _load_pyvista(*, off_screen: bool) -> ModuleType:
    """Load pyvista so that VTK does not look for a display that is not wanted.

    Raises `EnvironmentLacksError` if it cannot be loaded.
    """
    if off_screen and not _has_display():
        _need_egl()
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    try:
        import pyvista
    except ImportError as reason:
        raise EnvironmentLacksError(
            f"scenes and movies need pyvista and what it stands on ({reason})"
        ) from None
    return pyvista


def _need_egl() -> None:
    """Look for what draws without a display: where it lacks, VTK ends the whole process."""
    try:
        ctypes.CDLL(_EGL)
    except OSError:
        raise EnvironmentLacksError(
            f"drawing without a display needs {_EGL} (Debian and Ubuntu: apt install libegl1)"
        ) from None


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
