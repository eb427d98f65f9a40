"""Commands that use runs: run, check, plot, analyse, view and study."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

from wingcrack.command_line.declaring import (
    TOP,
    Parameter,
    RefusedError,
    UsageError,
    choice,
    command,
    flag,
)
from wingcrack.command_line.values import absolute, each_of, place, positive, whole
from wingcrack.figures.choices import ALL, CLUSTERS, DEFAULT_FORMATS, FORMATS, GROUPS, LAYOUTS
from wingcrack.figures.durations import parse_times
from wingcrack.welltest.units import read_columns

_SCENE = Parameter("scene", "SCENE.nml", read=place)


@command(
    "run",
    "wingcrack.solving:run",
    _SCENE,
    Parameter("--out", "DIR", "for the results (default: out/NAME of the scene)", place),
    Parameter("--threads", "N", "for windows side by side and loops (1)", whole(1, 9999), 1),
    Parameter(
        "--ranks",
        "N",
        "processes that share the matrices of a large body with a fluid, from 10,000 cells on (1);"
        " the first call with more than one installs MPI, MUMPS for it and builds a second program"
        " (docs/scale.md)",
        whole(1, 9999),
        1,
    ),
    Parameter(
        "--restart",
        "DIR",
        "go on from the newest checkpoint of the run in DIR, in the same folder or that of --out;"
        " without SCENE.nml the scene is DIR/scene.nml (docs/howto_restart.md)",
        place,
    ),
    Parameter("--end", "T", "with --restart: another end of the run [s]", positive),
    flag("--quiet", "no progress on the terminal"),
    flag("--no-plot", "no figures"),
    statuses="""\
0 done; 1 the run failed (the reason is the last line on stderr and in run.json);
2 bad input or usage (nothing is written); 3 the environment lacks something; 130 and 143
interrupted by SIGINT and SIGTERM (the last good state is on disk).""",
    example="./wingcrack run inputs/paper_c/onset.nml --out /tmp/onset --no-plot\n",
)
def run(given: SimpleNamespace) -> None:
    """Run a scene and draw its figures."""
    if given.out == "":
        raise UsageError("--out needs a value")
    if given.restart is None:
        if given.end is not None:
            raise UsageError("--end belongs to --restart: otherwise the scene has the end")
        _judge_scene(given)
    else:
        _judge_restart(given)
    if given.out is not None:
        judge_place(given.out)


@command(
    "check",
    "wingcrack.solving:check",
    _SCENE,
    flag(
        "--stress",
        "of each fracture: slip tendency and the pressures at which it slips, opens and grows;"
        " K_m of wells; steps and CPU time",
    ),
    flag("--json", "the same as JSON, in SI units"),
    Parameter("--mohr", "FILE", "draw the Mohr diagram into FILE.png or FILE.pdf", Path),
    about="Prints what the scene has, what it leaves out and its estimated size. Writes nothing\n"
    "but the Mohr diagram.\n",
    statuses="0 good; 1 the words cannot be written; 2 the scene is refused, or bad usage.",
    example="""\
