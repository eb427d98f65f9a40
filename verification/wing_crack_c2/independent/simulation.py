"""One step of time: contact, opening, leak-off and pressure of a crack that is its own image.

Unknown at each time are the jumps of the crack (coefficients of the shape functions of its
elements), the rate at which each of its cells loses fluid (constant since the last time) and the
pressure in it, one for all of the crack. The equations are contact or opening at each collocation
point, p = p_F at the middle of each cell, and the balance of fluid. All that went before enters by
superposition of the closed forms of `poroelastic`. A finite body has an outline of cells with jumps
of their own, which make its traction that of the far stresses; its fluid is kept in by images.
Crack and outline are their own image under a turn by 180 degrees: only one half is unknown.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from .contact import OPEN, SLIP, Contact
from .elastic import (
    NODES,
    POINTS,
    Numbers,
    equivalent_intensity,
    intensity,
    shapes,
    symmetric_influence,
    turned,
)
from .geometry import Geometry, Resolution, build_geometry
from .images import ITSELF, TURN, Copy, Supports, images
from .poroelastic import Pairs, Rock

PRESSURE, NORMAL, SHEAR = 0, 1, 2  # effects of sources and jumps
GROUP = 0.05  # cells that act from other cracks, and from the outline, as one [m]


@dataclass(frozen=True)
class Scene:
    """What is injected into what, in SI units."""

    rock: Rock
    toughness: float  # K_IC [Pa m^1/2]
    stress_xx: float  # far away, total [Pa]
    stress_yy: float
    half_length: float  # of the fracture [m]
    angle: float  # of the fracture [rad]
    aperture: float  # of the unloaded fracture [m]
    friction: float
    dilation: float  # tan(psi)
    rate: float  # into the whole fracture [m2/s]
    gain: float  # of a wing at the end [m]
    supports: Supports = "none"  # of a sealed square body; none: the infinite plane
    half_width: float = 1.0  # of the body [m]

    @property
    def initial_pressure(self) -> float:
        """Undrained pressure of the rock under the far stresses [Pa]."""
        return self.rock.undrained_pressure(self.stress_xx, self.stress_yy)


@dataclass(frozen=True)
class State:
    """The crack at a time; cells are those of the outline, then those of the crack."""

    time: float
    pressure: float
    k1: float
    k2: float
    opening: Numbers  # at the collocation points of the crack [m]
    slip: Numbers
    cell_jumps: Numbers  # [jump, cell] means [m]
    rates: Numbers  # loss of each cell per length [m/s]
    volume: float  # of opening, of this half [m2]
    contact: Contact
    normal: Numbers  # contact traction at the points [Pa]
    back_stress: float  # what the fluid in the rock does to the normal traction at the centre [Pa]
    geometry: Geometry

    @property
    def equivalent(self) -> float:
        """K_eq [Pa m^1/2]."""
        return equivalent_intensity(self.k1, self.k2)[0]


class ContactError(RuntimeError):
    """The states of contact have not settled."""


def restrict(values: Numbers, count: int) -> Numbers:
    """Values with zeros for cells that came later."""
    return np.pad(values, [(0, 0)] * (values.ndim - 1) + [(0, count - values.shape[-1])])


def block_diagonal(block: Numbers) -> Numbers:
    """The block twice on the diagonal."""
    zero = np.zeros_like(block)
    return np.block([[block, zero], [zero, block]])


@dataclass(frozen=True)
class Step:
    """What a step of time adds to the equations: its length and the effects of cells on cells."""

    length: float  # [s]
    past: Numbers  # [effect, cell] of all that went before
    source: Numbers  # [effect, point, cell] of unit rates
    jump: Numbers  # [effect, point, jump and cell] of unit jumps


@dataclass(frozen=True)
class Solution:
    """Unknowns of a step."""

    coefficients: Numbers  # [jump, outline cell or shape function]
    values: Numbers  # [jump, point] of the crack [m]
    cell_jumps: Numbers
    contact: Contact
    normal: Numbers
    rates: Numbers
    pressure: float


class Body:
    """A crack of given shape in its body: what its cells do to each other."""

    def __init__(self, scene: Scene, geometry: Geometry, coupled: bool) -> None:
        self.scene, self.geometry, self.coupled = scene, geometry, coupled
        self.count = geometry.half.size
        crack = slice(geometry.outline_cells, self.count)
        outline = slice(0, geometry.outline_cells)
        copies = images(scene.supports, scene.half_width)
        self.near = [self.acting(crack, crack, copy) for copy in (ITSELF, TURN)]
        self.other = [self.acting(crack, crack, copy) for copy in copies.crack_on_crack]
        if geometry.outline_cells > 0:
            for target, source, some in (
                (crack, outline, copies.outline_on_crack),
                (outline, crack, copies.crack_on_outline),
                (outline, outline, copies.outline_on_outline),
            ):
                self.other += [self.acting(target, source, copy) for copy in some]
        self.join_groups()
        self.undrained = self.outline_effects()

    def acting(self, target: slice, source: slice, copy: Copy) -> Acting:
        """What copies of some cells do to others."""
        cells = self.geometry
        pairs = Pairs(
            self.scene.rock,
            cells.centre[target],
            cells.angle[target],
            copy.places(cells.centre[source]),
            copy.directions(cells.angle[source]),
            cells.half[source],
        )
        return Acting(target, source, copy, pairs)

    def outline_effects(self) -> Numbers:
        """Effects of unit jumps of the outline, at all times: [effect, cell, jump, cell].

        They strain the body almost evenly; then its pressure changes evenly and nothing flows. So
        they act undrained for good: exact but for what is uneven in that strain.
        """
        result = np.zeros((3, self.count, 2, self.count))
        outer = self.geometry.outline_cells
        for acting in self.other:
            if acting.source.stop == outer:
                effects = acting.copy.weight * acting.pairs.jump(1e-9)
                effects[1] *= acting.copy.slip_sign
                result[:, acting.target, :, acting.source] += effects.transpose(1, 2, 0, 3)
        return result

    def join_groups(self) -> None:
        """Join cells of the crack to groups, whose fluid acts from afar as that of one cell."""
        cells, outer = self.geometry, self.geometry.outline_cells
        group = cells.groups(GROUP)
        count = group.max() + 1
        lengths = 2.0 * cells.half[outer:]
        share = np.zeros((count, lengths.size))
        share[group, np.arange(lengths.size)] = lengths
        total = share.sum(axis=1)
        self.gather = share / total[:, None]  # rates of groups from those of cells
        self.spread = np.zeros((self.count, outer + count))  # effects on cells from those on groups
        self.spread[:outer, :outer] = np.eye(outer)
        self.spread[np.arange(outer, self.count), outer + group] = 1.0
        centre = self.gather @ cells.centre[outer:]
        angle = np.angle(self.gather @ np.exp(1j * cells.angle[outer:]))
        copies = images(self.scene.supports, self.scene.half_width)
        self.far = []
        for target, some, points, lines in (
            (slice(0, outer), copies.fluid_on_outline, cells.centre[:outer], cells.angle[:outer]),
            (slice(outer, outer + count), copies.fluid_on_crack, centre, angle),
        ):
            if some:
                pairs = Pairs(
                    self.scene.rock,
                    points,
                    lines,
                    np.concatenate([copy.places(centre) for copy in some]),
                    np.concatenate([copy.directions(angle) for copy in some]),
                    np.tile(total / 2.0, len(some)),
                )
                self.far.append((target, pairs, np.array([copy.weight for copy in some])))

    def far_sources(self, lag: float) -> Numbers:
        """Effects of the fluid of images of groups: [effect, cell, cell of the crack]."""
        groups = self.gather.shape[0]
        result = np.zeros((3, self.spread.shape[1], groups))
        for target, pairs, weight in self.far:
            effects = pairs.source(lag).reshape(3, -1, weight.size, groups)
            result[:, target] = np.einsum("epcg,c->epg", effects, weight)
        return np.asarray(self.spread @ result @ self.gather)

    def jump_effects(self, lag: float) -> Numbers:
        """Effects of unit jumps of cells a time ago: [effect, cell, jump and cell]."""
        if not self.coupled:
            return np.zeros((3, self.count, 2 * self.count))
        result = self.undrained.copy()
        for acting in self.near:
            effects = acting.pairs.jump(lag).transpose(1, 2, 0, 3)
            result[:, acting.target, :, acting.source] += effects
        return result.reshape(3, self.count, -1)

    def source_effects(self, lag: float) -> Numbers:
        """Effects of unit rates of cells since a time ago: [effect, cell, cell]."""
        result = np.zeros((3, self.count, self.count))
        for acting in self.near:
            result[:, acting.target, acting.source] += acting.pairs.source(lag)
        if self.far:
            result[:, :, self.geometry.outline_cells :] += self.far_sources(lag)
        if not self.coupled:
            result[NORMAL : SHEAR + 1] = 0.0
        return result

    def influence(self, modulus: float) -> Numbers:
        """Elastic tractions of unit jumps: [traction, point, jump, function].

        The crack and its turned image act on its points by their elements, all else by cells.
        """
        geometry = self.geometry
        outer = geometry.outline_cells
        cells = np.zeros((2, self.count, 2, self.count))
        for acting in self.other:
            unit = modulus * acting.copy.weight * acting.pairs.elastic()
            for jump, sign in enumerate((1.0, acting.copy.slip_sign)):
                cells[:, acting.target, jump, acting.source] += sign * unit[jump]
        if self.scene.supports == "tractions":
            # A turn of the whole body makes no tractions: this gives it a stiffness. What loads the
            # outline has no moment, so the solution does not feel it.
            centre, angle = geometry.centre[:outer], geometry.angle[:outer]
            lever = np.conj(1j * centre) * np.exp(1j * angle)
            turn = np.stack([-lever.imag, lever.real])  # normal, along
            stiffness = np.einsum("ti,sj,j->tisj", turn, turn, geometry.half[:outer])
            cells[:, :outer, :, :outer] += modulus * stiffness / self.scene.half_width**4
        result = geometry.points_from_cells() @ cells.reshape(2, self.count, -1)
        result = result.reshape(2, -1, 2, self.count) @ geometry.averages()
        result[:, outer:, :, outer:] += symmetric_influence(geometry.elements, modulus)
        return np.asarray(result)


@dataclass(frozen=True)
class Acting:
    """A copy of some cells that acts on others; jumps of a crack from afar as in drained rock."""

    target: slice
    source: slice
    copy: Copy
    pairs: Pairs


@dataclass
class Simulation:
    """Scene, resolution, and all that happened so far."""

    scene: Scene
    resolution: Resolution
    coupled: bool = True  # jumps change the pore pressure, fluid in the rock the stress
    sources: list[tuple[float, Numbers]] = field(default_factory=list)  # changes of rates
    jumps: list[tuple[float, Numbers]] = field(default_factory=list)  # changes of cell_jumps
    states: list[State] = field(default_factory=list)

    def body(self, wing: list[complex]) -> Body:
        """Crack with a wing whose pieces end at the given places, from the fracture's end on."""
        scene = self.scene
        width = None if scene.supports == "none" else scene.half_width
        geometry = build_geometry(self.resolution, scene.half_length, scene.angle, width, wing)
        return Body(scene, geometry, self.coupled)

    def start(self) -> State:
        """State under the far stresses without flow: the rock is undrained."""
        body = self.body([])
        geometry, rock = body.geometry, self.scene.rock
        undrained = rock.modulus + (rock.stiffening if self.coupled else 0.0)
        matrices = body.influence(undrained)
        points = geometry.elements.points.size
        contact = Contact(np.full(points, SLIP), np.ones(points), np.zeros(points))
        effects = body.jump_effects(1e-6)[PRESSURE]
        crack, lengths = slice(geometry.outline_cells, None), geometry.half
        pressure = self.scene.initial_pressure
        while True:  # the opening by dilation changes the mean pressure at the fracture by a trifle
            solution = self.solve(geometry, matrices, contact, pressure)
            induced = (effects @ solution.cell_jumps.ravel())[crack]
            mean = float(induced @ lengths[crack] / lengths[crack].sum())
            if abs(self.scene.initial_pressure + mean - pressure) < 1.0:
                break
            pressure = self.scene.initial_pressure + mean
        # windows of K see the rock as it is at that time: undrained
        state = self.make_state(0.0, geometry, solution, undrained, 0.0)
        self.states.append(state)
        self.jumps.append((0.0, state.cell_jumps))
        return state

    def trial(self, time: float, body: Body, matrices: Numbers) -> State:
        """State at a time for a crack of given shape, from the last accepted one."""
        last, geometry, count = self.states[-1], body.geometry, body.count
        past = np.zeros((3, count))
        for since, change in self.sources:
            past += body.source_effects(time - since) @ restrict(change, count)
        for since, change in self.jumps:
            past += body.jump_effects(time - since) @ restrict(change, count).ravel()
        length = time - last.time
        source = body.source_effects(length)
        jump = body.jump_effects(0.5 * length)
        past -= source @ restrict(last.rates, count)
        past -= jump @ restrict(last.cell_jumps, count).ravel()
        contact = last.contact.moved(last.geometry.places, geometry.places)
        step = Step(length, past, source, jump)
        solution = self.solve(geometry, matrices, contact, last.pressure, step)
        back = past + source @ solution.rates + jump @ solution.cell_jumps.ravel()
        middle = float(back[NORMAL, geometry.outline_cells])
        return self.make_state(time, geometry, solution, self.scene.rock.modulus, middle)

    def accept(self, state: State) -> None:
        """Take a state as what has happened."""
        last = self.states[-1]
        count = state.rates.size
        middle = 0.5 * (last.time + state.time)
        self.sources.append((last.time, state.rates - restrict(last.rates, count)))
        self.jumps.append((middle, state.cell_jumps - restrict(last.cell_jumps, count)))
        self.states.append(replace(state, contact=replace(state.contact, slip=state.slip)))

    def make_state(
        self, time: float, geometry: Geometry, solution: Solution, modulus: float, back: float
    ) -> State:
        """State from the solution of the equations."""
        half = float(geometry.elements.half[-1])
        crack = slice(geometry.outline_cells, None)
        return State(
            time,
            solution.pressure,
            intensity(solution.coefficients[0, -POINTS], half, modulus),
            intensity(solution.coefficients[1, -POINTS], half, modulus),
            solution.values[0],
            solution.values[1],
            solution.cell_jumps,
            solution.rates,
            float(2.0 * geometry.half[crack] @ solution.cell_jumps[0, crack]),
            solution.contact,
            solution.normal,
            back,
            geometry,
        )

    def solve(
        self,
        geometry: Geometry,
        matrices: Numbers,
        contact: Contact,
        pressure: float,
        step: Step | None = None,
    ) -> Solution:
        """Solve for jumps, and with a step for rates and pressure too, until contact holds.

        Parameters
        ----------
        matrices: of `Body.influence`
        pressure: in the crack; with a step, that of the last state [Pa]
        """
        scene = self.scene
        outer = geometry.outline_cells
        points = matrices.shape[1]  # middles of outline cells, then points of the crack
        cells = geometry.half.size
        unknowns = 2 * points + (cells + 1 if step else 0)
        averages = geometry.averages()
        both = block_diagonal(averages)
        values = np.eye(points)
        values[-POINTS:, -POINTS:] = shapes(NODES, True)
        # contact tractions f = rows @ x + constant; on the outline, changes of traction
        rows = np.zeros((2, points, unknowns))
        rows[:, :, : 2 * points] = matrices.reshape(2, points, 2 * points)
        constant = np.zeros((2, points))
        crack_points = points - outer
        constant[:, outer:] = turned(
            np.full(crack_points, scene.stress_xx),
            np.full(crack_points, scene.stress_yy),
            np.zeros(crack_points),
            geometry.elements.point_angles,
        )
        if step:
            to_points = geometry.points_from_cells()
            tractions = slice(NORMAL, SHEAR + 1)
            constant += step.past[tractions] @ to_points.T
            rows[:, :, 2 * points : -1] = to_points @ step.source[tractions]
            rows[:, :, : 2 * points] += to_points @ step.jump[tractions] @ both
            rows[0, outer:, -1] = 1.0
        else:
            constant[0, outer:] += pressure
        jump_rows = np.zeros((2, points, unknowns))
        jump_rows[0, :, :points] = values
        jump_rows[1, :, points : 2 * points] = values
        column = np.full(unknowns, 1e-6)  # scales of the unknowns: jumps, rates, pressure
        column[2 * points :] = 1e-8
        if step:
            column[-1] = 1e6
        first, second = np.arange(points), points + np.arange(points)
        opening = None
        for _ in range(60):
            matrix = np.zeros((unknowns, unknowns))
            right = np.zeros(unknowns)
            state = np.concatenate([np.full(outer, OPEN), contact.state])
            sign = np.concatenate([np.ones(outer), contact.sign])
            slip = np.concatenate([np.zeros(outer), contact.slip])
            opened, slipping = state == OPEN, state == SLIP
            matrix[first[opened]] = rows[0, opened]
            right[first[opened]] = -constant[0, opened]
            matrix[second[opened]] = rows[1, opened]
            right[second[opened]] = -constant[1, opened]
            closed = ~opened
            side = np.where(slip + 1e-15 * sign >= 0.0, 1.0, -1.0)[:, None]
            stiff = scene.rock.modulus  # of rows of jumps, so that all rows are pressures
            gap_rows = jump_rows[0] - scene.dilation * side * jump_rows[1]
            matrix[first[closed]] = gap_rows[closed] * stiff
            drag = scene.friction * sign[:, None]
            matrix[second[slipping]] = (rows[1] + drag * rows[0])[slipping]
            right[second[slipping]] = -(constant[1] + drag[:, 0] * constant[0])[slipping]
            stuck = closed & ~slipping
            matrix[second[stuck]] = jump_rows[1, stuck] * stiff
            right[second[stuck]] = slip[stuck] * stiff
            if step:
                inner = 2 * points + np.arange(outer, cells)
                matrix[inner, 2 * points : -1] = step.source[PRESSURE, outer:]
                matrix[inner, : 2 * points] = step.jump[PRESSURE, outer:] @ both
                matrix[inner, -1] = -1.0
                right[inner] = -step.past[PRESSURE, outer:] - scene.initial_pressure
                rim = 2 * points + np.arange(outer)
                matrix[rim, rim] = 1e6 / column[rim]  # the outline gives no fluid
                row, total = self.balance(geometry, averages, step.length, pressure, opening)
                size = np.abs(row * column).max() / 1e6
                matrix[-1], right[-1] = row / size, total / size
            x = np.linalg.solve(matrix * column, right) * column
            coefficients = x[: 2 * points].reshape(2, points)
            jumps = (coefficients @ values.T)[:, outer:]
            force = (rows @ x + constant)[:, outer:]
            opening = coefficients[0] @ averages.T
            new = contact.updated(
                jumps[0], jumps[1], force[0], force[1], scene.friction, scene.dilation
            )
            if np.array_equal(new.state, contact.state) and np.array_equal(new.sign, contact.sign):
                return Solution(
                    coefficients,
                    jumps,
                    coefficients @ averages.T,
                    contact,
                    force[0],
                    x[2 * points : -1] if step else np.zeros(cells),
                    float(x[-1]) if step else pressure,
                )
            contact = new
        raise ContactError("contact has not settled in 60 iterations")

    def balance(
        self,
        geometry: Geometry,
        averages: Numbers,
        step: float,
        pressure: float,
        opening: Numbers | None,
    ) -> tuple[Numbers, float]:
        """Row and right side of the balance of fluid in this half of the crack [m2]."""
        scene, last, outer = self.scene, self.states[-1], geometry.outline_cells
        cells, points = averages.shape
        lengths = 2.0 * geometry.half
        lengths[:outer] = 0.0
        if opening is None:
            opening = restrict(last.cell_jumps, cells)[0]
        fracture = np.arange(cells) < outer + geometry.fracture_cells
        rest = np.where(fracture, scene.aperture, 0.0)
        held = float(lengths @ (rest + np.maximum(opening, 0.0)))
        elastic = held * scene.rock.compressibility
        row = np.zeros(2 * points + cells + 1)
        row[:points] = lengths @ averages
        row[2 * points : -1] = step * lengths
        row[-1] = elastic
        return row, last.volume + elastic * pressure + 0.5 * scene.rate * step
