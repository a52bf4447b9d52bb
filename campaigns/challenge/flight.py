# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulate a flight by integrating the equations of motion between commands."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import Final, final, Protocol

import numpy as np
from numpy.typing import NDArray

from campaigns.challenge.air import MovingAir, RoomAir
from campaigns.challenge.body import KirchhoffBody, rotation_matrix, State, STILL
from campaigns.challenge.rotors import RotorSet
from campaigns.challenge.truth import Six, VehicleTruth

Array = NDArray[np.float64]

TICK: Final = 0.01  # s; period of commands and step of the integrator


class UnlistedDisturbance(Protocol):
    """A disturbance outside the library that acts on one flight."""

    def adjust_duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return the duties that the rotors follow."""
        ...

    def adjust_thrusts(self, thrusts: Sequence[float], duties: Sequence[float]) -> Sequence[float]:
        """Return the changed thrust of each rotor [N]."""
        ...

    def air_motion(self) -> MovingAir | None:
        """Return its air motion, or None."""
        ...

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Advance by a step; return the wrench during it, about the hull centre in body axes."""
        ...


class ActuatorSet(Protocol):
    """Actuators that turn commands into a wrench."""

    def set_duties(self, duties: Sequence[float]) -> None:
        """Set the command of each actuator from now on."""
        ...

    def advance(self, seconds: float) -> None:
        """Advance by a time [s]."""
        ...

    def thrusts_after_command(self, seconds: float) -> list[float]:
        """Return the thrust of each actuator at a time after the command [s]."""
        ...

    def total_wrench(self, thrusts: Sequence[float]) -> Six:
        """Return force and moment of the thrusts about the hull centre."""
        ...


class DutyPilot(Protocol):
    """A pilot that commands rotor duties."""

    def initial_duties(self) -> list[float]:
        """Return the duties before the start."""
        ...

    def compute_duties(self, time: float, state: State) -> list[float]:
        """Return the duties at a time and state."""
        ...


@final
@dataclass(frozen=True, slots=True)
class SimulatedTrajectory:
    """The trajectory of a simulated flight."""

    time: Array  # times of the states, shape (N,) [s]
    # Position and velocity in the map, quaternion w x y z, body rates, shape (N, 13)
    states: Array
    gains: Array  # acceleration of the hull centre in the map, and of the body rates, shape (N, 6)
    commands: Array  # duties, every TICK from 0 on, shape (M, rotors)
    thrusts: Array  # thrusts of the rotors, shape (N, rotors) [N]
    unlisted: Array  # wrench of effects outside the library, in body axes, shape (N, 6) [N], [N m]


def state_derivative(state: State, gain: Six) -> State:
    """Return the derivative of a state."""
    _, _, _, u, v, w, q, x, y, z, a, b, c = state
    return [
        u, v, w, gain[0], gain[1], gain[2],
        -0.5 * (x * a + y * b + z * c),
        0.5 * (q * a + y * c - z * b),
        0.5 * (q * b + z * a - x * c),
        0.5 * (q * c + x * b - y * a),
        gain[3], gain[4], gain[5],
    ]  # fmt: skip


def step_runge_kutta(
    rate: Callable[[float, State], State], state: State, first: State, dt: float
) -> State:
    """Advance a state by one step of the classical Runge-Kutta method."""

    def shift_state(by: float, along: State) -> State:
        return [s + by * d for s, d in zip(state, along, strict=True)]

    second = rate(0.5 * dt, shift_state(0.5 * dt, first))
    third = rate(0.5 * dt, shift_state(0.5 * dt, second))
    fourth = rate(dt, shift_state(dt, third))
    after = [
        s + dt / 6.0 * (a + 2.0 * (b + c) + d)
        for s, a, b, c, d in zip(state, first, second, third, fourth, strict=True)
    ]
    # Normalise the quaternion, whose length drifts by the integration error
    length = math.sqrt(sum(each * each for each in after[6:10]))
    after[6:10] = [each / length for each in after[6:10]]
    return after


