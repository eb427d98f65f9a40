"""The loads of a run without a fluid, and whether all are proportional to the load factor."""

from __future__ import annotations

from collections.abc import Sequence

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
