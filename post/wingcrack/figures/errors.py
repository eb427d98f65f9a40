"""Why a figure or a whole call cannot be drawn; each message is one sentence for the user."""


class RunError(Exception):
    """The files of the run are missing, damaged or not what the contract says."""


class AbsentError(Exception):
    """A sound run that simply does not hold what a figure needs, such as pressure or tips."""


class EnvironmentLacksError(Exception):
    """The machine lacks something that is needed: a library, the solver, another program."""