./wingcrack check inputs/paper_c/onset.nml
./wingcrack check --stress inputs/examples/field.nml --mohr /tmp/field_mohr.png
""",
)
def check(given: SimpleNamespace) -> None:
    """Read and validate a scene without running it."""
    if given.mohr is not None:
        if given.mohr.suffix not in {".png", ".pdf"}:
            raise UsageError(f"--mohr must end in .png or .pdf, unlike {given.mohr}")
        if not given.mohr.parent.is_dir():
            raise UsageError(f"the diagram cannot go to {given.mohr}: there is no such folder")
    _judge_scene(given)


def _judge_restart(given: SimpleNamespace) -> None:
    if given.ranks > 1:
        raise UsageError("--restart goes with one process, without --ranks")
    if not any(Path(given.restart).glob("checkpoint*.bin")):
        raise RefusedError(f"{given.restart} has no checkpoint of a run to go on from")
    if given.scene is not None:
        _judge_scene(given)


def _judge_scene(given: SimpleNamespace) -> None:
    name, scene = given.scene, Path(given.scene or "")
    if not name:
        raise RefusedError(
            f"{given.command} needs a scene file, as in ./wingcrack {given.command}"
            " inputs/paper_c/onset.nml"
        )
    if scene.is_dir():
        raise RefusedError(f"{name} is a folder, not a scene file")
    if not scene.exists():
        raise RefusedError(f"there is no scene file {name}")
    if not scene.is_file():
        raise RefusedError(f"{name} is a pipe or a device, not a scene file")
    if not os.access(scene, os.R_OK):
        raise RefusedError(f"the scene file {name} cannot be read")


def judge_place(out: str) -> None:
    """Refuse results where a file is in the way."""
    place = next((place for place in (Path(out), *Path(out).parents) if place.exists()), None)
    if place is not None and not place.is_dir():
        raise RefusedError(f"results cannot go to {out}: {place} is a file")


_FORMATS = Parameter(
    "--format",
    "FORMAT,...",
    "of the figures: png, pdf, or png,pdf (default: png)",
    each_of(FORMATS),
    DEFAULT_FORMATS,
)


@command(
    "plot",
    "wingcrack.figures.cli:plot",
    Parameter("directories", "DIR...", read=Path, many=True),
    Parameter(
        "--times",
        "T,...",
        "times of maps and profiles: seconds, or with the unit s, min, h or d; the nearest"
        " written times are drawn (default: the first, the start of growth, the highest"
        " well pressure, equally spaced fracture lengths, the last; no short steps after growth)",
        parse_times,
        (),
    ),
    Parameter(
        "--only",
        "GROUP,...",
        f"draw these groups: {', '.join(GROUPS)}, or {ALL}",
        each_of((*GROUPS, ALL)),
        (),
    ),
    _FORMATS,
    choice(
        "--style", LAYOUTS, "for a page, one of its columns, or a slide (default: page)", "page"
    ),
    flag("--quiet", "print nothing but errors"),
    about="""\
Without --only, the figures in which something happens are drawn, and those that were drawn before:
network and stress intensities where tips grow, maps, profiles, lengths and states where a fracture
slips or opens, wells where there are several or stages; balance, view and mesh only on request.

groups of figures (--only), written to DIR/figures:
  summary    any run on one page: body and loads, network by state, pressure or load, length,
             K_eq over K_IC, errors, warnings; and index.html, which shows all figures
  story      an injection on one page: the network with its slip events, well pressure,
             injectivity, where the fluid is, lengths, seismic moment
  network    the fractures at the start and what has grown, coloured by its order
  maps       pore pressure, or its change since the first state where that shows the wells better;
             without a fluid stress; up to six states, with the contact states; of networks slip
             and aperture of all fractures
  fractures  opening, slip, aperture, pressure and tractions along each fracture that has a well,
             slips, opens or grows, at most 12; of all if --only names this group
  tips       stress intensities; load and growth; length, well pressure, states; fluid balance
  wells      pressures, flow, volume and injectivity of each well
  probes     pressure, displacement and stress at the probe points
  view       the deformed body, its displacements drawn larger than they are
  mesh       the mesh of the body, and around the fractures with the windows of the tips

Figures in another style than that of a page are written to DIR/figures_column or DIR/figures_slide.
A figure whose files are there and would come out the same is not drawn again.
""",
    example="./wingcrack plot out/wing_crack --times 0.5h,20h,40h --only maps,fractures\n",
)
def plot(given: SimpleNamespace) -> None:
    """Draw the figures of finished or running runs into DIR/figures."""
    if not given.directories:
        raise UsageError("plot needs the directory of a run, as in ./wingcrack plot out/onset")
    for directory in given.directories:
        _judge_folder(directory)


@command(
    "analyse",
    "wingcrack.welltest.cli:analyse",
    Parameter("path", "DIR|RECORD.csv", read=Path, required=True),
    Parameter(
        "--columns",
        "MAP",
        "of a record: header, quantity and unit of its columns, as"
        " 'injectionRate=rate [bpm],pressure=pressure [psi],time=time [s]'"
        " (default: the headers time_s, rate_m2_s, pressure_pa)",
        read_columns,
        read_columns("time_s=time [s],rate_m2_s=rate [m2/s],pressure_pa=pressure [Pa]"),
    ),
    Parameter("--viscosity", "PA_S", "of the fluid of a record [Pa s]", positive),
    Parameter("--storage", "S", "of the rock of a record, at uniaxial strain [1/Pa]", positive),
    Parameter(
        "--out", "DIR", "for the results (default: the run, or out/NAME of the record)", Path
    ),
    _FORMATS,
    flag("--quiet", "print nothing but errors"),
    about="""\
