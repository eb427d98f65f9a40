"""Sweeps of wells: small scenes with wells of every kind beside what else a scene may have.

    .venv/bin/python verification/programs/well_sweeps.py --folder /tmp/wells
    .venv/bin/python verification/programs/well_sweeps.py --folder /tmp/wells --only 17 42
    .venv/bin/python verification/programs/well_sweeps.py --first 1 --last 60 --solver OTHER

Each number is the seed of one scene (docs/sweeps.md). None may hang, nor end for a reason that is
one of the program's own; what wells do is judged from wells.csv and history.csv.
"""

from __future__ import annotations

import argparse
import collections
import csv
import math
import re
import shutil
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fluid_sweeps import SOLVER, Verdict, call_solver

SEED = 20261125
RUN_LIMIT_S = 60.0
KINDS = ("rate", "pressure", "limit", "stages", "conflict", "rock")

# Reasons that say how the equations are solved, not what happens in the rock.
OWN_REASONS = re.compile(
    "did not converge|singular|NaN|not a number|no progress in time|no combination of well controls"
    "|contact law is violated|no initial equilibrium|time error|reaches or leaves its limit|Euler"
    "|no finite number"
)


class Draw:
    """What chance gives a scene."""

    def __init__(self, number: int, seed: int = SEED) -> None:
        self._random = np.random.default_rng([seed, number])

    def between(self, low: float, high: float) -> float:
        """A number between two."""
        return float(self._random.uniform(low, high))

    def power(self, low: float, high: float) -> float:
        """10 to a power between low and high."""
        return float(10.0 ** self._random.uniform(low, high))

    def happens(self, share: float) -> bool:
        """Whether something of a probability happens."""
        return float(self._random.random()) < share

    def one_of(self, *choices: str) -> str:
        """One of some words."""
        return choices[int(self._random.integers(len(choices)))]


@dataclass
class Site:
    """What wells have to know of their scene."""

    half: float  # the body's side [m]
    end: float  # [s]
    pressure: float  # in the rock [Pa]
    least: float  # compression [Pa]
    fractures: list[tuple[float, float, float, float]]  # x and y of the middle, direction, length
    rate: float  # [m2/s]


def group(title: str, /, **values: float | str | list[float]) -> str:
    """A group of a scene file."""
    words = []
    for key, value in values.items():
        if isinstance(value, str):
            words.append(f"{key} = '{value}'")
        else:
            numbers = value if isinstance(value, list) else [value]
            words.append(f"{key} = {', '.join(repr(float(number)) for number in numbers)}")
    return f"&{title} {', '.join(words)} /\n"


def scene_text(number: int) -> str:
    """The scene of a seed."""
    draw = Draw(number)
    half = draw.power(0.0, 2.0)
    syy = -draw.between(15e6, 60e6)
    sxx = syy * draw.between(0.4, 1.6)
    least = min(-sxx, -syy)
    site = Site(
        half=half,
        end=draw.power(1.0, 6.0),
        pressure=least * draw.between(0.0, 0.7),
        least=least,
        fractures=[],
        rate=half**2 * draw.power(-10.0, -6.3),
    )
    kind = KINDS[number % len(KINDS)]
    grows = draw.happens(0.1) and kind != "rock"
    damping = draw.between(1e6, 6e6) if draw.happens(0.4) and not grows else 0.0
    text = group("domain", x_min=-half, x_max=half, y_min=-half, y_max=half)
    text += group(
        "material",
        young=draw.power(9.7, 10.8),
        poisson=draw.between(0.0, 0.4),
        biot=draw.between(0.3, 1.0),
        porosity=draw.power(-3.0, -0.7),
        permeability=draw.power(-22.0, -13.0),
        radiation_damping=damping,
        **({"toughness": draw.power(5.5, 6.5)} if grows else {}),
    )
    text += group(
        "fluid", compressibility=draw.power(-10.5, -9.0), viscosity=draw.power(-4.0, -2.5)
    )
    text += group("in_situ", sxx=sxx, syy=syy, sxy=draw.between(-0.2, 0.2) * least)
    text += group("initial", pressure=site.pressure)
    text += sides(draw, site)
    count = 0 if kind == "rock" and draw.happens(0.5) else (2 if draw.happens(0.4) else 1)
    text += "".join(fracture(draw, site, place, count) for place in range(count))
    if draw.happens(0.25):
        text += group(
            "region",
            name="other",
            shape="half_plane",
            x=[-half * draw.between(-0.5, 0.5), half * draw.between(-0.5, 0.5)],
            y=[-half, half],
            permeability=draw.power(-20.0, -14.0),
            young=draw.power(9.7, 10.8),
        )
    text += WELLS[kind](draw, site)
    text += group("time", end=site.end, **({"step": site.end / 40} if draw.happens(0.15) else {}))
    longest = max((length for *_, length in site.fractures), default=0.0)
    if count:
        shortest = min(length for *_, length in site.fractures)
        text += group("coarse", size_fracture=shortest / 10.0, size_boundary=half / 3.0)
    else:
        text += group("coarse", size_boundary=half / 5.0)
    if grows:
        text += f"&growth enabled = .true., stop_gain = {0.1 * longest!r} /\n"
        text += group("fine", window=0.4 * longest)
    return text + "&output vtu = .false. /\n"


