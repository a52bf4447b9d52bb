"""
Forces of forms that the library does not have, as columns of a linear flight.

What a term of a force does in each grid period follows from what the unexplained wrench does.
"""

from collections.abc import Iterator, Sequence
from typing import Final, final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.model.quaternions import rotation_matrix
from lta_discovery.posterior.elements import ForceGroup
from lta_discovery.posterior.force_terms import (
    FlightBoundingBox,
    list_axis_terms,
    OSCILLATION_LIMITS,
    position_terms,
    simulate_oscillator,
    TermInputs,
    thrust_terms,
)
from lta_discovery.replay.replay import AXIS_COUNT, STEPS_PER_PERIOD
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_model.effects.protocol import AXES as NAMES
from lta_model.state import ROTOR, ROTOR_AXIS, ROTOR_PLACE
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHAKEN: Final = (0, 1, 2, 1, 0, 1)  # axis of the specific force that drives a swing on each axis
USUAL_SHAKING: Final = 0.1  # m/s2


@final
class Force(NamedTuple):
    """A force of some terms: wrench of each in each grid period, shape (n, J, 6). [N, N m]"""

    name: str
    wrenches: Array


def build_scene(flights: Sequence[LinearFlight]) -> FlightBoundingBox:
    """Return the box around some flights, in which forces differ from place to place."""
    return FlightBoundingBox.from_positions(
        [np.concatenate([one.motion[a:b, :3] for a, b in one.runs]) for one in flights]
    )


def compute_wrenches(
    system: FlightSystem, flight: LinearFlight, scene: FlightBoundingBox, floor: Array
) -> tuple[list[ForceGroup], Array]:
    """
    Return the forces, and the wrenches of all their terms, shape (n, 6, J).

    `floor`: wrench of a term of usual size, shape (6,). [N, N m]
    """
    forces = list(_list_forces(_compute_inputs(system, flight), scene, floor))
    together = np.concatenate([one.wrenches for one in forces], axis=1).transpose(0, 2, 1)
    # Nothing is known between the runs, where nothing is filtered either
    wrenches = np.where(np.isfinite(together), together, 0.0)
    return [ForceGroup(one.name, one.wrenches.shape[1]) for one in forces], wrenches


def _compute_inputs(system: FlightSystem, flight: LinearFlight) -> TermInputs:
    """Return what the terms depend on, as one piece."""
    motion = flight.motion
    # Acceleration in the body frame; the term w x v is neglected
    rate = np.gradient(motion[:, 7:10], GRID_PERIOD, axis=0)
    felt = rate + STANDARD_GRAVITY * rotation_matrix(motion[:, 3:7])[:, 2]
    pushed = _compute_push(system, flight)
    return TermInputs(system.flight.time[None], motion[None], pushed[None], felt[None])


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


def _list_forces(inputs: TermInputs, scene: FlightBoundingBox, floor: Array) -> Iterator[Force]:
    """Yield all forces of a flight."""
    turn = rotation_matrix(inputs.states[0, :, 3:7])
    bumps = position_terms(inputs, scene)[1][0]
    # Forces along the axes of the map, on those of the body
    level = floor[0] * np.einsum('nj,nwa->njwa', bumps, turn[:, :2])
    wide = np.zeros((len(bumps), 2 * bumps.shape[1], AXIS_COUNT))
    wide[..., :3] = level.transpose(0, 2, 1, 3).reshape(len(bumps), -1, 3)
    yield Force('level force by place', wide)
    yield _build_force('place', 2, bumps, floor)
    common = [(name, values[0]) for name, _, values in list_axis_terms(inputs, scene)]
    common.append(('thrust x speed', thrust_terms(inputs)[1][0]))
    for axis in range(AXIS_COUNT):
        for name, values in common:
            yield _build_force(name, axis, values, floor)
        shaken = inputs.felt[..., SHAKEN[axis]]
        swung = [
            simulate_oscillator(inputs, (shaken - shaken.mean()) / USUAL_SHAKING, hertz)[0]
            for hertz in OSCILLATION_LIMITS
        ]
        yield _build_force('something that swings', axis, np.concatenate(swung, axis=1), floor)


def _build_force(name: str, axis: int, values: Array, floor: Array) -> Force:
    """Return a force on one axis, with a constant, so that its terms need no mean of 0."""
    wrenches = np.zeros((len(values), values.shape[1] + 1, AXIS_COUNT))
    wrenches[:, :-1, axis] = floor[axis] * values
    wrenches[:, -1, axis] = floor[axis]
    return Force(f'{NAMES[axis]} by {name}', wrenches)
