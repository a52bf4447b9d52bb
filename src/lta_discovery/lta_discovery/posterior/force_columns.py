# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Forces of forms that the library does not have, as columns of a linear flight.

A force is one hypothesis: a force field, air layers, a magnet, a one-way flap, rotor wash over a
fin, a swinging load. Each of its terms is a wrench in every grid period, in units of usual sizes,
so that strengths are comparable between flights. What a term does follows from what the
unexplained wrench does.
"""

from collections.abc import Iterator, Sequence
import math
from typing import Final, final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.posterior.elements import ForceGroup
from lta_discovery.replay.replay import AXIS_COUNT, STEPS_PER_PERIOD
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_model.effects.protocol import AXES
from lta_model.state import ROTOR, ROTOR_AXIS, ROTOR_PLACE
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]

USUAL_SPEED: Final = 0.3  # m/s, rad/s
USUAL_HEIGHT: Final = 0.5  # m
USUAL_PUSH: Final = {0: 0.02, 2: 0.05, 5: 0.003}  # by axis [N, N m]
USUAL_SHAKING: Final = 0.1  # m/s2
SIDE: Final = 5  # bumps per direction of place
LAYERS: Final = 10  # bumps of height
SHAKEN: Final = (0, 1, 2, 1, 0, 1)  # axis of the specific force that drives a swing on each axis
SWINGS: Final = (0.2, 0.35, 0.5)  # Hz; faster swings are spectral lines
DAMPED: Final = 0.1  # damping ratio of a swing


@final
class FlightBoundingBox(NamedTuple):
    """Box around all flights of a study: low and high corner, in the map [m]."""

    low: Array
    high: Array


@final
class _TermInputs(NamedTuple):
    """What the terms depend on in each grid period of a flight."""

    motion: Array  # states of the body, shape (n, 13)
    pushed: Array  # wrench of the rotors, or the commanded one, shape (n, 6) [N, N m]
    felt: Array  # specific force of the hull, body frame, shape (n, 3) [m/s2]


def build_scene(flights: Sequence[LinearFlight]) -> FlightBoundingBox:
    """Return the box around some flights, in which forces differ from place to place."""
    places = [one.motion[a:b, :3] for one in flights for a, b in one.runs]
    # The middle 96 %, at least 0.2 m wide, as a hover has no extent
    low, high = np.percentile(np.concatenate(places), [2.0, 98.0], axis=0)
    return FlightBoundingBox(low, np.maximum(high, low + 0.2))


def compute_wrenches(
    system: FlightSystem, flight: LinearFlight, scene: FlightBoundingBox, floor: Array
) -> tuple[list[ForceGroup], Array]:
    """
    Return the forces, and the wrenches of all their terms, shape (n, 6, J).

    `floor`: wrench of a term of usual size, shape (6,). [N, N m]
    """
    # Acceleration in the body frame; the term w x v is neglected
    rate = np.gradient(flight.motion[:, 7:10], GRID_PERIOD, axis=0)
    felt = rate + STANDARD_GRAVITY * rotation_matrix(flight.motion[:, 3:7])[:, 2]
    inputs = _TermInputs(flight.motion, _compute_push(system, flight), felt)
    forces = dict(_list_forces(inputs, scene, floor))
    together = np.concatenate([*forces.values()], axis=1).transpose(0, 2, 1)
    # Nothing is known between the runs, where nothing is filtered either
    wrenches = np.where(np.isfinite(together), together, 0.0)
    return [ForceGroup(name, each.shape[1]) for name, each in forces.items()], wrenches


def _compute_push(system: FlightSystem, flight: LinearFlight) -> Array:
    """Return the wrench of the rotors, or the commanded one, in each grid period, shape (n, 6)."""
    n, commanded = len(flight.motion), system.flight.wrench
    if commanded is not None:
        at = np.searchsorted(commanded.time, system.flight.time, side='right') - 1
        return commanded.values[np.maximum(at, 0), :AXIS_COUNT]
    rows = system.replay.build_replay_rows(flight.nominal)
    commands = system.replay.compute_body_inputs(rows).commands
    thrust = commands[: n * STEPS_PER_PERIOD].reshape(n, STEPS_PER_PERIOD, -1).mean(axis=1)
    body, pushed = flight.nominal.build_model().body, np.zeros((n, AXIS_COUNT))
    for k in range(len(flight.nominal.rotors)):
        place, axis = (
            body[at + k * ROTOR : at + k * ROTOR + 3] for at in (ROTOR_PLACE, ROTOR_AXIS)
        )
        pushed += thrust[:, k, None] * np.concatenate([axis, np.cross(place, axis)])
    return pushed


def _list_forces(
    inputs: _TermInputs, scene: FlightBoundingBox, floor: Array
) -> Iterator[tuple[str, Array]]:
    """Yield all forces of a flight: name, and wrench of each term, shape (n, J, 6) [N, N m]."""
    turn = rotation_matrix(inputs.motion[:, 3:7])
    bumps = _compute_bumps(inputs.motion, scene)
    # Forces along the axes of the map, on those of the body
    level = floor[0] * np.einsum('nj,nwa->njwa', bumps, turn[:, :2])
    wide = np.zeros((len(bumps), 2 * bumps.shape[1], AXIS_COUNT))
    wide[..., :3] = level.transpose(0, 2, 1, 3).reshape(len(bumps), -1, 3)
    yield 'level force by place', wide
    yield _build_force('place', 2, bumps, floor)
    common = dict(_list_axis_terms(inputs, scene))
    for axis in range(AXIS_COUNT):
        for name, values in common.items():
            yield _build_force(name, axis, values, floor)
        shaken = inputs.felt[:, SHAKEN[axis]]
        shaken = (shaken - shaken.mean()) / USUAL_SHAKING
        swung = [_simulate_oscillator(shaken, hertz) for hertz in SWINGS]
        yield _build_force('something that swings', axis, np.concatenate(swung, axis=1), floor)


def _build_force(name: str, axis: int, values: Array, floor: Array) -> tuple[str, Array]:
    """Return a force on one axis, with a constant, so that its terms need no mean of 0."""
    wrenches = np.zeros((len(values), values.shape[1] + 1, AXIS_COUNT))
    wrenches[:, :-1, axis] = floor[axis] * values
    wrenches[:, -1, axis] = floor[axis]
    return f'{AXES[axis]} by {name}', wrenches


def _compute_bumps(motion: Array, scene: FlightBoundingBox) -> Array:
    """Return Gaussian bumps on a grid of positions, shape (n, SIDE^2)."""
    spots = [np.linspace(scene.low[k], scene.high[k], SIDE) for k in range(2)]
    # Standard deviation of a bump: one interval of the grid
    width = np.maximum(scene.high[:2] - scene.low[:2], 0.5) / (SIDE - 1)
    away = [((motion[:, k, None] - spots[k]) / width[k]) ** 2 for k in range(2)]
    bumps: Array = np.exp(-0.5 * (away[0][:, :, None] + away[1][:, None, :]))
    return bumps.reshape(len(motion), -1)


def _simulate_oscillator(shaking: Array, hertz: float) -> Array:
    """Return position and speed of an oscillator driven by an acceleration, shape (n, 2)."""
    omega, dt = 2.0 * math.pi * hertz, GRID_PERIOD
    # Semi-implicit Euler with damping, written as a second-order filter
    decay = math.exp(-DAMPED * omega * dt)
    place = lfilter(
        [-decay * dt**2], [1.0, decay * (dt * omega) ** 2 - decay - 1.0, decay], shaking
    )
    speed = np.diff(place, prepend=0.0) / dt
    return np.column_stack([omega**2 * place, omega * speed])


def _list_axis_terms(inputs: _TermInputs, scene: FlightBoundingBox) -> Iterator[tuple[str, Array]]:
    """Yield what a force on any single axis may follow: name, and terms of shape (n, J)."""
    motion = inputs.motion[:, 7:13] / USUAL_SPEED
    up = inputs.motion[:, 2]
    height = (up - 0.5 * (scene.low[2] + scene.high[2])) / USUAL_HEIGHT
    spots = np.linspace(scene.low[2], scene.high[2], LAYERS)
    width = (scene.high[2] - scene.low[2]) / (LAYERS - 1)
    layers = np.exp(-0.5 * ((up[:, None] - spots) / width) ** 2)
    yield 'height', np.column_stack([height, layers, height[:, None] * motion[:, [0, 2]]])
    rotation = rotation_matrix(inputs.motion[:, 3:7])
    # Of the body x axis in the map; first and second harmonic
    heading = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    yield 'heading', np.column_stack([f(m * heading) for m in (1, 2) for f in (np.cos, np.sin)])
    # Half-waves act in one direction only
    ways = [np.maximum(sign * part, 0.0) for part in motion.T for sign in (1.0, -1.0)]
    yield 'one-sided speed', np.column_stack([one**n for one in ways for n in (1, 2)])
    pairs = [(i, j) for i in range(6) for j in range(i + 1, 6)]
    yield 'speed x speed', np.column_stack([motion[:, i] * motion[:, j] for i, j in pairs])
    terms = list[Array]()
    for axis, usual in USUAL_PUSH.items():
        push = inputs.pushed[:, axis] / usual
        terms += [*(push * motion[:, k] for k in (0, 1, 2, 5)), np.abs(push)]
    yield 'thrust x speed', np.column_stack(terms)