def sides(draw: Draw, site: Site) -> str:
    """How the body is held, where it is drained, and what changes there in time."""
    left: dict[str, float | list[float]] = {"x_displacement": 0.0}
    right: dict[str, float | list[float]] = {}
    if draw.happens(0.5):
        left["pressure"] = site.pressure
        right["pressure"] = site.pressure
    if draw.happens(0.2):
        right["time"] = [0.0, draw.between(0.1, 0.9) * site.end]
        if draw.happens(0.5):
            right["pressure"] = [site.pressure, site.pressure * draw.between(0.5, 1.3)]
        else:
            right["x_traction"] = [0.0, site.least * draw.between(-0.2, 0.1)]
    text = group("side", name="left", **left)
    text += group("side", name="bottom", y_displacement=0.0)
    return text + (group("side", name="right", **right) if right else "")


def fracture(draw: Draw, site: Site, place: int, count: int) -> str:
    """A fracture in its part of the body, or across the one before."""
    length = site.half * draw.between(0.2, 0.6)
    angle = math.pi * draw.between(0.0, 1.0)
    x = site.half * (0.0 if count == 1 else 0.45 * (2 * place - 1)) * draw.between(0.8, 1.0)
    y = site.half * draw.between(-0.2, 0.2)
    if place and draw.happens(0.4):
        x, y, before, _ = site.fractures[0]
        angle = before + math.pi * draw.between(0.25, 0.5)
    dx, dy = 0.5 * length * math.cos(angle), 0.5 * length * math.sin(angle)
    site.fractures.append((x, y, angle, length))
    aperture = draw.power(-5.0, -3.3)
    friction = draw.between(0.2, 0.8)
    more: dict[str, float] = {}
    manner = draw.one_of("plain", "plain", "weakening", "bonds", "closure", "dilation")
    if manner in ("weakening", "bonds"):
        more["friction_residual"] = friction * draw.between(0.3, 0.95)
        more["weakening_slip"] = draw.power(-5.0, -2.5)
    if manner == "bonds":
        more["cohesion"] = draw.power(5.5, 6.7)
        more["tensile_strength"] = more["cohesion"] * draw.between(0.3, 1.0)
        more["opening_weakening"] = draw.power(-5.0, -3.5)
    if manner == "closure":
        more["closure"] = aperture * draw.between(0.1, 0.8)
        more["normal_stiffness"] = draw.power(9.0, 12.0)
    if manner == "dilation":
        more["dilation_deg"] = draw.between(1.0, 8.0)
        more["dilation_slip"] = draw.power(-3.0, -2.0)
    if draw.happens(0.2):
        more["skin"] = draw.power(9.0, 13.0)
    ends = {"x": [x - dx, x + dx], "y": [y - dy, y + dy]}
    return group("fracture", name=f"f{place}", **ends, friction=friction, aperture=aperture, **more)


def where(draw: Draw, site: Site, share: float | None = None) -> dict[str, float | str]:
    """A fracture that a well feeds, perhaps at a point of it."""
    x, y, angle, length = site.fractures[0]
    if share is None and draw.happens(0.4):
        return {"fracture": "f0"}
    along = length * (draw.between(-0.45, 0.45) if share is None else share)
    return {"fracture": "f0", "x": x + along * math.cos(angle), "y": y + along * math.sin(angle)}


def loss(draw: Draw, site: Site) -> dict[str, float]:
    """What a well holds and loses."""
    more: dict[str, float] = {}
    if draw.happens(0.25):
        more["storage"] = site.half**2 * draw.power(-14.0, -11.0)
    if draw.happens(0.25):
        more["friction"] = 1e6 * draw.power(-1.0, 1.0) / site.rate
    return more


