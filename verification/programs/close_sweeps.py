"""Sweeps of close fractures: small sets that nearly touch each other, under stress in situ.

    .venv/bin/python verification/programs/close_sweeps.py --folder /tmp/close
    .venv/bin/python verification/programs/close_sweeps.py --folder /tmp/close --only 17 42
    .venv/bin/python verification/programs/close_sweeps.py --first 1 --last 80 --solver OTHER

Each number is the seed of one scene (docs/sweeps.md). None may hang, nor end for a reason that is
one of the program's own.
"""

from __future__ import annotations

import math
import sys

from well_sweeps import Draw, Sweep, group

SEED = 3226
KINDS = ("parallel", "en_echelon", "nearly_t", "in_line", "fan")

Ends = tuple[float, float, float, float]  # x and y of the start, x and y of the end


def scene_text(number: int) -> str:
    """The scene of a seed."""
    draw = Draw(number, SEED)
    length = draw.power(-1.0, 1.0)
    half = length * draw.between(2.5, 6.0)
    syy = -draw.between(5e6, 60e6)
    sxx = syy * draw.power(-0.5, 0.5)
    least = min(-sxx, -syy)
    pressure = least * draw.between(0.0, 0.9)
    text = group("domain", x_min=-half, x_max=half, y_min=-half, y_max=half)
    text += group(
        "material",
        young=draw.power(9.7, 10.8),
        poisson=draw.between(0.0, 0.4),
        biot=draw.between(0.3, 1.0),
        porosity=draw.power(-2.5, -0.7),
        permeability=draw.power(-21.0, -14.0),
    )
    text += group(
        "fluid", compressibility=draw.power(-10.0, -9.0), viscosity=draw.power(-4.0, -3.0)
    )
    text += group("side", name="left", x_displacement=0.0)
    text += group("side", name="bottom", y_displacement=0.0)
    if draw.happens(0.6):
        shear = draw.between(-0.5, 0.5) * math.sqrt(sxx * syy)
        text += group("in_situ", sxx=sxx, syy=syy, sxy=shear)
        text += group("initial", pressure=pressure)
    else:
        text += group("side", name="right", x_traction=sxx)
        text += group("side", name="top", y_traction=syy)
        text += group("initial", pressure=0.3 * pressure)
    aperture = draw.power(-5.0, -3.5) * length
    count = 2 + number // len(KINDS) % 3
    for place, ends in enumerate(PLACES[KINDS[number % len(KINDS)]](draw, length, count)):
        text += group(
            "fracture",
            name=f"f{place}",
            x=[ends[0], ends[2]],
            y=[ends[1], ends[3]],
            friction=draw.between(0.3, 1.0),
            dilation_deg=draw.between(0.0, 10.0) if draw.happens(0.7) else 0.0,
            aperture=aperture,
        )
    end = draw.power(1.0, 5.0)
    if draw.happens(0.6):
        rate = length**2 * draw.power(-6.0, -3.5) / end * (-0.1 if draw.happens(0.2) else 1.0)
        text += group("injection", fracture="f0", rate=rate)
    text += group("time", end=end, **({"step": end / 3.0} if draw.happens(0.5) else {}))
    text += group("coarse", size_fracture=length / draw.power(0.6, 1.4), size_boundary=half / 3.0)
    return text + "&growth intensities = .false. /\n&output vtu = .false. /\n"


def gap_of(draw: Draw, length: float) -> float:
    """How far apart fractures of a length are."""
    return length * draw.power(-3.0, math.log10(3e-2))


def line(x: float, y: float, angle: float, length: float) -> Ends:
    """A fracture from a point in a direction."""
    return x, y, x + length * math.cos(angle), y + length * math.sin(angle)


def moved(x: float, y: float, angle: float, along: float, aside: float) -> tuple[float, float]:
    """A point along and to the left of a direction."""
    return (
        x + along * math.cos(angle) - aside * math.sin(angle),
        y + along * math.sin(angle) + aside * math.cos(angle),
    )


def parallel(draw: Draw, length: float, count: int) -> list[Ends]:
    """Side by side, each a little moved along the one before."""
    angle = draw.between(0.0, math.pi)
    x, y = moved(0.0, 0.0, angle, -0.5 * length, 0.0)
    found = []
    for _ in range(count):
        found.append(line(x, y, angle, length))
        along = length * draw.between(-0.1, 0.1) if draw.happens(0.7) else 0.0
        x, y = moved(x, y, angle, along, gap_of(draw, length))
    return found


def en_echelon(draw: Draw, length: float, count: int) -> list[Ends]:
    """Each begins beside the middle of the one before."""
    angle = draw.between(0.0, math.pi)
    x, y = moved(0.0, 0.0, angle, -0.5 * length, 0.0)
    found = []
    for _ in range(count):
        found.append(line(x, y, angle, length))
        along = length * draw.between(0.3, 0.95)
        x, y = moved(x, y, angle, along, gap_of(draw, length))
    return found


def nearly_t(draw: Draw, length: float, count: int) -> list[Ends]:
    """The others end just before the first."""
    angle = draw.between(0.0, math.pi)
    x, y = moved(0.0, 0.0, angle, -0.5 * length, 0.0)
    found = [line(x, y, angle, length)]
    for place in range(1, count):
        side = 1.0 if place % 2 else -1.0
        along = length * (draw.between(0.1, 0.45) + (0.45 if place > 2 else 0.0))
        at = moved(x, y, angle, along, side * gap_of(draw, length))
        away = angle + side * math.pi * draw.between(0.25, 0.75)
        found.append(line(*at, away, length * draw.between(0.4, 1.0)))
    return found


def in_line(draw: Draw, length: float, count: int) -> list[Ends]:
    """One after the other, tip to tip."""
    angle = draw.between(0.0, math.pi)
    x, y = moved(0.0, 0.0, angle, -0.5 * length * count, 0.0)
    found = []
    for _ in range(count):
        part = line(x, y, angle, length * draw.between(0.5, 1.0))
        found.append(part)
        angle += draw.between(-0.2, 0.2) if draw.happens(0.5) else 0.0
        x, y = moved(part[2], part[3], angle, gap_of(draw, length), 0.0)
    return found


def fan(draw: Draw, length: float, count: int) -> list[Ends]:
    """From tips close together in different directions."""
    angle = draw.between(0.0, math.pi)
    found = []
    for place in range(count):
        away = angle + 2.0 * math.pi * (place + draw.between(-0.2, 0.2)) / count
        at = moved(0.0, 0.0, away, gap_of(draw, length), 0.0)
        found.append(line(*at, away, length * draw.between(0.4, 1.0)))
    return found


PLACES = {
    "parallel": parallel,
    "en_echelon": en_echelon,
    "nearly_t": nearly_t,
    "in_line": in_line,
    "fan": fan,
}


CLOSE_SWEEP = Sweep("close", KINDS, scene_text, lambda out, text: [], last=100)
sweep = CLOSE_SWEEP.run

if __name__ == "__main__":
    sys.exit(CLOSE_SWEEP.main(__doc__))
