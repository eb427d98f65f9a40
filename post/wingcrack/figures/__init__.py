"""Read the files of a wingcrack run and draw its figures.

>>> from wingcrack.figures import read_run
>>> run = read_run("out/wing_crack")  # doctest: +SKIP
>>> run.history.number("well_pressure_pa").max()  # doctest: +SKIP
"""

from typing import TYPE_CHECKING, Any

from wingcrack.errors import AbsentError, EnvironmentLacksError, RunError

if TYPE_CHECKING:
    from wingcrack.figures.read import Run, read_run
    from wingcrack.figures.table import Table, read_table

__all__ = [
    "AbsentError",
    "EnvironmentLacksError",
    "Run",
    "RunError",
    "Table",
    "read_run",
    "read_table",
]


def __getattr__(name: str) -> Any:
    """Load the readers when one is asked for: the command line is understood without numpy."""
    if name in {"Run", "read_run"}:
        from wingcrack.figures import read as module
    elif name in {"Table", "read_table"}:
        from wingcrack.figures import table as module  # type: ignore[no-redef]
    else:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(module, name)
