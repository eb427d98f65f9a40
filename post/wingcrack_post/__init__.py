"""Read the files of a wingcrack run and draw its figures.

>>> from wingcrack_post import read_run
>>> run = read_run("out/wing_crack")  # doctest: +SKIP
>>> run.history.number("well_pressure_pa").max()  # doctest: +SKIP
"""

from wingcrack_post.errors import AbsentError, EnvironmentLacksError, RunError
from wingcrack_post.read import Run, read_run
from wingcrack_post.table import Table, read_table

__version__ = "0.1.0"

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
