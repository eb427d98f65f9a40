"""Onset, and growth in equilibrium: for each length of the wings the time at which K_eq = K_IC."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .elastic import Numbers, equivalent_intensity
from .simulation import Simulation, State

Progress = Callable[[State], None]
CLOSE = 2e-4  # of K_IC
STRAIGHT = 2e-3  # K_II at the end of a piece, of K_IC


class GrowthError(RuntimeError):
    """No equilibrium has been found."""


def find_onset(simulation: Simulation, report: Progress) -> State:
    """Steps without growth up to the time at which K_eq = K_IC."""
    toughness = simulation.scene.toughness
    step = simulation.resolution.first_step
    body = simulation.body([])
    matrices = body.influence(simulation.scene.rock.modulus)
    while True:
        last = simulation.states[-1]
        state = simulation.trial(last.time + step, body, matrices)
        if state.equivalent < toughness * (1.0 + CLOSE):
            simulation.accept(state)
            report(state)
            step *= simulation.resolution.step_growth
            if state.equivalent > toughness * (1.0 - CLOSE):
                return state
            continue
        low, high = 0.0, step
        low_value = last.equivalent / toughness - 1.0
        high_value = state.equivalent / toughness - 1.0
        for _ in range(40):
            step = low - low_value * (high - low) / (high_value - low_value)
            step = min(max(step, low + 0.02 * (high - low)), high - 0.02 * (high - low))
            state = simulation.trial(last.time + step, body, matrices)
            value = state.equivalent / toughness - 1.0
            if abs(value) < CLOSE:
                break
            if value < 0.0:
                low, low_value = step, value
            else:
                high, high_value = step, value
        simulation.accept(state)
        report(state)
        return state


def grow(simulation: Simulation, report: Progress) -> None:
    """Inject until the wing has gained what the scene asks for: onset, then piece after piece."""
    report(simulation.start())
    scene, resolution = simulation.scene, simulation.resolution
    onset = find_onset(simulation, report)
    direction = scene.angle + equivalent_intensity(onset.k1, onset.k2)[1]
    wing: list[complex] = []
    end = 0j
    gained = 0.0
    length = resolution.first_piece
    step = onset.time * 0.2
    turn = 0.0
    slope: Numbers | None = None
    while gained < scene.gain - 1e-9:
        if gained + 1.5 * length > scene.gain:  # no tiny piece at the end
            length = scene.gain - gained
        fixed = not wing  # the first piece has the direction of the criterion
        piece = add_piece(simulation, wing, end, length, direction + turn, step, slope, fixed)
        state, step = piece.state, piece.step
        turn = 0.5 * (piece.direction - direction) if wing else 0.0
        slope = None if fixed else piece.slope
        direction = piece.direction
        end += length * np.exp(1j * direction)
        wing.append(end)
        gained += length
        simulation.accept(state)
        report(state)
        length = min(length * resolution.piece_growth, resolution.largest_piece)


@dataclass(frozen=True)
class Piece:
    """What a new piece of the wing leads to."""

    state: State
    direction: float  # [rad]
    step: float  # [s]
    slope: Numbers  # of K_II and K_eq over K_IC by direction and logarithm of the step


def add_piece(
    simulation: Simulation,
    wing: list[complex],
    end: complex,
    length: float,
    direction: float,
    step: float,
    slope: Numbers | None,
    fixed: bool,
) -> Piece:
    """State with one more piece, at the time and in the direction of equilibrium, by secants.

    Parameters
    ----------
    direction, step, slope: first guesses
    fixed: the direction is given

    A piece that would need no time belongs to a jump: it gets a thousandth of the last step.
    """
    toughness = simulation.scene.toughness
    last = simulation.states[-1].time
    shortest = float(np.log(1e-3 * step))

    def residual(place: Numbers) -> tuple[State, Numbers]:
        tip = end + length * np.exp(1j * place[0])
        body = simulation.body([*wing, tip])
        matrices = body.influence(simulation.scene.rock.modulus)
        state = simulation.trial(last + float(np.exp(place[1])), body, matrices)
        if fixed:
            return state, np.array([0.0, state.equivalent / toughness - 1.0])
        return state, np.array([state.k2, state.k1 - toughness]) / toughness

    place = np.array([direction, np.log(step)])
    state, value = residual(place)
    if slope is None:
        slope = np.eye(2)
        for index, change in ((1, 0.05),) if fixed else ((0, 0.02), (1, 0.05)):
            moved = place.copy()
            moved[index] += change
            slope[:, index] = (residual(moved)[1] - value) / change
    for _ in range(25):
        jumps = place[1] <= shortest and value[1] > 0.0
        if abs(value[0]) < STRAIGHT and (jumps or abs(value[1]) < CLOSE):
            return Piece(state, float(place[0]), float(np.exp(place[1])), slope)
        move = np.clip(-np.linalg.solve(slope, value), [-0.3, -1.0], [0.3, 1.0])
        if place[1] + move[1] < shortest:
            move = np.array([np.clip(-value[0] / slope[0, 0], -0.3, 0.3), shortest - place[1]])
        place = place + move
        state, new = residual(place)
        slope = slope + np.outer(new - value - slope @ move, move) / (move @ move)
        value = new
    raise GrowthError(f"no equilibrium at {abs(end)} m + {length} m: {value}")
