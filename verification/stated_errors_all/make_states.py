"""Write check.toml: states of known truth, half of them drawn by a seed, and what is asked of each.

Run with any Python 3: ``python3 make_states.py``. The exact values are closed forms (README.md).
"""

from __future__ import annotations

import math
import random
from pathlib import Path

SEED = 7
RANDOM = random.Random(SEED)
CELLS = (4, 6, 10, 20, 40)  # per half-length
DRAWN = (4, 5, 7, 8, 12, 15, 25, 30)

GAPS = {
    "direction, without a fluid": "the stated error of K_II of a crack under pressure alone is 13 times too large in the median",
}

HEAD = '''title = "Stated errors of all quantities"
group = "networks"
source = "closed forms, README.md"
# Written by make_states.py: change it there.

[defaults.check]
unit = "stated errors"
reference = 0.0
metric = "absolute"
scale = 10.0
tolerance = 1.0
held = { share = 0.95, factor = 10.0 }
'''

parts: list[str] = []


def text(value: object) -> str:
    """Text of a value in TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(text, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {text(v)}" for k, v in value.items()) + " }"
    return repr(value)


def _key(name: str) -> str:
    return name if name.replace("_", "").isalnum() else f'"{name}"'


def run(name: str, method: str, scene: str, given: dict, constants: dict, without: tuple = ()) -> None:
    """Add a run."""
    lines = ["[[run]]", f'name = "{name}"', f'method = "{method}"', f'scene = "{scene}"']
    lines.append(f"set = {text(given)}")
    if without:
        lines.append(f"unset = {text(list(without))}")
    parts.append("\n".join([*lines, f"constants = {text(constants)}"]))


def check(quantity: str, method: str, file: str, value: str, error: str, **how: object) -> None:
    """Ask that the stated error of a quantity holds: (value - exact) over it."""
    result = {"file": file, "column": f"({value})/maximum({error}, 1.0e-200)", **(how or {"take": "last"})}
    gap = f'\nknown_gap = "{GAPS[quantity]}"' if quantity in GAPS else ""
    parts.append(f'[[check]]\nquantity = "{quantity}"\nruns = ["{method}, *"]\nresult = {text(result)}{gap}')


def draw(low: float, high: float, digits: int) -> float:
    """Draw a number with few digits."""
    return round(RANDOM.uniform(low, high), digits)


def plane(young: float, poisson: float) -> float:
    """E' of plane strain."""
    return young / (1.0 - poisson**2)


def pressurized() -> None:
    """Sneddon's crack on the coarse level, by a volume or by a pressure."""
    states = [(n, 0.2, 0.5, 40.0, 1.0) for n in CELLS]
    states += [(RANDOM.choice(DRAWN), draw(0.05, 0.4, 2), draw(0.2, 1.0, 2), draw(10, 70, 0), draw(0.3, 3, 2)) for _ in CELLS]
    scene = "../pressurized_crack/pressurized_crack.nml"
    for i, (n, poisson, a, young, mpa) in enumerate(states):
        modulus, p = plane(young * 1e9, poisson), mpa * 1e6
        volume = 2.0 * math.pi * p * a**2 / modulus
        given = {
            "material.young": young * 1e9,
            "material.poisson": poisson,
            "fracture.1.x": [-a, a],
            "coarse.size_fracture": a / n,
        }
        exact = {"a": a, "p": p, "volume": volume, "widest": 4.0 * p * a / modulus, "held": 2e-3 * a}
        run(f"given volume, {i + 1}", "given volume", scene, {**given, "injection.1.rate": volume / 100.0}, exact, ("growth",))
        given["injection.1.pressure"] = p
        run(f"given pressure, {i + 1}", "given pressure", scene, given, exact, ("growth", "injection.1.rate"))
    for method in ("given volume", "given pressure"):
        last = {"where": {"time_s": "last"}}
        check(f"largest opening, {method}", method, "history.csv", "max_opening_m - widest", "max_opening_error_m")
        profile = "jump_n_m - widest*sqrt(1 - ((s_m - a)/a)**2)"
        check(f"opening of cells, {method}", method, "fractures.csv", profile, "jump_n_error_m", x="s_m", **last)
    check("pressure of a well, given volume", "given volume", "wells.csv", "pressure_pa - p", "pressure_error_pa")
    check("pressure of cells, given volume", "given volume", "fractures.csv", "pressure_pa - p", "pressure_error_pa", x="s_m", **last)
    check("injectivity, given volume", "given volume", "wells.csv", "injectivity_m2_s_pa - volume/100/p", "injectivity_error_m2_s_pa")
    for column, exact in (("fracture_volume_m2", "held + volume"), ("fracture_fluid_m2", "volume"), ("injected_m2", "volume"), ("injection_rate_m2_s", "volume/100")):
        stem, unit = {"injection_rate_m2_s": ("injection_rate", "m2_s")}.get(column, (column[:-3], "m2"))
        check(f"{column} at a given pressure", "given pressure", "history.csv", f"{column} - ({exact})", f"{stem}_error_{unit}")
    check("flow of a well at a given pressure", "given pressure", "wells.csv", "flow_m2_s - volume/100", "flow_error_m2_s")
    check("aperture of cells", "given pressure", "fractures.csv", f"aperture_m - 1.0e-3 - {profile[len('jump_n_m - ') :]}", "aperture_error_m", x="s_m", **last)


