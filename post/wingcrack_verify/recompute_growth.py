"""Judge the growth of a run with a fluid by its files alone (docs/verification.md, Stability).

The network is measured independently: lengths, joints where its polylines meet, ends. The values of
the tips are compared with the toughness and with the events, and stated errors are required.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any, TypeAlias

import f90nml
import numpy as np
import numpy.typing as npt

from wingcrack.figures.text_files import read_json
from wingcrack_verify import recompute
from wingcrack_verify.recompute import Findings, groups, load_of
from wingcrack_verify.recompute_files import Table, read_table

Points: TypeAlias = npt.NDArray[np.float64]

# What fluid and growth, which take turns, may leave (docs/limits.md).
K_EXCESS = 1.02
LEAST_SCALE = 0.01  # of K_eq, over the intensity that the loads may bring about (docs/theory.md)
K_LIMIT = "K_eq over K_IC after growth"
# Places are equal, and a piece has a length, within this share of the body.
PLACE = 1e-9
# A time of an event is that of its state within this share: both have all their digits.
TIME = 1e-12


@dataclass(frozen=True)
class GrowthFiles:
    """What the files of a run tell of growth."""

    scene: Any
    record: dict[str, Any]
    network: dict[str, Any]
    history: Table
    tips: Table
    events: Table


def judge_growth(folder: Path) -> Findings:
    """Judge the growth of a run."""
    findings = Findings()
    files = GrowthFiles(
        f90nml.read(folder / "scene.nml"),
        read_json(folder / "run.json"),
        read_json(folder / "network.json"),
        read_table(folder / "history.csv"),
        read_table(folder / "tips.csv"),
        read_table(folder / "events.csv"),
    )
    if not len(files.history["time_s"]):
        return findings
    domain = files.scene["domain"]
    place = PLACE * max(domain["x_max"] - domain["x_min"], domain["y_max"] - domain["y_min"])
    check_end(files, findings)
    check_times(files, findings)
    check_lengths(files, place, findings)
    check_joints(files, place, findings)
    check_tips(files, findings)
    check_stated_errors(files, findings)
    return findings


def check_end(files: GrowthFiles, findings: Findings) -> None:
    """A run says how and why it ended, in one sentence that a number did not spoil."""
    reason = str(files.record["reason"])
    if files.record["status"] not in ("finished", "failed") or not reason.strip():
        findings.wrong.append(f"run.json: status {files.record['status']!r}, reason {reason!r}")
    if any(word in reason for word in ("NaN", "Infinity", "not a number", "***")):
        findings.wrong.append(f"the reason is no cause: {reason}")


def check_times(files: GrowthFiles, findings: Findings) -> None:
    """Time goes on from state to state, and ends where run.json says that it does."""
    if (np.diff(files.history["time_s"]) <= 0.0).any():
        findings.wrong.append("time_s of history.csv does not rise")
    if files.record["reason"] == "the scene's end time":
        end = files.scene["time"]["end"]
        late = abs(float(files.history["time_s"][-1]) - end) / end
        findings.see("end of the run", late, "", PLACE)


def length_of(fracture: dict[str, Any]) -> float:
    """Length of a fracture of network.json [m]."""
    return float(np.hypot(np.diff(fracture["x_m"]), np.diff(fracture["y_m"])).sum())


def check_lengths(files: GrowthFiles, place: float, findings: Findings) -> None:
    """Fractures never become shorter, and their lengths are those of their polylines."""
    steps = files.network["steps"]
    for step in (*steps, files.network):
        for fracture in step["fractures"]:
            error = abs(length_of(fracture) - fracture["length_m"])
            findings.see("length of a polyline over its bound", error / place, "", 1.0)
    for before, after in pairwise(steps):
        for old, new in zip(before["fractures"], after["fractures"], strict=True):
            if length_of(new) < length_of(old) - place:
                shorter = length_of(old) - length_of(new)
                findings.wrong.append(
                    f"fracture {old['name']} is {shorter:.3g} m shorter at {after['time_s']:g} s"
                )
    if (np.diff(files.history["fracture_length_m"]) < -place).any():
        findings.wrong.append("fracture_length_m of history.csv falls")
    told = float(files.history["fracture_length_m"][-1])
    total = sum(length_of(fracture) for fracture in files.network["fractures"])
    if told > total + place:
        findings.wrong.append(f"history.csv ends with {told:.6g} m of {total:.6g} m")


def check_joints(files: GrowthFiles, place: float, findings: Findings) -> None:
    """Where polylines meet is a joint, and joints are where polylines meet."""
    fractures, joints = files.network["fractures"], files.network["joints"]
    lines = [np.column_stack((item["x_m"], item["y_m"])) for item in fractures]
    known = np.array([[joint["x_m"], joint["y_m"]] for joint in joints]).reshape(-1, 2)
    for joint, point in zip(joints, known, strict=True):
        for number in joint["fractures"]:
            gap = distance(point, lines[number - 1])
            findings.see("joint away from its fracture", gap / place, "[places]", 1e3)
        if joint["kind"] != "boundary" and len(joint["fractures"]) < 1:
            findings.wrong.append("a joint of no fracture")
    for one, other in combinations(range(len(lines)), 2):
        for point in crossings(lines[one], lines[other]):
            if not (np.hypot(*(known - point).T) <= 1e3 * place).any():
                at = f"({point[0]:.6g}, {point[1]:.6g}) m"
                findings.wrong.append(
                    f"{fractures[one]['name']} crosses {fractures[other]['name']} at {at} "
                    "without a joint"
                )


def distance(point: Points, line: Points) -> float:
    """Distance of a point from a polyline [m]."""
    start, along = line[:-1], np.diff(line, axis=0)
    share = ((point - start) * along).sum(axis=1) / (along**2).sum(axis=1)
    foot = start + np.clip(share, 0.0, 1.0)[:, None] * along
    return float(np.hypot(*(foot - point).T).min())


def crossings(one: Points, other: Points) -> list[Points]:
    """Points where two polylines cross, both with their inside."""
    found = []
    for a, b in pairwise(one):
        for c, d in pairwise(other):
            first, second, gap = b - a, d - c, c - a
            area = first[0] * second[1] - first[1] * second[0]
            if area == 0.0:
                continue
            s = (gap[0] * second[1] - gap[1] * second[0]) / area
            t = (gap[0] * first[1] - gap[1] * first[0]) / area
            inside = 1e-6  # ends that touch are joints of ends: where they lie is rounded
            if inside < s < 1.0 - inside and inside < t < 1.0 - inside:
                found.append(a + s * first)
    return found


def check_tips(files: GrowthFiles, findings: Findings) -> None:
    """No tip is left above the toughness, but where growth is unstable and is called so.

    Growth of a state at constant time is reported with it or, at the start, with the next one.
    """
    tips, toughness = files.tips, files.scene["material"]["toughness"]
    if "keq_pa_sqrtm" not in tips:
        findings.wrong.append("tips.csv has no K_eq")
        return
    for name, values in tips.items():
        if values.dtype.kind != "f" or not np.isfinite(values).all():
            findings.wrong.append(f"{name} of tips.csv is no number")
    share = tips["keq_pa_sqrtm"] / toughness
    load = max(load_of(files.scene), abs(files.scene["initial"]["pressure"]))
    lengths = np.array([recompute.length_of(drawn) for drawn in groups(files.scene, "fracture")])
    by_load = LEAST_SCALE * load * np.sqrt(math.pi * lengths / 2.0)
    scale = np.maximum(1.0, by_load[tips["fracture"].astype(int) - 1] / toughness)
    excess = (share - 1.0) / scale
    named = times_of(files.events, "unstable_growth")
    told = any(str(text).startswith(K_LIMIT) for text in files.record["warnings"])
    stopped = files.record["status"] == "failed"
    last = float(files.history["time_s"][-1])
    for k in np.flatnonzero(excess > K_EXCESS - 1.0):
        time = float(tips["time_s"][k])
        later = files.history["time_s"][files.history["time_s"] > time]
        until = float(later[0]) if len(later) else time
        if ((named >= time * (1.0 - TIME)) & (named <= until * (1.0 + TIME))).any():
            continue
        if told or (stopped and time >= last):
            continue
        findings.wrong.append(
            f"K_eq {share[k]:.4g} K_IC of tip {int(tips['tip'][k])} at {time:g} s is not called "
            "unstable"
        )
    findings.worst["K_eq/K_IC"] = float(share.max(initial=0.0))
    largest = float(files.record.get("keq_over_kic", 0.0))
    if abs(largest - share.max(initial=0.0)) > 1e-9 * max(1.0, largest):
        findings.wrong.append(f"keq_over_kic {largest:.6g} is {share.max():.6g} in tips.csv")


def times_of(events: Table, kind: str) -> Points:
    """Times of the events of a kind [s]."""
    if not len(events["time_s"]):
        return np.zeros(0)
    times: Points = events["time_s"][events["kind"] == kind].astype(float)
    return times


def check_stated_errors(files: GrowthFiles, findings: Findings) -> None:
    """Each K, the length and the pressure of the well have an error that could be theirs."""
    for name in ("fracture_length_error_m", "well_pressure_error_pa"):
        values = files.history.get(name)
        if values is None or not ((values >= 0.0) & np.isfinite(values)).all():
            findings.wrong.append(f"{name} is not stated")
    for name in ("k1_error_pa_sqrtm", "k2_error_pa_sqrtm"):
        values = files.tips.get(name)
        if values is None or not ((values >= 0.0) & np.isfinite(values)).all():
            findings.wrong.append(f"{name} is not stated")
            continue
        # A tip that is loaded has an error: none at all would be a claim that nobody can make.
        loaded = files.tips["keq_pa_sqrtm"] > 0.0
        both = files.tips["k1_error_pa_sqrtm"] + files.tips["k2_error_pa_sqrtm"]
        if (loaded & (both <= 0.0)).any():
            findings.wrong.append("a tip is loaded and has no error")
            return
