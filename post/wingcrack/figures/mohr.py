"""What a scene states before a run: its stresses as a table, JSON and a Mohr diagram."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MPA = 1e-6
_COLUMNS = (  # heading, key, factor, digits
    ("angle", "angle_deg", 1.0, 0),
    ("normal", "normal_pa", MPA, 2),
    ("shear", "shear_pa", MPA, 2),
    ("pressure", "pressure_pa", MPA, 2),
    ("tendency", "slip_tendency", 1.0, 3),
    ("friction", "friction", 1.0, 3),
    ("slips at", "slips_at_pa", MPA, 2),
    ("opens at", "opens_at_pa", MPA, 2),
    ("grows at", "grows_at_pa", MPA, 2),
)


def show(text: str, *, as_json: bool, figure: Path | None) -> int:
    """Write the solver's description of a scene, and the diagram; give the exit status."""
    if as_json:
        sys.stdout.write(text)
    else:
        print("\n".join(table(json.loads(text))))
    if figure is None:
        return 0
    found = json.loads(text)
    if "fractures" not in found:
        print("wingcrack check: no Mohr diagram: the stress is not known", file=sys.stderr)
        return 0
    from wingcrack.figures import style  # late: check answers at once without matplotlib

    drawn = style.save(mohr(found), figure.with_suffix(""), (figure.suffix[1:],))
    if not as_json:
        print(f"Mohr diagram: {drawn[0]}")
    return 0


def table(found: dict[str, Any]) -> Iterator[str]:
    """Lines of the terminal. Of a bent fracture the part that slips first is shown."""
    yield f"scene:        {found['scene']}"
    if "stress" in found:
        yield from _stress(found["stress"])
        shown = list(_first_to_slip(found["fractures"]))
        wide = max([8, *(len(part["fracture"]) for part in shown)])
        yield f"{'fracture':{wide}}" + "".join(f"{heading:>10}" for heading, *_ in _COLUMNS)
        for part in shown:
            cells = (_cell(part, *column[1:]) for column in _COLUMNS)
            yield f"{part['fracture']:{wide}}" + "".join(f"{cell:>10}" for cell in cells)
        yield "  angles in degrees, stresses and pressures in MPa, compression positive;"
        yield "  'slips at' below 'pressure': it slips from the start"
    else:
        yield f"stress:       not known before a run: {found['stress_unknown']}"
    for well in found["wells"]:
        if "k_m" in well:
            yield f"well:         '{well['well']}', K_m = {well['k_m']:.3g} at its largest rate"
        yield from _at_pressure(well, found.get("fractures", []))
    cost = found["cost"]
    yield (
        f"cost:         about {cost['steps']} steps, {cost['cells']} cells at the start and"
        f" {_duration(cost['cpu_s'])} of CPU time, within a factor of {cost['factor']:g} as a rule"
    )
    for warning in found["warnings"]:
        yield f"warning:      {warning}"


def _stress(stress: dict[str, float]) -> Iterator[str]:
    levels = [stress["y_min_m"], stress["y_max_m"]]
    if not _varies(stress):
        levels = levels[:1]
    for y in levels:
        xx, yy, xy, pressure = state_at(stress, y)
        middle, radius = 0.5 * (xx + yy), math.hypot(0.5 * (xx - yy), xy)
        where = f" at y = {y:g} m" if len(levels) > 1 else ""
        yield (
            f"stress:       largest and least compression {-(middle - radius) * MPA:.2f} and"
            f" {-(middle + radius) * MPA:.2f} MPa, pressure {pressure * MPA:.2f} MPa{where}"
        )


def _varies(stress: dict[str, float]) -> bool:
    slopes = ("xx_per_y_pa_m", "yy_per_y_pa_m", "pressure_per_y_pa_m")
    return any(stress[key] != 0.0 for key in slopes)


def state_at(stress: dict[str, float], y: float) -> tuple[float, float, float, float]:
    """Stresses xx, yy, xy and the pressure at a level [Pa]."""
    up = y - stress["y_datum_m"]
    return (
        stress["xx_pa"] + stress["xx_per_y_pa_m"] * up,
        stress["yy_pa"] + stress["yy_per_y_pa_m"] * up,
        stress["xy_pa"],
        stress["pressure_pa"] + stress["pressure_per_y_pa_m"] * up,
    )


