"""All figures of a run: which there are, and writing the chosen ones to files."""

from __future__ import annotations

import gc
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wingcrack.errors import AbsentError, EnvironmentLacksError, RunError
from wingcrack.figures.choices import ALL, DEFAULT_FORMATS, LAYOUTS
from wingcrack.figures.read import Run, read_run
from wingcrack.figures.slip import has_seismic
from wingcrack.figures.states import grows, slips_or_opens
from wingcrack.figures.unchanged import Drawn, fields_of, fingerprint_of, program, tables_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Outcome:
    """What became of one figure."""

    name: str  # name of the figure, the stem of its files (for profiles: of the first part of them)
    # what was written, or was there and is still true; empty if it was left out
    files: tuple[Path, ...]
    reason: str = ""  # why it was left out, else empty
    lacking: bool = False  # whether it was left out as this machine lacks something
    unchanged: bool = False  # whether nothing had to be drawn


@dataclass(frozen=True)
class _Figures:
    """A figure, or several of a kind."""

    group: str
    name: str
    # module and function, loaded when there is something to draw: the libraries take long
    maker: str
    of_fields: bool = False  # whether it needs the VTU files, and takes the wanted times
    # whether the function gives pairs of a label and a figure, and takes the wanted times
    several: bool = False
    # whether it is drawn without being asked for: whether something happens in it
    shown: Callable[[Run], bool] = lambda _run: True

    def draw(
        self, run: Run, times_s: Sequence[float], *, every: bool = True
    ) -> Iterator[tuple[str, Figure]]:
        """Give each figure with its label; of several that are many, `every` one if wanted."""
        module, _, function = self.maker.partition(":")
        make: Callable[..., Any] = getattr(import_module(f"wingcrack.figures.{module}"), function)
        if self.several:
            yield from make(run, times_s, every=every)
        elif self.of_fields:
            yield "", make(run, times_s)
        else:
            yield "", make(run)


_MANY = 16  # files of figures of a kind, after which what is left of them is tidied up


def _changing_wells(run: Run) -> bool:
    """Whether there are several wells or stages: of a single one, summary and story tell all."""
    if run.wells is None:
        return True  # the function tells that there are none
    wells, stages = (set(run.wells.text(column)) for column in ("well", "stage"))
    return len(wells) > 1 or len(stages - {"0"}) > 1  # 0: shut


def _moving_network(run: Run) -> bool:
    """Whether there are several fractures, some of which slip or open."""
    return len((run.network or {}).get("fractures", ())) > 3 and slips_or_opens(run)


def _untold(run: Run) -> bool:
    """Whether fractures move and no story shows pressure, length and states by time."""
    return slips_or_opens(run) and (run.wells is None or run.network is None)


def _has_heat(run: Run) -> bool:
    return run.fractures is not None and run.fractures.has("temperature_k")


def _on_request(_run: Run) -> bool:
    return False


_FIGURES = (
    _Figures("summary", "summary", "summary:summary"),
    _Figures("story", "story", "story:story"),
    _Figures("network", "network", "network:network_figure", shown=grows),
    _Figures("maps", "pressure_maps", "maps:pressure_maps", of_fields=True, shown=slips_or_opens),
    _Figures("maps", "stress_maps", "maps:stress_maps", of_fields=True, shown=slips_or_opens),
    _Figures("maps", "jump_maps", "jump_maps:jump_maps", of_fields=True, shown=_moving_network),
    _Figures(
        "fractures", "fracture", "profiles:fracture_profiles", several=True, shown=slips_or_opens
    ),
    _Figures("tips", "intensities", "history:intensities", shown=grows),
    _Figures("tips", "load", "load:load_figure"),
    _Figures("tips", "equilibrium", "equilibrium_figure:equilibrium_figure"),
    _Figures("tips", "development", "history:development", shown=_untold),
    _Figures("tips", "balance", "history:balance", shown=_on_request),
    _Figures("wells", "wells", "wells:well_histories", shown=_changing_wells),
    _Figures("seismicity", "seismicity", "seismicity:seismicity", shown=has_seismic),
    _Figures("probes", "probes", "probes:probe_histories"),
    _Figures("temperature", "temperature", "temperature:temperature", shown=_has_heat),
    _Figures("view", "view", "view:view", of_fields=True, shown=_on_request),
    _Figures("mesh", "mesh", "mesh:mesh_figure", of_fields=True, shown=_on_request),
)


