"""Simulate a flight of the truth vehicle along the course of its pilot."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_challenge.truth_equations import TruthConstants, TruthWork
from lta_challenge.truth_flight import LONGEST, PilotConstants, PilotInputs, SAMPLE_SIZE
from lta_challenge.truth_source import RIGID
from lta_challenge.truth_vehicle import (
    allocation_matrix,
    build_truth_model,
    compile_truth,
    rotate_vector,
    TruthVehicle,
)
from lta_config.errors import BadInput
from lta_discovery.model.nominal import NominalVehicle
from lta_model.effects.protocol import AirEffect, AirEffectInput
from lta_model.state import ACTUATORS, SURROUNDINGS
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Of the pilot: height, climb, sum of the heights, hover force; heading, yaw rate; speed, drag.
GAINS: Final = (0.12, 0.35, 0.012, 0.02, 0.01, 0.02, 0.4, 0.1)
LIMITS: Final = (0.2, 0.05, 0.2, 0.012, 0.012, 0.012)  # of a commanded wrench [N, N m]


@final
@dataclass(frozen=True, slots=True)
class TruthTrajectory:
    """The true trajectory of a flight, every 10 ms."""

    # Position in the map; body to map; velocity and rates in body axes, shape (n, 3)
    position: Array
    rotation: Array
    velocity: Array
    rates: Array
    thrust: Array  # thrust of each rotor [N], or the applied wrench, shape (n, 8)
    strange: Array  # wrench of effects outside the library in body axes, shape (n, 6) [N, N m]
    voltage: Array  # battery voltage, shape (n,) [V]
    commands: Array  # commands of the pilot, shape (n, 8)


def wind_at_position(hull: TruthVehicle, place: Array) -> Array:
    """Return the wind at a position in the map. [m/s]"""
    parts, out = build_truth_model(), np.zeros(3)
    for name, effect in parts.all_effects.items():
        if isinstance(effect, AirEffect) and hull.on[parts.flag_index(name)]:
            first = parts.parameter_offsets[name]
            p = tuple(hull.parameters[first : first + len(effect.parameters)].tolist())
            x, y, z = place.tolist()
            u, v, w = out.tolist()
            seen = AirEffectInput((x, y, z), (0.0, 0.0, 0.0), (u, v, w), ())
            # Effects act in sequence: each sees the wind of the previous ones
            out += effect.air(p, (), seen)[:3]
    return out


def initial_state(hull: TruthVehicle, height: float, tilt: Sequence[float]) -> Array:
    """Return the state of a vehicle at rest above the origin, with a small tilt."""
    y = np.concatenate([np.zeros(RIGID), build_truth_model().initial_memory])
    y[2] = height
    axis = np.array(tilt)
    # The columns of a rotation matrix are the rotated unit vectors
    rotation = np.column_stack([rotate_vector(axis, e) for e in np.eye(3)])
    y[3:12] = rotation.ravel()
    # Still over the ground is moving through the air, which shares in the momentum.
    y[12:15] = -rotation @ (hull.body[10:13] * (rotation.T @ wind_at_position(hull, y[:3])))
    return y


def create_work_arrays(size: int) -> TruthWork:
    """Return working arrays for a state of `size` elements."""
    return TruthWork(
        np.zeros((7, size)), np.zeros(ACTUATORS), np.zeros(ACTUATORS), np.zeros(9), np.zeros(6),
        np.zeros(1), np.zeros((3, 3)),
    )  # fmt: skip


def simulate_flight(
    hull: TruthVehicle,
    pilot: PilotInputs,
    nominal: NominalVehicle,
    *,
    height: float = 1.5,
    tilt: Sequence[float] = (0.0, 0.0, 0.0),
    cell: tuple[float, float, float] = (4.1, 0.0008, 0.06),
    longest: float = LONGEST,
) -> TruthTrajectory:
    """
    Simulate a flight.

    Parameters
    ----------
    pilot : PilotInputs
        Setpoints and excitation.
    nominal : NominalVehicle
        The vehicle that the pilot assumes.
    height : float
        Initial height. [m]
    tilt : 3 floats
        Initial attitude as a rotation vector. [rad]
    cell : 3 floats
        Full voltage [V], and its loss per duty and second [V/s] and per duty [V].
    longest : float
        Largest integrator step. [s]

    """
    count, rotors = len(pilot.setpoints), len(nominal.rotors)
    commands, samples = np.zeros((count, ACTUATORS)), np.zeros((count, SAMPLE_SIZE))
    # Columns: surge, heave, yaw and roll
    mix = allocation_matrix(nominal)[:, [0, 2, 5, 3]]  # a mix for these must leave roll alone
    # The pilot commands surge, heave and yaw; roll is zero, so its column is dropped
    mixing = np.linalg.pinv(mix.T)[:, :3]
    # All rotors of the nominal vehicle have the thrust curve of the first
    curve = np.array([nominal.parameter_value('thrust_curve', f'{c}_1') for c in 'ab'])
    constants = TruthConstants(
        hull.parameters, hull.on, np.zeros(SURROUNDINGS), hull.body, hull.inverse, hull.lift,
        hull.allocation, pilot.pushed,
    )  # fmt: skip
    compile_truth(rotors).core_fly_truth(
        initial_state(hull, height, tilt),
        constants,
        PilotConstants(np.array(GAINS), np.ascontiguousarray(mixing), curve, np.array(LIMITS)),
        pilot,
        hull.command_delay,
        np.array(cell),
        longest,
        create_work_arrays(build_truth_model().state_size),
        commands,
        samples,
    )
    # A hidden effect may be strong enough to destabilise the flight
    if not np.isfinite(samples).all():
        raise BadInput(
            'A flight with hidden effects became unstable in the simulation; choose another '
            '--seed for "lta challenge make".'
        )
    return TruthTrajectory(
        samples[:, :3], samples[:, 3:12].reshape(-1, 3, 3), samples[:, 12:15], samples[:, 15:18],
        samples[:, 18:26], samples[:, 26:32], samples[:, 32], commands,
    )  # fmt: skip
