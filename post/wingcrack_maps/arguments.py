"""What `wingcrack import` and `wingcrack network` can be asked for; needs nothing but Python."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from wingcrack_scenes.arguments import judge_name

ENDINGS = (".csv", ".txt", ".geojson", ".json", ".wkt", ".msh", ".geo")
FARTHEST = 1.0e8  # of places and lengths [m]: farther than the earth is wide
_WIDEST = 20.0  # SIGMA
UNITS = ("m", "km", "ft", "cm", "mm")

_IMPORT = """\
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

example:
  ./wingcrack import inputs/examples/outcrop.geojson --unit m --repair 0.1 --out /tmp/outcrop.nml
  ./wingcrack run /tmp/outcrop.nml
"""

_NETWORK = """\
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

example:
  ./wingcrack network --box 0,0,100,80 --density p21=0.08 --length power:2.5,5,40 \\
      --orientation vonmises:30,10 --distance 1 --seed 7 --out /tmp/random.nml
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say it in one sentence and exit with 2, without the usage lines."""
        name = self.prog.removeprefix("./")
        self.exit(2, f"{name}: {message}; ./{name} --help says more\n")


def parse(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Understand the command line, or end with a reason and status 2."""
    parser = argparse.ArgumentParser(prog="wingcrack_maps")
    commands = parser.add_subparsers(required=True, dest="command", parser_class=_Parser)
    of_import, of_network = _add_import(commands), _add_network(commands)
    given = parser.parse_args(arguments)
    own = of_import if given.command == "import" else of_network
    if given.command == "import":
        _judge_map(own, given)
    else:
        _judge_laws(own, given)
    _judge_files(own, given)
    return given


def _judge_map(parser: _Parser, given: argparse.Namespace) -> None:
    if given.map.is_dir():
        parser.error(f"{given.map} is a folder, not a map")
    if not given.map.is_file():
        parser.error(f"there is no map {given.map}")
    if given.map.suffix.lower() not in ENDINGS:
        parser.error(f"{given.map} must end in one of {', '.join(ENDINGS)}, which says what it is")
    if given.out is None:
        name = re.sub(r"[^A-Za-z0-9_.-]+", "_", given.map.stem)[:64].lstrip("_.-")
        given.out = Path(f"{name or 'map'}.nml")


def _judge_laws(parser: _Parser, given: argparse.Namespace) -> None:
    counts = {len(given.density), len(given.length), len(given.orientation)}
    if len(counts) > 1:
        parser.error("--density, --length and --orientation must be given equally often")
    if given.margin is None and given.scene is None:
        given.margin = 0.5 * max(given.box[2] - given.box[0], given.box[3] - given.box[1])


def _judge_files(parser: _Parser, given: argparse.Namespace) -> None:
    if given.scene is not None and not given.scene.is_file():
        parser.error(f"there is no scene file {given.scene}")
    if given.out.suffix != ".nml":
        parser.error(f"--out must end in .nml, unlike {given.out}")
    if given.scene is None:
        judge_name(parser, given.out)
    if given.out.is_dir() or not given.out.parent.is_dir():
        parser.error(f"the scene cannot go to {given.out}: there is no such folder, or it is one")
    for file in (given.out, given.out.with_suffix(".repairs.csv")):
        if file.exists() and not given.overwrite:
            parser.error(f"{file} is there already; --overwrite replaces it")


