"""Read the files of a wingcrack run and draw its figures.

>>> from wingcrack_post import read_run
>>> run = read_run("out/wing_crack")  # doctest: +SKIP
>>> run.history.number("well_pressure_pa").max()  # doctest: +SKIP
"""

from typing import TYPE_CHECKING, Any

from wingcrack_post.errors import AbsentError, EnvironmentLacksError, RunError

if TYPE_CHECKING:
    from wingcrack_post.read import Run, read_run
    from wingcrack_post.table import Table, read_table

__version__ = "0.2.0"

__all__ = [
    "AbsentError",
    "EnvironmentLacksError",
    "Run",
    "RunError",
    "Table",
    "__version__",
    "read_run",
    "read_table",
]


def __getattr__(name: str) -> Any:
    """Load the readers when one is asked for: the command line is understood without numpy."""
    if name in {"Run", "read_run"}:
        from wingcrack_post import read as module
    elif name in {"Table", "read_table"}:
        from wingcrack_post import table as module  # type: ignore[no-redef]
    else:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(module, name)