def _first_to_slip(parts: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    names = dict.fromkeys(part["fracture"] for part in parts)
    for name in names:
        yield min((part for part in parts if part["fracture"] == name), key=_margin)


def _margin(part: dict[str, Any]) -> float:
    """Rise of the pressure until a part slips; without bound where any shear traction does it."""
    if "opens_at_pa" not in part:
        return math.inf
    return float(part.get("slips_at_pa", -math.inf) - part["pressure_pa"])


def _cell(part: dict[str, Any], key: str, factor: float, digits: int) -> str:
    if key in part:
        return f"{part[key] * factor:.{digits}f}"
    return "always" if key == "slips_at_pa" and "opens_at_pa" in part else "-"


def _at_pressure(well: dict[str, Any], parts: list[dict[str, Any]]) -> Iterator[str]:
    """What the largest pressure of a well does to its fractures, without flow between them."""
    if not well.get("pressures_pa"):
        return
    pressure = max(well["pressures_pa"])
    for name in well.get("fractures", []):
        whole = [part for part in parts if part["fracture"] == name and "opens_at_pa" in part]
        done = [
            verb
            for verb, key in (("slips", "slips_at_pa"), ("opens", "opens_at_pa"))
            if any(part.get(key, -math.inf) < pressure for part in whole)
        ]
        if any(part.get("grows_at_pa", math.inf) < pressure for part in whole):
            done.append("would grow")
        if whole:
            words = ", ".join(done) or "neither slips nor opens"
            yield f"well:         '{well['well']}' at {pressure * MPA:.2f} MPa: '{name}' {words}"


def _duration(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds < 120.0 else f"{seconds / 60.0:.2g} min"


def mohr(found: dict[str, Any]) -> Figure:
    """Effective stresses: circles at the levels of the fractures, their points, friction."""
    import numpy as np

    from wingcrack.figures import style

    parts, stress = found["fractures"], found["stress"]

    @style.styled
    def draw() -> Figure:
        figure = style.new_figure(style.DOUBLE_COLUMN, 0.45 * style.DOUBLE_COLUMN)
        axes = figure.add_subplot()
        ys = sorted({stress["y_min_m"], stress["y_max_m"]})
        for index, y in enumerate(ys if _varies(stress) else ys[:1]):
            xx, yy, xy, pressure = state_at(stress, y)
            middle, radius = -0.5 * (xx + yy) - pressure, math.hypot(0.5 * (xx - yy), xy)
            angle = np.linspace(0.0, np.pi, 181)
            label = f"stress at y = {y:g} m" if _varies(stress) else "stress"
            axes.plot(
                (middle + radius * np.cos(angle)) * MPA,
                radius * np.sin(angle) * MPA,
                color="black",
                linestyle=style.LINE_STYLES[index],
                label=label,
            )
        normal = np.array([part["normal_pa"] - part["pressure_pa"] for part in parts]) * MPA
        shear = np.array([part["shear_pa"] for part in parts]) * MPA
        axes.plot(normal, shear, "o", color=style.CYCLE[1], markersize=4, label="fractures")
        named = set()
        for part, x, y in zip(parts, normal, shear, strict=True):
            if part["fracture"] not in named and len(parts) <= 30:
                axes.annotate(part["fracture"], (x, y), (3, 3), textcoords="offset points")
            named.add(part["fracture"])
        reach = max([0.0, *axes.get_xlim()])
        rubbing = [part for part in parts if "friction" in part]
        laws = sorted({(part["friction"], part["cohesion_pa"]) for part in rubbing})
        for index, (friction, cohesion) in enumerate(laws[: len(style.CYCLE)]):
            words = f"friction {friction:g}" + (f", {cohesion * MPA:g} MPa" if cohesion else "")
            ends = np.array([0.0, reach])
            axes.plot(ends, friction * ends + cohesion * MPA, color=style.CYCLE[index], label=words)
        axes.set_xlim(right=reach)
        axes.set_ylim(0.0, 1.15 * max([*shear, _highest(stress)]))
        axes.set_xlabel("effective normal traction [MPa], compression positive")
        axes.set_ylabel("shear traction [MPa]")
        axes.legend(loc="upper left")
        return figure

    return draw()


def _highest(stress: dict[str, float]) -> float:
    radii = []
    for y in (stress["y_min_m"], stress["y_max_m"]):
        xx, yy, xy, _ = state_at(stress, y)
        radii.append(math.hypot(0.5 * (xx - yy), xy) * MPA)
    return max(1e-6, *radii)
