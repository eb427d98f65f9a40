"""Write check.toml: states of known truth, half of them drawn by a seed, and what is asked of each.

Run with any Python 3: ``python3 make_states.py``. The exact values are closed forms (README.md).
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from pathlib import Path

SEED = 7
RANDOM = random.Random(SEED)
CELLS = (4, 6, 10, 20, 40)  # per half-length
DRAWN = (4, 5, 7, 8, 12, 15, 25, 30)

GAPS = {
    "direction, without a fluid": "the stated error of K_II of a crack under pressure alone is 29 "
    "times too large in the median",
}

HEAD = """title = "Stated errors of all quantities"
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
"""

parts: list[str] = []


def text(value: object) -> str:
    """Text of a value in TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(text, value)) + "]"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {text(v)}" for k, v in value.items()) + " }"
    return repr(value)


def _key(name: str) -> str:
    return name if name.replace("_", "").isalnum() else f'"{name}"'


def run(
    name: str,
    method: str,
    scene: str,
    given: Mapping[str, object],
    constants: Mapping[str, float],
    without: tuple[str, ...] = (),
) -> None:
    """Add a run."""
    lines = ["[[run]]", f'name = "{name}"', f'method = "{method}"', f'scene = "{scene}"']
    lines.append(f"set = {text(given)}")
    if without:
        lines.append(f"unset = {text(list(without))}")
    parts.append("\n".join([*lines, f"constants = {text(constants)}"]))


def check(quantity: str, method: str, file: str, value: str, error: str, **how: object) -> None:
    """Ask that the stated error of a quantity holds: (value - exact) over it."""
    column = f"({value})/maximum({error}, 1.0e-200)"
    add_check(quantity, method, {"file": file, "column": column, **(how or {"take": "last"})})


def add_check(quantity: str, method: str, result: Mapping[str, object]) -> None:
    """Add a check of a selection."""
    gap = f'\nknown_gap = "{GAPS[quantity]}"' if quantity in GAPS else ""
    parts.append(
        f'[[check]]\nquantity = "{quantity}"\nruns = ["{method}, *"]\nresult = {text(result)}{gap}'
    )


def draw(low: float, high: float, digits: int) -> float:
    """Draw a number with few digits."""
    return round(RANDOM.uniform(low, high), digits)


def plane(young: float, poisson: float) -> float:
    """E' of plane strain."""
    return young / (1.0 - poisson**2)


def pressurized() -> None:
    """Sneddon's crack on the coarse level, by a volume or by a pressure."""
    states = [(n, 0.2, 0.5, 40.0, 1.0) for n in CELLS]
    for _ in CELLS:
        elastic, a = (RANDOM.choice(DRAWN), draw(0.05, 0.4, 2)), draw(0.2, 1.0, 2)
        states.append((*elastic, a, draw(10, 70, 0), draw(0.3, 3, 2)))
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
        widest = 4.0 * p * a / modulus
        exact = {"a": a, "p": p, "volume": volume, "widest": widest, "held": 2e-3 * a}
        method, by_rate = "given volume", {**given, "injection.1.rate": volume / 100.0}
        run(f"{method}, {i + 1}", method, scene, by_rate, exact, ("growth",))
        method, by_pressure = "given pressure", {**given, "injection.1.pressure": p}
        run(f"{method}, {i + 1}", method, scene, by_pressure, exact, ("growth", "injection.1.rate"))
    last = {"where": {"time_s": "last"}}
    profile = "widest*sqrt(1 - ((s_m - a)/a)**2)"
    for method in ("given volume", "given pressure"):
        what, value = f"largest opening, {method}", "max_opening_m - widest"
        check(what, method, "history.csv", value, "max_opening_error_m")
        what, value = f"opening of cells, {method}", f"jump_n_m - {profile}"
        check(what, method, "fractures.csv", value, "jump_n_error_m", x="s_m", **last)
    method = "given volume"
    what = "pressure of a well, given volume"
    check(what, method, "wells.csv", "pressure_pa - p", "pressure_error_pa")
    what, of_cells = "pressure of cells, given volume", "fractures.csv"
    check(what, method, of_cells, "pressure_pa - p", "pressure_error_pa", x="s_m", **last)
    what, value = "injectivity, given volume", "injectivity_m2_s_pa - volume/100/p"
    check(what, method, "wells.csv", value, "injectivity_error_m2_s_pa")
    method = "given pressure"
    for stem, unit, true in (
        ("fracture_volume", "m2", "held + volume"),
        ("fracture_fluid", "m2", "volume"),
        ("injected", "m2", "volume"),
        ("injection_rate", "m2_s", "volume/100"),
    ):
        what, value = f"{stem}_{unit} at a given pressure", f"{stem}_{unit} - ({true})"
        check(what, method, "history.csv", value, f"{stem}_error_{unit}")
    what = "flow of a well at a given pressure"
    check(what, method, "wells.csv", "flow_m2_s - volume/100", "flow_error_m2_s")
    value = f"aperture_m - 1.0e-3 - {profile}"
    check("aperture of cells", method, of_cells, value, "aperture_error_m", x="s_m", **last)