def sheared() -> None:
    """Uniform stress drop on the coarse level."""
    states = [(n, 0.2, 45.0, 0.5, 6.8) for n in CELLS]
    while len(states) < 2 * len(CELLS):
        state = (RANDOM.choice(DRAWN), draw(0.05, 0.4, 2), draw(30, 60, 0), draw(0.3, 0.6, 2), draw(4, 8, 1))
        if drop_of(*state[2:]) > 3e5:
            states.append(state)
    a = 0.05
    for i, (n, poisson, angle, friction, mpa) in enumerate(states):
        modulus, drop = plane(40e9, poisson), drop_of(angle, friction, mpa)
        along = [a * math.cos(math.radians(angle)), a * math.sin(math.radians(angle))]
        slip = 4.0 * drop * a / modulus
        given = {
            "material.poisson": poisson,
            "fracture.1.friction": friction,
            "fracture.1.dilation_deg": 0.0,
            "fracture.1.x": [-along[0], along[0]],
            "fracture.1.y": [-along[1], along[1]],
            "initial.pressure": mpa * 1e6,
            "coarse.size_fracture": a / n,
        }
        normal = normal_of(angle) - mpa * 1e6
        moment = 20e9 / (1.0 + poisson) * 2.0 * a * math.pi / 4.0 * slip
        exact = {"a": a, "slip": slip, "moment": moment, "normal": normal, "shear": friction * normal}
        run(f"stress drop, {i + 1}", "stress drop", "../frictional_crack/frictional_crack.nml", given, exact, ("growth",))
    first = {"x": "s_m", "where": {"time_s": "first"}}
    cells("stress drop", "fractures.csv", "a", first)
    check("largest slip", "stress drop", "history.csv", "max_slip_m - slip", "max_slip_error_m", take="first")
    check("seismic moment", "stress drop", "history.csv", "seismic_moment_nm - moment", "seismic_moment_error_nm", take="first")


def cells(method: str, file: str, middle: str, how: dict) -> None:
    """Ask for slip and tractions along a crack."""
    profile = f"abs(jump_t_m) - slip*sqrt(1 - ((s_m - {middle})/a)**2)"
    check(f"slip of cells, {method}", method, file, profile, "jump_t_error_m", **how)
    check(f"normal traction of cells, {method}", method, file, "traction_n_pa + normal", "traction_n_error_pa", **how)
    check(f"shear traction of cells, {method}", method, file, "abs(traction_t_pa) - shear", "traction_t_error_pa", **how)


def normal_of(angle: float) -> float:
    """Compression across a crack at an angle, under 20 MPa in x and 10 MPa in y [Pa]."""
    return 20e6 * math.sin(math.radians(angle)) ** 2 + 10e6 * math.cos(math.radians(angle)) ** 2


