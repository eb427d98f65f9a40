"""`wingcrack reproduce`: scenes, studies, figures and printed numbers of a paper of the thesis."""

from __future__ import annotations

import csv
import re
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from wingcrack.errors import AbsentError, CaseError, RunError
from wingcrack.figures import style
from wingcrack.figures.text_files import write_whole
from wingcrack.runner.task import Outcome
from wingcrack.studies.table import write_rows
from wingcrack.sweeps.expressions import evaluate
from wingcrack.sweeps.selection import select
from wingcrack_verify.execute import Job, Programs, Runner
from wingcrack_verify.figures import Drawing, check_drawings, numbers_drawing, requested_drawing
from wingcrack_verify.judge import judge_case
from wingcrack_verify.page import number_text, templates
from wingcrack_verify.paper import Number, Paper, read_paper

# On narrow screens each row is a card, and these stand before its cells.
_HEADS = ("place", "quantity", "unit", "thesis", "measured", "ours", "exact", "remark")
COLUMNS = (
    "place",
    "quantity",
    "unit",
    "thesis",
    "measured",
    "ours",
    "ours_error",
    "exact",
    "run",
    "note",
)


@dataclass(frozen=True)
class Found:
    """A number with ours."""

    number: Number
    ours: float | None = None
    error: float | None = None
    exact: float | None = None
    reason: str = ""  # why there is none of ours

    @property
    def row(self) -> list[str]:
        """Cells of the table."""
        said = self.number
        values = (said.thesis, said.measured, self.ours, self.error, self.exact)
        cells = ["" if value is None else f"{value:.6g}" for value in values]
        note = "; ".join(filter(None, (said.note, self.reason)))
        return [said.place, said.quantity, said.unit, *cells, said.run or "", note]


def reproduce(given: SimpleNamespace) -> int:
    """Do what is asked for; give the exit status."""
    begin = time.perf_counter()
    try:
        paper = read_paper(given.papers / f"{given.paper}.toml", given.cases, given.quick)
    except CaseError as reason:
        print(f"wingcrack reproduce: {reason}", file=sys.stderr)
        return 2
    try:
        outcomes = _run(paper, given)
        status = max((_study(study, given) for study in paper.studies), default=0)
    except KeyboardInterrupt:
        print("wingcrack reproduce: interrupted; what is done is kept", file=sys.stderr)
        return 130
    if status in (130, 143):
        return status
    found = [_find(number, paper, outcomes) for number in paper.numbers]
    given.out.mkdir(parents=True, exist_ok=True)
    write_rows(given.out / "table.csv", COLUMNS, [item.row for item in found])
    figures, notes = _draw(paper, found, outcomes, given.out)
    _write_page(paper, found, figures, given)
    notes += [f"{item.number.quantity}: {item.reason}" for item in found if item.reason]
    for note in notes:
        print(note, file=sys.stderr)
    print(f"{given.out / 'index.html'}  ({time.perf_counter() - begin:.0f} s)")
    return 1 if notes or status else 0


def _run(paper: Paper, given: SimpleNamespace) -> dict[str, Outcome]:
    """Outcomes of all runs by "CASE: RUN"; those that `verify` has done are not repeated."""
    runner = Runner(Programs(given.build, given.cases / "programs"), given.cache, given.jobs)
    jobs = [Job(name.partition(": ")[0], run) for name, run in paper.runs.items()]
    count = 0

    def progress(job: Job, outcome: Outcome) -> None:
        nonlocal count
        count += 1
        how = outcome.reason or ("as before" if outcome.reused else f"{outcome.cpu_s:.2f} CPU s")
        print(f"[{count}/{len(jobs)}] {job.case}: {job.run.name}: {how}", flush=True)

    done = runner.run_all(jobs, progress)
    return {f"{case}: {run}": outcome for (case, run), outcome in done.items()}


def _study(file: Path, given: SimpleNamespace) -> int:
    from wingcrack.studies.cli import study

    out = given.out / "studies" / file.stem
    said = {"study": file, "quick": False, "out": out, "jobs": given.jobs, "cluster": None}
    return study(SimpleNamespace(**said, format=("png",), check=False, build=given.build))


