"""A map from its file, by the file's ending."""

from __future__ import annotations

from pathlib import Path

from wingcrack.figures.text_files import read_text
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.read_csv import read_csv, read_wkt
from wingcrack_maps.read_geo import read_geo
from wingcrack_maps.read_geojson import read_geojson
from wingcrack_maps.read_msh import read_msh
from wingcrack_maps.units import could_be_degrees, scale

ENDINGS = (".csv", ".txt", ".geojson", ".json", ".wkt", ".msh", ".geo")


def read_map(path: Path, unit: str | None) -> Map:
    """Read a map in metres.

    Raises `SceneError` if the file cannot be read or understood; nothing is guessed.

    `unit`: that of the map's coordinates; without one they are metres, and a GeoJSON file that says
    no coordinate system must have numbers that cannot be degrees.
    """
    ending = path.suffix.lower()
    if ending == ".msh":
        found, says_system = read_msh(path), True
    else:
        found, says_system = _read_text(path, ending)
    if not (found.lines or found.areas):
        raise SceneError(f"{path}: it contains no lines and no polygons")
    if unit is None and ending in (".geojson", ".json") and not says_system:
        if could_be_degrees(found):
            raise SceneError(
                f"{path}: it says no coordinate system, which in GeoJSON means degrees, and its"
                " numbers could be such: give --unit m (or km, ft, cm, mm) if they are lengths, or"
                " project the map first"
            )
        found.note("coordinate system", "the map says none; its numbers are taken as metres")
    scale(found, unit or "m", str(path))
    return found


def _read_text(path: Path, ending: str) -> tuple[Map, bool]:
    try:
        text = read_text(path)
    except ValueError as reason:
        raise SceneError(f"{path}: {reason}") from None
    except OSError as reason:
        raise SceneError(f"{path}: it cannot be read: {reason.strerror}") from None
    if not text.strip():
        raise SceneError(f"{path}: the file is empty")
    if ending in (".geojson", ".json"):
        return read_geojson(text, str(path))
    if ending == ".geo":
        return read_geo(text, str(path)), True
    if ending == ".wkt":
        return read_wkt(text, str(path)), True
    return read_csv(text, str(path)), True