def drop_of(angle: float, friction: float, mpa: float) -> float:
    """Shear stress less friction [Pa]."""
    shear = 10e6 * math.sin(math.radians(angle)) * math.cos(math.radians(angle))
    return shear - friction * (normal_of(angle) - mpa * 1e6)


def without_fluid() -> None:
    """The same two cracks by finite elements."""
    states = [(n, 0.2, 1.0) for n in CELLS]
    states += [(RANDOM.choice(DRAWN), draw(0.05, 0.4, 2), draw(0.3, 3, 2)) for _ in CELLS]
    for i, (n, poisson, mpa) in enumerate(states):
        modulus, p = plane(40e9, poisson), mpa * 1e6
        given = {"material.poisson": poisson, "fe.size_fracture": 1.0 / n, "fracture.1.face_pressure": p}
        exact = {
            "widest": 4.0 * p / modulus,
            "volume": 2.0 * math.pi * p / modulus,
            "energy": math.pi * p**2 / modulus,
            "k": p * math.sqrt(math.pi),
            "g": p**2 * math.pi / modulus,
        }
        run(f"open body, {i + 1}", "open body", "../pressurized_crack/pressurized_faces.nml", given, exact, ("fracture.2",))
    check("largest opening, without a fluid", "open body", "history.csv", "max_opening_m - widest", "max_opening_error_m")
    check("volume, without a fluid", "open body", "history.csv", "fracture_volume_m2 - volume", "fracture_volume_error_m2")
    check("strain energy", "open body", "history.csv", "strain_energy_j - energy", "strain_energy_error_j")
    check("opening of cells, without a fluid", "open body", "fractures.csv", "jump_n_m - widest*sqrt(1 - x_m**2)", "jump_n_error_m", x="x_m")
    check("K_eq, without a fluid", "open body", "tips.csv", "keq_pa_sqrtm - k", "keq_error_pa_sqrtm", x="tip")
    check("energy release rate, without a fluid", "open body", "tips.csv", "g_j_m2 - g", "g_error_j_m2", x="tip")
    check("direction, without a fluid", "open body", "tips.csv", "angle_deg", "angle_error_deg", x="tip")
    states = [(n, 0.2, 0.5, 6.8) for n in CELLS]
    states += [(RANDOM.choice(DRAWN), draw(0.05, 0.4, 2), draw(0.3, 0.55, 2), draw(5, 8, 1)) for _ in CELLS]
    a = 0.05
    for i, (n, poisson, friction, mpa) in enumerate(states):
        drop, normal = drop_of(45.0, friction, mpa), 15e6 - mpa * 1e6
        slip = 4.0 * drop * a / plane(40e9, poisson)
        given = {
            "material.poisson": poisson,
            "fe.size_fracture": a / n,
            "fracture.1.friction": friction,
            "fracture.1.face_pressure": mpa * 1e6,
        }
        moment = 20e9 / (1.0 + poisson) * 2.0 * a * math.pi / 4.0 * slip
        exact = {"a": a, "slip": slip, "moment": moment, "normal": normal, "shear": friction * normal}
        run(f"closed body, {i + 1}", "closed body", "../frictional_crack/closed_crack.nml", given, exact)
    cells("closed body", "fractures.csv", "a", {"x": "s_m"})
    check("largest slip, without a fluid", "closed body", "history.csv", "max_slip_m - slip", "max_slip_error_m")
    check("seismic moment, without a fluid", "closed body", "history.csv", "seismic_moment_nm - moment", "seismic_moment_error_nm")


