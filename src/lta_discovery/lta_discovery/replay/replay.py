"""One measured flight, replayed through the model: everything that a set of parameters decides."""

from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.flights.measured_flight import MeasuredFlight, PERIOD, Stream
from lta_discovery.flights.windows import Windows
from lta_discovery.flights.zero_order_hold import average_held_values
from lta_discovery.model.nominal import NominalVehicle, ReplayRows
from lta_discovery.model.parameter_sets import ParameterSteps
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.replay_kernel import BODY_LAYOUT, load_actuators, load_body, RIGID
from lta_discovery.replay.sensing import transform_readings
from lta_discovery.replay.variational_equation import NUDGE, WIDTH
from lta_model.state import ACTUATORS, COMMAND, MASS_PLACE, SURROUNDINGS, VOLTAGE
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEPS: Final = 2  # of the integrator in a grid period
LONGEST: Final = 0.01  # s; of a step of the actuators
ALL: Final = slice(None)
AXES: Final = 6
CLOCKS: Final = ('clock', 'pose_time')  # channels that decide when a pose is true
REMEMBERING: Final = [
    flag for flag, name in enumerate(BODY_LAYOUT.effects) if BODY_LAYOUT.memory_size(name)
]


@final
@dataclass(frozen=True, slots=True)
class BodyInputs:
    """
    What the body meets in each step of a flight, under one set of parameters.

    Attributes
    ----------
    commands : ndarray, shape (T, COMMAND)
        Mean thrust of each rotor [N], and the place of the moving mass.
    memory : ndarray, shape (T, M)
        Of the effects of the body.
    wrench : ndarray, shape (T, 6)
        Commanded as such, body frame. [N, N m]

    """

    commands: Array
    memory: Array
    wrench: Array

    def average_periods(self) -> tuple[Array, Array, Array]:
        """Return the means over each grid period."""
        first, second, third = (
            part.reshape(-1, STEPS, part.shape[1]).mean(axis=1)
            for part in (self.commands, self.memory, self.wrench)
        )
        return first, second, third


