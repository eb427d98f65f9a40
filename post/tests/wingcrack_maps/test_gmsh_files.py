"""Files of gmsh describe a map, or are refused with a line: nothing of them is executed."""

from __future__ import annotations

import re
import subprocess
import sys
import time
from pathlib import Path

import gmsh
import pytest

from map_calls import fractures, imported, needs_solver
from wingcrack.scenes.errors import SceneError
from wingcrack_maps.read import read_map

POST = Path(__file__).resolve().parents[2]

LINE = "Point(1) = {0, 0, 0};\nPoint(2) = {10, 0, 0};\nLine(1) = {1, 2};\n"
NAMED = LINE + 'Physical Curve("f1") = {1};\n'
MESH = (
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 10 0 0\n$EndNodes\n"
    "$Elements\n1\n1 1 2 1 1 1 2\n$EndElements\n"
)
FIELD = "Field[1] = ExternalProcess;\nField[1].CommandLine = 'touch x';\nBackground Field = 1;\n"

# What it tries, and the line that must be told; 'x' is what would appear if it were done.
HOSTILE_GEO = {
    "a field that is a process": (NAMED + FIELD, 5),
    "a folder": (NAMED + 'CreateDir "x";\n', 5),
    "the end": ("Exit;\n" + NAMED, 1),
    "an end in the middle": (LINE + "Abort;\n" + NAMED, 4),
    "a loop without end": (NAMED + "For i In {0:1000000000}\nx = 1;\nEndFor\n", 5),
    "a command": ("// x\nSystemCall 'touch x';\n", 2),
    "a command aside": (NAMED + 'NonBlockingSystemCall "touch x";\n', 5),
    "an old command": (NAMED + 'System "touch x";\n', 5),
    "another file": ("Include 'other.geo';\n", 1),
    "a merged file": (NAMED + 'Merge "other.geo";\n', 5),
    "a shape of another file": (NAMED + 'ShapeFromFile("other.brep");\n', 5),
    "a written file": (NAMED + 'Save "x";\n', 5),
    "a printed file": (NAMED + 'Print "x";\n', 5),
    "a line into a file": (NAMED + 'Printf("hello") > "x";\n', 5),
    "a macro": (NAMED + "Macro m\nReturn\nCall m;\n", 5),
    "a text that is parsed": (NAMED + 'Parse["Exit;"];\n', 5),
    "a variable of the environment": (NAMED + 's = GetEnv("HOME");\n', 5),
    "a number that is asked for": (NAMED + 'n = GetNumber("ask", 1);\n', 5),
    "a client of ONELAB": (NAMED + 'OnelabRun("client", "touch x");\n', 5),
    "a plugin": (NAMED + "Plugin(MathEval).Run;\n", 5),
    "an option": (NAMED + 'General.FileName = "x";\n', 5),
    "a definition of ONELAB": (NAMED + "DefineConstant[n = {1, Name 'n'}];\n", 5),
    "a string that is built": (NAMED + 's = StrCat("Sys", "tem");\n', 5),
    "a condition": (NAMED + "If (1)\nExit;\nEndIf\n", 5),
    "a file that is deleted": (NAMED + 'Delete "file";\n', 5),
    "a range of a thousand million": (LINE + 'Physical Curve("f1") = {1:1000000000};\n', 4),
    "arithmetic": (LINE + "Point(3) = {10^1000000, 0, 0};\n", 4),
    "hidden in a comment": (NAMED + "/* */ Exit; /* \n */\n", 5),
    "over two lines": (NAMED + "System\n'touch x';\n", 5),
    "a spline": (LINE + "Spline(2) = {1, 2};\n", 4),
    "a mesh in disguise": (MESH, 1),
    "a zero": (NAMED + "\0Exit;\n", 5),
}  # fmt: skip

HOSTILE_MSH = {
    "a script": ("SystemCall 'touch x';\n", 1),
    "a script behind a comment": ("// $MeshFormat\nSystemCall 'touch x';\n", 1),
    "a script behind the format": (MESH[:36] + "SystemCall 'touch x';\n", 4),
    "a script at the end": (MESH + "SystemCall 'touch x';\n", 13),
    "a script in a section": (MESH.replace("2 10 0 0", "2 10 0 System"), 7),
    "a section of scripts": (MESH + "$Script\nExit;\n$EndScript\n", 13),
    "no format": ("$MeshFormat\nnonsense\n", 1),
    "nodes without end": (MESH.replace("$Nodes\n2", "$Nodes\n999999999999999999"), 5),
    "elements without end": (MESH.replace("$Elements\n1", "$Elements\n1e9"), 10),
    "no nodes at all": (MESH.replace("$Nodes\n2", "$Nodes\n-2"), 5),
    "a section that does not end": (MESH.replace("$EndNodes", ""), 4),
    "an element of no type": (MESH.replace("1 1 2 1 1 1 2", "1 99 2 1 1 1 2"), 11),
    "elements of less than nothing": (MESH.replace("1 1 2 1 1 1 2", "1 1 -2 1 1 1 2"), 11),
    "a number of 5000 digits": (MESH.replace("2 10 0 0", "9" * 5000 + " 10 0 0"), 7),
    "a place at infinity": (MESH.replace("2 10 0 0", "2 1e999 0 0"), 7),
    "version 4": (MESH.replace("2.2 0 8", "4 0 8"), 2),
    "a node twice": (MESH.replace("2 10 0 0", "1 10 0 0"), 7),
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [("m.geo", *HOSTILE_GEO[what]) for what in HOSTILE_GEO]
    + [("m.msh", *HOSTILE_MSH[what]) for what in HOSTILE_MSH],
    ids=[*HOSTILE_GEO, *HOSTILE_MSH],
)
def test_what_is_more_than_a_map_is_refused_with_its_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    name: str,
    text: str,
    line: int,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text(text)
    (tmp_path / "other.geo").write_text("SystemCall 'touch x';\n")
    before, began = sorted(tmp_path.iterdir()), time.monotonic()
    status, _ = imported(tmp_path / name)
    assert time.monotonic() - began < 5.0
    assert status == 2
    assert f"{name}:{line}: " in capsys.readouterr().err
    assert sorted(tmp_path.iterdir()) == before


