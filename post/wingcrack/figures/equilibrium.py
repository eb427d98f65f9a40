"""The equilibrium path of length control: its branches, and the energy that a dead load releases.

Along the path each tip that grows is at its toughness: G(f, a) = G_c with the load factor f and the
length a. Where f falls as a grows (in the direction of the load), a load that does not fall drives
the tips: growth is unstable until the path returns to the factor f0 at which it began. The energy
released meanwhile, per metre of thickness, is

    E = integral of (G(f0, a) - G_c) da  [J/m]

Where all of the load is in proportion to f, the strain energy is U = f^2 C(a)/2 with a compliance
(under grips a stiffness) C = 2 U/f^2 [J/m], and G = f^2/2 dC/da (under grips -dC/da). Then

    E = integral of (f0^2 - f^2)/2 |dC|  [J/m]

which is the area between the path and the straight line f = f0 over the quantity q = 2 U/f = f C
[J/m] that is conjugate to f: a displacement under forces, a force under grips.

Where loads that do not change with the factor drive the tips, they grow at one factor, with K_eq
above K_IC. There G is known at each state from K, and E is its integral, by trapezoids.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wingcrack.errors import AbsentError
from wingcrack.figures.read import Run
from wingcrack.figures.scene import FORCES
from wingcrack.figures.table import BoolArray, FloatArray

_LONGER = 1.0e-9  # share of the length beyond which growth is more than round-off
_LEAST_FALL = 0.01  # share of f0: twice what the solver lets K_eq of growing tips miss K_IC by


@dataclass(frozen=True)
class Release:
    """Unstable growth that a load fixed at `factor` would see."""

    # first, last: states, from 0 in the path, between which it lies: it begins at the first and
    # ends in the interval that ends with the last
    first: int
    last: int
    factor: float  # f0, at which the load stays [-]
    # of the last interval, at which the path is back at f0 [-]; 1 where it does not come back
    share: float
    arrests: bool  # whether it comes back
    length_m: float  # grown between [m]
    # E set free, per metre of thickness [J/m]; None where the load is not in proportion to f and
    # the states are not at f0
    energy_j_m: float | None


@dataclass(frozen=True)
class EquilibriumPath:
    """States in which tips are at their toughness, in the order of the run."""

    factor: FloatArray  # (n,) load factor f [-]
    length_m: FloatArray  # (n,) length of all fractures [m]
    opening_m: FloatArray  # (n,) mean opening of all fractures [m]
    slip_m: FloatArray  # (n,) largest slip [m]
    # (n,) q = 2 U/f [J/m]; None where the load is not in proportion to f
    conjugate_j_m: FloatArray | None
    under_forces: bool  # whether q is a displacement; else it is a force
    # (n - 1,) of bool whether the piece from each state to the next one is passed over by a load
    # that stays
    unstable: BoolArray
    releases: tuple[Release, ...]  # what is unstable, in order; none of them overlap


def equilibrium_path(run: Run) -> EquilibriumPath:
    """Find the path of a run in length control, with what is unstable on it.

    Raises `AbsentError` if the run is not one in length control, or nothing has grown.
    """
    scene, history = run.scene, run.history
    if not history.has("load_factor") or scene is None or scene.control != "length":
        raise AbsentError("growth does not control the load")
    length = history.number("fracture_length_m")
    grown = np.flatnonzero(length[1:] > length[:1] * (1.0 + _LONGER))
    if grown.size == 0:
        raise AbsentError("nothing has grown")
    states = slice(int(grown[0]), None)  # from the onset: a row comes before the growth it drives
    factor, length = history.number("load_factor")[states], length[states]
    way = -1.0 if factor[0] < 0.0 else 1.0
    in_proportion = bool(scene.drive) and bool(np.all(way * factor > 0.0))
    energy = history.number("strain_energy_j")[states] if in_proportion else None
    compliance = None if energy is None else 2.0 * energy / factor**2
    releases = find_releases(way * factor, length, compliance)
    releases += _at_one_factor(run, int(grown[0]), way * factor, length, releases)
    releases.sort(key=lambda one: one.first)
    unstable = np.zeros(factor.size - 1, dtype=np.bool_)
    for release in releases:
        unstable[release.first : release.last] = True
    return EquilibriumPath(
        factor=factor,
        length_m=length,
        opening_m=history.number("fracture_volume_m2")[states] / length,
        slip_m=history.number("max_slip_m")[states],
        conjugate_j_m=None if compliance is None else factor * compliance,
        under_forces=scene.drive == FORCES,
        unstable=unstable,
        releases=tuple(replace(one, factor=way * one.factor) for one in releases),
    )


def _at_one_factor(
    run: Run, begun: int, factor: FloatArray, length_m: FloatArray, known: list[Release]
) -> list[Release]:
    """Find growth at the same factor that is not known yet; the path's first row is `begun`."""
    taken = {piece for one in known for piece in range(one.first, one.last)}
    found: list[Release] = []
    first = 0
    while first < factor.size - 1:
        last = first
        while last < factor.size - 1 and last not in taken and factor[last + 1] == factor[first]:
            last += 1
        if length_m[last] > length_m[first] * (1.0 + _LONGER):
            found.append(
                Release(
                    first=first,
                    last=last,
                    factor=float(factor[first]),
                    share=1.0,
                    arrests=last < factor.size - 1,
                    length_m=float(length_m[last] - length_m[first]),
                    energy_j_m=surplus_of_tips(run, begun + first + 1, begun + last + 1),
                )
            )
        first = max(last, first + 1)
    return found