def sheared() -> None:
    """Uniform stress drop on the coarse level."""
    states = [(n, 0.2, 45.0, 0.5, 6.8) for n in CELLS]
    while len(states) < 2 * len(CELLS):
        elastic = (RANDOM.choice(DRAWN), draw(0.05, 0.4, 2))
        state = (*elastic, draw(30, 60, 0), draw(0.3, 0.6, 2), draw(4, 8, 1))
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
        exact = {"a": a, "slip": slip, "moment": moment, "normal": normal}
        exact["shear"] = friction * normal
        scene = "../frictional_crack/frictional_crack.nml"
        run(f"stress drop, {i + 1}", "stress drop", scene, given, exact, ("growth",))
    cells("stress drop", {"x": "s_m", "where": {"time_s": "first"}})
    slips("stress drop", "", take="first")


def slips(method: str, remark: str, **how: object) -> None:
    """Ask for the largest slip and the moment."""
    value, error = "max_slip_m - slip", "max_slip_error_m"
    check(f"largest slip{remark}", method, "history.csv", value, error, **how)
    value, error = "seismic_moment_nm - moment", "seismic_moment_error_nm"
    check(f"seismic moment{remark}", method, "history.csv", value, error, **how)


def cells(method: str, how: Mapping[str, object]) -> None:
    """Ask for slip and tractions along a crack."""
    for what, value, error in (
        ("slip", "abs(jump_t_m) - slip*sqrt(1 - ((s_m - a)/a)**2)", "jump_t_error_m"),
        ("normal traction", "traction_n_pa + normal", "traction_n_error_pa"),
        ("shear traction", "abs(traction_t_pa) - shear", "traction_t_error_pa"),
    ):
        check(f"{what} of cells, {method}", method, "fractures.csv", value, error, **how)


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
        given = {"material.poisson": poisson, "fe.size_fracture": 1.0 / n}
        given["fracture.1.face_pressure"] = p
        exact = {
            "widest": 4.0 * p / modulus,
            "volume": 2.0 * math.pi * p / modulus,
            "energy": math.pi * p**2 / modulus,
            "k": p * math.sqrt(math.pi),
            "g": p**2 * math.pi / modulus,
        }
        scene = "../pressurized_crack/pressurized_faces.nml"
        run(f"open body, {i + 1}", "open body", scene, given, exact, ("fracture.2",))
    for what, value, error in (
        ("largest opening", "max_opening_m - widest", "max_opening_error_m"),
        ("volume", "fracture_volume_m2 - volume", "fracture_volume_error_m2"),
        ("strain energy", "strain_energy_j - energy", "strain_energy_error_j"),
    ):
        check(f"{what}, without a fluid", "open body", "history.csv", value, error)
    what, value = "opening of cells, without a fluid", "jump_n_m - widest*sqrt(1 - x_m**2)"
    check(what, "open body", "fractures.csv", value, "jump_n_error_m", x="x_m")
    for what, value, error in (
        ("K_eq", "keq_pa_sqrtm - k", "keq_error_pa_sqrtm"),
        ("energy release rate", "g_j_m2 - g", "g_error_j_m2"),
        ("direction", "angle_deg", "angle_error_deg"),
    ):
        check(f"{what}, without a fluid", "open body", "tips.csv", value, error, x="tip")
    closed_bodies()