def test_what_lies_beside_a_mesh_is_not_executed(tmp_path: Path) -> None:
    """As the program is called; gmsh is not even loaded, so nothing can reach its language."""
    (tmp_path / "m.msh").write_text(MESH)
    (tmp_path / "m.msh.opt").write_text("CreateDir 'x';\nSystemCall 'touch y';\n")
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "wingcrack", "import", "m.msh"],
        cwd=tmp_path,
        env={"PYTHONPATH": str(POST)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "wingcrack_maps.read_msh" in done.stderr
    assert not re.search(r"\| *gmsh$", done.stderr, re.MULTILINE)
    assert not {"x", "y"} & {path.name for path in tmp_path.iterdir()}


def write_mesh(path: Path, version: float, binary: int, order: int, parametric: int = 0) -> None:
    """Let gmsh write the mesh of a rectangle with a fracture."""
    gmsh.initialize(["t"], readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    occ.addRectangle(0, 0, 0, 40, 20)
    line = occ.addLine(occ.addPoint(5, 5, 0), occ.addPoint(15, 12, 0))
    _, origins = occ.fragment([(2, 1)], [(1, line)])
    occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [origins[0][0][1]], tag=7, name="granite")
    gmsh.model.addPhysicalGroup(1, [tag for _, tag in origins[1]], tag=9, name="the fault")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 5.0)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.option.setNumber("Mesh.SaveParametric", parametric)
    gmsh.write(str(path))
    gmsh.finalize()


@needs_solver
@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("order", [1, 2])
def test_meshes_of_all_formats_give_the_same_scene(
    tmp_path: Path, version: float, binary: int, order: int
) -> None:
    write_mesh(tmp_path / "m.msh", version, binary, order)
    status, scene = imported(tmp_path / "m.msh")
    assert status == 0
    found = fractures(scene)["the_fault"]
    ends = sorted(zip(found["x"], found["y"], strict=True))  # type: ignore[call-overload]
    assert ends == [(5.0, 5.0), (15.0, 12.0)]
    assert "&domain x_min = 0.0, x_max = 40.0, y_min = 0.0, y_max = 20.0 /" in scene.read_text()


@pytest.mark.parametrize("binary", [0, 1])
def test_places_on_curves_and_surfaces_are_left_aside(tmp_path: Path, binary: int) -> None:
    """A mesh may give each node its parameters on its curve or surface, too."""
    found = []
    for parametric in (0, 1):
        write_mesh(tmp_path / f"{parametric}.msh", 4.1, binary, 1, parametric)
        found.append(read_map(tmp_path / f"{parametric}.msh", None))
    sizes = [(tmp_path / f"{parametric}.msh").stat().st_size for parametric in (0, 1)]
    assert sizes[0] < sizes[1]
    for plain, other in zip(found[0].lines, found[1].lines, strict=True):
        assert sorted(plain.points.tolist()) == sorted(other.points.tolist())
    ends = sorted(map(tuple, found[1].lines[0].points.tolist()))
    assert ends == [(5.0, 5.0), (15.0, 12.0)]
    assert sorted(map(tuple, found[1].areas[0].points.tolist())) == [
        (0.0, 0.0),
        (0.0, 20.0),
        (40.0, 0.0),
        (40.0, 20.0),
    ]


RECTANGLES = """\
//+
SetFactory("OpenCASCADE");
lc = 1.5e+0; /* a
size */ far = -20;
Point(1) = {far, -20, 0, lc};  Point(2) = {20, -20, 0, lc};
Point(3) = {20, 20, 0, lc};    Point(4) = {far, 20, 0, lc};
Point(5) = {60, -20, 0};       Point(6) = {60, 20, 0};
Point(7) = {0, 0, 0};          Point(8) = {5, 6, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Line(5) = {2, 5}; Line(6) = {5, 6}; Line(7) = {6, 3}; Line(8) = {7, 8};
Line Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6, 7, -2};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
Line {8} In Surface {1};
Physical Surface("granite", 3) = {1}; Physical Surface("gneiss") = {2};
Physical Line(5) = {-8}; Physical Curve("foot") = {1}; Physical Point("p") = {1};
"""


