"""The contents of a run's files; a study that requires other quantities is refused."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

from wingcrack.errors import CaseError, RunError
from wingcrack.figures.table import read_table
from wingcrack.figures.text_files import read_json
from wingcrack.names import columns
from wingcrack.sweeps.paths import COLUMNS, NETWORK
from wingcrack.sweeps.selection import Selection, Values, names_of, select


class UnreadableError(CaseError):
    """A run has not written what a study wants to read of all runs."""


def names_of_output() -> Mapping[str, Mapping[str, str]]:
    """Columns or keys of each file with the runs that have them, as the program describes them."""
    files = {
        file: {name: row["runs"] for name, row in rows.items()}
        for file, rows in columns().items()
        if not file.endswith(".vtu")
    }
    files[NETWORK] = dict.fromkeys(COLUMNS, "always")  # read as a table of vertices
    return files


def judge_selection(
    selection: Selection, place: str, constants: Collection[str], has_fluid: bool
) -> None:
    """Refuse a selection of what no run writes, before there is one.

    Raises `CaseError`: with what would be right.

    `constants`: names that expressions can use in addition to those of the file. `has_fluid`:
    whether any run of the study has a fluid.
    """
    files = names_of_output()
    if selection.file not in files:
        raise CaseError(
            f"{place}: '{selection.file}' is no file of a run"
            f" that can be read; there are: {', '.join(files)}"
        )
    known = files[selection.file]
    kind = "key" if selection.key else "column"
    of_probes = tuple(name[len("NAME") :] for name in known if name.startswith("NAME_"))

    def is_known(name: str) -> bool:
        return name in known or (bool(of_probes) and name.endswith(of_probes))

    for name in sorted(names_of(selection, is_known) - set(constants)):
        near = difflib.get_close_matches(name, known, n=1)
        hint = f"did you mean '{near[0]}'?" if near else f"there are: {', '.join(known)}"
        raise CaseError(
            f"{place}: {selection.file} has no {kind} '{name}' (docs/output.md); {hint}"
        )
    for name in sorted(names_of(selection)):
        runs = known.get(name, "")
        if runs.startswith("without a fluid" if has_fluid else "with a fluid"):
            raise CaseError(
                f"{place}: {selection.file} has the {kind} '{name}' only {runs}, and"
                f" the scenes of this study have {'one' if has_fluid else 'none'}"
            )


def judge_run(selection: Selection, place: str, output: Path, constants: Collection[str]) -> None:
    """Refuse a selection of what a finished run has not written.

    Raises `UnreadableError` if the file, a column or a key is missing.
    """
    path = _within(output, selection.file)
    try:
        known: set[str] = set(COLUMNS)
        if selection.key:
            known = set(_keys(read_json(path)))
        elif selection.file != NETWORK:
            known = set(read_table(path).cells)
    except FileNotFoundError:
        raise UnreadableError(f"{place}: the run has no {selection.file}") from None
    except (OSError, ValueError, RunError) as reason:
        raise UnreadableError(f"{place}: {reason}") from None
    if strange := sorted(names_of(selection, known.__contains__) - set(constants)):
        raise UnreadableError(f"{place}: {selection.file} of the run has no {strange[0]}")


def _keys(content: Any, stem: str = "") -> Iterable[str]:
    if isinstance(content, dict):
        for name, value in content.items():
            yield stem + name
            yield from _keys(value, f"{stem}{name}.")


def select_in_run(
    selection: Selection, output: Path, constants: Mapping[str, float], as_path: bool = False
) -> Values:
    """As `select`, of a file that lies in the folder of a run, not where a link leads.

    Raises `CaseError`: as `select`, and if the file lies elsewhere.
    """
    _within(output, selection.file)
    return select(selection, output, constants, as_path)


def _within(output: Path, file: str) -> Path:
    path = output / file
    if not path.resolve().is_relative_to(output.resolve()):
        raise UnreadableError(f"{file}: it is not in the folder of the run")
    return path