Finds the shut-ins of every well, and for each: instantaneous shut-in pressure; Bourdet derivative;
lines of linear and radial flow with what follows from them (A sqrt(k), k h, pressure of the
reservoir); closure by the usual picks, and of a run when its first and last open cell close.
Writes figures/well_test.csv and figures/well_test_WELL_N.png (docs/howto_wells.md).
""",
    statuses="0 done; 2 bad input or usage, or no shut-in.",
    example="""\
./wingcrack analyse out/field
./wingcrack analyse record.csv --columns 'q=rate [l/s],p=pressure [bar],t=time [min]'
""",
)
def analyse(given: SimpleNamespace) -> None:
    """Analyse the shut-ins of a run or of a measured record."""
    if not given.path.exists():
        raise UsageError(f"there is no run or record {given.path}")


@command(
    "view",
    "wingcrack.view.cli:view",
    Parameter("directory", "DIR", read=Path),
    Parameter("--port", "N", "port of the page (default: a free one)", whole(1, 65535), 0),
    flag("--no-browser", "only print the address, open no browser"),
    about="""\
The page shows a field of the rock in every written state, the fractures by state, the wells, and
the history beside them. While a run goes on, new states appear by themselves. Only this machine
reaches the page, and it asks no other. Ctrl-C ends it.
""",
    example="""\
./wingcrack view out/onset
./wingcrack view out/onset --port 8040 --no-browser    # then: ssh -L 8040:localhost:8040 HOST
""",
)
def view(given: SimpleNamespace) -> None:
    """Show a finished or running run in the browser."""
    if given.directory is None:
        raise UsageError("view needs the directory of a run, as in ./wingcrack view out/onset")
    _judge_folder(given.directory)


def _judge_folder(directory: Path) -> None:
    if not directory.is_dir():
        raise UsageError(f"there is no directory {directory}")


@command(
    "study",
    "wingcrack.studies.cli:study",
    Parameter("study", "STUDY.toml", read=Path, required=True),
    Parameter(
        "--jobs",
        "N",
        "runs at a time, or workers of the cluster (default: the cores at hand,"
        f" {len(os.sched_getaffinity(0))})",
        whole(1, 1024),
    ),
    Parameter("--out", "DIR", "where the results go (default: out/STUDY)", Path),
    flag("--quick", "the short form defined in [quick] of the study's file"),
    choice(
        "--cluster",
        CLUSTERS,
        "how the runs are spread: none (processes of this call), or by Dask on this machine"
        " (local) or others (default: as the study's file says, else none)",
    ),
    _FORMATS,
    flag("--check", "read the study and check all its scenes, run nothing"),
    Parameter("--build", "DIR", "where the solver was built", absolute, TOP / "build" / "release"),
    about="""\
Runs a scene many times, as the study's file says (docs/studies.md), and writes table.csv,
table.parquet, statistics.csv, study.json and figures/ into the folder. A call that was ended, even
killed, goes on where it stopped when it is given again: finished runs are not repeated.
""",
    statuses="""\
0 done; 1 a run failed (the table has all others); 2 bad study, scene or usage
(nothing was run); 3 the environment lacks something; 130 and 143 interrupted: the table has what
was done until then.""",
    example="""\
./wingcrack study inputs/studies/d3_rate.toml --quick
./wingcrack study inputs/studies/monte_carlo.toml --jobs 4 --out out/chance
""",
)
def study(given: SimpleNamespace) -> None:
    """Run a scene many times as a file says, for a table and figures."""
    if given.study.is_dir():
        raise UsageError(f"{given.study} is a folder, not a study's file")
    if not given.study.is_file():
        raise UsageError(f"there is no study {given.study}")
    name = given.study.stem + ("_quick" if given.quick else "")
    given.out = (given.out or Path("out") / name).resolve()  # runs are made in folders of their own
    place = next(folder for folder in (given.out, *given.out.parents) if folder.exists())
    if not place.is_dir():
        raise UsageError(f"results cannot go to {given.out}: {place} is a file")
