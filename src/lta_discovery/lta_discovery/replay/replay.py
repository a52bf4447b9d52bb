# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Replay one measured flight through the model, for a set of parameters."""

from dataclasses import dataclass, replace
from typing import Final, final, NamedTuple

from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight, Stream
from lta_discovery.model.nominal import NominalVehicle, ReplayRows
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.replay_kernel import (
    BODY_LAYOUT,
    load_actuator_kernel,
    load_body_kernel,
    RIGID,
)
from lta_discovery.replay.sensing import apply_channel_effects
from lta_discovery.replay.state_changes import NUDGE, STATE_WIDTH
from lta_model.state import ACTUATORS, COMMAND, MASS_PLACE, SURROUNDINGS, VOLTAGE
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEPS_PER_PERIOD: Final = 2  # integrator steps in a grid period
LONGEST_ACTUATOR_STEP: Final = 0.01  # s; longest step of the actuators
ALL: Final = slice(None)
AXIS_COUNT: Final = 6
CLOCKS: Final = ('clock', 'pose_time')  # channels that shift the time of a pose
REMEMBERING: Final = [
    flag for flag, name in enumerate(BODY_LAYOUT.effects) if BODY_LAYOUT.memory_size(name)
]


@final
@dataclass(frozen=True, slots=True)
class BodyInputs:
    """Inputs of the body in each step of a flight, for one set of parameters."""

    # Mean thrust of each rotor [N], and the place of the moving mass, shape (T, COMMAND)
    commands: Array
    memory: Array  # of the effects of the body, shape (T, M)
    wrench: Array  # commanded wrench, body frame, shape (T, 6) [N, N m]

    def average_periods(self) -> tuple[Array, Array, Array]:
        """Return the means over each grid period."""
        first, second, third = map(_average_steps, (self.commands, self.memory, self.wrench))
        return first, second, third


def _average_steps(values: Array) -> Array:
    """Return the means of values by step over each grid period; faster than `mean`."""
    total = values[::STEPS_PER_PERIOD].copy()
    for k in range(1, STEPS_PER_PERIOD):
        total += values[k::STEPS_PER_PERIOD]
    return total / STEPS_PER_PERIOD


@final
class ParameterSteps(NamedTuple):
    """Free parameters, each as two parameter sets and the step between them."""

    # Rows and flags of the body kernel for each set, shape (R, W)
    rows: Array
    on: NDArray[np.uint8]
    faced: NDArray[np.int64]  # index of each set's inputs (Q of them), shape (R,)
    # As in `replay.BodyInputs`, by grid period, shape (Q, G, ...)
    commands: Array
    memory: Array
    wrench: Array
    # The two sets of each parameter, the same where it does not change the motion, shape (K,)
    before: NDArray[np.int64]
    after: NDArray[np.int64]
    steps: Array  # their difference, shape (K,)


