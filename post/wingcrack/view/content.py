"""Data of a run for the page: contents, a state, its mesh, colours, a history."""

from __future__ import annotations

import hashlib
import json
from collections import OrderedDict
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from threading import Lock
from typing import Any

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.colors import Colormap, to_hex

import wingcrack
from wingcrack.errors import AbsentError
from wingcrack.figures import style
from wingcrack.figures.fields import Snapshot, read_fractures, read_series
from wingcrack.figures.scene import read_scene
from wingcrack.figures.slip import seismic
from wingcrack.figures.story_map import EVENT_WORDS, event_shares, well_places
from wingcrack.figures.table import FloatArray
from wingcrack.figures.units import length_unit, time_unit
from wingcrack.runs.colours import MEAN, colouring, default_field, values_of
from wingcrack.runs.fields import Fields, read_fields
from wingcrack.runs.plots import default_column, fitting_unit
from wingcrack.runs.results import TEXTS
from wingcrack.runs.units import column_words

_FIELDS = (
    ("pressure", "pore pressure"),
    (MEAN, "mean in-plane stress"),
    ("stress.xx", "stress xx"),
    ("stress.yy", "stress yy"),
    ("stress.xy", "stress xy"),
    ("displacement.x", "displacement x"),
    ("displacement.y", "displacement y"),
    ("permeability.xx", "permeability xx"),
    ("permeability.yy", "permeability yy"),
)
# What the page says of a fracture cell: name, field, component
_ON_FRACTURES = (
    ("opening", "jump", 0),
    ("slip", "jump", 1),
    ("pressure", "pressure", None),
    ("normal traction", "traction", 0),
    ("shear traction", "traction", 1),
    ("aperture", "aperture", None),
)
_GROWTH = ("growth_onset", "growth_jump", "joint", "arrest")  # rows of events.csv that are shown
_COLOURED = ("slip", "opening", "aperture")  # by which fractures can be coloured
_UNITS = {"aperture": "m", "jump": "m", "pressure": "Pa", "traction": "Pa"}
_KEPT = 4  # states in memory: the one shown, the one before, and both ends of the run
_COLOURS = 256
_WATCHED = ("history.csv", "run.json", "network.json", "scene.nml", "matrix.pvd", "fractures.pvd")


