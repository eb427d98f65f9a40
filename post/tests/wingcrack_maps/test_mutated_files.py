"""Files that are damaged at random: every importer reads them, or refuses them in one sentence."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from map_calls import imported, needs_solver
from test_gmsh_files import MESH, RECTANGLES
from wingcrack.errors import CaseError, RunError
from wingcrack.figures.read import read_run
from wingcrack.studies.study import read_study
from wingcrack_maps import cli
from wingcrack_verify.case import read_case

FRACTURES = """\
&fluid viscosity = 1.0e-3 /
&injection fracture = 'base', rate = 1.0e-6 /
&domain x_min = 0.0, x_max = 9.0, y_min = 0.0, y_max = 9.0 /
&fracture name = 'base', x = 1.0, 2.0, y = 1.0, 2*2.0 /
"""
GEOJSON = """\
{"type": "FeatureCollection", "crs": {"properties": {"name": "EPSG:25832"}}, "features": [
{"type": "Feature", "properties": {"name": "a", "friction": 0.5, "kind": "fracture"},
"geometry": {"type": "LineString", "coordinates": [[0, 0, 7], [3.5, 1e1, 7]]}},
{"type": "Feature", "id": 3, "properties": null, "geometry": {"type": "GeometryCollection",
"geometries": [{"type": "MultiLineString", "coordinates": [[[5, 5], [9, 9]], [[9, 1], [5, 1]]]},
{"type": "Point", "coordinates": [1, 1]}]}},
{"type": "Feature", "properties": {"kind": "region", "young": 1e9, "name": "\\u00e9"},
"geometry": {"type": "Polygon", "coordinates": [[[0, 0], [20, 0], [20, 20], [0, 20], [0, 0]]]}}]}
"""
MAPS = {
    "m.geojson": GEOJSON,
    "m.wkt": "SRID=25832;LINESTRING (0 0, 5 5)\n# no line\nMULTILINESTRING ((1 0, 9 2), (3 3, 4 9))"
    "\nGEOMETRYCOLLECTION (LINESTRING Z (7 7 1, 8 9 1), POINT (1 1))\n",
    "m.csv": "name;x1;y1;x2;y2;friction;kind\na;0,5;0;7;7;0.5;\nb;1;0;9;3;;fracture\n",
    "vertices.csv": "id,x,y,toughness\n1,0,0,2e6\n1,5,5,2e6\n2,7,1,\n2,9,9,\n",
    "wkt.csv": 'wkt\tname\n"LINESTRING (0 0, 5 5)"\t"a ""b"""\nPOLYGON ((0 0,9 0,9 9,0 0))\tb\n',
    "m.geo": RECTANGLES,
    "m.msh": MESH,
}
STUDY = """\
title = "Rates"
scene = "scene.nml"
time_limit_s = 60
quantiles = [0.1, 0.9]
unset = ["domain.x_max"]
[over]
"injection.rate" = [1e-6, 2e-6]
share = [1, 2]
[set]
"fracture.base.friction" = "{0.1 * share:g}"
[units]
share = "-"
[constants]
depth = 2_000.0
[quick.over]
share = [1]
[[quantity]]
name = "pressure"
unit = "MPa"
file = "history.csv"
column = "1e-6 * well_pressure_pa"
take = "max"
[[figure]]
name = "all"
kind = "over"
quantity = "pressure"
over = "share"
"""
CHECK = """\
title = "Cubic law"
group = "flow"
source = "arithmetic"
[constants]
factor = 2.0
[defaults.check]
metric = "max_relative"
[[sweep]]
over = { both = { size = [0.2, 0.1], name = ["coarse", "fine"] } }
method = "plain"
scene = "scene.nml"
set = { "scene.name" = "{name}" }
[[check]]
quantity = "p"
unit = "Pa"
runs = ["*", "!coarse"]
tolerance = 0.01
reference = { expression = "2 * x_m**2" }
[check.result]
file = "history.csv"
column = "sqrt(factor) * p_pa"
x = "x_m"
where = { time_s = "last" }
"""
HISTORY = 'time_s,fracture_length_m,note\n1.0,2.0,a\n2.0,2.5,"b, c"\n'
RUN_FILES = {
    "history.csv": HISTORY,
    "run.json": '{"scene": "s", "status": "finished", "warnings": [], "cpu_s": 1.5}',
    "network.json": '{"fractures": [{"fracture": 1, "name": "f", "x_m": [0, 1], "y_m": [0, 1]}]}',
    "scene.nml": "&scene name = 's' /\n" + FRACTURES + "&time end = 1d3 /\n",
}
PIECES = (
    *(b"0", b"-1", b"1e999", b"-1e308", b"5e-324", b"nan", b"Infinity", b"null", b"true", b"1e-30"),
    *(b"9" * 400, b"9" * 5000, b"0x" + b"f" * 4000, b"0." + b"3" * 400, b"2147483648", b"1e18"),
    *(b"\0", b"\xff", b"\xef\xbb\xbf", b"\\ud800", b"\\u0000", b"\xc3\xa9", b"\x1b[2J", b"\n"),
    *(b'"', b"'", b'"""', b"\\", b"{", b"}", b"[", b"]", b"(", b")", b",", b";", b"=", b":", b"#"),
    *(b"/", b"$", b"&", b"*", b"%", b"!", b".", b"{}", b"[]", b'""', b"{x}", b"{1/0:99d}", b"\r"),
    *(b"a." * 900 + b"a=1\n", b"[" * 900 + b"]" * 900, b"{'a':" * 900, b"x" * 140_000),
    *(b"(" * 5000, b"1+" * 3000 + b"1", b"GEOMETRYCOLLECTION(" * 3000, b"[[a]]\n", b"1979-05-27"),
)  # fmt: skip
_NUMBER = re.compile(rb"\d[\d.e+-]*")