def closed_bodies() -> None:
    """Uniform stress drop by finite elements."""
    states = [(n, 0.2, 0.5, 6.8) for n in CELLS]
    for _ in CELLS:
        elastic = (RANDOM.choice(DRAWN), draw(0.05, 0.4, 2))
        states.append((*elastic, draw(0.3, 0.55, 2), draw(5, 8, 1)))
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
        exact = {"a": a, "slip": slip, "moment": moment, "normal": normal}
        exact["shear"] = friction * normal
        scene = "../frictional_crack/closed_crack.nml"
        run(f"closed body, {i + 1}", "closed body", scene, given, exact)
    cells("closed body", {"x": "s_m"})
    slips("closed body", ", without a fluid")


def leaking() -> None:
    """A closed fracture with leak-off, at a rate and at a pressure."""
    states = [(t, 1e-19, 0.7, "auto", 1.0) for t in (10.0, 100.0, 1105.0, 3600.0)]
    states += [(3600.0, 1e-19, 0.7, "off", 1.0), (1105.0, 1e-19, 0.7, "off", 0.25)]
    states += [(3600.0, 1e-18, 0.7, "off", 0.25)]
    for _ in range(7):
        layers = RANDOM.choice(("auto", "auto", "off"))
        time, permeability = 10 ** RANDOM.uniform(1.0, 3.8), 10 ** RANDOM.uniform(-20.0, -18.0)
        rounded = (float(f"{time:.3g}"), float(f"{permeability:.3g}"))
        states.append((*rounded, draw(0.5, 0.9, 2), layers, RANDOM.choice((0.5, 1.0, 2.0))))
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
        rise = 2.0 * ratio / math.sqrt(math.pi) - 1.0 + erfcx(ratio)
        rise *= supply * held / (2.0 * storage) ** 2 / c
        gained = 20.0 * held * rise
        exact = {"rise": rise, "gained": gained, "leaked": 1e-7 * time - gained}
        method = "leaking at a rate"
        run(f"{method}, {i + 1}", method, "../thin_layers/rate.nml", given, exact)
        leaked = 80.0 * 1e7 * storage * math.sqrt(c * time / math.pi)
        exact = {"leaked": leaked, "filled": 20.0 * held * 1e7}
        method = "leaking at a pressure"
        run(f"{method}, {i + 1}", method, "../thin_layers/pressure.nml", given, exact)
    for method, what, file, value, error in (
        (
            "rate",
            "pressure of a well",
            "wells.csv",
            "pressure_pa - 20e6 - rise",
            "pressure_error_pa",
        ),
        ("rate", "injectivity", "wells.csv", "injectivity_m2_s_pa - 1e-7/rise", ""),
        ("rate", "fluid in fractures", "history.csv", "fracture_fluid_m2 - gained", ""),
        ("rate", "leak-off at a rate", "history.csv", "leakoff_m2 - leaked", ""),
        ("rate", "fluid in the rock", "history.csv", "rock_fluid_m2 - leaked", ""),
        ("pressure", "leak-off at a pressure", "history.csv", "leakoff_m2 - leaked", ""),
        ("pressure", "injected volume", "history.csv", "injected_m2 - leaked - filled", ""),
        ("pressure", "injected volume of a well", "wells.csv", "injected_m2 - leaked - filled", ""),
    ):
        column = value.split(" - ")[0]
        unit = "_m2_s_pa" if column.startswith("injectivity") else "_m2"
        stated = error or f"{column.removesuffix(unit)}_error{unit}"
        check(f"{what}, leaking", f"leaking at a {method}", file, value, stated)


