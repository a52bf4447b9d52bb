# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Vehicle dynamics: the state derivative, its integration, and the wrench of each effect.

Compiled once per version of the effects and cached on disk (`kernel_cache`). States, commands and
surroundings are float64 arrays in the layouts of `lta_model.state`; shorter commands or
surroundings are padded with zeros. The functions check shapes only, because a `VehicleModel` is
checked when it is built.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from lta_model.model import VehicleModel
from lta_sim.simulated_vehicle import SIM_LAYOUT, SimulatedVehicle
import numpy as np
from numpy.typing import ArrayLike, NDArray

State = NDArray[np.float64]
CALM_AIR = (0.0, 0.0, 0.0)


@final
@dataclass(frozen=True, slots=True)
class ModelSnapshot:
    """Wrenches, thrusts and rates of a vehicle at one instant."""

    wrenches: Mapping[str, State]
    thrusts: State
    wind: State


def _copy_to_front(what: str, values: ArrayLike, room: State) -> None:
    """
    Copy numbers into the front of a zeroed array.

    Raises
    ------
    ValueError
        If there are too many numbers, or more than one dimension.

    """
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 1 or len(array) > len(room):
        raise ValueError(
            f'The {what} has the shape {array.shape}; it must be at most {room.shape}.'
        )
    room[: len(array)] = array


def _build_vehicle(
    state: ArrayLike, model: VehicleModel, command: ArrayLike, surroundings: ArrayLike
) -> SimulatedVehicle:
    """Return a simulated vehicle with state, command and surroundings set."""
    start = np.asarray(state, dtype=np.float64)
    if start.shape != (SIM_LAYOUT.size,):
        raise ValueError(
            f'The state has the shape {start.shape}; it must be ({SIM_LAYOUT.size},).'
        )
    vehicle = SimulatedVehicle(model)
    vehicle.state[:] = start
    _copy_to_front('command', command, vehicle.command)
    _copy_to_front('surroundings', surroundings, vehicle.surroundings)
    return vehicle


def state_derivative(
    state: ArrayLike, model: VehicleModel, command: ArrayLike, surroundings: ArrayLike = CALM_AIR
) -> State:
    """
    Return d/dt of a state.

    Parameters
    ----------
    state : array_like, shape (N,)
        Layout of `lta_model.state`, SI.
    command : array_like, shape (up to COMMAND,)
        Duty of each rotor, -1 to 1, and the position of the moving mass.
    surroundings : array_like, shape (up to SURROUNDINGS,)
        Wind, noise, irradiance, voltage, rate of the wind.

    Returns
    -------
    ndarray, shape (N,)
        Rate of each element. [1/s]

    Raises
    ------
    ValueError
        If an array has the wrong shape.

    """
    vehicle = _build_vehicle(state, model, command, surroundings)
    vehicle.evaluate_state()
    # A copy, because the row is reused
    return vehicle.rate.copy()


def advance(
    state: ArrayLike,
    model: VehicleModel,
    command: ArrayLike,
    surroundings: ArrayLike,
    dt: float,
    steps: int,
) -> State:
    """
    Return the state after `steps` classical Runge-Kutta steps under a constant command.

    The quaternion is normalised after each step. The step `dt` [s] must be below about 2.7 times
    the shortest time constant. Other parameters are as for `state_derivative`.
    """
    vehicle = _build_vehicle(state, model, command, surroundings)
    vehicle.advance(float(dt), int(steps))
    return vehicle.state.copy()


def evaluate_model(
    state: ArrayLike, model: VehicleModel, command: ArrayLike, surroundings: ArrayLike = CALM_AIR
) -> ModelSnapshot:
    """Return wrenches, thrusts and rates of a vehicle at a state."""
    vehicle = _build_vehicle(state, model, command, surroundings)
    vehicle.evaluate_state()
    wrenches = dict(zip(SIM_LAYOUT.wrench_names, vehicle.wrenches, strict=True))
    return ModelSnapshot(wrenches, vehicle.thrusts, vehicle.wind)


def effect_wrenches(
    state: ArrayLike, model: VehicleModel, command: ArrayLike, surroundings: ArrayLike = CALM_AIR
) -> Mapping[str, State]:
    """Return the wrench of each wrench effect, body frame [N, N m]."""
    return evaluate_model(state, model, command, surroundings).wrenches
