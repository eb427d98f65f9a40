"""The table of groups and names that a scene may hold, by groups."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from wingcrack.names import table
from wingcrack.runs.parameter_table import Parameter
from wingcrack.runs.parameter_table import parameters as all_parameters


@dataclass(frozen=True)
class Group:
    """A group of a scene file with its names in the order of the table."""

    name: str
    is_repeated: bool
    meaning: str
    parameters: dict[str, Parameter]


@cache
def groups() -> dict[str, Group]:
    """Give all groups by name, in the order of the table."""
    return {
        group["name"]: Group(
            group["name"],
            "repeated" in group,
            group["meaning"] + (f" Only in scenes {group['scenes']}." if "scenes" in group else ""),
            {
                row["name"]: all_parameters()[f"{group['name']}.{row['name']}"]
                for row in group["parameters"]
            },
        )
        for group in table()["groups"]
    }
