"""Commands that write scenes: new and import."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

from wingcrack.command_line import values
from wingcrack.command_line.declaring import Parameter, UsageError, choice, command, flag

KINDS = {
    "injection": "fluid into one fracture, which slips; stress intensity factors",
    "network": "fluid into fractures that cross and touch",
    "wells": "two wells in stages, up to pressures, in fractured rock",
    "mechanics": "no fluid: a crack grows under tension",
    "column": "no fractures: consolidation of a column",
    "heat": "cold water from well to well through hot rock",
}
ENDINGS = (".csv", ".txt", ".geojson", ".json", ".wkt", ".msh", ".geo",
           ".shp", ".gpkg", ".dxf", ".fgb", ".gml", ".kml")  # fmt: skip
UNITS = ("m", "km", "ft", "cm", "mm")
_OVERWRITE = flag("--overwrite", "replace files that are there")
_RANDOM = (
    Parameter("--box", "X0,Y0,X1,Y1", "of a random network [m]", values.box),
    Parameter("--density", "LAW", "how many", values.density, many=True),
    Parameter("--length", "LAW", "how long [m]", values.lengths, many=True),
    Parameter("--orientation", "LAW", "how they lie", values.orientations, many=True),
    Parameter(
        "--distance",
        "D",
        "least distance of two random fractures [m], which then do not cross (default: none kept)",
        values.length,
        0.0,
    ),
    flag("--crossings", "random fractures may cross, and only ends keep --distance from others"),
    Parameter("--seed", "N", "of the random numbers (default: 1)", values.whole(0), 1),
)
_COMMON = (  # of what makes scenes of fractures
    Parameter("--scene", "BASE.nml", "scene that the fractures are added to", Path),
    Parameter(
        "--set",
        "NAME=VALUE",
        "entry of all fractures that do not say it, as friction=0.7",
        many=True,
    ),
    Parameter(
        "--cell",
        "SIZE",
        "cells at all fractures [m] (default: by the length of each, at a cost that is stated)",
        values.length,
    ),
    Parameter("--drop-shorter", "D", "leave out traces shorter than this [m]", values.length),
    Parameter(
        "--simplify",
        "D",
        "leave out vertices that move a trace by less than this [m]",
        values.length,
    ),
    flag("--growth", "fractures grow; cells and windows follow from their lengths"),
    Parameter("--margin", "D", "room around the fractures in the body [m]", values.length),
    Parameter("--repair", "D", "repair what is nearer than this [m]", values.length),
    Parameter(
        "--near",
        "D",
        "list what is nearer than this [m] (default: D of --repair, or a fortieth of the median"
        " length)",
        values.length,
    ),
    Parameter(
        "--angle",
        "DEGREES",
        "least angle between two fractures (default: 5; the solver needs 3)",
        values.angle,
        5.0,
    ),
    choice(
        "--ends",
        ("join", "gap"),
        "repair of near ends: move them to a joint, or cut them back (default: join)",
        "join",
    ),
    _OVERWRITE,
)


@command(
    "new",
    "wingcrack.scenes.new:new",
    Parameter("kind", "[KIND]", default="injection"),
    Parameter("--out", "FILE", "the file to write (default: KIND.nml)", Path),
    Parameter(
        "--water",
        "KELVIN",
        "the fluid is water in rock of this temperature, at the pressure of the scene: properties"
        " by the IAPWS; with &heat the viscosity follows temperature",
        values.positive,
    ),
    _OVERWRITE,
    about="kinds:\n"
    + "".join(f"  {kind:<11}{words}\n" for kind, words in KINDS.items())
    + "\nThe file is a whole scene with a comment on every name; it runs in seconds as it is.\n",
    example="""\
./wingcrack new network --out /tmp/mine.nml
./wingcrack run /tmp/mine.nml --out /tmp/mine
""",
)
def new(given: SimpleNamespace) -> None:
    """Write a commented scene to start from (KIND: injection)."""
    if given.kind not in KINDS:
        raise UsageError(f"there is no kind '{given.kind}' (there are: {', '.join(KINDS)})")
    given.out = given.out or Path(f"{given.kind}.nml")
    _judge_out(given, is_new=True, also=())


@command(
    "import",
    "wingcrack_maps.cli:make_scene",
    Parameter("map", "[MAP]", read=Path),
    choice("--unit", UNITS, "unit of the map's coordinates"),
    Parameter(
        "--crs",
        "SYSTEM",
        "project the map to this coordinate system in metres, as EPSG:25832 or utm",
    ),
    Parameter("--layer", "NAME", "the layer to read (default: all)"),
    Parameter(
        "--origin",
        "X,Y",
        "place of the map [m] that becomes (0, 0): X,Y, or centre or corner of the map",
        values.origin,
    ),
    choice("--polygons", ("boundary", "region"), "what polygons are that do not say it"),
    Parameter("--region", "REGION:NAME=VALUE", "entry of a region, as marl:young=5e9", many=True),
    *_RANDOM,
    Parameter("--out", "SCENE.nml", "the scene to write (default: MAP.nml)", Path),
    *_COMMON,
    about="""\
