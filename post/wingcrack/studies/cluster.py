"""Machines of a study: this one, or others by Dask's classes."""

from __future__ import annotations

import importlib
import logging
from contextlib import ExitStack
from typing import Annotated, Any

from pydantic import Field

from wingcrack.errors import CaseError, EnvironmentLacksError
from wingcrack.figures.choices import CLUSTERS
from wingcrack.sweeps.fields import Entry, Table, choice, whole

# Module and class of each kind, and what must be installed for it.
_CLASSES = {
    "local": ("distributed", "LocalCluster", "distributed"),
    "slurm": ("dask_jobqueue", "SLURMCluster", "dask-jobqueue"),
    "pbs": ("dask_jobqueue", "PBSCluster", "dask-jobqueue"),
    "ssh": ("distributed", "SSHCluster", "asyncssh"),
}


class Cluster(Entry):
    """``[cluster]`` of a study, with a table for the class of each kind."""

    kind: Annotated[str, choice(CLUSTERS)] = "none"  # "none" for processes of this call
    workers: Annotated[int | None, whole(1)] = None  # runs at a time; None for the cores at hand
    local: Table = Field(default_factory=dict)
    slurm: Table = Field(default_factory=dict)
    pbs: Table = Field(default_factory=dict)
    ssh: Table = Field(default_factory=dict)


def connect(cluster: Cluster, workers: int, stack: ExitStack) -> Any:
    """Start a cluster and give a client of it; leaving the stack closes both.

    Raises `EnvironmentLacksError` if what the kind takes is not installed, or the cluster cannot be
    started.
    """
    module, name, needs = _CLASSES[cluster.kind]
    try:
        start = getattr(importlib.import_module(module), name)
        if cluster.kind == "ssh":
            importlib.import_module("asyncssh")
    except ImportError:
        raise EnvironmentLacksError(
            f"a cluster of kind '{cluster.kind}' takes the Python package {needs}, "
            f"which is not in .venv (.venv/bin/python -m pip install {needs})"
        ) from None
    given = dict(getattr(cluster, cluster.kind))
    if cluster.kind == "local":
        given = {
            "n_workers": workers,
            "threads_per_worker": 1,
            "dashboard_address": None,
            "silence_logs": logging.CRITICAL,  # the study reports a lost worker
            **given,
        }
    elif cluster.kind == "ssh" and "hosts" not in given:
        raise CaseError("cluster.ssh: 'hosts' is missing: the scheduler's, then one per worker")
    try:
        started = stack.enter_context(start(**given))
        if cluster.kind in ("slurm", "pbs"):
            started.scale(jobs=workers)
        client: Any = importlib.import_module("distributed").Client
        return stack.enter_context(client(started, set_as_default=False))
    except (TypeError, ValueError, OSError, RuntimeError) as reason:
        root: BaseException = reason
        while root.__cause__ is not None:  # the first one says why, the others that it failed
            root = root.__cause__
        said = str(root).strip().splitlines() or [type(root).__name__]
        raise EnvironmentLacksError(
            f"the cluster of kind '{cluster.kind}' cannot be started ({said[0]})"
        ) from None
