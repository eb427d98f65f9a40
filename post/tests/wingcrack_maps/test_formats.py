"""Files of geographic information systems and other programs, and their coordinate systems."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from map_calls import feature, fractures, geojson, imported, needs_solver
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.features import Map
from wingcrack_maps.read import read_map
from wingcrack_maps.units import could_be_degrees

pyogrio = pytest.importorskip("pyogrio")
pyproj = pytest.importorskip("pyproj")

LINES = [[(0.0, 0.0), (10.0, 0.0)], [(5.0, -4.0), (5.0, 6.0)]]
BERGEN = np.array([5.32, 60.39])


def written(path: Path, lines: list[list[tuple[float, float]]], system: str) -> Path:
    """Write lines with an attribute, as GDAL does."""
    pyogrio.raw.write(
        path,
        shapely.to_wkb(shapely.linestrings(np.array(lines))),
        [np.array([0.5, 0.7])],
        ["friction"],
        geometry_type="LineString",
        crs=system,
    )
    return path


def points(content: Map) -> list[list[list[float]]]:
    """Give the vertices of all lines."""
    return [line.points.tolist() for line in content.lines]


@pytest.mark.parametrize("ending", ["shp", "gpkg", "fgb"])
def test_files_of_information_systems(tmp_path: Path, ending: str) -> None:
    found = read_map(written(tmp_path / f"m.{ending}", LINES, "EPSG:25832"), None)
    assert sorted(points(found)) == np.array(LINES).tolist()
    assert {line.attributes["friction"] for line in found.lines} == {0.5, 0.7}
    assert "EPSG:25832" in found.system


def test_a_shapefile_without_its_index_and_its_table(tmp_path: Path) -> None:
    path = written(tmp_path / "m.shp", LINES, "EPSG:25832")
    for file in tmp_path.glob("m.*"):
        if file.suffix != ".shp":
            file.unlink()
    with pytest.raises(SceneError, match="could be degrees: give --unit m"):
        read_map(path, None)
    assert points(read_map(path, "km")) == (1000.0 * np.array(LINES)).tolist()
    assert [file.name for file in tmp_path.iterdir()] == ["m.shp"]


def test_lines_and_polylines_of_a_drawing(tmp_path: Path) -> None:
    places = ((0, 5), (4, 6), (9, 5))
    vertices = [f"0\nVERTEX\n8\n0\n10\n{x}\n20\n{y}\n" for x, y in places]
    text = (
        "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nfaults\n10\n0\n20\n0\n11\n10\n21\n5\n"
        "0\nPOLYLINE\n8\n0\n66\n1\n" + "".join(vertices) + "0\nSEQEND\n0\nENDSEC\n0\nEOF\n"
    )
    (tmp_path / "m.dxf").write_text(text)
    found = read_map(tmp_path / "m.dxf", None)
    assert points(found) == [[[0, 0], [10, 5]], [[0, 5], [4, 6], [9, 5]]]


def test_layers_are_read_together_or_by_name(tmp_path: Path) -> None:
    path = tmp_path / "m.gpkg"
    shapes = shapely.to_wkb(shapely.linestrings(np.array(LINES)))
    for name, k in (("joints", 0), ("faults", 1)):
        pyogrio.raw.write(path, shapes[k : k + 1], [], [], layer=name, append=path.exists(),
                          geometry_type="LineString", crs="EPSG:25832")  # fmt: skip
    assert len(read_map(path, None).lines) == 2
    assert points(read_map(path, None, layer="faults")) == [np.array(LINES[1]).tolist()]
    with pytest.raises(SceneError, match=r"no layer 'veins' \(it has: joints, faults"):
        read_map(path, None, layer="veins")


def test_a_file_that_is_no_geopackage_is_refused(tmp_path: Path) -> None:
    (tmp_path / "m.gpkg").write_bytes(b"SQLite format 3\0")
    with pytest.raises(SceneError, match=r"m\.gpkg: it cannot be read"):
        read_map(tmp_path / "m.gpkg", None)


def test_feet_of_a_system_become_metres(tmp_path: Path) -> None:
    found = read_map(written(tmp_path / "m.gpkg", LINES, "EPSG:2263"), None)
    assert found.lines[0].points[1, 0] == pytest.approx(10.0 * 0.3048006096, rel=1e-9)
    assert "unit" in [note.kind for note in found.notes]


@pytest.mark.parametrize("name", ["m.gpkg", "m.shp", "m.geojson"])
def test_degrees_are_refused_with_a_way_out_and_projected_on_request(
    tmp_path: Path, name: str
) -> None:
    """Lengths in UTM zone 31 are geodesic ones but for its scale, within 4e-4 of 1."""
    lines = [[(5.32, 60.39), (5.33, 60.392)], [(5.32, 60.39), (5.323, 60.393)]]
    path = written(tmp_path / name, lines, "EPSG:4326")
    with pytest.raises(SceneError, match="utm"):
        read_map(path, None)
    found = read_map(path, None, crs="utm")
    geodesic = pyproj.Geod(ellps="WGS84").geometry_length
    for line, given in zip(found.lines, lines, strict=True):
        assert line.length == pytest.approx(geodesic(shapely.LineString(given)), rel=4e-4)
    assert not could_be_degrees(found)
    same = read_map(path, None, crs="EPSG:32631")
    assert points(same) == points(found)
    for bad, why in (("EPSG:4258", "not the metre"), ("EPSG:2263", "not the metre"), ("x", "no")):
        with pytest.raises(SceneError, match=why):
            read_map(path, None, crs=bad)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("FID,START_X,START_Y,END_X,END_Y\n1,0,0,10,0\n2,5,-4,5,6\n", LINES),
        ("0,0,10,0\n5,-4,5,6\n", LINES),
        ("1,0,0,10,0\n2,5,-4,5,6\n", LINES),
        ("#FID, PT_X, PT_Y\n1,0,0\n1,10,0\n2,5,-4\n2,5,6\n", LINES),
        ("1;0,0;0\n1;10,0;0\n2;5;-4\n2;5;6\n", LINES),
    ],
)
def test_tables_of_other_programs(
    tmp_path: Path, text: str, found: list[list[tuple[float, float]]]
) -> None:
    (tmp_path / "m.csv").write_text(text)
    assert points(read_map(tmp_path / "m.csv", None)) == np.array(found).tolist()


def test_parts_that_go_on_where_others_end_are_one_fracture(tmp_path: Path) -> None:
    def several(*parts: list[list[float]]) -> dict[str, object]:
        geometry = {"type": "MultiLineString", "coordinates": list(parts)}
        return {"type": "Feature", "properties": {"name": "m"}, "geometry": geometry}

    path = geojson(
        tmp_path / "m.geojson",
        several([[0, 0], [10, 1]], [[20, 0], [10, 1]]),
        several([[0, 5], [8, 5]], [[12, 5], [20, 5]]),
        several([[0, 9], [5, 9]], [[5, 9], [9, 9]], [[5, 9], [5, 12]]),  # a fork stays apart
    )
    found = read_map(path, "m")
    assert [len(line.points) for line in found.lines] == [3, 2, 2, 2, 2, 2]
    assert [line.name for line in found.lines] == ["m", "m.1", "m.2", "m.1", "m.2", "m.3"]
    notes = [note.what for note in found.notes if note.kind == "joined"]
    assert notes == ["feature 1: 2 parts go on where others end: one fracture"]


@needs_solver
def test_a_system_in_degrees_becomes_a_scene(tmp_path: Path) -> None:
    lines = (feature(tuple(BERGEN), tuple(BERGEN + 0.001)),)
    path = geojson(tmp_path / "m.geojson", *lines)
    status, scene = imported(path, "--crs", "utm", "--origin", "centre")
    assert status == 0
    assert max(map(abs, fractures(scene)["f1"]["x"])) < 60.0  # type: ignore[call-overload]