@final
class FlightSimulator:
    """
    Simulator of one flight.

    The times of the states are shifted by the command delay, so that commands take effect exactly
    at a state.

    `unlisted`: disturbance outside the library. `actuators`: builds the actuators: `RotorSet`, or
    `WrenchActuators` for commanded wrenches.
    """

    def __init__(
        self,
        truth: VehicleTruth,
        pilot: DutyPilot,
        air: Sequence[MovingAir] = (),
        unlisted: UnlistedDisturbance | None = None,
        actuators: Callable[[VehicleTruth, Sequence[float]], ActuatorSet] = RotorSet,
    ) -> None:
        self._body, self._pilot, self._strange = KirchhoffBody(truth), pilot, unlisted
        own = unlisted.air_motion() if unlisted else None
        self._plain_air = RoomAir(air)
        self._air = RoomAir([*air, own]) if own else self._plain_air
        # A second set without the disturbance, to compute what the disturbance changes
        self._rotors, self._plain = (actuators(truth, pilot.initial_duties()) for _ in range(2))
        # Whole ticks of the delay; the rest shifts the times of the states
        self._late = math.floor(truth.delay / TICK)
        self._shift = truth.delay - TICK * self._late
        self._duties: Sequence[float] = pilot.initial_duties()
        self._push = STILL

    def _rotor_thrusts(self, after: float) -> Sequence[float]:
        """Return the thrust of each rotor at a time after the last command [s]."""
        thrusts = self._rotors.thrusts_after_command(after)
        return self._strange.adjust_thrusts(thrusts, self._duties) if self._strange else thrusts

    def _compute_accelerations(self, time: float, after: float, state: State) -> Six:
        wrench = self._rotors.total_wrench(self._rotor_thrusts(after))
        a, b, c, d, e, f = (one + two for one, two in zip(wrench, self._push, strict=True))
        air = self._air.sample_flow(time, state[0], state[1], state[2])
        return self._body.rigid_body_accelerations(state, air, (a, b, c, d, e, f), time)

    def _unlisted_wrench(self, time: float, state: State, gain: Six) -> Array:
        """Return the wrench that is equivalent to the disturbance."""
        wrench = self._plain.total_wrench(self._plain.thrusts_after_command(0.0))
        air = self._plain_air.sample_flow(time, state[0], state[1], state[2])
        plain = self._body.rigid_body_accelerations(state, air, wrench, time)
        more = np.subtract(gain, plain)
        r = np.array(rotation_matrix(*state[6:10])).reshape(3, 3)
        # Map to body axes: a row vector times R is R' times the vector
        more[:3] = more[:3] @ r
        wrench_more: Array = self._body.masses @ more
        return wrench_more

    def simulate_flight(self, state: State, seconds: float) -> SimulatedTrajectory:
        """Simulate a flight from a state; the first command follows TICK later."""
        count = round(seconds / TICK)
        commands: list[Sequence[float]] = []
        states, gains, thrusts, strange = [], list[Six](), list[Sequence[float]](), []
        gain: Six = STILL
        for k in range(-1, count):
            time = k * TICK + self._shift
            if k >= 0:
                commands.append(self._pilot.compute_duties(k * TICK, state))
            self._apply_command(commands[k - self._late] if k >= self._late and k >= 0 else None)
            if self._strange:
                air = self._air.sample_flow(time, state[0], state[1], state[2])
                self._push = self._strange.step_wrench(time, state, air, gain)
            gain = self._compute_accelerations(time, 0.0, state)
            states.append(state)
            gains.append(gain)
            thrusts.append(self._rotor_thrusts(0.0))
            strange.append(
                self._unlisted_wrench(time, state, gain) if self._strange else np.zeros(6)
            )
            state = self._step_state(time, state, gain)
        time_of = TICK * np.arange(-1, count, dtype=np.float64) + self._shift
        return SimulatedTrajectory(
            time_of, np.array(states), np.array(gains), np.array(commands),
            np.array(thrusts), np.array(strange),
        )  # fmt: skip

    def _apply_command(self, duties: Sequence[float] | None) -> None:
        """Apply a command to the rotors."""
        if duties is None:
            return
        self._plain.set_duties(duties)
        self._duties = self._strange.adjust_duties(duties) if self._strange else duties
        self._rotors.set_duties(self._duties)

    def _step_state(self, time: float, state: State, gain: Six) -> State:
        """Return the state after a step, and advance the rotors."""

        def rate(after: float, at: State) -> State:
            return state_derivative(at, self._compute_accelerations(time + after, after, at))

        later = step_runge_kutta(rate, state, state_derivative(state, gain), TICK)
        # The stages of the step use the rotors relative to their state at its start
        self._rotors.advance(TICK)
        self._plain.advance(TICK)
        return later
