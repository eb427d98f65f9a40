"""Verification: runs the cases of ``verification/``, judges every number and writes the report."""

from pathlib import Path


def case_folders(top: Path) -> dict[str, Path]:
    """Folders of the cases by name."""
    return {
        path.parent.name: path.parent
        for pattern in ("*/check.toml", "*/stability.toml")
        for path in sorted(top.glob(pattern))
    }
