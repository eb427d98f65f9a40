"""The groups of the report: the physics of a case."""

from __future__ import annotations

# In the order of the report; a case names its group in its own file.
GROUPS = {
    "elasticity": "Elasticity and cracks",
    "contact": "Contact and friction",
    "poroelasticity": "Poroelasticity",
    "flow": "Flow in fractures",
    "wells": "Wells",
    "growth": "Growth",
    "networks": "Networks and windows",
    "stability": "Stability and extremes",
    "cost": "Cost",
}
UNREADABLE = ""  # group of a case whose file cannot be used, which stands first
UNREADABLE_TITLE = "Files that cannot be used"


def title_of(group: str) -> str:
    """Title of a group's part of the report."""
    return GROUPS.get(group, UNREADABLE_TITLE)