def _add_import(commands: argparse._SubParsersAction[_Parser]) -> _Parser:
    parser = commands.add_parser(
        "import",
        prog="./wingcrack import",
        description="Make a scene of a fracture map, or add its fractures to one.",
        epilog=_IMPORT,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("map", metavar="MAP", type=Path, help="the fracture map")
    parser.add_argument("--unit", choices=UNITS, help="unit of the map's coordinates")
    parser.add_argument(
        "--origin",
        type=_origin,
        metavar="X,Y",
        help="place of the map [m] that becomes (0, 0): X,Y, or centre or corner of the map",
    )
    parser.add_argument(
        "--polygons", choices=("boundary", "region"), help="what polygons are that do not say it"
    )
    parser.add_argument(
        "--region",
        action="append",
        default=[],
        metavar="REGION:NAME=VALUE",
        help="entry of a region, as marl:young=5e9",
    )
    _add_common(parser, needs_out=False)
    return parser


def _add_network(commands: argparse._SubParsersAction[_Parser]) -> _Parser:
    parser = commands.add_parser(
        "network",
        prog="./wingcrack network",
        description="Make a scene of a random fracture network, or add one to a scene.",
        epilog=_NETWORK,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--box", required=True, type=_box, metavar="X0,Y0,X1,Y1", help="[m]")
    parser.add_argument("--density", metavar="LAW", type=_density, required=True, action="append")
    parser.add_argument(
        "--length", metavar="LAW", type=_law(_LENGTHS), required=True, action="append"
    )
    parser.add_argument(
        "--orientation", metavar="LAW", type=_law(_ANGLES), required=True, action="append"
    )
    parser.add_argument(
        "--distance",
        type=_length,
        default=0.0,
        metavar="D",
        help="least distance of two fractures [m], which then do not cross (default: none kept)",
    )
    parser.add_argument(
        "--crossings",
        action="store_true",
        help="fractures may cross, and only ends keep --distance from other fractures",
    )
    parser.add_argument("--seed", type=_whole, default=1, help="of the random numbers (default: 1)")
    _add_common(parser, needs_out=True)
    return parser


def _add_common(parser: _Parser, needs_out: bool) -> None:
    parser.add_argument(
        "--out",
        type=Path,
        metavar="SCENE.nml",
        required=needs_out,
        help="the scene to write" + ("" if needs_out else " (default: MAP.nml)"),
    )
    parser.add_argument(
        "--scene", type=Path, metavar="BASE.nml", help="scene that the fractures are added to"
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="entry of all fractures that do not say it, as friction=0.7",
    )
    parser.add_argument("--cell", type=_length, metavar="SIZE", help="cells at the fractures [m]")
    parser.add_argument(
        "--margin", type=_length, metavar="D", help="room around the fractures in the body [m]"
    )
    parser.add_argument(
        "--repair", type=_length, metavar="D", help="repair what is nearer than this [m]"
    )
    parser.add_argument(
        "--near",
        type=_length,
        metavar="D",
        help="list what is nearer than this [m] (default: D of --repair, or a fortieth of the"
        " median length)",
    )
    parser.add_argument(
        "--angle",
        type=_angle,
        default=5.0,
        metavar="DEGREES",
        help="least angle between two fractures (default: 5; the solver needs 3)",
    )
    parser.add_argument(
        "--ends",
        choices=("join", "gap"),
        default="join",
        help="repair of near ends: move them to a joint, or cut them back (default: join)",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace files that are there")


_LENGTHS = {"constant": (1, 1), "power": (3, 3), "lognormal": (2, 4), "exponential": (1, 3)}
_ANGLES = {"uniform": (0, 2), "constant": (1, 1), "vonmises": (2, 2)}


def _law(known: dict[str, tuple[int, int]]) -> Callable[[str], tuple[str, tuple[float, ...]]]:
    def parse(text: str) -> tuple[str, tuple[float, ...]]:
        name, mark, rest = text.partition(":")
        if name not in known:
            raise argparse.ArgumentTypeError(f"'{text}' is none of {', '.join(known)}")
        numbers = tuple(_number(word) for word in rest.split(",")) if mark else ()
        least, most = known[name]
        if not least <= len(numbers) <= most or (most - least == 2 and len(numbers) == least + 1):
            raise argparse.ArgumentTypeError(f"'{text}' has {len(numbers)} numbers after its name")
        if known is _LENGTHS:
            _judge_length(name, numbers, text)
        elif name == "vonmises" and numbers[1] < 0.0:
            raise argparse.ArgumentTypeError(f"'{text}': KAPPA must not be negative")
        elif len(numbers) == 2 and name == "uniform" and not numbers[0] < numbers[1]:
            raise argparse.ArgumentTypeError(f"'{text}': FROM must be less than TO")
        return name, numbers

    return parse


def _judge_length(name: str, numbers: tuple[float, ...], text: str) -> None:
    lengths = numbers[1:] if name == "power" else (*numbers[:1], *numbers[-2:])
    if name == "exponential" and len(numbers) == 3:
        lengths = (numbers[0], numbers[2])  # its least length may be 0
    if name == "lognormal" and len(numbers) == 2:
        lengths = numbers
    if min(lengths) <= 0.0 or (name == "lognormal" and numbers[1] <= 0.0):
        raise argparse.ArgumentTypeError(f"'{text}': lengths must be greater than 0")
    if name == "lognormal" and numbers[1] > _WIDEST:
        raise argparse.ArgumentTypeError(f"'{text}': SIGMA must be at most {_WIDEST:g}")
    if max(lengths) > FARTHEST:
        raise argparse.ArgumentTypeError(f"'{text}': lengths must be at most {FARTHEST:.0e} m")
    if len(numbers) > 2 and not 0.0 <= numbers[-2] < numbers[-1]:
        raise argparse.ArgumentTypeError(f"'{text}': MIN must be less than MAX")


def _density(text: str) -> tuple[str, float]:
    name, mark, value = text.partition("=")
    if not mark or name not in ("p20", "p21"):
        raise argparse.ArgumentTypeError(f"'{text}' must be p20=N or p21=L")
    return name, _positive(value)


def _number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"'{text}' is no number")
    return number


def _positive(text: str) -> float:
    number = _number(text)
    if number <= 0.0:
        raise argparse.ArgumentTypeError(f"'{text}' must be greater than 0")
    return number


def _length(text: str) -> float:
    number = _positive(text)
    if number > FARTHEST:
        raise argparse.ArgumentTypeError(f"'{text}' must be at most {FARTHEST:.0e} m")
    return number


def _places(text: str, count: int, what: str) -> tuple[float, ...]:
    """So many coordinates [m]."""
    words = text.split(",")
    numbers = tuple(map(_number, words)) if len(words) == count else (math.inf,)
    if max(map(abs, numbers)) > FARTHEST:
        raise argparse.ArgumentTypeError(f"'{text}' must be {what}, none beyond {FARTHEST:.0e} m")
    return numbers


def _angle(text: str) -> float:
    number = _number(text)
    if not 3.0 <= number <= 45.0:
        raise argparse.ArgumentTypeError(f"'{text}' must be from 3 to 45 degrees")
    return number


def _whole(text: str) -> int:
    if not (text.isascii() and text.isdigit()):
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number from 0 on")
    return int(text)


def _origin(text: str) -> str:
    if text not in ("centre", "corner"):
        _places(text, 2, "X,Y, centre or corner")
    return text


def _box(text: str) -> tuple[float, ...]:
    numbers = _places(text, 4, "X0,Y0,X1,Y1")
    if min(numbers[2] - numbers[0], numbers[3] - numbers[1]) < 1.0 / FARTHEST:
        raise argparse.ArgumentTypeError(f"'{text}' must be X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1")
    return numbers