def _find(number: Number, paper: Paper, outcomes: Mapping[str, Outcome]) -> Found:
    """Ours with its stated error and the exact value, where there are such."""
    exact = number.exact if isinstance(number.exact, float) else None
    if number.run is None or number.ours is None:
        return Found(number, exact=exact)
    outcome, constants = outcomes[number.run], paper.runs[number.run].constants
    if outcome.status != "finished":
        return Found(number, exact=exact, reason=f"{outcome.status}: {outcome.reason}")
    folder = Path(outcome.folder) / "output"
    try:
        if isinstance(number.exact, str):
            exact = float(evaluate(number.exact, constants))
        ours = float(select(number.ours, folder, constants).values[0])
        error = None if number.error is None else _error_of(number, folder, constants)
    except CaseError as reason:
        return Found(number, exact=exact, reason=str(reason))
    return Found(number, ours, error, exact)


def _error_of(number: Number, folder: Path, constants: Mapping[str, float]) -> float | None:
    """Give the stated error of a number; None where the run states none (-1).

    That of the time of an event stands in its detail, "known to 3.2 s".
    """
    assert number.error is not None and number.ours is not None
    column, _, size = number.error.partition("/")
    if column == "detail":
        kind = number.ours.where.get("kind")
        with (folder / number.ours.file).open(newline="", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["kind"] == kind]
        first = min(rows, key=lambda row: float(row["time_s"]))
        said = re.search(r"known to ([-+.\deE]+) s", first["detail"])
        return float(said[1]) / float(size or 1.0) if said else None
    selection = number.ours.model_copy(update={"column": number.error})
    value = float(select(selection, folder, constants).values[0])
    return value if value >= 0.0 else None


def _draw(
    paper: Paper, found: list[Found], outcomes: Mapping[str, Outcome], out: Path
) -> tuple[list[dict[str, str]], list[str]]:
    """Write all figures; give their files with titles, and what could not be drawn."""
    figures: list[dict[str, str]] = []
    notes: list[str] = []
    folder = out / "figures"
    folder.mkdir(parents=True, exist_ok=True)

    def keep(place: str, drawing: Drawing) -> None:
        name = f"figure_{len(figures) + 1:02}.svg"
        write_whole(folder / name, drawing.svg)
        figures.append({"file": name, "title": f"{place}: {drawing.title}"})
        figures[-1]["caption"] = drawing.caption

    for name, items in _series(found):
        keep(items[0].number.place, numbers_drawing(name, items))
    for figure in paper.figures:
        try:
            if figure.case:
                case = paper.shown[figure.case]
                report = judge_case(
                    case, {run.name: outcomes[f"{case.name}: {run.name}"] for run in case.runs}
                )
                drawings = [drawing for check in report.checks for drawing in check_drawings(check)]
                drawings += filter(None, map(requested_drawing, report.figures))
                for drawing in drawings:
                    keep(figure.place, drawing)
                continue
            assert figure.run is not None
            for stem, title in _of_run(figure.of, figure.times_s or (), outcomes[figure.run]):
                place = folder / f"figure_{len(figures) + 1:02}"
                file = style.save(stem, place, ("png",))[0].name
                said = figure.caption or figure.run
                figures.append({"file": file, "title": f"{figure.place}: {title}", "caption": said})
        except (AbsentError, CaseError, RunError) as reason:
            notes.append(f"{figure.place}: {reason}")
    for study in paper.studies:
        for path in sorted((out / "studies" / study.stem / "figures").glob("*.png")):
            title = f"study {study.stem}: {path.stem.replace('_', ' ')}"
            figures.append({"file": f"../{path.relative_to(out)}", "title": title, "caption": ""})
    return figures, notes


def _of_run(names: tuple[str, ...], times_s: tuple[float, ...], outcome: Outcome) -> Iterator[Any]:
    """Figures of a run with their names."""
    from wingcrack.figures.catalogue import figure_of
    from wingcrack.figures.read import read_run

    if outcome.status != "finished":
        raise CaseError(f"{outcome.status}: {outcome.reason}")
    run = read_run(Path(outcome.folder) / "output")
    for name in names:
        yield figure_of(run, name, times_s), name.replace("_", " ")


def _series(found: list[Found]) -> list[tuple[str, list[Found]]]:
    """Numbers that are points of one curve, by the name of the curve."""
    names = dict.fromkeys(item.number.series for item in found if item.number.series)
    return [
        (name, [item for item in found if item.number.series == name]) for name in names if name
    ]


def _write_page(
    paper: Paper, found: list[Found], figures: list[dict[str, str]], given: SimpleNamespace
) -> None:
    text = (
        templates()
        .get_template("paper.html.j2")
        .render(
            paper=paper,
            rows=found,
            figures=figures,
            quick=given.quick,
            number=number_text,
            columns={"numbers": _HEADS},
        )
    )
    write_whole(given.out / "index.html", text)
