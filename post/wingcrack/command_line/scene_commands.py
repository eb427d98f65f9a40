"""What writes scenes: new, import and network."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from wingcrack.command_line import values
from wingcrack.command_line.declaring import (
    Choice,
    Place,
    Reader,
    UsageError,
    argument,
    command,
    option,
)

KINDS = {
    "injection": "fluid into one fracture, which slips; stress intensity factors",
    "network": "fluid into fractures that cross and touch",
    "wells": "two wells in stages, up to pressures, in fractured rock",
    "mechanics": "no fluid: a crack grows under tension",
    "column": "no fractures: consolidation of a column",
}
ENDINGS = (".csv", ".txt", ".geojson", ".json", ".wkt", ".msh", ".geo")
UNITS = ("m", "km", "ft", "cm", "mm")
_OVERWRITE = option("--overwrite", is_flag=True, help="replace files that are there")
_PATH, _LENGTH = Place(), Reader(values.length)


@command(
    "new",
    "wingcrack_scenes.cli:new",
    about="kinds:\n"
    + "".join(f"  {kind:<11}{words}\n" for kind, words in KINDS.items())
    + "\nThe file is a whole scene with a comment on every name; it runs in seconds as it is.\n",
    example="""\
./wingcrack new network --out /tmp/mine.nml
./wingcrack run /tmp/mine.nml --out /tmp/mine
""",
)
@argument("kind", metavar="[KIND]", required=False, default="injection")
@option("--out", type=_PATH, metavar="FILE", help="the file to write (default: KIND.nml)")
@_OVERWRITE
def new(given: SimpleNamespace) -> None:
    """Write a commented scene to start from (KIND: injection)."""
    if given.kind not in KINDS:
        raise UsageError(f"there is no kind '{given.kind}' (there are: {', '.join(KINDS)})")
    given.out = given.out or Path(f"{given.kind}.nml")
    _judge_out(given, is_new=True, also=())


def _common(needs_out: bool) -> Callable[[Any], Any]:
    """Options of what makes scenes of fractures."""
    options = (
        option(
            "--out",
            type=_PATH,
            metavar="SCENE.nml",
            required=needs_out,
            help="the scene to write" + ("" if needs_out else " (default: MAP.nml)"),
        ),
        option(
            "--scene", type=_PATH, metavar="BASE.nml", help="scene that the fractures are added to"
        ),
        option(
            "--set",
            multiple=True,
            metavar="NAME=VALUE",
            help="entry of all fractures that do not say it, as friction=0.7",
        ),
        option("--cell", type=_LENGTH, metavar="SIZE", help="cells at the fractures [m]"),
        option(
            "--margin", type=_LENGTH, metavar="D", help="room around the fractures in the body [m]"
        ),
        option("--repair", type=_LENGTH, metavar="D", help="repair what is nearer than this [m]"),
        option(
            "--near",
            type=_LENGTH,
            metavar="D",
            help="list what is nearer than this [m] (default: D of --repair, or a fortieth of the"
            " median length)",
        ),
        option(
            "--angle",
            type=Reader(values.angle),
            default=5.0,
            metavar="DEGREES",
            help="least angle between two fractures; the solver needs 3",
        ),
        option(
            "--ends",
            type=Choice(("join", "gap")),
            default="join",
            help="repair of near ends: move them to a joint, or cut them back",
        ),
        _OVERWRITE,
    )

    def add(function: Any) -> Any:
        for one in reversed(options):
            function = one(function)
        return function

    return add


@command(
    "import",
    "wingcrack_maps.cli:make_scene",
    about="""\
The file's ending says what it is:
  .geojson .json  GeoJSON: lines are fractures; polygons by their property kind, boundary or region
  .csv .txt       a table with columns x1, y1, x2, y2 (a fracture a row), name, x, y (a vertex a
                  row) or wkt; parted by commas, semicolons or tabs
  .wkt            well-known text, a geometry a line
  .geo .msh       gmsh: physical curves are fractures, physical surfaces body and regions; nothing
                  is executed: of a .geo file straight lines are read, of the rest its .msh file