The file's ending says what it is:
  .geojson .json  GeoJSON: lines are fractures; polygons by their property kind, boundary or region
  .csv .txt       a table with columns x1, y1, x2, y2 (a fracture a row), name, x, y (a vertex a
                  row) or wkt; parted by commas, semicolons or tabs
  .wkt            well-known text, a geometry a line
  .shp .gpkg .dxf .fgb .gml .kml   read by GDAL, which the first such call installs
  .geo .msh       gmsh: physical curves are fractures, physical surfaces body and regions; nothing
                  is executed: of a .geo file straight lines are read, of the rest its .msh file
Attributes with the name of an entry of &fracture (friction, aperture, toughness ...) become that
entry, in SI units; docs/maps.md tells the rest.

Faults (near ends, duplicates, overlaps, small angles, short segments ...) are always listed. With
--repair they are repaired, each repair is listed too, and SCENE.repairs.csv and .json hold all.
The scene is written once `check` accepts it; otherwise nothing is, and the reason is told.

Without a MAP the fractures are random. Centres lie in --box, uniformly; fractures may reach beyond
it. --density, --length and --orientation may be repeated: the k-th of each makes the k-th set.
  --density      p20=N (fractures per m2) or p21=L (metres of fracture per m2)
  --length       constant:L, power:EXPONENT,MIN,MAX (density of lengths ~ l^-EXPONENT),
                 lognormal:MEDIAN,SIGMA[,MIN,MAX] (SIGMA of ln l) or exponential:MEAN[,MIN,MAX]
  --orientation  uniform, uniform:FROM,TO, constant:ANGLE or vonmises:MEAN,KAPPA, in degrees from
                 the x axis counter-clockwise; KAPPA is that of the doubled angle, as usual for axes
Lengths and angles are drawn once; where a fracture comes nearer to another one than --distance,
its place is drawn again, so that the laws hold and only the places are no longer independent.
""",
    example="""\
./wingcrack import inputs/examples/outcrop.geojson --unit m --repair 0.1 --out /tmp/outcrop.nml
./wingcrack run /tmp/outcrop.nml
./wingcrack import --box 0,0,100,80 --density p21=0.08 --length power:2.5,5,40 \\
    --orientation vonmises:30,10 --distance 1 --seed 7 --out /tmp/random.nml
""",
)
def import_map(given: SimpleNamespace) -> None:
    """Make a scene of a fracture map or a random network, or add it to one."""
    laws = (given.density, given.length, given.orientation)
    if given.map is None:
        _judge_random(given, laws)
        return
    if given.box is not None or any(laws):
        raise UsageError(
            "--box, --density, --length and --orientation are for a network without MAP"
        )
    if given.map.is_dir():
        raise UsageError(f"{given.map} is a folder, not a map")
    if not given.map.is_file():
        raise UsageError(f"there is no map {given.map}")
    if given.map.suffix.lower() not in ENDINGS:
        endings = ", ".join(ENDINGS)
        raise UsageError(f"{given.map} must end in one of {endings}, which says what it is")
    if given.out is None:
        name = re.sub(r"[^A-Za-z0-9_.-]+", "_", given.map.stem)[:64].lstrip("_.-")
        given.out = Path(f"{name or 'map'}.nml")
    _judge_scenes(given)


def _judge_random(given: SimpleNamespace, laws: tuple[list[object], ...]) -> None:
    if given.box is None or not all(laws) or given.out is None:
        raise UsageError(
            "a MAP is missing; or, for a random network, --box, --density, --length, --orientation"
            " and --out"
        )
    if any((given.unit, given.crs, given.layer, given.origin, given.polygons, given.region)):
        raise UsageError("--unit, --crs, --layer, --origin, --polygons and --region are of a MAP")
    if len(set(map(len, laws))) > 1:
        raise UsageError("--density, --length and --orientation must be given equally often")
    if given.margin is None and given.scene is None:
        given.margin = 0.5 * max(given.box[2] - given.box[0], given.box[3] - given.box[1])
    _judge_scenes(given)


def _judge_scenes(given: SimpleNamespace) -> None:
    if given.scene is not None and not given.scene.is_file():
        raise UsageError(f"there is no scene file {given.scene}")
    _judge_out(given, is_new=given.scene is None, also=(given.out.with_suffix(".repairs.csv"),))


def _judge_out(given: SimpleNamespace, *, is_new: bool, also: tuple[Path, ...]) -> None:
    out: Path = given.out
    if out.suffix != ".nml":
        raise UsageError(f"--out must end in .nml, unlike {out}")
    if is_new and not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}", out.stem):
        raise UsageError(
            f"the scene is called as its file, so {out.name} may have letters, digits, '_', '-' and"
            " '.' only, at most 64, and begins with a letter or a digit"
        )
    if out.is_dir() or not out.parent.is_dir():
        raise UsageError(f"the scene cannot go to {out}: there is no such folder, or it is one")
    for file in (out, *also):
        if file.exists() and not given.overwrite:
            raise UsageError(f"{file} is there already; --overwrite replaces it")
