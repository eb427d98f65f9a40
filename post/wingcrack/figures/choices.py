"""Choices of the options; the command line and the packages take them from here."""

from __future__ import annotations

GROUPS = (
    *("summary", "story", "network", "maps", "fractures", "tips", "wells", "seismicity", "probes"),
    *("temperature", "view", "mesh"),
)
ALL = "all"
FORMATS = ("png", "pdf")
LAYOUTS = ("page", "column", "slide")
DEFAULT_FORMATS = ("png",)
CLUSTERS = ("none", "local", "slurm", "pbs", "ssh")  # how the runs of a study are spread