Attributes with the name of an entry of &fracture (friction, aperture, toughness ...) become that
entry, in SI units; docs/maps.md tells the rest.

Faults (near ends, duplicates, overlaps, small angles, short segments ...) are always listed. With
--repair they are repaired, each repair is listed too, and SCENE.repairs.csv and .json hold all.
The scene is written once `check` accepts it; otherwise nothing is, and the reason is told.
""",
    example="""\
./wingcrack import inputs/examples/outcrop.geojson --unit m --repair 0.1 --out /tmp/outcrop.nml
./wingcrack run /tmp/outcrop.nml
""",
)
@argument("map", metavar="MAP", type=_PATH)
@option("--unit", type=Choice(UNITS), help="unit of the map's coordinates")
@option(
    "--origin",
    type=Reader(values.origin),
    metavar="X,Y",
    help="place of the map [m] that becomes (0, 0): X,Y, or centre or corner of the map",
)
@option(
    "--polygons",
    type=Choice(("boundary", "region")),
    help="what polygons are that do not say it",
)
@option(
    "--region",
    multiple=True,
    metavar="REGION:NAME=VALUE",
    help="entry of a region, as marl:young=5e9",
)
@_common(needs_out=False)
def import_map(given: SimpleNamespace) -> None:
    """Make a scene of a fracture map, or add its fractures to one."""
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


@command(
    "network",
    "wingcrack_maps.cli:make_scene",
    about="""\
Centres lie in the box, uniformly; fractures may reach beyond it, and the body has room around
them. --density, --length and --orientation may be given several times: the k-th of each makes the
k-th set.
  --density      p20=N (fractures per m2) or p21=L (metres of fracture per m2)
  --length       constant:L, power:EXPONENT,MIN,MAX (density of lengths ~ l^-EXPONENT),
                 lognormal:MEDIAN,SIGMA[,MIN,MAX] (SIGMA of ln l) or exponential:MEAN[,MIN,MAX]
  --orientation  uniform, uniform:FROM,TO, constant:ANGLE or vonmises:MEAN,KAPPA, in degrees from
                 the x axis counter-clockwise; KAPPA is that of the doubled angle, as usual for axes
Lengths and angles are drawn once; where a fracture comes nearer to another one than --distance,
its place is drawn anew, so that the laws hold and only the places are no longer independent.
""",
    example="""\
./wingcrack network --box 0,0,100,80 --density p21=0.08 --length power:2.5,5,40 \\
    --orientation vonmises:30,10 --distance 1 --seed 7 --out /tmp/random.nml
""",
)
@option("--box", required=True, type=Reader(values.box), metavar="X0,Y0,X1,Y1", help="[m]")
@option(
    "--density", required=True, multiple=True, type=Reader(values.density), metavar="LAW",
    help="how many fractures",
)  # fmt: skip
@option(
    "--length", required=True, multiple=True, type=Reader(values.lengths), metavar="LAW",
    help="how long they are [m]",
)  # fmt: skip
@option(
    "--orientation", required=True, multiple=True, type=Reader(values.orientations),
    metavar="LAW", help="how they lie [degrees]",
)  # fmt: skip
@option(
    "--distance",
    type=_LENGTH,
    default=0.0,
    show_default="none kept",
    metavar="D",
    help="least distance of two fractures [m], which then do not cross",
)
@option(
    "--crossings",
    is_flag=True,
    help="fractures may cross, and only ends keep --distance from other fractures",
)
@option("--seed", type=Reader(values.whole(0)), default=1, help="of the random numbers")
@_common(needs_out=True)
def network(given: SimpleNamespace) -> None:
    """Make a scene of a random fracture network, or add one to a scene."""
    if len({len(given.density), len(given.length), len(given.orientation)}) > 1:
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
