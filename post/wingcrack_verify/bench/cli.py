"""`wingcrack bench`: measurements of speed, compared with stored ones."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace

from wingcrack.errors import CaseError, EnvironmentLacksError
from wingcrack.figures.text_files import write_whole
from wingcrack_verify.bench.catalogue import TOP, Benchmark, read_benchmarks
from wingcrack_verify.bench.measure import Measurement, RunFailedError, count, measure
from wingcrack_verify.bench.table import (
    MOST_CPU,
    MOST_INSTRUCTIONS,
    Baseline,
    Exponent,
    as_growth,
    as_json,
    as_phases,
    as_table,
    differences,
    exponents,
    instructions_ratio,
    made_with,
    read_baseline,
    store,
)
from wingcrack_verify.environment import machine, revision


def bench(given: SimpleNamespace) -> int:
    """Do what is asked for; give the exit status."""
    known, kinds = read_benchmarks()
    measured: list[Measurement] = []
    failed: list[str] = []
    try:
        for name in given.names:
            try:
                measured.append(_measured(known[name], given))
            except (RunFailedError, CaseError) as reason:
                print(f"wingcrack bench: {reason}", file=sys.stderr)
                failed.append(name)
        if measured:
            measured = _counted(measured, known, given)
    except KeyboardInterrupt:
        print("wingcrack bench: interrupted; nothing was written", file=sys.stderr)
        return 130
    if not measured:
        return 1
    here = made_with(given.solver)
    stored = read_baseline(given.baseline)
    found = exponents(kinds, {m.name: m for m in measured})
    _tell(measured, stored, found)
    _write(measured, stored, found, here, given.out)
    status = (
        _store(measured, here, given.baseline) if given.store else _judge(measured, stored, here)
    )
    if failed:
        print(f"wingcrack bench: failed: {', '.join(failed)}", file=sys.stderr)
        return 1
    return status


def _measured(benchmark: Benchmark, given: SimpleNamespace) -> Measurement:
    """Run a scene as often as is asked for."""
    print(f"measuring {benchmark.name}: {benchmark.title}", file=sys.stderr)
    repetitions = 1 if given.quick and given.against is None else given.repeat
    return measure(benchmark, given.solver, repetitions, given.against)


def _counted(
    measured: Sequence[Measurement], known: Mapping[str, Benchmark], given: SimpleNamespace
) -> list[Measurement]:
    """Count instructions where that is asked for; several at a time, as they do not mind."""
    insists = given.instructions or given.store
    if not (insists or (given.quick and given.against is None)):
        return list(measured)
    print("counting instructions", file=sys.stderr)

    def one(measurement: Measurement) -> Measurement:
        try:
            found, why_not = count(known[measurement.name], given.solver)
        except EnvironmentLacksError as reason:
            if insists:
                raise
            found, why_not = None, str(reason)
        return replace(measurement, instructions=found, why_not_counted=why_not)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, measured))


def _tell(measured: Sequence[Measurement], stored: Baseline, found: Sequence[Exponent]) -> None:
    print(as_table(measured, stored))
    print(f"\n{as_phases(measured)}")
    if found:
        print(f"\n{as_growth(found)}")
    for measurement in measured:
        if measurement.why_not_counted:
            print(f"{measurement.name}: no instructions: {measurement.why_not_counted}")


def _write(
    measured: Sequence[Measurement],
    stored: Baseline,
    found: Sequence[Exponent],
    here: dict[str, str],
    out: Path,
) -> None:
    out.mkdir(parents=True, exist_ok=True)
    record = {
        "revision": revision(TOP),
        "machine": machine(),
        "made_with": here,
        "measurements": as_json(measured, stored),
        "growth": [asdict(exponent) for exponent in found],
    }
    write_whole(out / "bench.json", json.dumps(record, indent=2) + "\n")


def _store(measured: Sequence[Measurement], here: dict[str, str], path: Path) -> int:
    counts = {m.name: m.instructions for m in measured if m.instructions is not None}
    if len(counts) < len(measured):
        print("wingcrack bench: nothing was stored: not all could be counted", file=sys.stderr)
        return 1
    store(path, Baseline(here, counts))
    print(f"stored the counts of {', '.join(counts)} in {path}")
    return 0


def _judge(measured: Sequence[Measurement], stored: Baseline, here: dict[str, str]) -> int:
    """Find what has become slower; say so in the last line, and give the exit status."""
    losses = [
        f"{m.name} takes {m.ratio:.2f} times the CPU time of the other program"
        for m in measured
        if m.ratio is not None and m.ratio > MOST_CPU
    ]
    counted = {m.name: instructions_ratio(m, stored) for m in measured}
    ratios = {name: ratio for name, ratio in counted.items() if ratio is not None}
    differing = differences(stored.made_with, here)
    if ratios and differing:
        print(
            "instructions are not judged: the stored counts were made with other"
            f" {'; '.join(differing)}"
        )
    elif ratios:
        losses += [
            f"{name} takes {ratio:.3f} times the stored instructions"
            for name, ratio in ratios.items()
            if ratio > MOST_INSTRUCTIONS
        ]
        print(f"instructions are judged for {', '.join(ratios)}")
    if losses:
        print(f"wingcrack bench: a loss: {'; '.join(losses)}", file=sys.stderr)
        return 1
    return 0