@final
class FlightReplay:
    """
    Replay pieces of a flight.

    `first`, shape (S,): grid point at which each piece begins. `length`: of all pieces, in grid
    periods. `still`, shape (COMMAND,): command of a vehicle at rest: `Vehicle.pack_command(())`.
    """

    def __init__(
        self, flight: MeasuredFlight, first: NDArray[np.int64], length: int, still: Array
    ) -> None:
        self.flight, self._periods, self._still = flight, first, still
        self.dt = GRID_PERIOD / STEPS_PER_PERIOD
        # One more piece than the flight: the last piece may reach past its end
        count = (len(flight.time) + length) * STEPS_PER_PERIOD
        self._steps = flight.time[0] + self.dt * np.arange(count)
        self.first = first * STEPS_PER_PERIOD
        self.span = length * STEPS_PER_PERIOD
        self._around = np.zeros((count, SURROUNDINGS))
        # Of the surroundings only the voltage is recorded; the others stay 0
        self._around[:, VOLTAGE] = self._interpolate_voltage(self._steps)
        self._sparse = self._around[::STEPS_PER_PERIOD].copy()
        orders = flight.commands
        self._orders = np.zeros((len(orders.time), COMMAND))
        self._orders[:, : orders.values.shape[1]] = orders.values
        self._met = np.zeros((len(orders.time), SURROUNDINGS))
        self._met[:, VOLTAGE] = self._interpolate_voltage(orders.time)
        self._known = self._measured_motion()
        self._rest = self._rest_commands()

    def _interpolate_voltage(self, time: Array) -> Array:
        """Return the voltage, 0 where it is unknown."""
        finite = np.isfinite(self.flight.voltage)
        if not finite.any():
            return np.zeros(len(time))
        return np.interp(time, self.flight.time[finite], self.flight.voltage[finite])

    def _measured_motion(self) -> Array:
        """Return the measured motion by step, at rest where unknown, for effects with memory."""
        states = np.zeros((len(self._steps), RIGID))
        # Identity quaternion (x y z w)
        states[:, 6] = 1.0
        good = np.isfinite(self.flight.position).all(axis=1)
        for k in range(3):
            values = self.flight.position[good, k]
            states[:, k] = np.interp(self._steps, self.flight.time[good], values)
        return states

    def _rest_commands(self) -> Array:
        """Return the command of each step without rotors: the place of the moving mass."""
        commands = np.tile(self._still, (len(self._steps), 1))
        if self.flight.mass is not None:
            mass_stream = self.flight.mass
            # Zero-order hold: the newest command at each step, with a margin for rounding
            newest = np.searchsorted(mass_stream.time, self._steps + 1e-9, side='right') - 1
            commands[:, MASS_PLACE:] = mass_stream.values[np.maximum(newest, 0)]
        return commands

    def build_replay_rows(self, nominal: NominalVehicle) -> ReplayRows:
        """Return the inputs of the compiled replay for a vehicle in this flight."""
        if self.flight.mass is not None:
            # Use the mean place, which is exact for a constant one, as in a glide.
            nominal = nominal.with_mass_at(self._rest[:, MASS_PLACE:].mean(axis=0))
        return self._delay_by_clocks(nominal.build_replay_rows())

    def adapt_rows(self, nominal: NominalVehicle, rows: ReplayRows) -> ReplayRows:
        """Return `build_replay_rows` of a vehicle from its own rows (`NominalVehicle`)."""
        if self.flight.mass is not None:
            return self.build_replay_rows(nominal)  # CG and inertia change
        return self._delay_by_clocks(rows)

    def delays_commands(self, knob: FreeParameter) -> bool:
        """Return whether a clock parameter shifts the commands in this flight."""
        return self.flight.has_only_pose and knob.channels <= set(CLOCKS)

    def _delay_by_clocks(self, rows: ReplayRows) -> ReplayRows:
        """
        Convert an offset of the tracker's clock into a delay of the commands.

        This applies if only the tracker recorded the flight. The replay then uses the tracker's
        clock, and late poses and late commands become exactly equivalent. Late poses would be
        interpolated to second order only, with initial states near the measured ones instead of
        the shifted ones.
        """
        acting = rows.acting
        late = tuple(link for name in CLOCKS for link in acting[name])
        if not late or not self.flight.has_only_pose:
            return rows
        orders = {'command_time': (*acting['command_time'], *late)}
        return replace(rows, acting={**acting, **dict.fromkeys(CLOCKS, ()), **orders})

    def _mean_wrench(self, rows: ReplayRows) -> Array:
        """Return the mean commanded wrench in each step, after any delay."""
        wrench_stream = self.flight.wrench
        if wrench_stream is None:
            return np.zeros((len(self._steps), AXIS_COUNT))
        # A delay shifts when commands arrive, not their values
        acting = apply_channel_effects(
            rows.acting['command_wrench'], wrench_stream.values, wrench_stream.time
        )
        late = Stream(wrench_stream.time + _command_delays(rows, wrench_stream.time), acting)
        return average_held_values(late, np.append(self._steps, self._steps[-1] + self.dt))

    def _applied_wrench(self, ready: BodyInputs, latent: Array, which: slice) -> Array:
        """Return the wrench in each step of some pieces: latent plus commanded."""
        steps = self.first[which, None] + np.arange(self.span)
        return np.ascontiguousarray(latent + ready.wrench[steps])

    def mean_thrusts(self, rows: ReplayRows) -> Array:
        """Return the mean thrust of each rotor in each step [N]."""
        out = np.zeros((len(self._steps), ACTUATORS))
        if self.flight.wrench is not None:
            return out
        time = self.flight.commands.time
        load_actuator_kernel().chain(
            rows.actuators.copy(), rows.actuators_on, time + _command_delays(rows, time),
            self._orders, self._met, float(self._steps[0]), self.dt, LONGEST_ACTUATOR_STEP, out,
        )  # fmt: skip
        return out

    def compute_body_inputs(
        self, rows: ReplayRows, before: BodyInputs | None = None
    ) -> BodyInputs:
        """
        Return the inputs of the body.

        `before`: of a set with the same actuators, which are not simulated again.
        """
        # Actuators are the expensive part: skip them if only memory or body changed
        if before is None:
            commands = self._rest.copy()
            commands[:, :ACTUATORS] = self.mean_thrusts(rows)
            wrench = self._mean_wrench(rows)
        else:
            commands, wrench = before.commands, before.wrench
        return BodyInputs(commands, self._effect_memory(rows, commands), wrench)

    def _effect_memory(self, rows: ReplayRows, commands: Array) -> Array:
        """Return the memory of the effects in each step."""
        memory = np.tile(rows.body[RIGID : BODY_LAYOUT.size], (len(self._steps), 1))
        if rows.body_on[REMEMBERING].any():
            load_body_kernel().remember(
                rows.body.copy(),
                rows.body_on,
                self._known,
                commands,
                self._around,
                self.dt,
                memory,
            )
        return memory

    def update_wrench(self, rows: ReplayRows, before: BodyInputs) -> BodyInputs:
        """Return the inputs of the body with other gains of the commanded wrench."""
        return replace(before, wrench=self._mean_wrench(rows))

    def integrate_pieces(
        self, rows: ReplayRows, ready: BodyInputs, start: Array, latent: Array, which: slice = ALL
    ) -> Array:
        """
        Integrate each piece; return the states at each step, shape (S, span + 1, 13).

        `latent` is the unexplained force and moment of each step in the body frame. [N, N m]
        """
        out = np.zeros((len(start), self.span + 1, RIGID))
        load_body_kernel().fly(
            rows.body.copy(), rows.body_on, self.first[which], start, ready.commands, self._around,
            ready.memory, self._applied_wrench(ready, latent, which), self.dt, out,
        )  # fmt: skip
        return out

    def state_jacobians(self, turns: ParameterSteps, states: Array, latent: Array) -> Array:
        """
        Return the Jacobians of the state rates (`state_changes`), shape (S, n, 12, 12).

        `states`, shape (S, n, 13), and the mean unexplained wrench `latent`, shape (S, n, 6), are
        those in the middle of each grid period. Only the first parameter set is used.
        """
        out = np.zeros((*states.shape[:2], STATE_WIDTH, STATE_WIDTH))
        load_body_kernel().jacobians(
            turns.rows[0].copy(), turns.on[0], self._periods, states, turns.commands[0],
            self._sparse, turns.memory[0], turns.wrench[0], latent, NUDGE, out,
        )  # fmt: skip
        return out

    def parameter_sensitivities(
        self, turns: ParameterSteps, states: Array, latent: Array
    ) -> Array:
        """
        Return the sensitivities of the accelerations to parameters, shape (S, n, 6, K).

        The change of d/dt of body velocity and rates per unit. Arguments as in `state_jacobians`.
        """
        out = np.zeros((*states.shape[:2], AXIS_COUNT, len(turns.steps)))
        # Work space of the kernel
        answers = np.empty((len(turns.rows), states.shape[1], AXIS_COUNT))
        load_body_kernel().answers(
            turns.rows, turns.on, turns.faced, self._periods, states, turns.commands,
            self._sparse, turns.memory, turns.wrench, latent, turns.before, turns.after,
            turns.steps, answers, out,
        )  # fmt: skip
        return out


def _command_delays(rows: ReplayRows, time: Array) -> Array:
    """Return the delay of the commands at some times [s]."""
    # The chain shifts a time of 0 back by the delay
    return -apply_channel_effects(rows.acting['command_time'], np.zeros((len(time), 1)), time)[
        :, 0
    ]


def average_held_values(stream: Stream, edges: Array) -> Array:
    """
    Return the mean of a held signal over each interval, shape (n, k).

    The signal is 0 before its first sample. There are n + 1 rising edges.
    """
    # Each value is held until the next sample
    apart = np.diff(stream.time)[:, None] * stream.values[:-1]
    total = np.vstack([np.zeros((1, stream.values.shape[1])), np.cumsum(apart, axis=0)])
    # -1 before the first sample
    newest = np.searchsorted(stream.time, edges, side='right') - 1
    begun = newest >= 0
    at = np.where(begun, newest, 0)
    since = np.where(begun, edges - stream.time[at], 0.0)
    integral = total[at] + since[:, None] * stream.values[at]
    # Differences of the running integral are exact for a held signal
    means: Array = np.diff(integral, axis=0) / np.diff(edges)[:, None]
    return means