def limit(draw: Draw, site: Site, rate: float) -> float:
    """A pressure that bounds a rate, on the right or on the wrong side of that in the rock."""
    if rate > 0.0:
        return max(0.0, site.pressure + draw.between(-0.3, 1.1) * (site.least - site.pressure))
    return site.pressure * draw.between(0.1, 1.2)


def time_of(draw: Draw, site: Site) -> dict[str, float]:
    """When a well begins and ends."""
    when: dict[str, float] = {}
    if draw.happens(0.3):
        when["start"] = site.end * draw.between(0.01, 0.3)
    if draw.happens(0.3):
        when["end"] = site.end * draw.between(0.4, 0.9)
    return when


def some_rate(draw: Draw, site: Site) -> float:
    """A rate, a fifth of them of extraction."""
    return site.rate * draw.between(0.2, 1.0) * (-0.1 if draw.happens(0.2) else 1.0)


def by_rate(draw: Draw, site: Site) -> str:
    """A well at a rate."""
    return group(
        "injection",
        name="a",
        **where(draw, site),
        rate=some_rate(draw, site),
        **loss(draw, site),
        **time_of(draw, site),
    )


def by_pressure(draw: Draw, site: Site) -> str:
    """A well at a pressure."""
    return group(
        "injection",
        name="a",
        **where(draw, site),
        pressure=limit(draw, site, 1.0),
        **loss(draw, site),
        **time_of(draw, site),
    )


def by_limit(draw: Draw, site: Site) -> str:
    """A well at a rate up to a pressure."""
    rate = some_rate(draw, site)
    return group(
        "injection",
        name="a",
        **where(draw, site),
        rate=rate,
        pressure=limit(draw, site, rate),
        **loss(draw, site),
        **time_of(draw, site),
    )


def by_stages(draw: Draw, site: Site) -> str:
    """A well with four stages."""
    rates, pressures, times = [], [], []
    for stage in range(4):
        rate = 0.0 if draw.happens(0.2) else some_rate(draw, site)
        rates.append(rate)
        pressures.append(limit(draw, site, rate))
        times.append(site.end * (stage + draw.between(0.0, 0.5)) / 4.0)
    more = {"pressure": pressures} if draw.happens(0.7) else {}
    return group(
        "injection",
        name="a",
        **where(draw, site),
        rate=rates,
        **more,
        time=times,
        **loss(draw, site),
    )


def by_conflict(draw: Draw, site: Site) -> str:
    """Two or three wells in one fracture that want different things."""
    places = [where(draw, site, share) for share in (-0.35, 0.35, 0.0)]
    return wells_at(draw, site, places[: 3 if draw.happens(0.3) else 2])


def by_rock(draw: Draw, site: Site) -> str:
    """One or three wells in the rock."""
    radius = 1e-3 * site.half
    places: list[dict[str, float | str]] = [
        {"x": site.half * x, "y": site.half * 0.8, "radius": radius} for x in (-0.5, 0.0, 0.5)
    ]
    return wells_at(draw, site, places[: 3 if draw.happens(0.5) else 1])


def wells_at(draw: Draw, site: Site, places: list[dict[str, float | str]]) -> str:
    """A well at each place: at a rate, at a pressure or at a rate up to a pressure."""
    text = ""
    for name, place in zip("abc", places, strict=False):
        manner = draw.one_of("rate", "pressure", "limit", "limit")
        rate = some_rate(draw, site)
        asked = {} if manner == "pressure" else {"rate": rate}
        if manner != "rate":
            asked["pressure"] = limit(draw, site, rate)
        more = {**loss(draw, site), **time_of(draw, site)}
        text += group("injection", name=name, **place, **asked, **more)
    return text


WELLS = {
    "rate": by_rate,
    "pressure": by_pressure,
    "limit": by_limit,
    "stages": by_stages,
    "conflict": by_conflict,
    "rock": by_rock,
}