def damaged(content: bytes, chance: random.Random) -> bytes:
    """Give a text in which one to three things are wrong."""
    for _ in range(chance.choice((1, 1, 2, 3))):
        a, b = sorted(chance.randrange(len(content) + 1) for _ in range(2))
        numbers = list(_NUMBER.finditer(content))
        what = chance.randrange(7)
        if what == 0:
            content = content[:a]
        elif what == 1:
            content = content[:a] + content[min(b, a + 30) :]
        elif what == 2:
            content = content[:b] + content[a:b] + content[b:]
        elif what == 3:
            content = content[:a] + bytes([chance.randrange(256)]) + content[a + 1 :]
        elif what == 4 or not numbers:
            content = content[:a] + chance.choice(PIECES) + content[a:]
        else:
            number = chance.choice(numbers)
            content = content[: number.start()] + chance.choice(PIECES) + content[number.end() :]
    return content


def judge_map(folder: Path, name: str, content: bytes, said: Callable[[], str]) -> None:
    """Import a map: status 0, or 2 with one sentence and nothing written."""
    (folder / name).write_bytes(content)
    status, _ = imported(folder / name, "--unit", "m", "--polygons", "region")
    words = said()
    assert status in (0, 2), words
    if status == 2:
        assert words.startswith("wingcrack import: "), words
        assert words.count("\n") == 1, words
        assert [file.name for file in folder.iterdir()] == [name]


def judge_run(folder: Path, name: str, content: bytes) -> None:
    """Read the files of a run of which one is damaged: read, or refused in one sentence."""
    for other, text in RUN_FILES.items():
        (folder / other).write_text(text)
    (folder / name).write_bytes(content)
    refused(lambda: read_run(folder).history.number("fracture_length_m"))


def judge_base(folder: Path, content: bytes) -> None:
    """Read a damaged scene that a map is added to, and as the base of a study."""
    from wingcrack.scenes.errors import SceneError
    from wingcrack_maps.base import read_base

    (folder / "scene.nml").write_bytes(content)
    try:
        base = read_base(folder / "scene.nml")
        assert base is not None
        base.body(), base.number("coarse", "size_fracture"), base.names
    except SceneError as reason:
        assert str(reason)


def refused(read: Callable[[], object]) -> None:
    """Call what may raise errors of the packages only."""
    try:
        read()
    except (CaseError, RunError) as reason:
        assert str(reason)


def judge_toml(folder: Path, name: str, content: bytes) -> None:
    """Read a study or a check: nothing but a `CaseError` comes of it."""
    (folder / "scene.nml").write_text(FRACTURES)
    (folder / name).write_bytes(content)
    if name == "check.toml":
        refused(lambda: read_case(folder))
    else:
        refused(lambda: read_study(folder / name, quick=True))


@needs_solver
@pytest.mark.parametrize("name", MAPS)
def test_damaged_maps(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    name: str,
) -> None:
    monkeypatch.setattr(cli, "check", lambda _: (True, ""))
    chance = random.Random(name)
    for number in range(25):
        folder = tmp_path / str(number)
        folder.mkdir()
        judge_map(
            folder, name, damaged(MAPS[name].encode(), chance), lambda: capsys.readouterr().err
        )


@pytest.mark.parametrize(("name", "text"), [("study.toml", STUDY), ("check.toml", CHECK)])
def test_damaged_studies_and_checks(tmp_path: Path, name: str, text: str) -> None:
    chance = random.Random(name)
    for _ in range(60):
        judge_toml(tmp_path, name, damaged(text.encode(), chance))


@pytest.mark.parametrize("name", RUN_FILES)
def test_damaged_runs(tmp_path: Path, name: str) -> None:
    chance = random.Random(name)
    for _ in range(40):
        judge_run(tmp_path, name, damaged(RUN_FILES[name].encode(), chance))


def test_damaged_scenes(tmp_path: Path) -> None:
    chance = random.Random(1)
    for _ in range(40):
        judge_base(tmp_path, damaged(FRACTURES.encode(), chance))
