"""A map from its file, by the file's ending."""

from __future__ import annotations

from pathlib import Path

from wingcrack.figures.text_files import read_text
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.read_csv import read_csv, read_wkt
from wingcrack_maps.read_gdal import read_gdal
from wingcrack_maps.read_geo import read_geo
from wingcrack_maps.read_geojson import read_geojson
from wingcrack_maps.read_msh import read_msh
from wingcrack_maps.systems import metres_of, project
from wingcrack_maps.units import could_be_degrees, in_degrees, refuse_degrees, scale

OF_GDAL = (".shp", ".gpkg", ".dxf", ".fgb", ".gml", ".kml")
_GEOJSON = (".geojson", ".json")


def read_map(path: Path, unit: str | None, crs: str | None = None, layer: str | None = None) -> Map:
    """Read a map in metres.

    Raises `SceneError` if the file cannot be read or understood; nothing is guessed.

    `unit`: that of the map's coordinates; without one it is that of the coordinate system where
    GDAL reads the file, or else the metre, and a GeoJSON file that says no coordinate system must
    have numbers that cannot be degrees. `crs`: a system in metres that the map is projected to.
    `layer`: the one to be read, of a file that has several.
    """
    ending = path.suffix.lower()
    if layer is not None and ending not in OF_GDAL:
        raise SceneError(f"{path}: --layer is for files with layers: {', '.join(OF_GDAL)}")
    if ending in OF_GDAL:
        found = read_gdal(path, layer)
    else:
        found = read_msh(path) if ending == ".msh" else _read_text(path, ending)
    if not (found.lines or found.areas):
        raise SceneError(f"{path}: it contains no lines and no polygons")
    if crs is not None:
        if not found.system and ending not in _GEOJSON:
            raise SceneError(f"{path}: it says no coordinate system, so --crs cannot project it")
        project(found, found.system or "EPSG:4326", crs, str(path))
        unit = "m"
    elif in_degrees(found.system):
        refuse_degrees(str(path), found.system, found)
    elif ending in OF_GDAL and found.system:
        metres = metres_of(found.system, str(path), found)
        if unit is None and metres != 1.0:
            for item in found.features:
                item.points = item.points * metres
            found.note("unit", f"{found.system} has units of {metres:.9g} m; they became metres")
        found.note("coordinate system", f"the map has {found.system}")
    elif found.system:
        words = f"the map has {found.system}; lengths have the unit of --unit, by default m"
        found.note("coordinate system", words)
    elif ending in OF_GDAL:
        if unit is None and ending != ".dxf" and could_be_degrees(found):
            raise SceneError(
                f"{path}: it says no coordinate system, and its numbers could be degrees: give"
                " --unit m (or km, ft, cm, mm) if they are lengths"
            )
        found.note("coordinate system", "the map says none; its numbers are taken as lengths")
    if unit is None and ending in _GEOJSON and not found.system:
        if could_be_degrees(found):
            raise SceneError(
                f"{path}: it says no coordinate system, which in GeoJSON means degrees, and its"
                " numbers could be such: give --unit m (or km, ft, cm, mm) if they are lengths, or"
                " a coordinate system in metres to project them to, as --crs utm"
            )
        found.note("coordinate system", "the map says none; its numbers are taken as metres")
    scale(found, unit or "m", str(path))
    return found


def _read_text(path: Path, ending: str) -> Map:
    try:
        text = read_text(path)
    except ValueError as reason:
        raise SceneError(f"{path}: {reason}") from None
    except OSError as reason:
        raise SceneError(f"{path}: it cannot be read: {reason.strerror}") from None
    if not text.strip():
        raise SceneError(f"{path}: the file is empty")
    if ending in _GEOJSON:
        return read_geojson(text, str(path))
    if ending == ".geo":
        return read_geo(text, str(path))
    if ending == ".wkt":
        return read_wkt(text, str(path))
    return read_csv(text, str(path))