def erfcx(x: float) -> float:
    """exp(x**2) erfc(x)."""
    if x < 25.0:
        return math.exp(x * x) * math.erfc(x)
    return 1.0 / (x * math.sqrt(math.pi)) * (1.0 - 0.5 / x**2)


def diffusion(
    young: float,
    poisson: float,
    biot: float,
    porosity: float,
    fluid: float,
    permeability: float,
    viscosity: float,
) -> tuple[float, float]:
    """Storage at uniaxial strain [1/Pa] and diffusivity [m2/s]."""
    bulk, shear = young / 3.0 / (1.0 - 2.0 * poisson), young / 2.0 / (1.0 + poisson)
    storage = porosity * fluid + (biot - porosity) / bulk + biot**2 / (bulk + 4.0 / 3.0 * shear)
    return storage, permeability / viscosity / storage


def columns() -> None:
    """Terzaghi's column: pressure, settlement, stress, outflow."""
    states = [(0.05, 1348.75, 53950.0), (0.1, 2697.5, 53950.0), (0.025, 1348.75, 10790.0)]
    states += [(0.05, 0.0, 53950.0), (0.1, 0.0, 107900.0)]
    for _ in range(6):
        end = draw(5000, 80000, -2)
        size = RANDOM.choice((0.04, 0.05, 0.06, 0.08))
        states.append((size, RANDOM.choice((0.0, end / 40.0, end / 80.0)), end))
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
            strains = (biot * start * series(1.0 - (j + 0.5) * y / n, t) - 10e6 for j in range(n))
            exact[f"u{k}"] = sum(strains) / axial * y / n
            exact[f"s{k}"] = lame / axial * (-10e6 + biot * p[k]) - biot * p[k]
        waves = [(2 * m + 1) * math.pi / 2.0 for m in range(200)]
        left = sum(2.0 / wave**2 * math.exp(-(wave**2) * t) for wave in waves)
        exact["lost"] = 0.25 * (storage + biot**2 / axial) * start * (1.0 - left)
        given = {"coarse.size_fracture": size, "coarse.size_boundary": size, "time.end": end}
        given.update({"time.step": step} if step else {})
        without = () if step else ("time.step",)
        run(f"column, {i + 1}", "column", "../terzaghi/terzaghi.nml", given, exact, without)
    for what, value, exact_name, error in (
        ("pore pressure", "p_pa", "p", "p_error_pa"),
        ("displacement", "uy_m", "u", "u_error_m"),
        ("stress", "sxx_pa", "s", "s_error_pa"),
    ):
        selected = [f"(z0{k}_{value} - {exact_name}{k})/z0{k}_{error}" for k in deep]
        places = {"x": [k / 10.0 for k in deep], "at": {"time_s": "last"}}
        result = {"file": "probes.csv", "columns": selected, **places}
        add_check(f"{what} at probes", "column", result)
    what, value = "outflow of the rock", "rock_outflow_m2 - lost"
    check(what, "column", "history.csv", value, "rock_outflow_error_m2")


