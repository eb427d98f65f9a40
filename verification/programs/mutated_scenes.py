"""Mutated scene files: through `check` in one process, through the real program, and through runs.

    .venv/bin/python verification/programs/mutated_scenes.py check --count 2000000
    .venv/bin/python verification/programs/mutated_scenes.py processes --count 20000
    .venv/bin/python verification/programs/mutated_scenes.py runs --count 2000
    .venv/bin/python verification/programs/mutated_scenes.py checkpoints --count 20000

Each number stands for one mutated file of inputs/ (docs/sweeps.md). What is found wrong is told
with its number; `--first NUMBER --count 1` does it again.
"""

from __future__ import annotations

import argparse
import collections
import csv
import json
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import f90nml

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "post"))

from wingcrack.sweeps.scene import scene_text  # noqa: E402

BUILD = TOP / "build" / "release"
SOLVER = BUILD / "fortran" / "app" / "wingcrack-solver"
PROGRAM = BUILD / "verification" / "mutated_scenes"
LOADER = BUILD / "verification" / "mutated_checkpoints"
# Those that are whole by themselves: a table beside a scene does not go along when it is mutated.
SCENES = [
    path for path in sorted((TOP / "inputs").rglob("*.nml")) if "schedule" not in path.read_text()
]

CHUNK = 5000  # numbers to a process
CHUNK_LIMIT_S = 3600.0  # for one of them; the program has a limit for each file
CHECK_LIMIT_S = 20.0  # for one `check`
RUN_LIMIT_S = 10.0  # then a run is asked to stop
STOP_LIMIT_S = 30.0  # and then it must have stopped
MEMORY = 4 << 30  # of one run [byte]


@dataclass
class Tally:
    """Counts by outcome, and what is wrong, each with the number of its file."""

    counts: collections.Counter[str] = field(default_factory=collections.Counter)
    faults: list[str] = field(default_factory=list)

    def blame(self, number: int, what: str) -> None:
        """Add a fault and tell it at once."""
        self.faults.append(f"{number}: {what}")
        print(f"{number}: {what}", flush=True)


def check_in_process(first: int, count: int, scenes: list[Path]) -> Tally:
    """Judge mutated files by what `check` does, many to a process."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        number = first
        while number < first + count:
            last = min(number + CHUNK, first + count) - 1
            number = check_chunk(number, last, scenes, folder, tally)
            print(f"{number - first} files: {dict(tally.counts)}", flush=True)
    return tally


def check_chunk(first: int, last: int, scenes: list[Path], folder: Path, tally: Tally) -> int:
    """Judge mutated files in one process; gives the number to go on with."""
    done = subprocess.run(
        [PROGRAM, "check", str(first), str(last), *scenes],
        cwd=folder,
        capture_output=True,
        text=True,
        errors="replace",
        timeout=CHUNK_LIMIT_S,
        check=False,
    )
    words = done.stdout.replace(",", "").split()
    left = sorted(int(path.stem.split("-")[1]) for path in folder.glob("mutated-*.nml"))
    for path in folder.iterdir():
        path.unlink()
    if done.returncode in (0, 1) and "refused" in words:
        for what in ("refused", "accepted", "faults"):
            tally.counts[what] += int(words[words.index(what) - 1])
        for line in done.stderr.splitlines():
            if line.startswith("mutated-"):
                tally.blame(int(line.split("-")[1].split(".")[0]), line)
        return last + 1
    # The last file that stands there is the one that ended the process.
    culprit = left[-1] if left else first
    tally.blame(culprit, f"the process ended with status {done.returncode}: {done.stderr[-500:]}")
    tally.counts["crashed"] += 1
    if culprit > first:
        check_chunk(first, culprit - 1, scenes, folder, tally)
    return culprit + 1


def written(first: int, count: int, scenes: list[Path], folder: Path) -> Iterator[int]:
    """Write mutated files into the folder, some at a time, and take away those that are left."""
    for begin in range(first, first + count, 200):
        end = min(begin + 200, first + count)
        subprocess.run(
            [PROGRAM, "write", str(begin), str(end - 1), *scenes],
            cwd=folder,
            capture_output=True,
            check=False,
        )
        yield from range(begin, end)
        for path in folder.glob("*-*.nml"):
            path.unlink()


def sentence_fault(done: subprocess.CompletedProcess[str]) -> str:
    """Tell what is wrong with the last words of a program that did not succeed; nothing if good."""
    lines = done.stderr.splitlines()
    if len(lines) != 1 or not lines[0].startswith("wingcrack: "):
        return f"status {done.returncode}, and stderr is {done.stderr[-500:]!r}"
    return ""


def check_by_program(first: int, count: int, scenes: list[Path]) -> Tally:
    """Judge mutated files by the real program, a process for each."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in written(first, count, scenes, folder):
            path = f"mutated-{number}.nml"
            accepted = (folder / f"scene-{number}.nml").exists()
            try:
                done = call(folder, CHECK_LIMIT_S, "check", path)
            except subprocess.TimeoutExpired:
                tally.blame(number, "check hangs")
                continue
            tally.counts[f"status {done.returncode}"] += 1
            if done.returncode != (0 if accepted else 2):
                tally.blame(number, f"status {done.returncode}: {done.stderr[-500:]}")
            elif done.returncode == 0 and done.stderr:
                tally.blame(number, f"stderr has {done.stderr!r}")
            elif done.returncode == 2 and (done.stdout or sentence_fault(done)):
                tally.blame(number, f"{done.stdout!r}, {sentence_fault(done)}")
    return tally


