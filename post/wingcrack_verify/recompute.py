"""Judge a run with a fluid by its files alone: contact, mass, bounds, limits.

The criteria are in `docs/sweeps.md` and the part Stability of `docs/verification.md`.

This module is independent of the solver: the contact law, the balance of fluid and the limits are
recomputed from scene.nml, the tables, the VTU files and run.json.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from wingcrack.names import table as name_table
from wingcrack_verify.recompute_files import Numbers, Run, State, read_run

CONTACT = "contact residual"
MASS = "mass error"
# A result is not wrong before it is wrong by so much, over what it is compared with.
TOLERANCE = 1e-7
ROUND_OFF = 1e-9
# Where a mesh follows growth, the pressures before it are not in the files on the new cells. Those
# of the old ones are interpolated, which concerns only what the fluid is compressed: a few 1e-3
# of the fluid in the few cells that changed, known to a hundredth.
TOLERANCE_REMESHED = 1e-5


@dataclass(frozen=True)
class Limit:
    """Values of a quantity that are warned of, and that stop a run."""

    warning: float
    stop: float


@dataclass
class Findings:
    """What is wrong, and the worst of what was measured."""

    wrong: list[str] = field(default_factory=list)
    worst: dict[str, float] = field(default_factory=dict)

    def see(self, name: str, value: float, where: str, bound: float) -> None:
        """Take note of an error; more than the bound, or no number, is wrong."""
        self.worst[name] = max(self.worst.get(name, 0.0), value)
        if not value <= bound:
            self.wrong.append(f"{name} {value:.3g} {where}")


def read_limits() -> dict[str, Limit]:
    """The limits of the program by their names; some never stop a run."""
    return {
        row["name"]: Limit(row["warning"], np.inf if row["stop"] is None else row["stop"])
        for row in name_table()["limits"]
    }


def groups(scene: Any, name: str) -> list[Any]:
    """All items of a repeated group."""
    found = scene.get(name, [])
    return found if isinstance(found, list) else [found]


def judge(folder: Path) -> Findings:
    """Judge all states of a run."""
    findings = Findings()
    run = read_run(folder)
    limits = read_limits()
    warnings = " ".join(run.record["warnings"])
    if not run.states:
        if run.record["steps"] > 0:
            findings.wrong.append("steps without a row in history.csv")
        return findings
    # What is warned of may be as large as what would have stopped the run.
    contact = limits[CONTACT].stop if CONTACT in warnings else TOLERANCE
    mass = limits[MASS].stop if MASS in warnings else TOLERANCE
    before: State | None = None
    for state in run.states:
        if state.history["time_s"] not in state.cells["time_s"]:
            findings.wrong.append("a state without fields")
            continue
        check_numbers(state, findings)
        check_contact(run.scene, before, state, contact, findings)
        check_counts(run.scene, state, findings)
        check_load(run.scene, state, findings)
        check_voids(run.scene, state, findings)
        if before is not None and same_mesh(before, state):
            check_mass(run.scene, before, state, mass, findings)
        elif before is not None:
            check_mass(run.scene, before, state, TOLERANCE_REMESHED, findings, "remeshed ")
        before = state
    check_bounds(run, findings)
    check_limits(run, limits, findings)
    return findings


def at(state: State) -> str:
    """When a state is, for messages."""
    return f"at {state.history['time_s']:g} s"


def same_mesh(a: State, b: State) -> bool:
    """Nothing has grown between two states."""
    return len(a.lengths) == len(b.lengths) and len(a.areas) == len(b.areas)


def check_numbers(state: State, findings: Findings) -> None:
    """All numbers are finite."""
    for table in (state.cells, state.rock, state.history):
        for name, values in table.items():
            column = np.asarray(values)
            if column.dtype.kind == "f" and not np.isfinite(column).all():
                findings.wrong.append(f"{name} is no number {at(state)}")


def law_of_cells(scene: Any, state: State) -> tuple[Numbers, Numbers, Numbers, Numbers]:
    """Friction, tangent of dilation, residual aperture and roughness of each fracture cell."""
    fractures = groups(scene, "fracture")
    of_cell = [fractures[int(number) - 1] for number in state.cells["fracture"]]
    place = state.cells["s_m"]
    has_grown = (place < 0.0) | (place > [length_of(fracture) for fracture in of_cell])
    aperture = np.array([fracture["aperture"] for fracture in of_cell])
    is_rough = scene["growth"]["new_volume"] == "conserved"  # and holds no fluid
    return (
        np.array([fracture["friction"] for fracture in of_cell]),
        np.tan(np.radians([fracture["dilation_deg"] for fracture in of_cell])),
        np.where(has_grown, scene["growth"]["new_aperture"], aperture),
        np.where(has_grown & is_rough, scene["growth"]["new_aperture"], 0.0),
    )


def length_of(fracture: Any) -> float:
    """Length of a polyline [m]."""
    return float(np.hypot(np.diff(fracture["x"]), np.diff(fracture["y"])).sum())


def check_contact(
    scene: Any, before: State | None, state: State, bound: float, findings: Findings
) -> None:
    """Coulomb's law, no penetration, and what the states stick, slip and open mean.

    The values of a cell are means over its two ends, and `slip` is also what a cell is called whose
    ends do different things. So a bound that holds at both ends holds for the mean, but equality is
    asked for only where both ends must be the same.
    """
    cells = state.cells
    friction, dilation, _, _ = law_of_cells(scene, state)
    normal, shear = cells["traction_n_pa"], cells["traction_t_pa"]
    opening = cells["jump_n_m"] - dilation * np.abs(cells["jump_t_m"])
    # Jumps become stresses with the stiffness of a cell of rock.
    stiffness = scene["material"]["young"] / state.lengths.mean()
    traction = max(float(np.hypot(normal, shear).max()), load_of(scene))
    scale = traction + ROUND_OFF * stiffness * float(np.abs(cells["jump_n_m"]).max())

    def see(name: str, stress: Numbers) -> None:
        findings.see(name, max(0.0, float(stress.max(initial=0.0))) / scale, at(state), bound)

    see("tension of contact", normal)
    see("penetration", -stiffness * opening)
    see("shear above friction", np.abs(shear) - friction * np.maximum(0.0, -normal))
    is_open, sticks = cells["state"] == "open", cells["state"] == "stick"
    see("traction on open faces", np.hypot(normal, shear)[is_open])
    if before is None or not same_mesh(before, state):
        return
    slip = cells["jump_t_m"] - before.cells["jump_t_m"]
    see("slip of cells that stick", stiffness * np.abs(slip[sticks]))
    old = before.cells["jump_t_m"]
    one_way = sticks & (np.abs(cells["jump_t_m"]) + np.abs(old) > 0.0)
    see("opening of cells that stick", -stiffness * opening[one_way])
    # Closed at both ends and at the bound: both ends slip, and the same way.
    closed = stiffness * np.abs(opening) <= bound * scale
    at_bound = np.abs(np.abs(shear) - friction * np.maximum(0.0, -normal)) <= bound * scale
    slips = (cells["state"] == "slip") & closed & at_bound & (np.abs(shear) > bound * scale)
    along = np.minimum(stiffness * np.abs(slip), np.maximum(0.0, -shear * np.sign(slip)))
    see("slip against friction", along[slips])


def check_counts(scene: Any, state: State, findings: Findings) -> None:
    """Apertures, volume and counts of states follow from the cells."""
    _, _, aperture, roughness = law_of_cells(scene, state)
    cells, row = state.cells, state.history
    size = np.abs(cells["aperture_m"]).max()
    gap = np.abs(aperture + cells["jump_n_m"] - cells["aperture_m"]).max()
    findings.see("aperture", float(gap / size), at(state), ROUND_OFF)
    filled = cells["aperture_m"] - cells["void_m"]
    volume = float(((filled - roughness) * state.lengths).sum())
    error = abs(volume - row["fracture_volume_m2"]) / (float(state.lengths.sum()) * float(size))
    findings.see("fracture volume", error, at(state), ROUND_OFF)
    for word in ("stick", "slip", "open"):
        if int((cells["state"] == word).sum()) != int(row[f"n_{word}"]):
            findings.wrong.append(f"n_{word} is not the number of cells {at(state)}")


def load_of(scene: Any) -> float:
    """The largest traction on the body [Pa]."""
    names = ("x_traction", "y_traction")
    return max(
        abs(float(side.get(name) or 0.0)) for side in groups(scene, "side") for name in names
    )


def check_load(scene: Any, state: State, findings: Findings) -> None:
    """The mean stress of the body is its load: left and bottom slide, right and top are loaded."""
    sides = {side["name"]: side for side in groups(scene, "side")}
    wanted = (sides["right"]["x_traction"], sides["top"]["y_traction"])
    stress = state.rock["stress"]
    scale = max(load_of(scene), float(np.abs(stress).max()))
    for component, load in enumerate(wanted):
        mean = float((stress[:, component] * state.areas).sum() / state.areas.sum())
        findings.see("mean stress", abs(mean - load) / scale, at(state), TOLERANCE)


def storage_of(scene: Any) -> tuple[float, float]:
    """Storage at constant stress in the plane, and fluid content per stress xx + yy [1/Pa].

    zeta = S p + alpha div u, with sxx + syy = 2 (lambda + G) div u - 2 alpha p.
    """
    rock, fluid = scene["material"], scene["fluid"]
    young, poisson, biot = rock["young"], rock["poisson"], rock["biot"]
    bulk = young / (3.0 * (1.0 - 2.0 * poisson))
    plane = young / (2.0 * (1.0 + poisson) * (1.0 - 2.0 * poisson))  # lambda + G
    grains = (biot - rock["porosity"]) / bulk
    if rock["storage"] == "textbook":
        grains *= 1.0 - biot
    storage = grains + rock["porosity"] * fluid["compressibility"]
    return storage + biot**2 / plane, biot / (2.0 * plane)


def content_of(scene: Any, state: State) -> Numbers:
    """Fluid that each rock cell holds more than at no pressure and stress [m2]."""
    by_pressure, by_stress = storage_of(scene)
    stress = state.rock["stress"]
    content: Numbers = state.areas * (
        by_pressure * state.rock["pressure"] + by_stress * (stress[:, 0] + stress[:, 1])
    )
    return content


def injected_until(scene: Any, time: float) -> float:
    """Fluid that the wells have given until a time [m2]."""
    return float(
        sum(
            well["rate"] * max(0.0, min(time, well.get("end") or math.inf) - well["start"])
            for well in groups(scene, "injection")
        )
    )


def check_mass(
    scene: Any, before: State, state: State, bound: float, findings: Findings, kind: str = ""
) -> None:
    """What is injected in a step is what rock and fractures take up; what leaks off, the rock."""
    now, then = state.cells, before.cells
    rock = float(content_of(scene, state).sum() - content_of(scene, before).sum())
    filled, old = now["aperture_m"] - now["void_m"], then["aperture_m"] - then["void_m"]
    pressure = now["pressure_pa"] - pressure_on(before, state)
    compressed = scene["fluid"]["compressibility"] * filled * pressure
    fracture = float((state.lengths * (filled + compressed)).sum() - (before.lengths * old).sum())
    # New faces are rough: their residual aperture conducts, but holds nothing.
    roughness = [
        float((each.lengths * law_of_cells(scene, each)[3]).sum()) for each in (state, before)
    ]
    fracture -= roughness[0] - roughness[1]
    end, start = state.history["time_s"], before.history["time_s"]
    injected = injected_until(scene, end) - injected_until(scene, start)
    lost = {
        name: state.history[name] - before.history[name]
        for name in ("outflow_m2", "rock_outflow_m2", "prefilled_m2")
    }
    given = injected + lost["prefilled_m2"] - lost["outflow_m2"] - lost["rock_outflow_m2"]
    by_pressure, by_stress = storage_of(scene)
    largest = float(np.abs(state.rock["stress"]).max() * 2.0 * by_stress)
    largest += float(np.abs(state.rock["pressure"]).max() * by_pressure)
    # Contents are differences of large numbers: what their rounding is worth is no error.
    rounding = 1e-13 * largest * float(state.areas.sum())
    total = max(abs(injected_until(scene, end)), state.history["fracture_volume_m2"])
    error = max(0.0, abs(rock + fracture - given) - rounding)
    findings.see(f"{kind}mass balance", error / total, at(state), bound)
    leaked = state.history["leakoff_m2"] - before.history["leakoff_m2"]
    error = max(0.0, abs(rock + lost["rock_outflow_m2"] - leaked) - rounding)
    findings.see(f"{kind}leak-off", error / total, at(state), bound)
    error = abs(state.history["injected_m2"] - injected_until(scene, end)) / total
    findings.see("injected", error, at(state), ROUND_OFF)


def pressure_on(before: State, state: State) -> Numbers:
    """Pressures of a state on the fracture cells of the next one, which may be others [Pa]."""
    if same_mesh(before, state):
        return np.asarray(before.cells["pressure_pa"], dtype=float)
    found = np.empty(len(state.lengths))
    for number in np.unique(state.cells["fracture"]):
        new, old = state.cells["fracture"] == number, before.cells["fracture"] == number
        order = np.argsort(before.cells["s_m"][old])
        found[new] = np.interp(
            state.cells["s_m"][new],
            before.cells["s_m"][old][order],
            before.cells["pressure_pa"][old][order],
        )
    return found


def check_voids(scene: Any, state: State, findings: Findings) -> None:
    """Fluid in fractures is not below the pressure of its vapour, which alone makes voids."""
    cells, least = state.cells, scene["fluid"].get("vapour_pressure")
    if least is None:
        return
    size = max(float(np.abs(cells["pressure_pa"]).max()), load_of(scene))
    below = (least - cells["pressure_pa"]) / size
    findings.see("pressure below that of vapour", float(below.max()), at(state), TOLERANCE)
    void, aperture = cells["void_m"], cells["aperture_m"]
    findings.see("void below 0", float((-void / aperture.max()).max()), at(state), TOLERANCE)
    above = (void - aperture) / aperture.max()
    findings.see("void above the aperture", float(above.max()), at(state), TOLERANCE)
    boils = np.where(void > TOLERANCE * aperture.max(), -below, 0.0)
    findings.see("void under pressure", float(boils.max()), at(state), TOLERANCE)


def check_bounds(run: Run, findings: Findings) -> None:
    """Pressures of the rock stay between those of the fractures, of the start, and of compression.

    Fluid diffuses from where the pressure is high to where it is low, so new highs arise only where
    the rock is compressed: by at most what it would be without flow.
    """
    by_pressure, by_stress = storage_of(run.scene)
    # Before the load the rock is not strained; free of it, it expands, and the pressure falls.
    initial = run.scene["initial"]["pressure"]
    storage = by_pressure - 2.0 * run.scene["material"]["biot"] * by_stress
    low, high = initial * storage / by_pressure, initial
    undrained = np.zeros(1)
    lowest = math.inf
    for state in run.states:
        stress = state.rock["stress"]
        response = -by_stress / by_pressure * (stress[:, 0] + stress[:, 1])
        fluid = state.cells["pressure_pa"]
        if len(undrained) in (1, len(response)):
            change = response - undrained
        else:  # other cells
            change = np.array([pick(response) - pick(undrained) for pick in (np.min, np.max)])
        low += min(0.0, float(change.min()))
        high += max(0.0, float(change.max()))
        undrained = response
        low, high = min(low, float(fluid.min())), max(high, float(fluid.max()))
        pressure = state.rock["pressure"]
        beyond = max(float(pressure.max()) - high, low - float(pressure.min()))
        scale = high - low + ROUND_OFF * max(abs(high), abs(low), load_of(run.scene))
        findings.see("pressure beyond its bounds", max(0.0, beyond) / scale, at(state), 0.1)
        lowest = min(lowest, float(pressure.min()), float(fluid.min()))
    told = run.record["lowest_pressure_pa"]
    scale = max(abs(lowest), abs(told), load_of(run.scene))
    findings.see("lowest_pressure_pa", abs(told - lowest) / scale, "", TOLERANCE)


def watched(run: Run) -> dict[str, float]:
    """The largest values of what docs/limits.md watches, as far as the files tell."""
    domain, young = run.scene["domain"], run.scene["material"]["young"]
    size = np.array([domain["x_max"] - domain["x_min"], domain["y_max"] - domain["y_min"]])
    scale = max(load_of(run.scene), abs(run.scene["initial"]["pressure"]))
    longest = max(length_of(fracture) for fracture in groups(run.scene, "fracture"))
    if run.scene["growth"]["enabled"]:
        scale = max(scale, run.scene["material"]["toughness"] / math.sqrt(math.pi * longest / 2))
    values: dict[str, float] = {}

    def see(name: str, value: float) -> None:
        values[name] = max(values.get(name, 0.0), value)

    for state in run.states:
        cells = state.cells
        pressure = max(
            float(np.abs(cells["pressure_pa"]).max()), float(np.abs(state.rock["pressure"]).max())
        )
        see("aperture over the body's size", float(cells["aperture_m"].max() / size.min()))
        see("pressure over Young's modulus", pressure / young)
        see("pressure over the load", pressure / scale)
        displacement = state.rock["displacement"][:, :2]
        see("strain of the body", float((np.ptp(displacement, axis=0) / size).max()))
        jump = np.hypot(cells["jump_n_m"], cells["jump_t_m"])
        see("jump over its fracture cell's length", float((jump / state.lengths).max()))
        see(MASS, state.history["mass_error_relative"])
    see("forward error bound", run.record["forward_error_bound"])
    see(CONTACT, run.record["contact_residual"])
    return values


def check_limits(run: Run, limits: dict[str, Limit], findings: Findings) -> None:
    """What passes its limit is warned of, what does not is not, and nothing passes that of a stop.

    The jump of a cell is the mean of its ends, so it tells only that a warning is missing.
    """
    warnings = run.record["warnings"]
    stopped = run.record["status"] == "failed"
    for name, value in watched(run).items():
        limit = limits[name]
        is_told = any(warning.startswith(name) for warning in warnings)
        if value > limit.warning * (1.0 + 1e-6) and not is_told:
            findings.wrong.append(f"no warning of {name} {value:.3g}")
        # The state that stopped a run is reported, but not in the files.
        if value < 0.99 * limit.warning and is_told and not stopped and "jump" not in name:
            findings.wrong.append(f"a warning of {name}, which is {value:.3g}")
        if value > limit.stop * (1.0 + 1e-6) and not stopped:
            findings.wrong.append(f"{name} {value:.3g} did not stop the run")
    angle = min(state.angle for state in run.states)
    is_told = any(warning.startswith("smallest angle") for warning in warnings)
    if is_told != (angle < limits["smallest angle of the mesh"].warning):
        findings.wrong.append(f"smallest angle {angle:.3g}, told: {is_told}")
