"""All pictures of the documentation that come from runs.

Scenes are run by the runner that `verify` and `study` use, one at a time so that CPU times mean
something, and kept in build/pictures; what has run is not run again until scene or solver change.
"""

from __future__ import annotations

from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import wingcrack
from wingcrack.runner.pool import Pool
from wingcrack.runner.task import Task, tables_of
from wingcrack.scenes.new import new_scene
from wingcrack.scenes.solver import SOLVER
from wingcrack_docs.gallery import write_gallery
from wingcrack_docs.places import PICTURES, SCENES, TOP, DocsError
from wingcrack_docs.thumbnail import draw_states, draw_story, draw_summary, new_figure, save_small

_RUNS = TOP / "build" / "pictures"
_LIMIT_S = 3600.0
_MAIN = SCENES / "paper_c" / "wing_crack.nml"
_MAP = SCENES / "examples" / "outcrop.geojson"
_RATES = (2.0e-9, 5.0e-9, 1.0e-8)  # [m2/s] of the tutorial's study


def make_pictures() -> None:
    """Run what has not run, draw all pictures, write the gallery's page.

    Raises `DocsError` if a scene does not reach its end, or has no place in the gallery,
    `EnvironmentLacksError` if there is no solver.
    """
    scenes = {
        scene.relative_to(SCENES).with_suffix("").as_posix(): scene
        for scene in sorted(SCENES.rglob("*.nml"))
    }
    tasks = [_task(label, scene, scene.read_text("utf-8")) for label, scene in scenes.items()]
    own = new_scene("injection", "mine")
    rates = {f"tutorial/rate {rate:g}": _at_rate(own, rate) for rate in _RATES}
    tasks += [_task(label, SCENES / "mine.nml", text) for label, text in rates.items()]
    tasks.append(_task("tutorial/outcrop", _MAP, _map_scene()))
    runs = _run(tasks)
    write_gallery({scene: runs[label] for label, scene in scenes.items()})
    main = runs[_MAIN.relative_to(SCENES).with_suffix("").as_posix()]
    draw_story(main, PICTURES / "story.png")
    mine = runs[f"tutorial/rate {_RATES[1]:g}"]
    draw_summary(mine, PICTURES / "tutorial_summary.png")
    draw_states(runs["tutorial/outcrop"], PICTURES / "tutorial_map.png")
    _draw_rates([runs[label] for label in rates], PICTURES / "tutorial_rates.png")


def _map_scene() -> str:
    """Text of the scene that the tutorial makes of the map."""
    from wingcrack.command_line import main

    _RUNS.mkdir(parents=True, exist_ok=True)
    file = _RUNS / "outcrop.nml"
    words = ["import", str(_MAP), "--unit", "m", "--repair", "0.1", "--overwrite"]
    with redirect_stdout(StringIO()) as said:
        status = main([*words, "--out", str(file)])
    if status != 0:
        raise DocsError(f"{_MAP.name} was not imported: {said.getvalue().strip()}")
    return file.read_text("utf-8")


def _at_rate(text: str, rate: float) -> str:
    changed = text.replace("rate = 5.0e-9", f"rate = {rate:g}")
    if f"rate = {rate:g}" not in changed:
        raise DocsError("the scene of `new injection` has no rate of 5.0e-9 any more")
    return changed


def _draw_rates(runs: list[wingcrack.Run], path: Path) -> None:
    figure = new_figure()
    labels = [f"{rate:g} m2/s" for rate in _RATES]
    wingcrack.compare(runs, "well_pressure_pa", ax=figure.add_subplot(), labels=labels)
    save_small(figure, path)


def _task(label: str, scene: Path, text: str) -> Task:
    return Task(label, _RUNS, SOLVER, text, (), tables_of(scene, text), _LIMIT_S)


def _run(tasks: list[Task]) -> dict[str, wingcrack.Run]:
    pool: Pool[str] = Pool(1)
    known = {task.label: task for task in tasks}
    outcomes = pool.run_all(
        known,
        lambda label: pool.run_task(known[label]),
        lambda label, outcome: print(f"{label}: {outcome.cpu_s:.1f} CPU s", flush=True),
    )
    for label, outcome in outcomes.items():
        if outcome.status != "finished":
            raise DocsError(f"the run {label} has {outcome.status}: {outcome.reason}")
    return {
        label: wingcrack.open(Path(outcome.folder) / "output")
        for label, outcome in outcomes.items()
    }