def test_what_a_geo_file_may_hold(tmp_path: Path) -> None:
    (tmp_path / "m.geo").write_text("\ufeff" + RECTANGLES, encoding="utf-8")
    found = read_map(tmp_path / "m.geo", None)
    assert [(line.name, line.points.tolist()) for line in found.lines] == [
        ("5", [[0.0, 0.0], [5.0, 6.0]])
    ]
    assert [(area.name, area.role, len(area.points)) for area in found.areas] == [
        ("body", "boundary", 4),
        ("granite", "region", 4),
        ("gneiss", "region", 4),
    ]
    assert any("'foot' lies on the rim" in note.what for note in found.notes)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("Line(8) = {7, 8}", "Line(8) = {7, 9}", "m.geo:10: there is no point 9"),
        ("Line(8) = {7, 8}", "Line(8) = {7, 7}", "m.geo:10: the line has no length"),
        ("Line(8) = {7, 8}", "Line(8) = {7, 8, 1}", "m.geo:10: a line takes two points"),
        ("Line(8) = {7, 8}", "Line(7) = {7, 8}", "m.geo:10: number 7 is there twice"),
        ("{5, 6, 7, -2}", "{5, 6, 7, 2}", "m.geo:11: the lines of the loop do not follow"),
        ('"gneiss"', '"granite"', "m.geo:14: the physical group 'granite' is there twice"),
        ("{-8}", "{8.5}", "m.geo:15: there is no curve 8.5"),
        ("Physical Point", "Physical Volume", "m.geo:15: 'Physical Volume' is not read"),
        ("{5, 6, 0}", "{5, 6}", "m.geo:8: a point takes x, y, z"),
        ("{5, 6, 0}", "{5, size, 0}", "m.geo:8: there must be a number, not 'size'"),
        ("Plane Surface(2) = {2};", "Plane Surface(2) = {2}", "m.geo:13: there must be ';'"),
    ],
)
def test_a_geometry_that_is_none_is_refused(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    assert old in RECTANGLES
    (tmp_path / "m.geo").write_text(RECTANGLES.replace(old, new))
    with pytest.raises(SceneError, match=re.escape(reason)):
        read_map(tmp_path / "m.geo", None)


def mesh(nodes: list[tuple[float, float]], *elements: tuple[int, int, list[int]]) -> str:
    """Give a mesh: elements as type, physical group and nodes, which count from 1."""
    places = "".join(f"{k} {x} {y} 0\n" for k, (x, y) in enumerate(nodes, start=1))
    rows = "".join(
        f"{k} {kind} 2 {group} 1 {' '.join(map(str, corners))}\n"
        for k, (kind, group, corners) in enumerate(elements, start=1)
    )
    return (
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes)}\n{places}$EndNodes\n"
        f"$Elements\n{len(elements)}\n{rows}$EndElements\n"
    )


def test_elements_of_no_group_and_points_are_no_map(tmp_path: Path) -> None:
    nodes = [(0.0, 0.0), (10.0, 0.0), (10.0, 5.0)]
    elements = [(1, 3, [1, 2]), (1, 0, [2, 3]), (15, 4, [3]), (15, 0, [1])]
    (tmp_path / "m.msh").write_text(mesh(nodes, *elements))
    found = read_map(tmp_path / "m.msh", None)
    assert [(line.name, line.points.tolist()) for line in found.lines] == [
        ("3", [[0.0, 0.0], [10.0, 0.0]])
    ]
    assert found.areas == []


def test_a_body_of_two_pieces_is_refused(tmp_path: Path) -> None:
    nodes = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (5.0, 0.0), (6.0, 0.0), (5.0, 1.0)]
    (tmp_path / "m.msh").write_text(mesh(nodes, (2, 1, [1, 2, 3]), (2, 2, [4, 5, 6])))
    with pytest.raises(SceneError, match="surfaces must be one piece, which is the body"):
        read_map(tmp_path / "m.msh", None)


def test_a_curve_on_a_slanted_rim_far_from_the_origin_is_a_side(tmp_path: Path) -> None:
    """In UTM coordinates a node on the rim is off it by some 1e-10 m, for want of digits."""
    corners = [(500000.1, 5400000.3), (501000.7, 5400333.9), (500400.2, 5400900.6)]
    (x, y), (x_end, y_end) = corners[:2]
    shares = [k / 7.0 for k in range(8)]
    nodes = [(x + s * (x_end - x), y + s * (y_end - y)) for s in shares]
    edges = [(1, 2 + k, [4 + k, 5 + k]) for k in range(7)]
    (tmp_path / "m.msh").write_text(mesh([*corners, *nodes], (2, 1, [1, 2, 3]), *edges))
    found = read_map(tmp_path / "m.msh", None)
    assert found.lines == []
    assert sum("lies on the rim: a side" in note.what for note in found.notes) == 7
