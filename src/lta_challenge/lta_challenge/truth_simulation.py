"""Simulate a flight of the truth vehicle along the course of its pilot."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_challenge.truth_flight import KEPT, LONGEST
from lta_challenge.truth_source import RIGID
from lta_challenge.truth_vehicle import (
    allocation_matrix,
    compile_truth,
    compose_truth,
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
class PilotInputs:
    """
    What one flight is asked to be.

    Attributes
    ----------
    wanted : ndarray, shape (n, 3)
        Height [m], heading [rad] and forward speed [m/s] at each tick.
    noise : ndarray, shape (n, 3)
        Of height, heading and speeds as the pilot sees them.
    shaken : ndarray, shape (n, 8)
        Added to duties [1], or to a wrench in parts of its limits.
    pushed : bool
        Whether the vehicle is told a wrench instead of duties.

    """

    wanted: Array
    noise: Array
    shaken: Array
    pushed: bool = False


@final
@dataclass(frozen=True, slots=True)
class TruthTrajectory:
    """
    A flight as it was, every 10 ms.

    Attributes
    ----------
    position, rotation, velocity, rates : ndarray, shape (n, 3), (n, 3, 3), (n, 3), (n, 3)
        In the map; body to map; body axes.
    thrust : ndarray, shape (n, 8)
        Of each rotor [N], or the wrench that was obeyed.
    strange : ndarray, shape (n, 6)
        What is in no library pushed with, body axes. [N, N m]
    voltage : ndarray, shape (n,)
        Of the battery. [V]
    commands : ndarray, shape (n, 8)
        As given.

    """

    position: Array
    rotation: Array
    velocity: Array
    rates: Array
    thrust: Array
    strange: Array
    voltage: Array
    commands: Array


def wind_at(hull: TruthVehicle, place: Array) -> Array:
    """Return the wind at a place, in the map. [m/s]"""
    parts, out = compose_truth(), np.zeros(3)
    for name, effect in parts.all_effects.items():
        if isinstance(effect, AirEffect) and hull.on[parts.flag_index(name)]:
            first = parts.parameter_offsets[name]
            p = tuple(hull.parameters[first : first + len(effect.parameters)].tolist())
            x, y, z = place.tolist()
            u, v, w = out.tolist()
            seen = AirEffectInput((x, y, z), (0.0, 0.0, 0.0), (u, v, w), ())
            out += effect.air(p, (), seen)[:3]
    return out


def initial_state(hull: TruthVehicle, height: float, tilt: Sequence[float]) -> Array:
    """Return the state of a vehicle that hangs still over the origin, a little askew."""
    y = np.concatenate([np.zeros(RIGID), compose_truth().initial_memory])
    y[2] = height
    axis = np.array(tilt)
    rotation = np.column_stack([rotate_vector(axis, e) for e in np.eye(3)])
    y[3:12] = rotation.ravel()
    # Still over the ground is moving through the air, which shares in the momentum.
    y[12:15] = -rotation @ (hull.body[10:13] * (rotation.T @ wind_at(hull, y[:3])))
    return y


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
    Fly.

    Parameters
    ----------
    hull : Vessel
        The vehicle as it is.
    pilot : Pilot
        What it is asked to do.
    known : Nominal
        The vehicle as its pilot knows it.
    height : float
        To begin at. [m]
    tilt : 3 floats
        Axis and angle that the attitude begins with. [rad]
    cell : 3 floats
        Voltage when full [V], its loss by a duty second [V/s] and by a duty [V].
    longest : float
        Step of the integrator. [s]

    """
    count, rotors = len(pilot.wanted), len(nominal.rotors)
    commands, kept = np.zeros((count, ACTUATORS)), np.zeros((count, KEPT))
    wanted = allocation_matrix(nominal)[:, [0, 2, 5, 3]]  # a mix for these must leave roll alone
    mixing = np.linalg.pinv(wanted.T)[:, :3]
    curve = np.array([nominal.parameter_value('thrust_curve', f'{c}_1') for c in 'ab'])
    around = np.zeros(SURROUNDINGS)
    compile_truth(rotors).fly(
        initial_state(hull, height, tilt), hull.parameters, hull.on, around, hull.body,
        hull.inverse, hull.lift, hull.allocation, pilot.pushed, pilot.wanted, pilot.noise,
        pilot.shaken, np.array(GAINS), np.ascontiguousarray(mixing), curve, np.array(LIMITS),
        hull.command_delay, np.array(cell), longest, commands, kept,
    )  # fmt: skip
    if not np.isfinite(kept).all():
        raise BadInput('A generated flight diverged; choose smaller effects.')
    return TruthTrajectory(
        kept[:, :3], kept[:, 3:12].reshape(-1, 3, 3), kept[:, 12:15], kept[:, 15:18],
        kept[:, 18:26], kept[:, 26:32], kept[:, 32], commands,
    )  # fmt: skip