def call(folder: Path, limit: float, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Call the real program."""
    return subprocess.run(
        [SOLVER, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        errors="replace",
        timeout=limit,
        check=False,
    )


def shortened(path: Path) -> str:
    """Text of a scene with coarser cells, few steps and little growth."""
    scene = f90nml.read(path)
    changes: dict[str, Any] = {"output.vtu": True, "output.checkpoint_states": 1}
    size = 0.1  # of the default sizes, which follow from the fractures [m]
    for level in ("coarse", "fe"):
        for name in ("size_fracture", "size_boundary"):
            if level in scene and name in scene[level]:
                changes[f"{level}.{name}"] = 2.0 * scene[level][name]
        size = scene.get(level, {}).get("size_fracture", size)
    if "time" in scene:
        step = scene["time"].get("step", 0.01 * scene["time"]["end"])
        changes["time.step"] = step
        changes["time.end"] = 3.0 * step
        changes["injection.1.start"] = step
        changes["injection.1.end"] = 2.0 * step
    elif "load" in scene:
        changes["load.steps"] = min(3, scene["load"].get("steps", 1))
    if scene.get("growth", {}).get("enabled", False):
        changes["growth.stop_gain"] = 1.5 * size
    return scene_text(path, changes, [])


def run_short(first: int, count: int, scenes: list[Path]) -> Tally:
    """Run mutated files of short scenes by the real program."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as name:
        short = []
        for path in scenes:
            short.append(Path(name) / f"{path.parent.name}_{path.name}")
            short[-1].write_text(shortened(path))
        folder = Path(name) / "runs"
        folder.mkdir()
        for number in written(first, count, short, folder):
            began = time.monotonic()
            outcome, fault = judge_run(folder, number)
            tally.counts[outcome] += 1
            if fault:
                tally.blame(number, f"{outcome}: {fault}")
            elif outcome != "status 2":
                print(f"{number}: {outcome}, {time.monotonic() - began:.1f} s", flush=True)
            shutil.rmtree(folder / "out", ignore_errors=True)
    return tally


def load_checkpoints(first: int, count: int, scenes: list[Path]) -> Tally:
    """Load mutated checkpoints of short scenes; every tenth one goes on by a state."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path in scenes:
            run = folder / f"{path.parent.name}_{path.stem}"
            (folder / "scene.nml").write_text(shortened(path))
            subprocess.run(
                [SOLVER, "run", "scene.nml", "--out", run, "--quiet"],
                cwd=folder,
                capture_output=True,
                check=False,
            )
            if (run / "checkpoint_old.bin").exists():
                (run / "checkpoint_old.bin").rename(run / "checkpoint.bin")
            else:
                shutil.rmtree(run, ignore_errors=True)
        runs = sorted(path for path in folder.iterdir() if path.is_dir())
        for begin in range(first, first + count, 1000):
            end = min(begin + 1000, first + count)
            done = subprocess.run(
                [LOADER, str(begin), str(end - 1), "10", *runs],
                cwd=folder,
                capture_output=True,
                text=True,
                errors="replace",
                check=False,
            )
            for line in done.stderr.splitlines():
                if line.startswith("fault "):
                    tally.blame(int(line.split()[1].rstrip(":")), line)
            for words in done.stdout.strip().split(", "):
                number, what = words.split(" ", 1)
                tally.counts[what] += int(number)
            print(f"{end - first} checkpoints: {dict(tally.counts)}", flush=True)
    return tally


def judge_run(folder: Path, number: int) -> tuple[str, str]:
    """Run a file; gives the outcome, and what is wrong or nothing."""
    done = run_limited(folder, f"mutated-{number}.nml")
    out = folder / "out"
    outcome = f"status {done.returncode}"
    if done.returncode not in (0, 1, 2, 130):
        return outcome, done.stderr[-500:]
    if done.returncode == 0 and (done.stdout or done.stderr):
        return outcome, f"says {done.stdout!r}, {done.stderr!r}"
    if done.returncode != 0 and sentence_fault(done):
        return outcome, sentence_fault(done)
    if done.returncode == 2:
        return outcome, "files were written" if out.exists() else ""
    if not (out / "scene.nml").exists():
        # Too little memory to begin, or a mesh that cannot be made.
        return f"{outcome}, nothing written", "" if done.returncode == 1 else "no scene.nml"
    return outcome, files_fault(folder, number, done)


def run_limited(folder: Path, path: str) -> subprocess.CompletedProcess[str]:
    """Run a scene with bounds on its memory and time; past the time, ask it to stop."""

    def bound() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    with subprocess.Popen(
        [SOLVER, "run", path, "--out", "out", "--quiet"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        preexec_fn=bound,
    ) as process:
        try:
            out, error = process.communicate(timeout=RUN_LIMIT_S)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
            try:
                out, error = process.communicate(timeout=STOP_LIMIT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                out, error = process.communicate()
                error += f"still at work after {RUN_LIMIT_S + STOP_LIMIT_S:g} s"
    return subprocess.CompletedProcess(process.args, process.returncode, out, error)


def without_sizes(text: str) -> str:
    """Leave out the line on default sizes: scene.nml gives the sizes that were chosen."""
    return "".join(line for line in text.splitlines(True) if not line.startswith("sizes:"))


def files_fault(folder: Path, number: int, done: subprocess.CompletedProcess[str]) -> str:
    """Tell what is wrong with the files of a run that began; nothing if good."""
    out = folder / "out"
    if (out / "scene.nml").read_bytes() != (folder / f"scene-{number}.nml").read_bytes():
        return "scene.nml is not the scene that was read"
    again = call(folder, CHECK_LIMIT_S, "check", "out/scene.nml")
    if again.returncode != 0:
        return f"scene.nml cannot be read: {again.stderr}"
    first = call(folder, CHECK_LIMIT_S, "check", f"mutated-{number}.nml")
    if without_sizes(again.stdout) != without_sizes(first.stdout):
        return "scene.nml is described in other words than the file itself"
    if list(out.rglob("*.part")):
        return "a file is not whole"
    record = json.loads((out / "run.json").read_text())
    if record["status"] != {0: "finished", 1: "failed", 130: "stopped"}[done.returncode]:
        return f"run.json says {record['status']}"
    if done.returncode == 1 and done.stderr.strip() != f"wingcrack: {record['reason']}":
        return f"run.json says {record['reason']}"
    for table in out.glob("*.csv"):
        for row in csv.reader(table.read_text().splitlines()):
            if any(item.lstrip("-") in ("nan", "inf") for item in row):
                return f"{table.name} has the row {','.join(row)}"
    return ""


def main() -> int:
    """Do what the command line asks for; 1 if anything is wrong."""
    how = {
        "check": check_in_process,
        "processes": check_by_program,
        "runs": run_short,
        "checkpoints": load_checkpoints,
    }
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("how", choices=how)
    parser.add_argument("--first", type=int, default=1, help="number of the first file")
    parser.add_argument("--count", type=int, default=2000, help="how many")
    arguments = parser.parse_args()
    tally = how[arguments.how](arguments.first, arguments.count, SCENES)
    kinds = collections.Counter(fault.split(": ")[-1][:60] for fault in tally.faults)
    print(f"{arguments.count} files: {dict(tally.counts)}")
    print(f"{len(tally.faults)} faults")
    for kind, n in kinds.most_common(20):
        print(f"  {n} x {kind}")
    return 1 if tally.faults else 0


if __name__ == "__main__":
    sys.exit(main())