def read(path: Path) -> list[dict[str, str]]:
    """The rows of a table."""
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def faults(out: Path, text: str) -> list[str]:
    """What is wrong with what the wells have done."""
    found = []
    history = read(out / "history.csv")
    taken: dict[str, float] = {}
    stored = "storage" in text
    for row in read(out / "wells.csv"):
        time_s, rate = row["time_s"], float(row["rate_m2_s"])
        taken[time_s] = taken.get(time_s, 0.0) + float(row["injected_m2"])
        if row["control"] not in ("rate", "limit", "pressure", "shut"):
            found.append(f"control is '{row['control']}'")
        asked = float(row.get("asked_m2_s") or rate)
        if row["control"] in ("rate", "limit") and not stored:
            share = rate / asked if asked else 0.0
            if not -1e-6 <= share <= 1.0 + 1e-6:
                found.append(f"at {time_s} s {rate} m2/s of {asked}")
    scale = max((abs(value) for value in taken.values()), default=0.0)
    for row in history:
        sum_of_wells = taken.get(row["time_s"], 0.0)
        if not stored and abs(float(row["injected_m2"]) - sum_of_wells) > 1e-11 * scale:
            found.append(f"at {row['time_s']} s injected_m2 is not the sum of the wells'")
        if 0.0 < abs(float(row["max_opening_m"])) < 1e-25:
            found.append(f"an opening of {row['max_opening_m']} m")
    return found


@dataclass(frozen=True)
class Sweep:
    """Scenes by their seeds, of some kinds in turn; `faults` names what is wrong in the files."""

    name: str
    kinds: tuple[str, ...]
    scene_text: Callable[[int], str]
    faults: Callable[[Path, str], list[str]]
    last: int  # seed of a whole sweep

    def run(
        self, folder: Path, numbers: list[int], solver: Path = SOLVER, limit_s: float = RUN_LIMIT_S
    ) -> collections.Counter[str]:
        """Run scenes, print each verdict, and keep the files of those that are wrong."""
        tally: collections.Counter[str] = collections.Counter()
        reasons: collections.Counter[str] = collections.Counter()
        for number in numbers:
            place = folder / f"{self.name}_{number:03d}"
            place.mkdir(parents=True, exist_ok=True)
            kind = self.kinds[number % len(self.kinds)]
            verdict = self._run_scene(place, number, solver, limit_s)
            tally[verdict.word] += 1
            detail = verdict.detail if verdict.word in ("WRONG", "stopped") else ""
            reasons[f"{kind}: {verdict.word} {without_numbers(detail)}"] += 1
            print(
                f"{number} {kind}: {verdict.word} ({verdict.seconds:.1f} s) {verdict.detail}",
                flush=True,
            )
            if verdict.word != "WRONG" and len(numbers) > 1:
                shutil.rmtree(place)
        for reason, count in reasons.most_common():
            print(f"{count} {reason}")
        return tally

    def _run_scene(self, folder: Path, number: int, solver: Path, limit_s: float) -> Verdict:
        """Run a scene and judge it."""
        text = self.scene_text(number)
        (folder / "scene.nml").write_text(text)
        verdict, reason, seconds = call_solver(folder, solver, limit_s)
        if verdict is not None:
            return verdict
        wrong = self.faults(folder / "out", text)
        if wrong:
            return Verdict("WRONG", f"{wrong[0]} ({len(wrong)} faults)", seconds)
        if reason:
            return Verdict("WRONG" if OWN_REASONS.search(reason) else "stopped", reason, seconds)
        return Verdict("right", f"{len(read(folder / 'out/history.csv')) - 1} steps", seconds)

    def main(self, description: str) -> int:
        """Do what the command line asks for; 1 if a run is wrong."""
        parser = argparse.ArgumentParser(description=description.splitlines()[0])
        parser.add_argument("--first", type=int, default=1, help="the first seed")
        parser.add_argument("--last", type=int, default=self.last, help="the last seed")
        parser.add_argument("--only", type=int, nargs="+", default=[], help="some seeds")
        parser.add_argument("--solver", type=Path, default=SOLVER, help="another program")
        parser.add_argument("--limit", type=float, default=RUN_LIMIT_S, help="seconds for each")
        parser.add_argument("--folder", type=Path, help="where runs are kept that are wrong")
        arguments = parser.parse_args()
        folder = arguments.folder or Path(tempfile.mkdtemp(prefix=self.name))
        numbers = arguments.only or list(range(arguments.first, arguments.last + 1))
        tally = self.run(folder, numbers, arguments.solver.resolve(), arguments.limit)
        print(f"{sum(tally.values())} runs: {dict(tally)}; those that are wrong are in {folder}")
        return 1 if tally["WRONG"] else 0


def without_numbers(reason: str) -> str:
    """A reason without its numbers and names, for the tally."""
    return re.sub(r"-?\d+\.?\d*(E[+-]?\d+)?|f\d", "#", reason.split("; ")[0])[-150:]


WELL_SWEEP = Sweep("well", KINDS, scene_text, faults, last=300)
sweep = WELL_SWEEP.run

if __name__ == "__main__":
    sys.exit(WELL_SWEEP.main(__doc__))
