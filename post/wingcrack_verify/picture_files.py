"""The pictures of a run that a case can request, and the files that they require.

This module is separate from `pictures`, which draws them and takes long to load.
"""

from __future__ import annotations

from pathlib import Path

from wingcrack.errors import CaseError
from wingcrack.sweeps.paths import NETWORK, network_table

_FIELDS = "matrix.pvd"
# Its network, its contact states, its pore pressure; each with the file without which it cannot be.
PICTURES = {"network": NETWORK, "states": "fractures.csv", "pressure": _FIELDS}


def require_files(picture: str, folder: Path) -> None:
    """Raise a `CaseError` if the run did not write what the picture shows."""
    needed = PICTURES[picture]
    if needed == NETWORK:
        network_table(folder / NETWORK)
    elif not (folder / needed).is_file():
        hint = '; set "output.vtu" = true' if needed == _FIELDS else ""
        raise CaseError(f"the run wrote no {needed}{hint}")