def series(z: float, t: float) -> float:
    """Pressure over the undrained one at the depth z."""
    waves = [(2 * m + 1) * math.pi / 2.0 for m in range(200)]
    return sum(2.0 / wave * math.sin(wave * z) * math.exp(-(wave**2) * t) for wave in waves)


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
        step = RANDOM.choice((0.0, end / 20.0))
        states.append((0.02, RANDOM.choice((0.5, 1.0, 2.0)), step, end))
    for i, (size, large, step, end) in enumerate(states):
        exact = {}
        for name, r in (("near", 0.1), ("far", 0.5)):
            rise = 5e-9 * 1e-4 / 4.0 / math.pi / 5e-20 * exponential_integral(r**2 / 4.0 / c / end)
            exact[f"at_{name}"] = 18405496.0856 + rise
        given = {"coarse.size_fracture": size, "coarse.size_boundary": large, "time.end": end}
        given.update({"time.step": step} if step else {})
        without = () if step else ("time.step",)
        scene = "../line_source/line_source.nml"
        run(f"line source, {i + 1}", "line source", scene, given, exact, without)
    names = ("near", "near_opposite", "far", "far_opposite")
    selected = [f"({name}_p_pa - at_{name.split('_')[0]})/{name}_p_error_pa" for name in names]
    places = {"x": [1.0, 2.0, 3.0, 4.0], "at": {"time_s": "last"}}
    result = {"file": "probes.csv", "columns": selected, **places}
    add_check("pore pressure at probes, line source", "line source", result)
    wells_in_rock()


def wells_in_rock() -> None:
    """Steady, by images at the sides; early, in an infinite body."""
    scene = "../wells_in_rock/wells_in_rock.nml"
    places = ((0.0, 0.0, 89082.5605), (0.3, 0.2, 87270.5016), (-0.55, 0.7, 76734.7261))
    wells = [(size, *place) for size in (0.1, 0.15, 0.2) for place in places]
    for i, (size, x, y, p) in enumerate(wells):
        given = {"coarse.size_boundary": size, "injection.1.x": x, "injection.1.y": y}
        run(f"rock at a rate, {i + 1}", "rock at a rate", scene, given, {"p": p})
        method, by_pressure = "rock at a pressure", {**given, "injection.1.pressure": p}
        run(f"{method}, {i + 1}", method, scene, by_pressure, {"p": p}, ("injection.1.rate",))
    _, c = diffusion(40e9, 0.2, 0.8, 0.1, 4e-10, 1e-15, 1e-3)
    early = [(0.1, 0.05), (0.1, 0.5), (0.05, 2.0)]
    for _ in range(3):
        size = RANDOM.choice((0.05, 0.1))
        early.append((size, float(f"{10 ** RANDOM.uniform(-1.0, 0.3):.2g}")))
    for i, (size, end) in enumerate(early):
        p = 1e-7 * 1e-3 / 4.0 / math.pi / 1e-15 * exponential_integral(0.004**2 / 4.0 / c / end)
        given = {"coarse.size_boundary": size, "time.end": end}
        run(f"rock at a rate, early {i + 1}", "rock at a rate", scene, given, {"p": p})
    for what, method, column, true, error in (
        ("pressure", "rate", "pressure_pa", "p", "pressure_error_pa"),
        ("head pressure", "rate", "head_pressure_pa", "p", "head_pressure_error_pa"),
        ("flow", "pressure", "flow_m2_s", "1e-7", "flow_error_m2_s"),
    ):
        quantity, runs = f"{what} of a well in rock", f"rock at a {method}"
        check(quantity, runs, "wells.csv", f"{column} - {true}", error)


def events() -> None:
    """A slip event of uniform stress drop."""
    a = 0.45
    states = [(0.01, 5.0), (0.02, 5.0), (0.04, 5.0)]
    states += [(RANDOM.choice((0.015, 0.03, 0.05)), draw(4.5, 8, 2)) for _ in range(3)]
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
    for name, true, unit in (
        ("moment", "moment", "_nm"),
        ("mean_slip", "slip", "_m"),
        ("magnitude", "magnitude_exact", ""),
        ("stress_drop", "drop", "_pa"),
    ):
        what, value = f"{name.replace('_', ' ')} of a slip event", f"{name}{unit} - {true}"
        check(what, "slip event", "slip_events.csv", value, f"{name}_error{unit}")


if __name__ == "__main__":
    for family in (pressurized, sheared, without_fluid, leaking, columns, sources, events):
        family()
    whole = "\n".join([HEAD, "\n\n".join(parts), ""])
    Path(__file__).with_name("check.toml").write_text(whole, encoding="utf-8")