def leaking() -> None:
    """A closed fracture with leak-off, at a rate and at a pressure."""
    states = [(t, 1e-19, 0.7, "auto", 1.0) for t in (10.0, 100.0, 1105.0, 3600.0)]
    states += [(3600.0, 1e-19, 0.7, "off", 1.0), (1105.0, 1e-19, 0.7, "off", 0.25), (3600.0, 1e-18, 0.7, "off", 0.25)]
    for _ in range(7):
        layers = RANDOM.choice(("auto", "auto", "off"))
        time, permeability = 10 ** RANDOM.uniform(1.0, 3.8), 10 ** RANDOM.uniform(-20.0, -18.0)
        states.append((float(f"{time:.3g}"), float(f"{permeability:.3g}"), draw(0.5, 0.9, 2), layers, RANDOM.choice((0.5, 1.0, 2.0))))
    for i, (time, permeability, biot, layers, size) in enumerate(states):
        storage, c = diffusion(40e9, 0.25, biot, 0.01, 4.5e-10, permeability, 1e-3)
        given = {
            "material.permeability": permeability,
            "material.biot": biot,
            "time.end": time,
            "coarse.size_fracture": size,
            "coarse.layers": layers,
        }
        held, supply = 4.5e-13, 1e-7 / 20.0
        ratio = 2.0 * storage / held * math.sqrt(c * time)
        rise = supply * held / (2.0 * storage) ** 2 / c * (2.0 * ratio / math.sqrt(math.pi) - 1.0 + erfcx(ratio))
        gained = 20.0 * held * rise
        exact = {"rise": rise, "gained": gained, "leaked": 1e-7 * time - gained}
        run(f"leaking at a rate, {i + 1}", "leaking at a rate", "../thin_layers/rate.nml", given, exact)
        leaked = 80.0 * 1e7 * storage * math.sqrt(c * time / math.pi)
        exact = {"leaked": leaked, "filled": 20.0 * held * 1e7}
        run(f"leaking at a pressure, {i + 1}", "leaking at a pressure", "../thin_layers/pressure.nml", given, exact)
    method = "leaking at a rate"
    check("pressure of a well, leak-off", method, "wells.csv", "pressure_pa - 20e6 - rise", "pressure_error_pa")
    check("injectivity, leak-off", method, "wells.csv", "injectivity_m2_s_pa - 1.0e-7/rise", "injectivity_error_m2_s_pa")
    check("fluid in fractures, leak-off", method, "history.csv", "fracture_fluid_m2 - gained", "fracture_fluid_error_m2")
    check("leak-off at a rate", method, "history.csv", "leakoff_m2 - leaked", "leakoff_error_m2")
    check("fluid in the rock, leak-off", method, "history.csv", "rock_fluid_m2 - leaked", "rock_fluid_error_m2")
    method = "leaking at a pressure"
    check("leak-off at a pressure", method, "history.csv", "leakoff_m2 - leaked", "leakoff_error_m2")
    check("injected volume, leak-off", method, "history.csv", "injected_m2 - leaked - filled", "injected_error_m2")
    check("injected volume of a well, leak-off", method, "wells.csv", "injected_m2 - leaked - filled", "injected_error_m2")


def erfcx(x: float) -> float:
    """exp(x**2) erfc(x)."""
    if x < 25.0:
        return math.exp(x * x) * math.erfc(x)
    return 1.0 / (x * math.sqrt(math.pi)) * (1.0 - 0.5 / x**2)


def diffusion(young: float, poisson: float, biot: float, porosity: float, fluid: float, permeability: float, viscosity: float) -> tuple[float, float]:
    """Storage at uniaxial strain [1/Pa] and diffusivity [m2/s]."""
    bulk, shear = young / 3.0 / (1.0 - 2.0 * poisson), young / 2.0 / (1.0 + poisson)
    storage = porosity * fluid + (biot - porosity) / bulk + biot**2 / (bulk + 4.0 / 3.0 * shear)
    return storage, permeability / viscosity / storage


