"""The folders of the cases; needs nothing but Python."""

from __future__ import annotations

from pathlib import Path


def case_folders(top: Path) -> dict[str, Path]:
    """Folders of the cases by name."""
    return {
        path.parent.name: path.parent
        for pattern in ("*/check.toml", "*/stability.toml")
        for path in sorted(top.glob(pattern))
    }
