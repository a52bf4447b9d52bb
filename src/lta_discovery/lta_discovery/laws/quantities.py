"""Compute the quantities on which a law may depend, for a fit, a forecast, or measured motion."""

from collections.abc import Mapping
import math
from typing import Final

from lta_config.schema.vehicle_law import AXES as LAW_AXES
from lta_config.schema.vehicle_law import HiddenState
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_logarithm,
    quaternion_product,
    rotate_vectors,
    rotation_matrix,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import AXES
from lta_discovery.replay.replay import STEPS
from lta_model.law_arrays import evaluate_product
from lta_model.state import ROTOR, ROTOR_AXIS, ROTOR_PLACE
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter, savgol_filter

Array = NDArray[np.float64]
Quantities = dict[str, Array]

SMOOTH: Final = 13  # grid points; of the cubic that measured motion is differentiated with


def state_quantities(states: Array) -> Quantities:
    """Return the quantities of states, shape (..., 13), each of shape (...)."""
    out = dict(zip(('x', 'y', 'height'), np.moveaxis(states[..., :3], -1, 0), strict=True))
    names = ('u', 'v', 'w', 'p', 'q', 'r')
    out |= dict(zip(names, np.moveaxis(states[..., 7:13], -1, 0), strict=True))
    out['rate'] = np.linalg.norm(states[..., 10:13], axis=-1)
    out['speed'] = np.linalg.norm(states[..., 7:10], axis=-1)
    rotation = rotation_matrix(states[..., 3:7])
    out['roll'] = np.arctan2(rotation[..., 2, 1], rotation[..., 2, 2])
    out['pitch'] = np.arcsin(np.clip(-rotation[..., 2, 0], -1.0, 1.0))
    out['yaw'] = np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0])
    return out


def input_quantities(flight: FlightLinearizer, nominal: NominalVehicle) -> Quantities:
    """Return time, voltage and wrench of the rotors in each grid period of a flight, (n,)."""
    replay = flight.replay
    ready = replay.compute_body_inputs(replay.build_replay_rows(nominal))
    commands, _, wrench = ready.average_periods()
    body = nominal.build_model().body
    pushed = np.zeros((len(commands), AXES))
    for i in range(len(nominal.rotors)):
        place, axis = (
            body[at + i * ROTOR : at + i * ROTOR + 3] for at in (ROTOR_PLACE, ROTOR_AXIS)
        )
        pushed += commands[:, i, None] * np.concatenate([axis, np.cross(place, axis)])
    pushed += wrench
    time = replay.flight.time[0] + PERIOD * np.arange(len(commands))
    volts = replay.flight.voltage
    finite = np.isfinite(volts)
    voltage = (
        np.interp(time, replay.flight.time[finite], volts[finite])
        if finite.any()
        else np.zeros(len(time))
    )
    return {
        'time': time,
        'voltage': voltage,
        'thrust_surge': pushed[:, 0],
        'thrust_heave': pushed[:, 2],
        'thrust_yaw': pushed[:, 5],
    }


def thrust_ranges(vehicle: Vehicle) -> dict[str, tuple[float, float]]:
    """Return the least and the largest wrench of the rotors along each axis, by quantity."""
    ends = []
    for rotor in vehicle.rotors:
        full = rotor.full_thrust * np.array([*rotor.axis, *np.cross(rotor.place, rotor.axis)])
        ends.append(np.sort([-full * rotor.reversible, full], axis=0))
    low, high = np.sum(ends, axis=0) if ends else np.zeros((2, AXES))
    return {
        f'thrust_{axis}': (float(low[k]), float(high[k]))
        for k, axis in enumerate(list(LAW_AXES)[:AXES])
    }