def columns() -> None:
    """Terzaghi's column: pressure, settlement, stress, outflow."""
    states = [(0.05, 1348.75, 53950.0), (0.1, 2697.5, 53950.0), (0.025, 1348.75, 10790.0), (0.05, 0.0, 53950.0), (0.1, 0.0, 107900.0)]
    for _ in range(6):
        end = draw(5000, 80000, -2)
        states.append((RANDOM.choice((0.04, 0.05, 0.06, 0.08)), RANDOM.choice((0.0, end / 40.0, end / 80.0)), end))
    young, poisson, biot, porosity = 40e9, 0.2, 0.8, 0.01
    bulk, shear = young / 3.0 / (1.0 - 2.0 * poisson), young / 2.0 / (1.0 + poisson)
    axial, lame = bulk + 4.0 / 3.0 * shear, bulk - 2.0 / 3.0 * shear
    storage = porosity * 4e-10 + (biot - porosity) / bulk
    start = biot * 10e6 / (axial * storage + biot**2)
    deep = range(1, 10)
    for i, (size, step, end) in enumerate(states):
        t = end * 5e-16 / (storage + biot**2 / axial)
        p = {k: start * series(k / 10.0, t) for k in deep}
        exact: dict[str, float] = {f"p{k}": p[k] for k in deep}
        for k in deep:
            y, n = 1.0 - k / 10.0, 400
            exact[f"u{k}"] = sum((-10e6 + biot * start * series(1.0 - (j + 0.5) * y / n, t)) / axial * y / n for j in range(n))
            exact[f"s{k}"] = lame / axial * (-10e6 + biot * p[k]) - biot * p[k]
        left = sum(8.0 / math.pi**2 / (2 * m + 1) ** 2 * math.exp(-(((2 * m + 1) * math.pi / 2.0) ** 2) * t) for m in range(200))
        exact["lost"] = 0.25 * (storage + biot**2 / axial) * start * (1.0 - left)
        given = {"coarse.size_fracture": size, "coarse.size_boundary": size, "time.end": end}
        run(f"column, {i + 1}", "column", "../terzaghi/terzaghi.nml", {**given, **({"time.step": step} if step else {})}, exact, () if step else ("time.step",))
    for what, value, exact_name, error in (
        ("pore pressure", "p_pa", "p", "p_error_pa"),
        ("displacement", "uy_m", "u", "u_error_m"),
        ("stress", "sxx_pa", "s", "s_error_pa"),
    ):
        selected = [f"(z0{k}_{value} - {exact_name}{k})/z0{k}_{error}" for k in deep]
        result = {"file": "probes.csv", "columns": selected, "x": [k / 10.0 for k in deep], "at": {"time_s": "last"}}
        parts.append(f'[[check]]\nquantity = "{what} at probes"\nruns = ["column, *"]\nresult = {text(result)}')
    check("outflow of the rock", "column", "history.csv", "rock_outflow_m2 - lost", "rock_outflow_error_m2")


def series(z: float, t: float) -> float:
    """Pressure over the undrained one at the depth z."""
    return sum(4.0 / math.pi / (2 * m + 1) * math.sin((2 * m + 1) * math.pi / 2.0 * z) * math.exp(-(((2 * m + 1) * math.pi / 2.0) ** 2) * t) for m in range(200))


def exponential_integral(x: float) -> float:
    """E_1(x), by its series or its continued fraction."""
    if x < 1.0:
        total, term = -0.5772156649015329 - math.log(x), 1.0
        for n in range(1, 40):
            term *= -x / n
            total -= term / n
        return total
    fraction = 0.0
    for n in range(80, 0, -1):
        fraction = n / (1.0 + n / (x + fraction))
    return math.exp(-x) / (x + fraction)


