"""Sweeps of heat: small scenes with Peclet numbers of 1e-6 to 1e6, and what else may be stiff.

    .venv/bin/python verification/programs/heat_sweeps.py --folder /tmp/heat
    .venv/bin/python verification/programs/heat_sweeps.py --folder /tmp/heat --only 17 42

Each number is the seed of one scene (docs/sweeps.md). None may hang, nor end for a reason that is
one of the program's own; balances, bounds of temperature and warnings are read from the files.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

from well_sweeps import Draw, Site, Sweep, fracture, group, read

KINDS = ("through", "cold", "grows", "joints", "rock", "sides")
CAPACITY = 2.2e6  # of the rock [J/(m3 K)]
OF_FLUID = 4.2e6  # [J/(m3 K)]
DATUM = 400.0  # [K]


def scene_text(number: int) -> str:
    """The scene of a seed."""
    draw = Draw(number, seed=20261127)
    kind = KINDS[number % len(KINDS)]
    half = draw.power(-0.3, 2.0)
    least = draw.between(5e6, 40e6)
    pressure = least * draw.between(0.0, 0.6)
    conductivity = draw.power(-1.0, 1.3)
    # From seconds to years, or the time in which heat is conducted through a hundredth of the body.
    end = draw.power(1.0, 8.0)
    if draw.happens(0.5):
        end = 1e-4 * half**2 * CAPACITY / conductivity
    site = Site(half, end, pressure, least, [], rate=0.0)
    site.rate = draw.power(-6.0, 6.0) * conductivity / OF_FLUID
    if kind in ("grows", "cold"):
        # Of the fluid that fills a fracture as wide as a thousandth of the body.
        site.rate = min(site.rate, 1e-3 * half**2 / end)
    text = group("domain", x_min=-half, x_max=half, y_min=-half, y_max=half)
    text += group(
        "material",
        young=draw.power(9.7, 10.8),
        poisson=draw.between(0.0, 0.4),
        biot=draw.between(0.1, 1.0),
        porosity=draw.power(-3.0, -1.0),
        permeability=draw.power(-21.0, -13.0),
        heat_capacity=CAPACITY,
        heat_conductivity=conductivity,
        **({"heat_expansion": draw.power(-5.3, -4.0)} if draw.happens(0.7) else {}),
        **({"toughness": draw.power(5.5, 6.5)} if kind == "grows" else {}),
    )
    fluid: dict[str, float | list[float]] = {"heat_capacity": OF_FLUID}
    if draw.happens(0.4):
        fluid["heat_expansion"] = draw.power(-4.0, -3.0)
    if draw.happens(0.4):
        fluid["table_temperature"] = [200.0, DATUM, 600.0]
        fluid["viscosity_at"] = [2e-3, 3e-4, 1e-4]
    text += group("fluid", compressibility=draw.power(-10.0, -9.0), viscosity=3e-4, **fluid)
    text += group("in_situ", sxx=-least * draw.between(1.0, 2.0), syy=-least)
    text += group("initial", pressure=pressure)
    coldest = draw.between(1.0, 120.0)
    heat: dict[str, float | list[float]] = {"temperature": DATUM}
    if draw.happens(0.3):
        heat["temperature_per_y"] = -draw.between(0.0, 0.5) * coldest / half
        heat["y_datum"] = draw.between(-1.0, 1.0) * half
    if kind == "rock":
        heat |= {"source_x": [0.3 * half], "source_y": [0.4 * half]}
        heat["source_power"] = [conductivity * draw.between(-1.0, 1.0) * coldest]
    text += group("heat", **heat)
    text += sides(draw, site, kind, coldest)
    count = {"rock": 0, "joints": 2}.get(kind, 2 if draw.happens(0.2) else 1)
    lines = [fracture(draw, site, 0, count)] if count else []
    if count == 2:
        x, y, angle, length = site.fractures[0]
        angle += math.pi * draw.between(0.25, 0.5)
        dx, dy = 0.4 * length * math.cos(angle), 0.4 * length * math.sin(angle)
        ends = {"x": [x - dx, x + dx], "y": [y - dy, y + dy]}
        lines.append(group("fracture", name="f1", **ends, friction=0.6, aperture=1e-4))
    text += "".join(lines)
    if draw.happens(0.4):
        text += group(
            "region",
            name="other",
            shape="half_plane",
            x=[-half * draw.between(-0.5, 0.5), half * draw.between(-0.5, 0.5)],
            y=[-half, half],
            heat_conductivity=conductivity * draw.power(-3.0, 0.0),
            heat_capacity=CAPACITY * draw.power(-0.5, 0.5),
            permeability=draw.power(-20.0, -14.0),
        )
    text += wells(draw, site, kind, coldest)
    text += group("time", end=end, **({"step": end / 30} if draw.happens(0.3) else {}))
    size = 0.1 * min((length for *_, length in site.fractures), default=2.0 * half)
    text += group("coarse", size_fracture=size, size_boundary=half / 3.0)
    if kind == "grows":
        text += f"&growth enabled = .true., stop_gain = {2.0 * size!r} /\n"
    return text + "&output vtu = .false. /\n"


def sides(draw: Draw, site: Site, kind: str, coldest: float) -> str:
    """How the body is held, drained and cooled."""
    left: dict[str, float | str] = {"x_displacement": 0.0}
    right: dict[str, float | str] = {}
    if draw.happens(0.6) or kind in ("through", "rock"):
        left["pressure"] = site.pressure
        right["pressure"] = site.pressure
    if draw.happens(0.3) or kind == "sides":
        left["temperature"] = DATUM - coldest * draw.between(0.0, 1.0)
    if draw.happens(0.3):
        right["heat_flux"] = draw.between(-1.0, 1.0) * coldest / site.half
    if kind == "sides" and draw.happens(0.5):
        left["pressure"] = site.pressure * draw.between(0.5, 1.5)
        right["pressure"] = site.pressure
    text = group("side", name="left", **left)
    text += group("side", name="bottom", y_displacement=0.0)
    return text + (group("side", name="right", **right) if right else "")


def wells(draw: Draw, site: Site, kind: str, coldest: float) -> str:
    """A well that supplies cold fluid, perhaps in stages, and one that takes it."""
    if kind == "sides":
        return ""
    cold = DATUM - coldest
    if kind == "rock":
        return group(
            "injection",
            name="a",
            x=-0.4 * site.half,
            y=-0.5 * site.half,
            radius=1e-3 * site.half,
            rate=min(site.rate, 1e-6 * site.half**2),
            temperature=cold,
        )
    x, y, angle, length = site.fractures[0]
    places = [
        {"x": x + share * length * math.cos(angle), "y": y + share * length * math.sin(angle)}
        for share in (-0.45, 0.45)
    ]
    stages: dict[str, float | list[float]] = {"rate": site.rate, "temperature": cold}
    if draw.happens(0.3):
        stages = {
            "rate": [site.rate, 0.0, site.rate],
            "time": [0.0, 0.4 * site.end, 0.6 * site.end],
            "temperature": [cold, cold, DATUM],
        }
    text = group("injection", name="a", fracture="f0", **places[0], **stages)
    if kind == "through" or draw.happens(0.2):
        text += group(
            "injection",
            name="b",
            fracture="f0",
            **places[1],
            pressure=site.pressure,
            temperature=cold,
        )
    return text


def faults(out: Path, text: str) -> list[str]:
    """What is wrong with balances, temperatures and warnings."""
    found = []
    record = json.loads((out / "run.json").read_text())
    warnings = " ".join(str(warning) for warning in record["warnings"])
    history = read(out / "history.csv")
    for row in history:
        for key, value in row.items():
            if not math.isfinite(float(value)):
                found.append(f"{key} = {value} at {row['time_s']} s")
    error = max(float(row["heat_error_relative"]) for row in history)
    if error > 1e-10:
        found.append(f"heat is conserved to {error:.1e} only")
    error = max(float(row["mass_error_relative"]) for row in history)
    if error > 1e-7 and "mass" not in warnings:
        found.append(f"fluid is conserved to {error:.1e} only")
    if "source_power" in text or "heat_flux" in text:
        return found
    if float(record["heat_beyond_range_k"]) > 1.2 and "temperatures leave" not in warnings:
        found.append(f"temperatures leave their range by {record['heat_beyond_range_k']} K")
    return found


HEAT_SWEEP = Sweep("heat", KINDS, scene_text, faults, last=60)
sweep = HEAT_SWEEP.run

if __name__ == "__main__":
    sys.exit(HEAT_SWEEP.main(__doc__))
