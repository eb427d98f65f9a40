"""Maps from the files of geographic information systems and of drawing programs, by GDAL."""

from __future__ import annotations

import shutil
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.geometry import add_geometry
from wingcrack_maps.needs import needed

_OF_DRAWINGS = ("PaperSpace", "SubClasses", "Linetype", "EntityHandle", "Text")  # of DXF


def read_gdal(path: Path, layer: str | None) -> Map:
    """Read all layers of a file, or one, in their own unit.

    Raises `SceneError` if the file cannot be read, or its layers have different systems.
    """
    pyogrio = needed("pyogrio")
    pyogrio.set_gdal_config_options({"SHAPE_RESTORE_SHX": "YES"})
    found = Map()
    try:
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of what concerns no lines
            source = _whole(path, Path(folder))
            names = [str(name) for name, _ in pyogrio.list_layers(source)]
            if layer is not None and layer not in names:
                raise SceneError(f"{path}: it has no layer '{layer}' (it has: {', '.join(names)})")
            for name in names if layer is None else [layer]:
                read = pyogrio.raw.read(source, layer=name)
                _add_layer(found, read, f" of layer '{name}'" if len(names) > 1 else "", str(path))
    except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError, OSError) as reason:
        words = " ".join(str(reason).replace(str(source), path.name).split())
        raise SceneError(f"{path}: it cannot be read: {words}") from None
    return found


def _whole(path: Path, folder: Path) -> Path:
    """Give a shapefile its index, which can be made if it is missing, in a copy."""
    if path.suffix.lower() != ".shp" or any(path.parent.glob(f"{path.stem}.[sS][hH][xX]")):
        return path
    for file in path.parent.glob(f"{path.stem}.*"):
        shutil.copy(file, folder)
        (folder / file.name).chmod(0o600)
    return folder / path.name


def _add_layer(found: Map, read: tuple[Any, ...], of_layer: str, path: str) -> None:
    about, _, shapes, columns = read
    system = str(about["crs"] or "")
    if found.system and system and system != found.system:
        raise SceneError(
            f"{path}: features{of_layer} have the coordinate system {system}, those before"
            f" {found.system}: choose a layer by --layer"
        )
    found.system = found.system or system
    names = [str(name) for name in about["fields"]]
    for k, geometry in enumerate(shapely.from_wkb(shapes)):
        where = f"feature {k + 1}{of_layer}"
        if geometry is None:
            found.note("empty", f"{where} has no geometry and gives nothing")
            continue
        values = {
            name: _plain(column[k])
            for name, column in zip(names, columns, strict=True)
            if name not in _OF_DRAWINGS
        }
        add_geometry(found, geometry, values, path, where)


def _plain(value: object) -> object:
    """Give a value of a table as Python has it; what is missing is nothing."""
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and np.isnan(value) else value
