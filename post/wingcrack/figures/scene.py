"""The few values of ``scene.nml`` that figures show or use in addition to the results."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from wingcrack.errors import RunError
from wingcrack.figures.regions import Region, read_region
from wingcrack.figures.table import FloatArray
from wingcrack.figures.text_files import read_text

# quoted text (a doubled quote stands for one), comment, group, slash, equal sign, plain word
_TOKEN = re.compile(r"'(?:[^']|'')*'|\"(?:[^\"]|\"\")*\"|![^\n]*|&\w+|/|=|[^\s,=/!&'\"]+")


@dataclass(frozen=True)
class FractureLaw:
    """What the scene says about one fracture."""

    name: str
    friction: float | None  # mu_s [-]
    toughness_pa_sqrtm: float | None = None  # its own [Pa m^1/2]


@dataclass(frozen=True)
class Well:
    """When a well, or an entry of one, starts and, unless at the end of the run, stops [s].

    `place_m` is where it feeds its fracture [m]; None: along all of it.
    """

    start_s: float
    stop_s: float | None
    fracture: str = ""
    place_m: tuple[float, float] | None = None


@dataclass(frozen=True)
class Scene:
    """What figures use of a scene."""

    name: str
    title: str
    toughness_pa_sqrtm: float | None  # K_IC [Pa m^1/2]; None if the scene has none
    # in the order of the file, which is the order of the numbers in the results
    fractures: tuple[FractureLaw, ...]
    # (n, 2) closed line around the body [m]; None if the scene does not tell it
    outline: FloatArray | None = None
    young_pa: float | None = None  # Young's modulus [Pa]
    # regular time step [s]; None without a fluid, or where none is given
    step_s: float | None = None
    chosen_steps: bool = False  # whether time steps follow from their error
    wells: tuple[Well, ...] = ()  # injections
    # load_pa, load_name: stress that stands for the load, at load factor 1 [Pa], and how it is
    # called; None where the scene has no load of a kind for which there is one
    load_pa: float | None = None
    load_name: str = ""
    # parts of the rock with a permeability of their own, in the order in which they count
    regions: tuple[Region, ...] = ()
    # components xx and yy of the rock elsewhere [m2]
    permeability_m2: tuple[float, float] | None = None
    breadth_m: float = 1.0  # assumed length of the fractures out of the plane [m]
    thickness_m: float = 1.0  # of the body, for volumes of wells [m]
    # how growth in equilibrium takes the load along, 'length' or 'dead'; '' with a fluid, or
    # without such growth
    control: str = ""
    window_m: float | None = None  # side of the windows around the tips [m]; None: the whole body
    # whether 'forces' or 'grips' drive a body whose answer is in proportion to them, else ''
    drive: str = ""

    def fracture(self, label: str) -> FractureLaw | None:
        """The law of a fracture known by its name or by its number from 1."""
        for fracture in self.fractures:
            if fracture.name == label:
                return fracture
        if label.isdecimal() and len(label) < 10 and 1 <= int(label) <= len(self.fractures):
            return self.fractures[int(label) - 1]
        return None


def read_groups(text: str) -> list[tuple[str, dict[str, list[str]]]]:
    """Split a Fortran namelist text into its groups, each a name and the raw values by name.

    >>> read_groups("&fracture name = 'a', x = 0.1 0.2 / ! the flaw")
    [('fracture', {'name': ["'a'"], 'x': ['0.1', '0.2']})]
    """
    groups: list[tuple[str, dict[str, list[str]]]] = []
    inside = False
    values: list[str] = []
    tokens = [token for token in _TOKEN.findall(text) if not token.startswith("!")]
    for token, following in pairwise([*tokens, "/"]):
        if token.startswith("&"):
            groups.append((token[1:].lower(), {}))
            inside = True
        elif token == "/":
            inside = False
        elif inside and following == "=":
            values = groups[-1][1].setdefault(token.lower(), [])
        elif inside and token != "=":
            values.append(token)
    return groups


def read_scene(path: Path) -> Scene | None:
    """Read ``scene.nml``; None where the run has none."""
    try:
        text = read_text(path)
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as reason:
        raise RunError(f"{path}: the file cannot be read ({reason}).") from None
    groups = read_groups(text)
    first: dict[str, dict[str, list[str]]] = {}
    for group, values in groups:
        first.setdefault(group, values)

    def number(group: str, key: str) -> float | None:
        return _number(path, group, first.get(group, {}), key)

    laws = [
        FractureLaw(
            _text(values, "name"),
            _number(path, group, values, "friction"),
            _number(path, group, values, "toughness"),
        )
        for group, values in groups
        if group == "fracture"
    ]
    wells = [
        well for group, values in groups if group == "injection" for well in _wells(path, values)
    ]
    load, load_name = _load(path, groups)
    outline = _outline(path, first["domain"]) if "domain" in first else None
    has_windows = "fluid" in first and _text(first.get("fine", {}), "window") != "body"
    along_x, along_y = (
        number("material", key) or number("material", "permeability")
        for key in ("permeability_xx", "permeability_yy")
    )
    return Scene(
        name=_text(first.get("scene", {}), "name"),
        title=_text(first.get("scene", {}), "title"),
        toughness_pa_sqrtm=number("material", "toughness"),
        fractures=tuple(laws),
        outline=outline,
        young_pa=number("material", "young"),
        step_s=number("time", "step"),
        chosen_steps=(number("time", "tolerance") or 0.0) > 0.0,
        wells=tuple(wells),
        load_pa=load,
        load_name=load_name,
        regions=_regions(path, groups, outline),
        permeability_m2=None if along_x is None or along_y is None else (along_x, along_y),
        breadth_m=number("output", "out_of_plane_length") or 1.0,
        thickness_m=number("scene", "thickness") or 1.0,
        control=control_of(groups),
        drive=drive_of(groups),
        window_m=number("fine", "window") if has_windows else None,
    )


def _wells(path: Path, values: dict[str, list[str]]) -> Iterator[Well]:
    """A well, or one per entry."""
    for entry in range(max(1, len(values.get("fracture", ())))):
        own = {key: values.get(key, [])[entry : entry + 1] for key in ("fracture", "x", "y")}
        yield Well(
            _number(path, "injection", values, "start") or 0.0,
            _number(path, "injection", values, "end"),
            _text(own, "fracture"),
            _place(path, own),
        )


def _place(path: Path, values: dict[str, list[str]]) -> tuple[float, float] | None:
    """Where a well stands [m]; None along a whole fracture."""
    x, y = (_number(path, "injection", values, key) for key in ("x", "y"))
    return None if x is None or y is None else (x, y)


def _regions(
    path: Path, groups: list[tuple[str, dict[str, list[str]]]], outline: FloatArray | None
) -> tuple[Region, ...]:
    """Regions with an outline, in the order of the file."""
    if outline is None:
        return ()
    found = []
    for group, values in groups:
        if group != "region":
            continue
        numbers = {
            key: [
                number for raw in raws if (number := _one_number(path, group, raw, key)) is not None
            ]
            for key, raws in values.items()
            if key not in ("name", "shape")
        }
        region = read_region(
            _text(values, "name"), _text(values, "shape") or "polygon", numbers, outline
        )
        if region is not None:
            found.append(region)
    return tuple(found)


def _one_number(path: Path, group: str, raw: str, key: str) -> float | None:
    return _number(path, group, {key: [raw]}, key)


def _load(path: Path, groups: list[tuple[str, dict[str, list[str]]]]) -> tuple[float | None, str]:
    """Stress that stands for the load [Pa]: P / (pi R) of a disc, else the largest traction."""

    def largest(group: str, *keys: str) -> float:
        found = [_number(path, name, v, key) for name, v in groups if name == group for key in keys]
        return max((abs(value) for value in found if value is not None), default=0.0)

    force, radius = largest("point_load", "x_force", "y_force"), largest("domain", "radius")
    if force > 0.0:
        return (force / (np.pi * radius), r"$P/(\pi R)$") if radius > 0.0 else (None, "")
    sides = ("x_traction", "y_traction", "normal_traction", "shear_traction")
    traction = largest("side", *sides)
    if traction > 0.0:
        return traction, "largest traction on a side"
    pressure = largest("fracture", "face_pressure")
    return (pressure, "largest pressure on faces") if pressure > 0.0 else (None, "")


def _outline(path: Path, values: dict[str, list[str]]) -> FloatArray | None:
    """Closed line around a rectangle or a disc [m]."""
    shape = _text(values, "shape") or "rectangle"
    names: tuple[str, ...] = ("x_min", "x_max", "y_min", "y_max")
    if shape == "disc":
        names = ("x_centre", "y_centre", "radius")
    found = [_number(path, "domain", values, name) for name in names]
    if shape == "polygon":
        return _polygon(path, values)
    if shape not in ("rectangle", "disc") or any(value is None for value in found):
        return None
    numbers = np.array(found, dtype=np.float64)
    if shape == "disc":
        angle = np.linspace(0.0, 2.0 * np.pi, 361)
        circle = np.column_stack((np.cos(angle), np.sin(angle)))
        return np.asarray(numbers[:2] + numbers[2] * circle)
    (left, right), (bottom, top) = numbers[:2], numbers[2:]
    corners = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
    return np.array(corners, dtype=np.float64)


def _polygon(path: Path, values: dict[str, list[str]]) -> FloatArray | None:
    """Closed line through the corners of a polygon [m]."""
    corners = [
        [_number(path, "domain", {name: [raw]}, name) for raw in values.get(name, [])]
        for name in ("x", "y")
    ]
    if len(corners[0]) < 3 or len(corners[0]) != len(corners[1]):
        return None
    points = np.array(corners, dtype=np.float64).T
    return np.concatenate((points, points[:1]))


def _text(values: dict[str, list[str]], key: str) -> str:
    raw = "".join(values.get(key, [])[:1])
    return raw[1:-1].replace(raw[:1] * 2, raw[:1]).strip() if raw[:1] in ("'", '"') else raw


def _number(path: Path, group: str, values: dict[str, list[str]], key: str) -> float | None:
    if not values.get(key):
        return None
    raw = values[key][0]
    try:
        return float(raw.lower().replace("d", "e"))
    except ValueError:
        raise RunError(f"{path}: '{raw}' for {key} in &{group} is no number.") from None


Groups = Sequence[tuple[str, dict[str, list[str]]]]

FORCES = "forces"  # dead loads: tractions, point loads, pressure on faces
GRIPS = "grips"  # displacements of sides and restraints, and slip that is given

_FORCES = {
    "side": ("x_traction", "y_traction", "normal_traction", "shear_traction"),
    "point_load": ("x_force", "y_force"),
    "fracture": ("face_pressure",),
}
_GRIPS = {
    "side": ("x_displacement", "y_displacement"),
    "restraint": ("x_displacement", "y_displacement"),
    "fracture": ("slip",),
}
_CONSTANT = {
    "in_situ": ("sxx", "syy", "sxy", "sxx_per_y", "syy_per_y"),
    "gravity": ("x", "y"),
    "fracture": ("friction", "cohesion", "normal_stiffness"),
}


def control_of(groups: Groups) -> str:
    """How growth in equilibrium takes the load along, 'length' or 'dead'; '' where none does."""
    names = {name for name, _ in groups}
    growth = next((values for name, values in groups if name == "growth"), {})
    if "fluid" in names or _word(growth, "law") == "paris":
        return ""
    if _word(growth, "enabled").strip(".").lower() not in ("true", "t"):
        return ""
    load = next((values for name, values in groups if name == "load"), {})
    return _word(load, "control") or ("dead" if load.get("factors") else "length")


def drive_of(groups: Groups) -> str:
    """`FORCES` or `GRIPS` where these alone drive a body whose answer is in proportion to them.

    '' where both do, where stress in situ, weight, friction, bonds or joints that close add what
    does not scale with the factor, or where nothing drives the body.
    """
    if _any(groups, _CONSTANT):
        return ""
    forces, grips = _any(groups, _FORCES), _any(groups, _GRIPS)
    if forces == grips:
        return ""
    return FORCES if forces else GRIPS


def _any(groups: Groups, names: dict[str, tuple[str, ...]]) -> bool:
    """Whether any of the named values is given and not zero."""
    return any(
        _is_not_zero(raw)
        for group, values in groups
        for name in names.get(group, ())
        for raw in values.get(name, [])
    )


def _is_not_zero(raw: str) -> bool:
    number = raw.rpartition("*")[2].lower().replace("d", "e")
    try:
        return float(number) != 0.0
    except ValueError:
        return True  # not a number: what it is worth is not known


def _word(values: dict[str, list[str]], name: str) -> str:
    """The word that is given for a name, without its quotes."""
    return "".join(values.get(name, [])[:1]).strip("'\"")