class Content:
    """The files of a run as messages for the page; a run that continues is read again.

    Places in messages are relative to the middle of the body, as 32-bit numbers: coordinates of
    a survey would lose their last digits.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._lock = Lock()
        self._seen: list[str] = []
        self._run: wingcrack.Run | None = None
        self._matrix: tuple[Snapshot, ...] = ()
        self._fractures: tuple[Snapshot, ...] = ()
        self._origin = np.zeros(2)
        self._kept: OrderedDict[str, Fields] = OrderedDict()

    def overview(self) -> bytes:
        """What the run is, which states and fields it has, where its wells are, as JSON.

        Raises `RunError` if there is no run in the folder, or a file is damaged, `AbsentError` if
        no state is written.
        """
        with self._lock:
            return json.dumps(self._overview(), allow_nan=False).encode()

    def state(self, place: int, field: str, stamp: str) -> bytes:
        """Values of a field in a written state [SI], and its fractures.

        Raises `AbsentError` if there is no such state or field, or not any more as the stamp tells
        it.
        """
        with self._lock:
            found = self._state(place, stamp)
            fractures = found.fractures
            there = [one for one in _ON_FRACTURES if one[1] in fractures]
            columns = [_component(fractures[name], part) for _, name, part in there]
            count = len(found.segments)
            head = {
                "mesh": _mesh_of(found),
                "columns": [[words, _UNITS[name]] for words, name, _ in there],
            }
            return pack(
                head,
                {
                    "values": values_of(found, field).astype(np.float32),
                    "segments": self._near(found.segments),
                    "states": np.asarray(fractures.get("state", np.zeros(count)), dtype=np.uint8),
                    "owners": np.asarray(
                        fractures.get("fracture", np.zeros(count)), dtype=np.uint32
                    ),
                    "on_fractures": np.array(columns, dtype=np.float32),
                },
            )

    def mesh(self, place: int, stamp: str) -> bytes:
        """Nodes and triangles of a written state."""
        with self._lock:
            found = self._state(place, stamp)
            return pack(
                {"mesh": _mesh_of(found)},
                {
                    "points": self._near(found.points),
                    "triangles": found.triangles.astype(np.uint32),
                },
            )

    def scale(self, field: str) -> bytes:
        """Colours for a field in all states as JSON.

        `plain` has colours from dark to light for a range that the page chooses.
        """
        with self._lock:
            self._refresh()
            look = colouring(map(self._state, range(len(self._matrix))), field)
            return json.dumps(
                {
                    "label": look.label,
                    "unit": look.unit.name,
                    "size": look.unit.size,
                    "low": look.norm.vmin,
                    "high": look.norm.vmax,
                    "colours": _colours(look.colours),
                    "plain": _colours(style.FIELD_COLOURS),
                    "jumps": self._largest_jumps(),
                    "jump_colours": _colours(style.JUMP_COLOURS),
                },
                allow_nan=False,
            ).encode()

    def history(self, column: str) -> bytes:
        """Rows of the history: their moments [SI] and a column in a unit that reads well."""
        with self._lock:
            run = self._refresh()
            values = run.column(column).astype(np.float64)
            unit = fitting_unit(column, values)
            label = f"{column_words(column)} [{unit.name}]"
            return pack({"label": label}, {"moments": run.moments, "values": unit.of(values)})

    # Inside, with the lock held

    def _refresh(self) -> wingcrack.Run:
        """See whether the run has gone on."""
        seen = [_stamp(self._directory / name) for name in _WATCHED]
        if self._run is None or seen != self._seen:
            self._run = None
            run = wingcrack.open(self._directory)
            self._matrix = read_series(self._directory / "matrix.pvd")
            self._fractures = read_series(self._directory / "fractures.pvd")
            if not self._matrix:
                raise AbsentError(
                    f"{self._directory} has no fields to show: the scene turns VTU files off,"
                    " or no state is written yet"
                )
            self._run, self._seen = run, seen
            points = self._state(0).points
            self._origin = 0.5 * (points.min(axis=0) + points.max(axis=0))
        return self._run

    def _overview(self) -> dict[str, Any]:
        run = self._refresh()
        first = self._state(0)
        table = run.table("history")
        load = table.has("load_factor")
        clock = time_unit(self._matrix[-1].time_s)
        unit = length_unit(first.points)
        return {
            "name": run.name,
            "title": _title(self._directory),
            "status": run.status,
            "reason": run.reason,
            "warnings": len(run.warnings),
            "moments": [snapshot.time_s for snapshot in self._matrix],
            "rows": [snapshot.row for snapshot in self._matrix],
            "stamps": [_stamp(snapshot.path) for snapshot in self._matrix],
            "moment": {
                "name": "load factor" if load else "time",
                "unit": "-" if load else clock.name,
                "size": 1.0 if load else clock.size,
            },
            "length": {"unit": unit.name, "size": unit.size},
            "origin": self._origin.tolist(),
            "fields": [[name, words] for name, words in _FIELDS if _has(first, name)],
            "field": default_field(first),
            "columns": [
                [name, column_words(name)]
                for name in table.cells
                if name not in TEXTS and name not in ("time_s", "load_factor")
            ],
            "column": default_column(run),
            "states": [[state, to_hex(style.STATE_COLOURS[state])] for state in style.STATES],
            "fractures": self._names(run),
            "wells": self._wells(run),
            "events": self._events(run),
        }

    def _state(self, place: int, stamp: str | None = None) -> Fields:
        """Fields of a written state, the last few of which are kept."""
        if not 0 <= place < len(self._matrix):
            raise AbsentError(f"there is no state {place}; the run has {len(self._matrix)}")
        snapshot = self._matrix[place]
        key = _stamp(snapshot.path)
        if stamp is not None and stamp != key:
            raise AbsentError(f"state {place} has been written again")
        found = self._kept.pop(key, None)
        if found is None:
            found = read_fields(self._directory, self._matrix, self._fractures, snapshot.time_s)
        self._kept[key] = found
        if len(self._kept) > _KEPT:
            self._kept.popitem(last=False)
        return found

    def _largest_jumps(self) -> dict[str, float]:
        """Largest slip, opening and aperture of all states [m], of those that the run has."""
        largest: dict[str, float] = {}
        for snapshot in self._fractures:
            found = read_fractures(snapshot.path)
            for name in _COLOURED if len(found.segments) else ():
                with suppress(AbsentError):
                    high = float(found.of(name).max())
                    largest[name] = max(high, largest.get(name, 0.0))
        return largest

    def _near(self, places: FloatArray) -> npt.NDArray[np.float32]:
        return np.asarray(places - self._origin, dtype=np.float32)

    def _names(self, run: wingcrack.Run) -> dict[int, str]:
        network = _network(run)
        return {
            int(item["fracture"]): str(item.get("name") or f"fracture {item['fracture']}")
            for item in network.get("fractures", [])
        }

    def _wells(self, run: wingcrack.Run) -> list[list[float]]:
        places = well_places(read_scene(self._directory / "scene.nml"), _network(run))
        return [(np.array(place) - self._origin).tolist() for place in places]

    def _events(self, run: wingcrack.Run) -> list[list[Any]]:
        """Slip and growth of a run with time: kind, place, time [s], size from 0 to 1, words."""
        found: list[list[Any]] = []
        with suppress(AbsentError):
            slip = run.table("slip_events")
            moment = slip.number("moment_nm")
            share = event_shares(moment)
            for k, fast in enumerate(seismic(slip)):
                words = f"{'seismic' if fast else 'aseismic'} slip, moment {moment[k]:.3g} N m"
                if fast:
                    words += f", magnitude {slip.number('magnitude')[k]:.2f}"
                found.append([EVENT_WORDS[bool(fast)], slip, k, "end_s", float(share[k]), words])
        with suppress(AbsentError):
            events = run.table("events")
            for k, kind in enumerate(events.text("kind") if events.has("time_s") else ()):
                if kind in _GROWTH:
                    words = f"{kind.replace('_', ' ')}: {events.text('detail')[k]}"
                    found.append([kind.replace("_", " "), events, k, "time_s", 0.0, words])
        shown = []
        for kind, table, k, when, size, words in found:
            x, y, time_s = (float(table.number(name)[k]) for name in ("x_m", "y_m", when))
            if np.isfinite([x, y, time_s]).all():
                shown.append(
                    [kind, *(np.array([x, y]) - self._origin).tolist(), time_s, size, words]
                )
        return shown


def _colours(name: Colormap | str) -> list[int]:
    """Red, green and blue from 0 to 255, one colour after the other."""
    colours = matplotlib.colormaps.get_cmap(name)(np.linspace(0.0, 1.0, _COLOURS))
    return [int(part) for part in np.round(255.0 * colours[:, :3]).ravel()]


def _network(run: wingcrack.Run) -> dict[str, Any]:
    try:
        return run.network
    except AbsentError:
        return {}


def _title(directory: Path) -> str:
    scene = read_scene(directory / "scene.nml")
    return scene.title if scene else ""


def _has(found: Fields, field: str) -> bool:
    try:
        values_of(found, field)
    except AbsentError:
        return False
    return True


def _component(values: FloatArray, part: int | None) -> FloatArray:
    return values if part is None else values[:, part]


def _mesh_of(found: Fields) -> str:
    """A name for the mesh: states between two remeshings share it."""
    digest = hashlib.blake2b(digest_size=12)
    digest.update(found.points.tobytes())
    digest.update(np.ascontiguousarray(found.triangles).tobytes())
    return digest.hexdigest()


def _stamp(path: Path) -> str:
    """A text that differs once a file is written again."""
    try:
        seen = path.stat()
    except OSError:
        return f"{path.name}: none"
    return f"{path.name}:{seen.st_mtime_ns:x}:{seen.st_size:x}"


_ALIGNED = 8  # [byte]
_LENGTH_BYTES = 4
_KINDS = {"f4": "Float32Array", "f8": "Float64Array", "u4": "Uint32Array", "u1": "Uint8Array"}


def pack(head: Mapping[str, Any], arrays: Mapping[str, npt.NDArray[Any]]) -> bytes:
    """Put a head and arrays (of float32, float64, uint32 or uint8) into one message.

    Layout: length of the head as a 32-bit number, the head in JSON, then the arrays, all
    little-endian; each begins at a multiple of eight bytes from the start, so that typed arrays of
    JavaScript can lie on them without a copy.
    """
    parts: list[bytes] = []
    places: dict[str, tuple[str, int, int]] = {}
    offset = 0
    for name, values in arrays.items():
        flat = np.ascontiguousarray(values).ravel()
        data = flat.astype(flat.dtype.newbyteorder("<"), copy=False).tobytes()
        places[name] = (_KINDS[flat.dtype.str[1:]], offset, flat.size)
        data += bytes(-len(data) % _ALIGNED)
        parts.append(data)
        offset += len(data)
    text = json.dumps({**head, "arrays": places}, allow_nan=False).encode()
    text += b" " * (-(_LENGTH_BYTES + len(text)) % _ALIGNED)
    return b"".join((len(text).to_bytes(_LENGTH_BYTES, "little"), text, *parts))