def measured_states(flight: FlightLinearizer, count: int) -> Array:
    """Return the measured motion on the grid, smoothed; gaps are bridged linearly, (n, 13)."""
    measured = flight.replay.flight
    good = np.isfinite(measured.position).all(axis=1) & np.isfinite(measured.quaternion).all(
        axis=1
    )
    grid = np.arange(count)
    at = np.flatnonzero(good)
    position = np.column_stack([np.interp(grid, at, measured.position[at, k]) for k in range(3)])
    quaternion = np.column_stack(
        [np.interp(grid, at, measured.quaternion[at, k]) for k in range(4)]
    )
    quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    place = savgol_filter(position, SMOOTH, 3, axis=0)
    velocity = savgol_filter(position, SMOOTH, 3, deriv=1, delta=PERIOD, axis=0)
    turn = quaternion_logarithm(
        quaternion_product(quaternion_conjugate(quaternion[:-1]), quaternion[1:])
    )
    rates = savgol_filter(np.vstack([turn, turn[-1:]]) / PERIOD, SMOOTH, 2, axis=0)
    velocity = rotate_vectors(quaternion_conjugate(quaternion), velocity)
    return np.hstack([place, quaternion, velocity, rates])


def filter_hidden(
    drive: Array, dt: float, state: HiddenState, start: Array | None
) -> tuple[Array, Array]:
    """
    Return a hidden state and its rate for a drive, both of its shape (S, n).

    Parameters
    ----------
    start : ndarray, shape (S, 2), optional
        State and rate at the beginning; those of the start of a flight by default.

    """
    begin = np.tile([state.start or 0.0, 0.0], (len(drive), 1)) if start is None else start
    if state.time_constant is not None:
        time = state.time_constant
        decay = math.exp(-dt / time)
        value = lfilter([1.0 - decay], [1.0, -decay], drive, zi=decay * begin[:, :1])[0]
        return value, (drive - value) / time
    frequency, damping = state.frequency or 1.0, min(state.damping or 0.0, 0.999)
    # Exact step of the damped oscillator under a constant drive
    wave = frequency * math.sqrt(max(1.0 - damping**2, 1e-9))
    fade, angle = math.exp(-damping * frequency * dt), wave * dt
    cosine, sine = math.cos(angle), math.sin(angle)
    a = fade * np.array(
        [
            [cosine + damping * frequency / wave * sine, sine / wave],
            [-(frequency**2) / wave * sine, cosine - damping * frequency / wave * sine],
        ]
    )
    trace, determinant = float(np.trace(a)), float(np.linalg.det(a))
    b = (np.eye(2) - a) @ np.array([1.0, 0.0])
    denominator = [1.0, -trace, determinant]
    # x+ = a x + b d: numerators of both outputs, from the resolvent
    numerators = (
        [b[0], a[0, 1] * b[1] - a[1, 1] * b[0]],
        [b[1], a[1, 0] * b[0] - a[0, 0] * b[1]],
    )
    out = []
    free = begin @ a.T
    then = free @ a.T
    for k in range(2):
        # Initial filter state that gives the free response
        zi = np.column_stack([free[:, k], then[:, k] - trace * free[:, k]])
        out.append(lfilter(numerators[k], denominator, drive, axis=-1, zi=zi)[0])
    return out[0], out[1]


def follow_drive(
    state: HiddenState, whole: Quantities, fade: Array | float = 1.0
) -> tuple[Array, Array]:
    """Return a hidden state and its rate over a whole flight, shape (n,), for a faded drive."""
    drive = fade * evaluate_product(state.drive, whole)
    value, rate = filter_hidden(drive[None], PERIOD, state, None)
    return value[0], rate[0]


def at_pieces(flight: FlightLinearizer, inputs: Mapping[str, Array]) -> Quantities:
    """Return inputs of a flight in the grid periods of its pieces, shape (S, n)."""
    steps = flight.replay.cut.first[:, None] + np.arange(flight.replay.cut.length)
    return {name: values[np.minimum(steps, len(values) - 1)] for name, values in inputs.items()}


def middle_states(states: Array) -> Array:
    """Return the states in the middle of each grid period, from those at each step."""
    return np.ascontiguousarray(states[:, STEPS // 2 :: STEPS])
