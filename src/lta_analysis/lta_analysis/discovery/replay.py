"""One measured flight, replayed through the model: everything that a set of parameters decides."""

from dataclasses import dataclass
from typing import Final, final

from lta_analysis.discovery.measured import Measured, PERIOD
from lta_analysis.discovery.nominal import Rows
from lta_analysis.discovery.replay_kernel import actuators, body, BODY_LAYOUT, RIGID
from lta_analysis.discovery.windows import Windows
from lta_sim.measurement import read
from lta_sim.state import ACTUATORS, COMMAND, SURROUNDINGS, VOLTAGE
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEPS: Final = 2  # of the integrator in a grid period
LONGEST: Final = 0.01  # s; of a step of the actuators
ALL: Final = slice(None)


@final
@dataclass(frozen=True, slots=True)
class Ready:
    """
    What the body meets in each step of a flight, under one set of parameters.

    Attributes
    ----------
    commands : ndarray, shape (T, COMMAND)
        Mean thrust of each rotor [N], and the place of the moving mass.
    memory : ndarray, shape (T, M)
        Of the effects of the body.

    """

    commands: Array
    memory: Array


@final
class Replay:
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

    def __init__(self, flight: Measured, cut: Windows, still: Array) -> None:
        self.flight, self.cut, self._still = flight, cut, still
        self.dt = PERIOD / STEPS
        count = (len(flight.time) + cut.length) * STEPS
        self._steps = flight.time[0] + self.dt * np.arange(count)
        self.first = cut.first * STEPS
        self.span = cut.length * STEPS
        self._around = np.zeros((count, SURROUNDINGS))
        self._around[:, VOLTAGE] = self._volts(self._steps)
        orders = flight.commands
        self._orders = np.zeros((len(orders.time), COMMAND))
        self._orders[:, : orders.values.shape[1]] = orders.values
        self._met = np.zeros((len(orders.time), SURROUNDINGS))
        self._met[:, VOLTAGE] = self._volts(orders.time)
        self._known = self._motion()

    def _volts(self, time: Array) -> Array:
        """Return the voltage, 0 where nobody knows it."""
        known = np.isfinite(self.flight.voltage)
        if not known.any():
            return np.zeros(len(time))
        return np.interp(time, self.flight.time[known], self.flight.voltage[known])

    def _motion(self) -> Array:
        """Return the measured motion by step, at rest where nobody knows: what memories see."""
        states = np.zeros((len(self._steps), RIGID))
        states[:, 6] = 1.0
        good = np.isfinite(self.flight.position).all(axis=1)
        for k in range(3):
            values = self.flight.position[good, k]
            states[:, k] = np.interp(self._steps, self.flight.time[good], values)
        return states

    def thrusts(self, rows: Rows) -> Array:
        """Return the mean thrust of each rotor in each step. [N]"""
        delay = -read(rows.acting['command_time'], (0.0,), 0.0)[0]
        out = np.zeros((len(self._steps), ACTUATORS))
        actuators().chain(
            rows.actuators.copy(), rows.actuators_on, self.flight.commands.time + delay,
            self._orders, self._met, float(self._steps[0]), self.dt, LONGEST, out,
        )  # fmt: skip
        return out

    def ready(self, rows: Rows, before: Ready | None = None) -> Ready:
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
            commands = np.tile(self._still, (len(self._steps), 1))
            commands[:, :ACTUATORS] = self.thrusts(rows)
        else:
            commands = before.commands
        memory = np.zeros((len(self._steps), BODY_LAYOUT.size - RIGID))
        body().remember(
            rows.body.copy(), rows.body_on, self._known, commands, self._around, self.dt, memory
        )
        return Ready(commands, memory)

    def fly(
        self, rows: Rows, ready: Ready, start: Array, latent: Array, which: slice = ALL
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
        body().fly(
            rows.body.copy(), rows.body_on, self.first[which], start, ready.commands, self._around,
            ready.memory, latent, self.dt, out,
        )  # fmt: skip
        return out

    def slopes(
        self, rows: Rows, ready: Ready, states: Array, latent: Array, which: slice = ALL
    ) -> Array:
        """
        Return rates at given states.

        Parameters
        ----------
        rows, ready, latent, which
            As for `fly`.
        states : ndarray, shape (S, span, 13)
            One in each step.

        Returns
        -------
        ndarray, shape (S, span, 9)
            d/dt of position, body velocity and body rates.

        """
        out = np.zeros((len(states), self.span, 9))
        body().slopes(
            rows.body.copy(), rows.body_on, self.first[which], states, ready.commands,
            self._around, ready.memory, latent, out,
        )  # fmt: skip
        return out
