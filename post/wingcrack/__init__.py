"""Runs and scenes of wingcrack in Python: tables, fields, figures, movies.

>>> import wingcrack
>>> run = wingcrack.open("out/wing_crack")  # doctest: +SKIP
>>> run.history["well_pressure_pa"].max()  # doctest: +SKIP
>>> run.plot_history("well_pressure_pa").figure.savefig("pressure.png")  # doctest: +SKIP

Each error is one sentence of one of these exceptions:

* `RunError`: files are missing, damaged or of another kind;
* `AbsentError`: a valid run without the requested quantity, such as pressure or tips;
* `SceneError`: a scene that is refused, or an address in it that does not exist;
* `RunFailedError`: a run that was started and ended without its results;
* `EnvironmentLacksError`: this machine lacks a library or the solver.
"""

from typing import TYPE_CHECKING, Any

from wingcrack.errors import (
    AbsentError,
    EnvironmentLacksError,
    RunError,
    RunFailedError,
    SceneError,
)

if TYPE_CHECKING:
    from wingcrack.runs.comparison import compare
    from wingcrack.runs.fields import Fields
    from wingcrack.runs.parameter_table import Parameter, parameters
    from wingcrack.runs.run import Run, Scene
    from wingcrack.runs.run import open_run as open  # noqa: A004

__version__ = "0.2.0"

__all__ = [
    "AbsentError",
    "EnvironmentLacksError",
    "Fields",
    "Parameter",
    "Run",
    "RunError",
    "RunFailedError",
    "Scene",
    "SceneError",
    "compare",
    "open",
    "parameters",
]

_PLACES = {
    "Fields": ("runs.fields", "Fields"),
    "Parameter": ("runs.parameter_table", "Parameter"),
    "Run": ("runs.run", "Run"),
    "Scene": ("runs.run", "Scene"),
    "compare": ("runs.comparison", "compare"),
    "open": ("runs.run", "open_run"),
    "parameters": ("runs.parameter_table", "parameters"),
}


def __getattr__(name: str) -> Any:
    """Load what is asked for: importing the package alone costs a few milliseconds."""
    if name not in _PLACES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    from importlib import import_module

    module, attribute = _PLACES[name]
    found = getattr(import_module(f"{__name__}.{module}"), attribute)
    globals()[name] = found
    return found
