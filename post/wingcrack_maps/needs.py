"""Packages that only some maps take."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from wingcrack.errors import EnvironmentLacksError


def needed(package: str) -> Any:
    """Give a package of requirements_maps_gis.txt; the launcher installs it when needed."""
    try:
        return import_module(package)
    except ImportError:
        raise EnvironmentLacksError(
            f"{package} is missing: ./wingcrack import installs what this map takes"
            " (requirements_maps_gis.txt)"
        ) from None