def draw_figures(
    directory: Path,
    only: Sequence[str] = (),
    formats: Sequence[str] = DEFAULT_FORMATS,
    times_s: Sequence[float] = (),
    layout: str = LAYOUTS[0],
) -> Iterator[Outcome]:
    """Draw the figures of the named groups, or of ``all``, into ``figures`` in the run's folder.

    Those of another layout than that of a page have a folder of their own, as ``figures_column``.

    Without names these are the figures in which something happens, and those drawn before. Those
    whose files are there and would come out the same are not drawn again. Yields an outcome per
    figure as soon as it is known. Damaged files raise `RunError`.
    """
    # fingerprints come before what they are of is read: what changes in between is drawn again
    tables = tables_of(directory) if directory.is_dir() else ""
    run = read_run(directory)
    is_page = layout == LAYOUTS[0]
    folder = directory / ("figures" if is_page else f"figures_{layout}")
    record = Drawn(folder)
    way = [
        program(),
        tables,
        str(directory.resolve()),
        repr(tuple(formats)),
        repr(tuple(times_s)),
        layout,
    ]
    fields: str | None = None
    by_name = bool(only) and ALL not in only
    for figures in _FIGURES:
        if by_name and figures.group not in only:
            continue
        if not (only or figures.shown(run) or record.has(figures.name)):
            yield Outcome(figures.name, (), f"drawn on request (--only {figures.group})")
            continue
        if figures.of_fields and fields is None:
            fields = fields_of(s.path for s in (*run.matrix, *run.fracture_fields))
        used = [*way, fields or ""] if figures.of_fields else way
        used = [*used, str(by_name)] if figures.several else used
        known = "" if figures.of_fields and not fields else fingerprint_of(used)
        found = record.find(figures.name, known)
        if found is not None:
            yield Outcome(figures.name, tuple(found[0]), found[1], unchanged=True)
            continue
        before = record.forget(figures.name)
        # what needs no fields does not get them, so that it cannot come to depend on them
        given = run if figures.of_fields else replace(run, matrix=(), fracture_fields=())
        from wingcrack.figures import style

        with style.layout(layout):
            outcome = _drawn(given, figures, folder, formats, times_s, every=by_name)
        for file in before.difference(outcome.files):
            file.unlink(missing_ok=True)  # it shows what is no more
        if not outcome.lacking:
            record.note(figures.name, known, outcome.files, outcome.reason)
        yield outcome
    if is_page and (not by_name or "summary" in only):
        yield _page(run, record, way)


def _page(run: Run, record: Drawn, way: Sequence[str]) -> Outcome:
    """Write the page that shows the pictures that are there by now, unless it does."""
    folder = run.directory / "figures"
    pictures = sorted(path.name for path in folder.glob("[!.]*.p*"))
    known = fingerprint_of([*way, *pictures])
    found = record.find("index", known)
    if found is not None:
        return Outcome("index", tuple(found[0]), unchanged=True)
    record.forget("index")
    write: Callable[[Run, Path, Sequence[str]], list[Path]]
    write = import_module("wingcrack.figures.page").write_page
    files = write(run, folder, [figures.name for figures in _FIGURES])
    record.note("index", known, files, "")
    return Outcome("index", tuple(files))


def figure_of(run: Run, name: str, times_s: Sequence[float] = ()) -> Figure:
    """Give one figure by the name of its files, as ``story`` or ``fracture_1``.

    Raises `AbsentError` if the run does not hold what it needs, `RunError` if there is no figure of
    that name.
    """
    for figures in _FIGURES:
        if figures.several and not name.startswith(f"{figures.name}_"):
            continue
        if not figures.several and name != figures.name:
            continue
        for label, figure in figures.draw(run, times_s):
            if not label or f"{figures.name}_{label}" == name:
                return figure
    known = (f"{f.name}_NAME" if f.several else f.name for f in _FIGURES)
    raise RunError(f"there is no figure '{name}'; there are {', '.join(known)}.")


def _drawn(
    run: Run,
    figures: _Figures,
    folder: Path,
    formats: Sequence[str],
    times_s: Sequence[float],
    *,
    every: bool,
) -> Outcome:
    files: list[Path] = []
    try:
        for label, figure in figures.draw(run, times_s, every=every):
            from wingcrack.figures.style import save

            name = f"{figures.name}_{label}" if label else figures.name
            files += save(figure, folder / re.sub(r"[^\w.-]+", "_", name), formats)
            del figure
            if len(files) % _MANY == 0:
                gc.collect()  # a figure refers to itself
    except AbsentError as reason:
        return Outcome(figures.name, tuple(files), str(reason))
    except EnvironmentLacksError as reason:
        return Outcome(figures.name, tuple(files), str(reason), lacking=True)
    return Outcome(figures.name, tuple(files))
