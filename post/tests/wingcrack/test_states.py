"""Which states figures show, and when growth began."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from synthetic_run import GROWTH_STEP, HOUR, LAST_WING, STEPS, times, wing_length
from wingcrack.figures import Run, read_run
from wingcrack.figures.states import (
    _history_rows,
    growth_start,
    last_settled,
    select_states,
    settled_rows,
)


def _chosen(run: Run, count: int, wanted: tuple[float, ...] = ()) -> list[float]:
    return [float(times()[place]) for place in select_states(run, times(), count, wanted)]


def _rewritten(run: Path, **columns: list[float]) -> Run:
    """Change columns of history.csv."""
    path = run / "history.csv"
    header, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    for name, values in columns.items():
        for row, value in zip(rows, values, strict=True):
            row[header.index(name)] = repr(float(value))
    text = "\n".join(",".join(row) for row in [header, *rows])
    path.write_text(text + "\n", encoding="utf-8")
    return read_run(run)


def test_wanted_times_give_the_nearest_written_ones_once(wet_run: Path) -> None:
    wanted = (31.0 * HOUR, 9.0 * HOUR, 11.0 * HOUR, 1e9)
    assert _chosen(read_run(wet_run), 3, wanted) == [10.0 * HOUR, 30.0 * HOUR, 65.0 * HOUR]


@pytest.mark.parametrize("events", [True, False])
def test_growth_starts_at_the_state_before_the_first_longer_one(
    own_run: Path, events: bool
) -> None:
    if not events:
        (own_run / "events.csv").unlink()
    assert growth_start(read_run(own_run)) == times()[GROWTH_STEP - 1]


def test_default_states_hold_start_growth_and_end(wet_run: Path) -> None:
    chosen = _chosen(read_run(wet_run), 6)
    assert chosen[:2] == [times()[0], times()[GROWTH_STEP - 1]]
    assert chosen[-1] == times()[-1]
    # between them: the first written ones that reach equally spaced lengths
    steps = [
        next(s for s in range(STEPS) if wing_length(s) >= share * LAST_WING)
        for share in (0.25, 0.5, 0.75)
    ]
    assert chosen[2:-1] == [float(times()[step]) for step in steps]


def test_without_growth_states_are_equally_spaced(own_run: Path) -> None:
    (own_run / "events.csv").unlink()
    lines = (own_run / "history.csv").read_text(encoding="utf-8").splitlines()
    kept = "\n".join(lines[: GROWTH_STEP + 1]) + "\n"
    (own_run / "history.csv").write_text(kept, encoding="utf-8")
    run = read_run(own_run)
    assert growth_start(run) is None
    assert select_states(run, times()[:GROWTH_STEP], 3) == [0, 2, 4]


def test_a_short_step_after_growth_is_passed_over(own_run: Path) -> None:
    steps = [5.0 * HOUR] * (STEPS - 1) + [60.0]
    run = _rewritten(own_run, dt_s=steps)
    assert _chosen(run, 6)[-1] == times()[-2]
    assert last_settled(run, list(times())) == STEPS - 2
    # a short step without growth is a state like others
    lengths = [0.1 + 0.01 * min(step, STEPS - 2) for step in range(STEPS)]
    run = _rewritten(own_run, fracture_length_m=lengths)
    assert _chosen(run, 6)[-1] == times()[-1]


def test_the_highest_well_pressure_is_among_them(own_run: Path) -> None:
    for peak in range(1, STEPS - 1):
        pressures = [7.0e6 + 1.0e6 * (step == peak) for step in range(STEPS)]
        run = _rewritten(own_run, well_pressure_pa=pressures)
        chosen = select_states(run, times(), 6)
        assert peak in chosen
        assert len(chosen) == 6


def test_as_many_states_as_there_are(dry_run: Path) -> None:
    run = read_run(dry_run)
    for count in range(2, STEPS + 3):
        assert len(select_states(run, times(), count)) == min(count, STEPS)


def test_states_since_growth(dry_run: Path) -> None:
    run = read_run(dry_run)
    chosen = select_states(run, times(), 6, since_growth=True)
    assert chosen[0] == GROWTH_STEP - 1
    assert len(chosen) == 6
    # growth in the last written state only: the ones just before it, not the first ones
    written = times()[:GROWTH_STEP]
    assert select_states(run, written, 3, since_growth=True) == [2, 3, 4]


def test_states_that_share_a_moment_keep_their_order(own_run: Path) -> None:
    moments = np.minimum(times(), times()[6])  # from the seventh on all at one load
    run = _rewritten(own_run, time_s=list(moments))
    assert select_states(run, moments, STEPS) == list(range(STEPS))
    chosen = select_states(run, moments, 6)
    assert chosen[-1] == STEPS - 1
    assert len(chosen) == 6


def test_rows_that_the_files_tell_are_taken(own_run: Path) -> None:
    """Of many states of one load only the first ones are written, and the last."""
    run = _rewritten(own_run, time_s=[*times()[:4], *[times()[3]] * (STEPS - 4)])
    written = [*times()[:5], times()[3]]
    rows = [0, 1, 2, 3, 4, STEPS - 1]
    assert select_states(run, written, 6, rows=rows) == [0, 1, 2, 3, 4, 5]
    assert select_states(run, written, 2, rows=rows)[-1] == 5
    assert list(_history_rows(run, np.array(written), rows)) == rows


def test_short_steps_are_not_settled(own_run: Path) -> None:
    steps = [HOUR] * STEPS
    steps[GROWTH_STEP] = 0.01 * HOUR
    run = _rewritten(own_run, dt_s=steps)
    settled = list(settled_rows(run))
    assert settled == [row for row in range(STEPS) if row != GROWTH_STEP]