def surplus_of_tips(run: Run, first: int, last: int) -> float | None:
    """Integral of G - G_c over the growth between two rows of history.csv, from 1 [J/m].

    None where intensities or toughness are not known.
    """
    tips, scene = run.tips, run.scene
    names = ("history_row", "tip", "fracture", "keq_pa_sqrtm", "g_j_m2", "advance_m")
    if tips is None or scene is None or not scene.toughness_pa_sqrtm or not tips.has(*names):
        return None
    row, tip, fracture, intensity, rate, advance = (tips.number(name) for name in names)
    energy = 0.0
    for at in np.flatnonzero((row > first) & (row <= last) & (advance > 0.0)):
        own = scene.fractures[int(fracture[at]) - 1].toughness_pa_sqrtm
        toughness = own or scene.toughness_pa_sqrtm
        if not intensity[at] > 0.0:
            return None
        needed = rate[at] * (toughness / intensity[at]) ** 2  # G goes with the square of K
        before = np.flatnonzero((row == row[at] - 1) & (tip == tip[at]))
        rates = [rate[at], rate[before[0]] if before.size else rate[at]]
        energy += float((np.mean(rates) - needed) * advance[at])
    return energy


def find_releases(
    factor: FloatArray, length_m: FloatArray, compliance_j_m: FloatArray | None
) -> list[Release]:
    """Find what is unstable on a path whose load rises from 0.

    Parameters
    ----------
    factor : (n,) array
        Load factor, positive [-].
    length_m : (n,) array
        Lengths, which do not fall [m].
    compliance_j_m : (n,) array or None
        C = 2 U/f^2 [J/m]; None: energies stay unknown.

    Notes
    -----
    A fall of less than 1 % is none: so far the factor of growing tips may be off.
    """
    found: list[Release] = []
    first = 0
    while first < factor.size - 1:
        back = np.flatnonzero(factor[first + 1 :] >= factor[first])
        last = first + 1 + int(back[0]) if back.size else factor.size - 1
        grows = length_m[first + 1] > length_m[first] * (1.0 + _LONGER)
        if not grows or factor[first : last + 1].min() > (1.0 - _LEAST_FALL) * factor[first]:
            first += 1
            continue
        share = 1.0
        if back.size:
            share = float((factor[first] - factor[last - 1]) / (factor[last] - factor[last - 1]))
        along = np.array([*range(first, last), last - 1 + share])
        found.append(_release(factor, length_m, compliance_j_m, along, arrests=bool(back.size)))
        first = last
    return found


def _release(
    factor: FloatArray,
    length_m: FloatArray,
    compliance_j_m: FloatArray | None,
    along: FloatArray,
    *,
    arrests: bool,
) -> Release:
    """Give the growth along places of the path, from the first to the last, and its energy."""

    def at_places(values: FloatArray) -> FloatArray:
        return np.interp(along, np.arange(values.size), values)

    first, held, grown = int(along[0]), float(factor[int(along[0])]), at_places(length_m)
    energy = None
    if compliance_j_m is not None:
        surplus = 0.5 * (held**2 - at_places(factor) ** 2)
        rise = np.diff(at_places(compliance_j_m))
        energy = float(abs(np.sum(0.5 * (surplus[1:] + surplus[:-1]) * rise)))
    return Release(
        first=first,
        last=first + along.size - 1,
        factor=held,
        share=float(along[-1] - along[-2]),
        arrests=arrests,
        length_m=float(grown[-1] - grown[0]),
        energy_j_m=energy,
    )