@final
class ModelReplay:
    """
    A flight that can be replayed.

    Parameters
    ----------
    flight : Measured
        The flight.
    cut : Windows
        Its pieces.
    still : ndarray, shape (COMMAND,)
        The command of a vehicle at rest: `Vehicle.command(())`.

    """

    def __init__(self, flight: MeasuredFlight, cut: Windows, still: Array) -> None:
        self.flight, self.cut, self._still = flight, cut, still
        self.dt = PERIOD / STEPS
        count = (len(flight.time) + cut.length) * STEPS
        self._steps = flight.time[0] + self.dt * np.arange(count)
        self.first = cut.first * STEPS
        self.span = cut.length * STEPS
        self._around = np.zeros((count, SURROUNDINGS))
        self._around[:, VOLTAGE] = self._interpolate_voltage(self._steps)
        self._sparse = self._around[::STEPS].copy()
        orders = flight.commands
        self._orders = np.zeros((len(orders.time), COMMAND))
        self._orders[:, : orders.values.shape[1]] = orders.values
        self._met = np.zeros((len(orders.time), SURROUNDINGS))
        self._met[:, VOLTAGE] = self._interpolate_voltage(orders.time)
        self._known = self._measured_motion()
        self._rest = self._rest_commands()

    def with_pieces(self, cut: Windows) -> 'ModelReplay':
        """Return the same flight in other pieces."""
        return ModelReplay(self.flight, cut, self._still)

    def _interpolate_voltage(self, time: Array) -> Array:
        """Return the voltage, 0 where nobody knows it."""
        known = np.isfinite(self.flight.voltage)
        if not known.any():
            return np.zeros(len(time))
        return np.interp(time, self.flight.time[known], self.flight.voltage[known])

    def _measured_motion(self) -> Array:
        """Return the measured motion by step, at rest where nobody knows: what memories see."""
        states = np.zeros((len(self._steps), RIGID))
        states[:, 6] = 1.0
        good = np.isfinite(self.flight.position).all(axis=1)
        for k in range(3):
            values = self.flight.position[good, k]
            states[:, k] = np.interp(self._steps, self.flight.time[good], values)
        return states

    def _rest_commands(self) -> Array:
        """Return the command of each step with no rotor turning: where the moving mass is."""
        commands = np.tile(self._still, (len(self._steps), 1))
        if self.flight.mass is not None:
            told = self.flight.mass
            newest = np.searchsorted(told.time, self._steps + 1e-9, side='right') - 1
            commands[:, MASS_PLACE:] = told.values[np.maximum(newest, 0)]
        return commands

    def build_rows(self, nominal: NominalVehicle) -> ReplayRows:
        """Return what the compiled replay takes of a vehicle in this flight."""
        if self.flight.mass is not None:
            # About its mean place: where it stands still, as in a glide, nothing is left out.
            nominal = nominal.with_mass_at(self._rest[:, MASS_PLACE:].mean(axis=0))
        return self._delay_by_clocks(nominal.build_rows())

    def update_rows(
        self, nominal: NominalVehicle, other: NominalVehicle, rows: ReplayRows
    ) -> ReplayRows:
        """Return `rows` of a vehicle, knowing those of one that differs little."""
        if self.flight.mass is not None:
            return self.build_rows(nominal)  # its balance and inertia are weighed anew
        return self._delay_by_clocks(nominal.update_rows(other, rows))

    def delays_commands(self, knob: FreeParameter) -> bool:
        """Tell whether a knob of the clocks decides when commands are obeyed in this flight."""
        return self.flight.has_only_pose and knob.channels <= set(CLOCKS)

    def _delay_by_clocks(self, rows: ReplayRows) -> ReplayRows:
        """
        Return parameters with what the tracker's stamps are off by as a delay of the commands.

        Only where nothing but the tracker saw the flight. The replay then runs by the tracker's
        clock, and a late pose and a late command are the same, to the last bit. If late poses were
        read off a replay by the other clock, they would differ: they are read to second order, and
        each piece begins near where the tracker has the vehicle, not where it is by then.
        """
        acting = rows.acting
        late = tuple(link for name in CLOCKS for link in acting[name])
        if not late or not self.flight.has_only_pose:
            return rows
        orders = {'command_time': (*acting['command_time'], *late)}
        return replace(rows, acting={**acting, **dict.fromkeys(CLOCKS, ()), **orders})

    def _mean_wrench(self, rows: ReplayRows) -> Array:
        """Return the mean commanded wrench in each step, after any delay."""
        told = self.flight.wrench
        if told is None:
            return np.zeros((len(self._steps), AXES))
        late = Stream(told.time + _command_delays(rows, told.time), told.values * rows.gains)
        return average_held_values(late, np.append(self._steps, self._steps[-1] + self.dt))

    def _applied_wrench(self, ready: BodyInputs, latent: Array, which: slice) -> Array:
        """Return the wrench in each step of some pieces: latent, and commanded as such."""
        steps = self.first[which, None] + np.arange(self.span)
        return np.ascontiguousarray(latent + ready.wrench[steps])

    def mean_thrusts(self, rows: ReplayRows) -> Array:
        """Return the mean thrust of each rotor in each step. [N]"""
        out = np.zeros((len(self._steps), ACTUATORS))
        time = self.flight.commands.time
        load_actuators().chain(
            rows.actuators.copy(), rows.actuators_on, time + _command_delays(rows, time),
            self._orders, self._met, float(self._steps[0]), self.dt, LONGEST, out,
        )  # fmt: skip
        return out

    def compute_inputs(self, rows: ReplayRows, before: BodyInputs | None = None) -> BodyInputs:
        """
        Return what the body meets.

        Parameters
        ----------
        rows : Rows
            The parameters.
        before : Ready, optional
            Of a set with the same actuators, which need not be run again.

        """
        if before is None:
            commands = self._rest.copy()
            commands[:, :ACTUATORS] = self.mean_thrusts(rows)
            wrench = self._mean_wrench(rows)
        else:
            commands, wrench = before.commands, before.wrench
        return BodyInputs(commands, self._compute_memory(rows, commands), wrench)

    def _compute_memory(self, rows: ReplayRows, commands: Array) -> Array:
        """Return the memory of the effects in each step."""
        memory = np.tile(rows.body[RIGID : BODY_LAYOUT.size], (len(self._steps), 1))
        if rows.body_on[REMEMBERING].any():
            load_body().remember(
                rows.body.copy(), rows.body_on, self._known, commands, self._around, self.dt,
                memory,
            )  # fmt: skip
        return memory

    def update_wrench(self, rows: ReplayRows, before: BodyInputs) -> BodyInputs:
        """Return what the body meets with other gains of the commanded wrench."""
        return replace(before, wrench=self._mean_wrench(rows))

    def integrate_pieces(
        self, rows: ReplayRows, ready: BodyInputs, start: Array, latent: Array, which: slice = ALL
    ) -> Array:
        """
        Integrate each piece.

        Parameters
        ----------
        rows, ready : Rows, Ready
            The parameters, and what the body meets under them.
        start : ndarray, shape (S, 13)
            States at the beginnings.
        latent : ndarray, shape (S, span, 6)
            Force and moment that nothing explains, body frame. [N, N m]
        which : slice
            Of the pieces: those that the arrays are about.

        Returns
        -------
        ndarray, shape (S, span + 1, 13)
            States at each step.

        """
        out = np.zeros((len(start), self.span + 1, RIGID))
        load_body().fly(
            rows.body.copy(), rows.body_on, self.first[which], start, ready.commands, self._around,
            ready.memory, self._applied_wrench(ready, latent, which), self.dt, out,
        )  # fmt: skip
        return out

    def state_jacobians(
        self, turns: ParameterSteps, states: Array, latent: Array, which: slice = ALL
    ) -> Array:
        """
        Return how the rates of a change answer to the change, at given states.

        Parameters
        ----------
        turns : Turns
            The first set of parameters and what it meets count.
        states : ndarray, shape (S, n, 13)
            In the middle of each grid period.
        latent : ndarray, shape (S, n, 6)
            Mean force and moment that nothing explains. [N, N m]
        which : slice
            Of the pieces: those that the arrays are about.

        Returns
        -------
        ndarray, shape (S, n, 12, 12)
            F of `tangent`.

        """
        out = np.zeros((*states.shape[:2], WIDTH, WIDTH))
        load_body().jacobians(
            turns.rows[0].copy(), turns.on[0], self.cut.first[which], states, turns.commands[0],
            self._sparse, turns.memory[0], turns.wrench[0], latent, NUDGE, out,
        )  # fmt: skip
        return out

    def parameter_sensitivities(
        self, turns: ParameterSteps, states: Array, latent: Array, which: slice = ALL
    ) -> Array:
        """
        Return how the accelerations answer to knobs, at given states.

        Parameters
        ----------
        turns : Turns
            The knobs.
        states, latent, which
            As for `state_jacobians`.

        Returns
        -------
        ndarray, shape (S, n, 6, K)
            d/dt of body velocity and body rates by a unit of each knob.

        """
        out = np.zeros((*states.shape[:2], AXES, len(turns.steps)))
        kept = np.empty((len(turns.rows), states.shape[1], AXES))
        load_body().answers(
            turns.rows, turns.on, turns.faced, self.cut.first[which], states, turns.commands,
            self._sparse, turns.memory, turns.wrench, latent, turns.before, turns.after,
            turns.steps, kept, out,
        )  # fmt: skip
        return out


def _command_delays(rows: ReplayRows, time: Array) -> Array:
    """Return how late the commands of some times are obeyed. [s]"""
    return -transform_readings(rows.acting['command_time'], np.zeros((len(time), 1)), time)[:, 0]
