"""Maps of every format become scenes that the solver accepts."""

from __future__ import annotations

import json
from pathlib import Path

import f90nml
import gmsh
import numpy as np
import pytest

from map_calls import OUTCROP, area, feature, fractures, geojson, imported, needs_solver, rows
from wingcrack.command_line import main
from wingcrack.scenes.solver import check
from wingcrack_maps.features import Line, Map
from wingcrack_maps.read import read_map
from wingcrack_maps.units import could_be_degrees, in_degrees

pytestmark = needs_solver

LINE = '{"type": "LineString", "coordinates": [[9, 9], %s]}'
IN_A = '{"type": "GeometryCollection", "geometries": ['
LINES = (feature((0, 0), (10, 0), name="a"), feature((5, -4), (5, 6), name="b", friction=0.7))


def test_a_geojson_map_becomes_a_scene(tmp_path: Path) -> None:
    status, scene = imported(geojson(tmp_path / "m.geojson", *LINES), "--unit", "m")
    assert status == 0
    found = fractures(scene)
    assert found["a"]["x"] == [0.0, 10.0]
    assert found["b"]["y"] == [-4.0, 6.0]
    assert (found["a"]["friction"], found["b"]["friction"]) == (0.6, 0.7)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("m.wkt", "# two\nLINESTRING (0 0, 10 0)\nSRID=25832;LINESTRING Z (5 -4 1, 5 6 2)\n"),
        ("m.csv", "x1,y1,x2,y2\n0,0,10,0\n5,-4,5,6\n"),
        ("m.csv", "\ufeffX1;Y1;X2;Y2\r\n0;0;10,0;0\r\n5;-4;5;6,0\r\n"),
        ("m.csv", "name\tx\ty\nf1\t0\t0\nf1\t10\t0\nf2\t5\t-4\nf2\t5\t6\n"),
        ("m.csv", 'wkt,name\n"LINESTRING (0 0, 10 0)",f1\n"MULTILINESTRING ((5 -4, 5 6))",f2\n'),
        ("m.geo", "Point(1)={0,0,0};Point(2)={10,0,0};Point(3)={5,-4,0};Point(4)={5,6,0};"
         'Line(1)={1,2};Line(2)={3,4};Physical Curve("f1")={1};Physical Curve("f2")={2};\n'),
    ],
    ids=["wkt", "segments", "semicolons", "vertices", "wkt column", "geo"],
)  # fmt: skip
def test_formats_give_the_same_fractures(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    status, scene = imported(tmp_path / name)
    assert status == 0
    found = fractures(scene)
    assert {name: (f["x"], f["y"]) for name, f in found.items()} == {
        "f1": ([0.0, 10.0], [0.0, 0.0]),
        "f2": ([5.0, 5.0], [-4.0, 6.0]),
    }


@pytest.mark.parametrize(("unit", "metres"), [("km", 1000.0), ("ft", 0.3048), ("cm", 0.01)])
def test_units_of_length(tmp_path: Path, unit: str, metres: float) -> None:
    _, scene = imported(geojson(tmp_path / "m.geojson", *LINES), "--unit", unit)
    assert fractures(scene)["a"]["x"] == [0.0, pytest.approx(10.0 * metres, rel=1e-15)]


def test_the_origin_is_moved_and_told(tmp_path: Path) -> None:
    lines = (feature((3500000, 5700000), (3500010, 5700004)),)
    path = geojson(tmp_path / "m.geojson", *lines)
    status, scene = imported(path, "--origin", "3500000,5700000")
    assert status == 0
    assert fractures(scene)["f1"]["x"] == [0.0, 10.0]
    assert "(3500000, 5700000) m of the map" in scene.with_suffix(".repairs.csv").read_text()


def test_boundary_and_regions(tmp_path: Path) -> None:
    body = area((-20, -20), (40, -20), (40, 30), (-20, 35), kind="boundary")
    soft = area((20, -10), (30, -10), (30, 10), (20, 10), kind="region", name="marl", young=5e9)
    path = geojson(tmp_path / "m.geojson", *LINES, body, soft)
    status, scene = imported(path, "--unit", "m")
    assert status == 0
    text = scene.read_text()
    assert "shape = 'polygon'" in text
    assert "name = 'marl'" in text
    assert "young = 5000000000.0" in text


def test_fractures_are_added_to_a_scene(tmp_path: Path) -> None:
    base = tmp_path / "base.nml"
    base.write_text(
        "! my rock\n&domain x_min = -50, x_max = 50, y_min = -50, y_max = 50 /\n"
        "&material young = 1e10, poisson = 0.2 /\n"
        "&side name = 'bottom', x_displacement = 0.0, y_displacement = 0.0 /\n"
        "&side name = 'top', y_traction = -1e6 /\n"
        "&fracture name = 'a', x = -30.0, -20.0, y = 5.0, 5.0, friction = 0.4 /\n"
    )
    path = geojson(tmp_path / "m.geojson", *LINES)
    status, scene = imported(path, "--unit", "m", "--scene", str(base), "--set", "friction=0.5")
    assert status == 0
    text = scene.read_text()
    assert text.startswith(base.read_text())
    assert "aperture" not in text  # there is no fluid
    found = fractures(scene)
    assert {name: f["friction"] for name, f in found.items()} == {"a": 0.4, "a_2": 0.5, "b": 0.7}
    assert ("renamed", "", "") in rows(scene, "noted")


def test_a_scene_may_grow_by_one_line(tmp_path: Path) -> None:
    path = geojson(tmp_path / "m.geojson", *LINES)
    status, scene = imported(path, "--unit", "m")
    assert status == 0
    groups = f90nml.read(scene)
    assert "growth" not in groups
    assert groups["material"]["toughness"] == 1.5e6
    # without growth fractures slip only
    assert groups["injection"]["pressure"] < -groups["in_situ"]["syy"]
    with scene.open("a", encoding="utf-8") as file:
        file.write("&growth enabled = .true. /\n")
    is_good, words = check(scene)
    assert is_good, words
    assert "tips:         growth" in words


@pytest.mark.parametrize("cell", [None, "0.5"])
def test_growth_leaves_the_sizes_to_the_solver(tmp_path: Path, cell: str | None) -> None:
    path = geojson(tmp_path / "m.geojson", feature((0, 0), (10, 0)), feature((20, 3), (21, 3)))
    options = ["--unit", "m", "--growth"] + ([] if cell is None else ["--cell", cell])
    status, scene = imported(path, *options)
    assert status == 0
    groups = f90nml.read(scene)
    assert groups["growth"]["enabled"]
    # what stands across the smallest compression can open
    assert groups["injection"]["pressure"] > -groups["in_situ"]["syy"]
    assert ("coarse" in groups) is (cell is not None)
    is_good, words = check(scene)
    assert is_good, words
    assert ("sizes:        cells 0.1 to 1 m along fractures" in words) is (cell is None)


def test_growth_in_a_scene_with_growth_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    base = tmp_path / "base.nml"
    base.write_text("&growth enabled = .false. /\n")
    path = geojson(tmp_path / "m.geojson", *LINES)
    assert imported(path, "--unit", "m", "--scene", str(base), "--growth")[0] == 2
    assert "has a group &growth; set enabled = .true. there" in capsys.readouterr().err


def test_a_toughness_that_is_missing_is_told_with_a_value(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    base = tmp_path / "base.nml"
    base.write_text(
        "&material young = 40.0e9, poisson = 0.25, biot = 0.7, porosity = 0.01,"
        " permeability = 1.0e-18 /\n"
        "&fluid compressibility = 4.5e-10, viscosity = 3.0e-4 /\n&time end = 1.0 /\n"
    )
    path = geojson(tmp_path / "m.geojson", *LINES)
    assert imported(path, "--unit", "m", "--scene", str(base), "--growth")[0] == 2
    assert "begin with toughness = 1.5e6" in capsys.readouterr().err


def test_names_are_made_good_and_different(tmp_path: Path) -> None:
    lines = [feature((0, 4 * k), (9, 4 * k), name=n) for k, n in enumerate(["Störung 1"] * 2)]
    lines.append(feature((0, 12), (9, 12), name="x" * 80))
    lines.append(feature((0, 16), (9, 16), name="断层"))
    status, scene = imported(geojson(tmp_path / "m.geojson", *lines), "--unit", "m")
    assert status == 0
    assert list(fractures(scene)) == ["Storung_1", "Storung_1_2", "x" * 64, "f4"]
    assert len([row for row in rows(scene, "noted") if row[0] == "renamed"]) == 4


def test_a_name_begins_with_a_letter_or_a_digit(tmp_path: Path) -> None:
    lines = [feature((0, 4 * k), (9, 4 * k), name=n) for k, n in enumerate((".a", "..", "-b_"))]
    status, scene = imported(geojson(tmp_path / "m.geojson", *lines), "--unit", "m")
    assert status == 0
    assert list(fractures(scene)) == ["a", "f2", "b"]


def test_a_hidden_map_gives_a_scene_that_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".my map.csv").write_text("x1,y1,x2,y2\n0,0,9,9\n")
    assert main(["import", ".my map.csv"]) == 0
    assert (tmp_path / "my_map.nml").is_file()
    with pytest.raises(SystemExit, match="2"):
        main(["import", ".my map.csv", "--out", ".mine.nml"])


def test_a_long_geometry_in_a_cell_is_read(tmp_path: Path) -> None:
    places = ", ".join(f"{k} {k % 2}.0" for k in range(20_000))
    (tmp_path / "m.csv").write_text(f'name,wkt\nlong,"LINESTRING ({places})"\n')
    assert len(read_map(tmp_path / "m.csv", None).lines[0].points) == 20_000


def test_attributes_that_are_no_entry_are_told(tmp_path: Path) -> None:
    path = geojson(tmp_path / "m.geojson", feature((0, 0), (9, 1), strike=30, Aperture="2e-4"))
    status, scene = imported(path, "--unit", "m")
    assert status == 0
    assert fractures(scene)["f1"]["aperture"] == 2e-4
    assert (
        "'strike' of 1 features is no entry of &fracture"
        in scene.with_suffix(".repairs.csv").read_text()
    )


@pytest.mark.parametrize("text", ["friction", "frictoin=0.5", "x=1.0", "=0.5"])
def test_what_is_set_must_be_an_entry(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    path = geojson(tmp_path / "m.geojson", *LINES)
    assert imported(path, "--unit", "m", "--set", text)[0] == 2
    assert f"--set {text}: it must be NAME=VALUE with a NAME of" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("m.csv", "", "the file is empty"),
        ("m.csv", "x1,y1,x2,y2\n", "it contains no lines"),
        ("m.csv", "a,b\n1,2\n", "the columns a, b hold no fractures; there must be x1, y1"),
        ("m.csv", "x1,y1,x2,y2\n0,0,1\n", "m.csv:2: the row has 3 values but must have 4"),
        ("m.csv", "x1,y1,x2,y2\n0,0,1,?\n", "m.csv:2: y2 is '?' but must be a number"),
        ("m.csv", "x1,y1,x2,y2\n0,0,1,inf\n", "m.csv:2: y2 is 'inf' but must be a number"),
        ("m.csv", 'x1,y1,x2,y2\n0,0,1,"0,5"\n', "m.csv:2: y2 is '0,5' but must be a number"),
        ("m.csv", "x1,y1,x1,y2\n0,0,1,1\n", "the column 'x1' is given twice"),
        ("m.csv", "name,x,y\na,0,0\nb,1,1\na,2,2\n", "m.csv:4: 'a' goes on after 'b'"),
        ("m.csv", "name,x,y\na,0,0\n", "'a' has one vertex, but it takes two"),
        ("m.csv", "x1,y1,x2,y2,friction\n0,0,9,1,high\n", "friction is 'high' but must be a num"),
        ("m.csv", "x1,y1,x2,y2,friction\n0,0,9,1,-1\n", "check refuses the scene"),
        ("m.wkt", "LINESTRING (0 0, 1\n", "line 1 is no well-known text"),
        ("m.wkt", "SRID=4326;LINESTRING (0 0, 1 1)\n", "is in degrees of longitude and latitude"),
        ("m.wkt", "POINT (1 1)\n", "it contains no lines and no polygons"),
        ("m.geojson", "{", "not a JSON file"),
        ("m.geojson", "[]", "no GeoJSON"),
        ("m.geojson", '{"type": "FeatureCollection"}', 'has no list "features"'),
        ("m.geojson", '{"type": "LineString", "coordinates": [[0, NaN], [1, 1]]}', "[0, NaN] must"),
        ("m.geojson", '{"type": "LineString", "coordinates": "x"}', "has no geometry that can"),
        ("m.geojson", '{"type": "LineString", "coordinates": [[0, 0], [1, 1]]}', "give --unit m"),
        ("m.geojson", LINE.replace("9, 9", "9, 9, 1") % "[0, 0, null]", "[0, 0, null] must"),
        ("m.geojson", LINE % "[0, 0, 5]", "some places of the LineString have a height"),
        ("m.geojson", LINE % "[1e999, 0]", "the place [Infinity, 0] must hold finite numbers"),
        ("m.geojson", LINE % f"[{'9' * 400}, 0]", "has 400 digits, which is too large"),
        ("m.geojson", LINE % "{}", "must be a list"),
        ("m.geojson", LINE % ("[" * 900 + "]" * 900), "more than 100 deep within one another"),
        ("m.geojson", IN_A * 900 + LINE % "[0, 0]" + "]}" * 900, "more than 100 deep within"),
        ("m.geojson", "[" * 100_000, "more than 100 deep within one another"),
        ("m.geojson", '{"type": "\\ud800", "a": 1}', "a text in it has half a character"),
        ("m.geojson", '{"type": "Circle"}', 'its type "Circle" is none of Point, MultiPoint'),
        ("m.wkt", "GEOMETRYCOLLECTION (" * 100_000, "more than 100 brackets in one another"),
        ("m.wkt", "LINESTRING (0 0, 1 1)\0)", "it has a zero byte"),
        ("m.wkt", "LINESTRING (0 0, 1e999 1)", "line 1 has a coordinate that is no finite number"),
        ("m.csv", "wkt\nGEOMETRYCOLLECTION" + "(" * 150_000, "row 2 is no well-known text"),
        ("m.geo", "Point(1)={0,0,0};", "it has no physical curves or surfaces"),
        ("m.csv", "x1,y1,x2,y2\n1,1,1,1\n", "all its lines lie at one place"),
        ("m.csv", "x1,y1,x2,y2\n1,1,1,1\n2,2,2,2\n", "no fracture has a length"),
        ("m.csv", "x1,y1,x2,y2\n1,1,1,1\n2,2,9,9\n", "check refuses the scene"),
        ("m.csv", "x1,y1,x2,y2\n0,0,1e300,1\n", "row 2 has a coordinate of 1e+300 m, but none"),
    ],
)  # fmt: skip
def test_bad_maps_are_refused_with_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, text: str, reason: str
) -> None:
    (tmp_path / name).write_text(text)
    status, _ = imported(tmp_path / name)
    assert status == 2
    assert reason in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize(
    ("features", "more", "reason"),
    [
        ([area((0, 0), (9, 0), (0, 9))], {}, "may be the body or a region"),
        ([area((0, 0), (9, 0), (0, 9), kind="lake")], {}, "has the kind 'lake', but it must be"),
        ([feature((0, 0), (9, 0), kind="region")], {}, "is a line but its kind is 'region'"),
        ([area((0, 0), (9, 9), (9, 0), (0, 9), kind="region"), *LINES], {}, "crosses itself"),
        ([area((0, 0), (9, 0), (0, 9), kind="boundary")], {}, "it has no lines"),
        (LINES, {"crs": {"properties": {"name": "urn:ogc:def:crs:EPSG::4326"}}}, "in degrees"),
        (LINES, {"crs": {"properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}}, "in degrees"),
        (["x"], {}, "feature 1 is no object with a geometry"),
    ],
)  # fmt: skip
def test_bad_features_are_refused(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    features: list[dict[str, object]],
    more: dict[str, object],
    reason: str,
) -> None:
    status, scene = imported(geojson(tmp_path / "m.geojson", *features, **more), "--unit", "m")
    assert status == 2
    assert reason in capsys.readouterr().err
    assert not scene.exists()


@pytest.mark.parametrize(
    ("place", "answer"),
    [((180.0, -90.0), True), ((-180.0, 90.5), False), ((180.5, 0.0), False)],
)
def test_numbers_that_could_be_degrees(place: tuple[float, float], answer: bool) -> None:
    content = Map([Line("f1", np.array([(0.0, 0.0), place]))])
    assert could_be_degrees(content) == answer


def test_coordinate_systems_by_name() -> None:
    degrees = ("EPSG:4326", "urn:ogc:def:crs:EPSG::4258", "SRID=4269", "OGC:CRS84", "WGS 84")
    lengths = ("EPSG:25832", "urn:ogc:def:crs:EPSG::3857", "SRID=31467", "local", "EPSG:4547")
    assert all(in_degrees(system) for system in degrees)
    assert not any(in_degrees(system) for system in lengths)


def test_gmsh_regions_sides_and_an_embedded_fracture(tmp_path: Path) -> None:
    gmsh.initialize(["t"], readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    left, right = occ.addRectangle(0, 0, 0, 20, 20), occ.addRectangle(20, 0, 0, 20, 20)
    line = occ.addLine(occ.addPoint(5, 5, 0), occ.addPoint(15, 12, 0))
    _, origins = occ.fragment([(2, left), (2, right)], [(1, line)])
    occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [origins[0][0][1]], name="granite")
    gmsh.model.addPhysicalGroup(2, [origins[1][0][1]], name="gneiss")
    gmsh.model.addPhysicalGroup(1, [tag for _, tag in origins[2]], name="fault")
    foot = [t for _, t in gmsh.model.getEntitiesInBoundingBox(-1, -1, -1, 21, 0.1, 1, 1)]
    gmsh.model.addPhysicalGroup(1, foot, name="foot")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 3.0)
    gmsh.model.mesh.generate(2)
    gmsh.write(str(tmp_path / "m.msh"))
    gmsh.finalize()

    status, scene = imported(tmp_path / "m.msh", "--region", "gneiss:young=5e10")
    assert status == 0
    found = fractures(scene)
    assert list(found) == ["fault"]
    ends = sorted(zip(found["fault"]["x"], found["fault"]["y"], strict=True))  # type: ignore[call-overload]
    assert ends == [(5.0, 5.0), (15.0, 12.0)]
    text = scene.read_text()
    assert "&domain x_min = 0.0, x_max = 40.0, y_min = 0.0, y_max = 20.0 /" in text
    assert "! &region name = 'granite'" in text
    assert f90nml.read(scene)["region"]["name"] == "gneiss"
    assert ("no rock", "", "") in rows(scene, "noted")
    assert "'foot' lies on the rim" in scene.with_suffix(".repairs.csv").read_text()


def test_the_outcrop_is_refused_as_it_is_where_the_solver_could_not_mesh_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "o.nml"
    assert main(["import", str(OUTCROP), "--unit", "m", "--out", str(out)]) == 2
    assert "--repair DISTANCE may mend it" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_the_outcrop_is_repaired(tmp_path: Path) -> None:
    """What the generator of the map has put in is found, each as often as it is there."""
    out = tmp_path / "o.nml"
    call = ["import", str(OUTCROP), "--unit", "m", "--repair", "0.1", "--out", str(out)]
    assert main(call) == 0
    content = json.loads(out.with_suffix(".repairs.json").read_text())
    assert (content["fractures read"], content["fractures written"]) == (50, 45)
    assert content["faults left"] == 0
    kinds = [row["fault"] for row in content["rows"] if row["status"] == "repaired"]
    put_in = {"short segment": 2, "short fracture": 2, "duplicate": 3, "overlap": 3, "end past": 4}
    assert {kind: kinds.count(kind) for kind in put_in} == put_in
    assert kinds.count("near end") == 4 + 3  # short of their targets, and joined after the overlaps


def test_nothing_is_replaced_unasked_and_a_folder_that_cannot_be_written_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = geojson(tmp_path / "m.geojson", *LINES)
    assert imported(path, "--unit", "m")[0] == 0
    with pytest.raises(SystemExit) as ended:
        imported(path, "--unit", "m")
    assert ended.value.code == 2
    assert "--overwrite replaces it" in capsys.readouterr().err
    assert imported(path, "--unit", "m", "--overwrite")[0] == 0


def test_sizes_follow_from_the_lengths_and_their_cost_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An eighth of the long one; of the median for the others, but no more than their length."""
    lines = [feature((0, 6 * k), (4, 6 * k)) for k in range(3)]
    lines += [feature((10, 0), (10, 16)), feature((14, 0), (14, 0.2))]
    status, scene = imported(geojson(tmp_path / "m.geojson", *lines), "--unit", "m")
    assert status == 0
    found = [fracture["cell_size"] for fracture in fractures(scene).values()]
    assert found == pytest.approx([0.5, 0.5, 0.5, 2.0, 0.2], rel=0.01)
    assert "CPU s, without its figures" in capsys.readouterr().out


def test_a_large_network_has_coarser_cells(tmp_path: Path) -> None:
    lines = [
        feature((10 * i, 10 * j), (10 * i + 8, 10 * j + 2)) for i in range(25) for j in range(20)
    ]
    status, scene = imported(geojson(tmp_path / "m.geojson", *lines), "--unit", "m")
    assert status == 0
    found = [fracture["cell_size"] for fracture in fractures(scene).values()]
    assert found == pytest.approx([500 * np.hypot(8, 2) / 1500] * 500, rel=0.01)


def test_short_traces_and_vertices_are_left_out_on_request(tmp_path: Path) -> None:
    wavy = feature((0, 0), (5, 0.01), (10, 0), name="wavy")
    path = geojson(tmp_path / "m.geojson", wavy, feature((3, 4), (3, 4.5)), feature((7, 5), (9, 9)))
    status, scene = imported(path, "--unit", "m", "--drop-shorter", "1", "--simplify", "0.1")
    assert status == 0
    assert [len(fracture["x"]) for fracture in fractures(scene).values()] == [2, 2]  # type: ignore[arg-type]
    notes = scene.with_suffix(".repairs.csv").read_text()
    assert "1 traces shorter than 1 m, together 0.5 m" in notes
    assert "1 of 7 vertices" in notes
    assert imported(path, "--unit", "m", "--drop-shorter", "99", "--overwrite")[0] == 2


def point(x: float, y: float, **properties: object) -> dict[str, object]:
    """Give a point of a GeoJSON map."""
    geometry = {"type": "Point", "coordinates": [x, y]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def test_points_become_wells(tmp_path: Path) -> None:
    """Each in the nearest fracture, with a radius in the rock; units and origin as of the lines."""
    wells = (
        point(0.002, 0.0001, kind="well", name="GT 1", rate_l_s=0.01, pressure_mpa=33, depth=3),
        point(0.012, 0.008, kind="Well", rate=-1e-6, radius=0.1, end=1800),
        point(0.0, 0.0, name="sample"),
    )
    lines = (feature((0, 0), (0.01, 0)), feature((0.005, 0.003), (0.005, 0.009)))
    path = geojson(tmp_path / "m.geojson", *lines, *wells)
    status, scene = imported(path, "--unit", "km", "--origin", "0,1")
    assert status == 0
    first, second = (dict(group) for group in f90nml.read(scene)["injection"])
    assert first == {
        "name": "GT_1", "fracture": "nearest", "x": 2.0, "y": pytest.approx(-0.9),
        "rate_l_s": 0.01, "pressure_mpa": 33.0,
    }  # fmt: skip
    assert second == {
        "name": "w2", "x": 12.0, "y": 7.0, "rate": -1e-6, "radius": 0.1, "end": 1800.0
    }  # fmt: skip
    assert ("left out", "", "") in rows(scene, "noted")


def test_wells_of_a_table(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text("name;x;y;kind;rate\na;0;0;;\na;10;0;;\nw;2,5;0,1;well;1e-6\n")
    status, scene = imported(path)
    assert status == 0
    assert dict(f90nml.read(scene)["injection"]) == {
        "name": "w", "fracture": "nearest", "x": 2.5, "y": 0.1, "rate": 1e-6
    }  # fmt: skip


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (point(2, 0, kind="well"), "a well needs a rate"),
        (point(2, 0, kind="well", rate="much"), "rate is 'much' but must be"),
        (feature((2, 0), (3, 1), kind="well"), "takes a point"),
        (point(2, 0, kind="region"), "takes a polygon"),
    ],
)
def test_wrong_wells_are_refused(
    wrong: dict[str, object], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, _ = imported(geojson(tmp_path / "m.geojson", *LINES, wrong), "--unit", "m")
    assert status == 2
    assert words in capsys.readouterr().err