def sources() -> None:
    """A line source, and wells in rock: steady and early."""
    _, c = diffusion(40e9, 0.2, 0.8, 0.01, 4e-10, 5e-20, 1e-4)
    states = [(0.01, 1.0, 1800.0, 54000.0), (0.02, 2.0, 5400.0, 54000.0), (0.01, 1.0, 0.0, 54000.0)]
    for _ in range(3):
        end = draw(15000, 54000, -2)
        states.append((0.02, RANDOM.choice((0.5, 1.0, 2.0)), RANDOM.choice((0.0, end / 20.0)), end))
    for i, (size, large, step, end) in enumerate(states):
        exact = {name: 18405496.0856 + 5e-9 * 1e-4 / 4.0 / math.pi / 5e-20 * exponential_integral(r**2 / 4.0 / c / end) for name, r in (("near", 0.1), ("far", 0.5))}
        given = {"coarse.size_fracture": size, "coarse.size_boundary": large, "time.end": end}
        run(f"line source, {i + 1}", "line source", "../line_source/line_source.nml", {**given, **({"time.step": step} if step else {})}, {"at_near": exact["near"], "at_far": exact["far"]}, () if step else ("time.step",))
    names = ("near", "near_opposite", "far", "far_opposite")
    selected = [f"({name}_p_pa - at_{name.split('_')[0]})/{name}_p_error_pa" for name in names]
    result = {"file": "probes.csv", "columns": selected, "x": [1.0, 2.0, 3.0, 4.0], "at": {"time_s": "last"}}
    parts.append(f'[[check]]\nquantity = "pore pressure at probes, line source"\nruns = ["line source, *"]\nresult = {text(result)}')
    wells = [(h, x, y, p) for h in (0.1, 0.15, 0.2) for x, y, p in ((0.0, 0.0, 89082.5605), (0.3, 0.2, 87270.5016), (-0.55, 0.7, 76734.7261))]
    for i, (size, x, y, p) in enumerate(wells):
        given = {"coarse.size_boundary": size, "injection.1.x": x, "injection.1.y": y}
        run(f"rock at a rate, {i + 1}", "rock at a rate", "../wells_in_rock/wells_in_rock.nml", given, {"p": p})
        run(f"rock at a pressure, {i + 1}", "rock at a pressure", "../wells_in_rock/wells_in_rock.nml", {**given, "injection.1.pressure": p}, {"p": p}, ("injection.1.rate",))
    _, c = diffusion(40e9, 0.2, 0.8, 0.1, 4e-10, 1e-15, 1e-3)
    early = [(0.1, 0.05), (0.1, 0.5), (0.05, 2.0)] + [(RANDOM.choice((0.05, 0.1)), float(f"{10 ** RANDOM.uniform(-1.0, 0.3):.2g}")) for _ in range(3)]
    for i, (size, end) in enumerate(early):
        p = 1e-7 * 1e-3 / 4.0 / math.pi / 1e-15 * exponential_integral(0.004**2 / 4.0 / c / end)
        run(f"rock at a rate, early {i + 1}", "rock at a rate", "../wells_in_rock/wells_in_rock.nml", {"coarse.size_boundary": size, "time.end": end}, {"p": p})
    check("pressure of a well in rock", "rock at a rate", "wells.csv", "pressure_pa - p", "pressure_error_pa")
    check("head pressure of a well in rock", "rock at a rate", "wells.csv", "head_pressure_pa - p", "head_pressure_error_pa")
    check("flow of a well in rock", "rock at a pressure", "wells.csv", "flow_m2_s - 1.0e-7", "flow_error_m2_s")


def events() -> None:
    """A slip event of uniform stress drop."""
    a = 0.45
    states = [(0.01, 5.0), (0.02, 5.0), (0.04, 5.0)] + [(RANDOM.choice((0.015, 0.03, 0.05)), draw(4.5, 8, 2)) for _ in range(3)]
    for i, (size, mpa) in enumerate(states):
        drop = 10e6 - 0.6 * (20e6 - mpa * 1e6)
        exact = {
            "drop": drop,
            "slip": math.pi / 2.0 * 0.8 * drop * a / (40e9 / 2.4),
            "moment": math.pi * 0.8 * a**2 * drop,
            "magnitude_exact": (math.log10(math.pi * 0.8 * a**2 * drop) - 9.1) / 1.5,
        }
        given = {"coarse.size_fracture": size, "injection.1.pressure": mpa * 1e6}
        run(f"slip event, {i + 1}", "slip event", "../slip_events/uniform_drop.nml", given, exact)
    for name, exact_name, unit in (("moment", "moment", "_nm"), ("mean_slip", "slip", "_m"), ("magnitude", "magnitude_exact", ""), ("stress_drop", "drop", "_pa")):
        check(f"{name.replace('_', ' ')} of a slip event", "slip event", "slip_events.csv", f"{name}{unit} - {exact_name}", f"{name}_error{unit}")


if __name__ == "__main__":
    for family in (pressurized, sheared, without_fluid, leaking, columns, sources, events):
        family()
    Path(__file__).with_name("check.toml").write_text("\n".join([HEAD, "\n\n".join(parts), ""]), encoding="utf-8")
