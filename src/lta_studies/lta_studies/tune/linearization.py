"""
Linearise one control period of an opened loop about a steady flight.

    x' = A x + B u,    y = C x

x is the state of vehicle, estimator and controller, u the wrench given to the rotors (surge,
heave, yaw), and y the wrench that the cascade demands; in flight u = y. Derivatives are central
differences. At a symmetric kink, such as one forward rotor for each turning direction, they give
the mean slope, which is exact for the loop concerned.
"""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import final

from lta_control.attitude import up_in_body
from lta_control.autopilot import MEMORY
from lta_control.cascade import Setpoint, WrenchDemand
from lta_control.flight_step import DroneMemory
from lta_control.per_rotor import SLOTS
from lta_studies.tune.loop_cut import cascade_memory, LoopCut
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
DIFFERENCE = 1e-6  # step of the central differences, relative above 1
NEUTRAL = 1e-5  # rounding tolerance for the integrators (position, bias), eigenvalue 1


@final
@dataclass(frozen=True, slots=True)
class LinearLoop:
    """An opened loop, linearised about one steady flight."""

    # Matrices of x' = A x + B u, y = C x; unconnected states are removed
    a: Array
    b: Array
    c: Array
    period: float  # control period [s]
    # Spectral radius of the closed loop, and angular frequency of that mode [1, rad/s]
    radius: float
    swing: float
    tilt: float  # tilt in the steady flight [rad]
    thrusts: tuple[float, ...]  # thrusts in the steady flight [N]

    @property
    def is_stable(self) -> bool:
        """Whether small disturbances decay."""
        return self.radius < 1.0 + NEUTRAL

    @property
    def growth_rate(self) -> float:
        """Growth rate of the least damped mode; negative if it decays. [1/s]"""
        return math.log(self.radius) / self.period


def linearize_loop(cut: LoopCut, setpoint: Setpoint) -> LinearLoop:
    """Linearise a loop about the steady flight at a setpoint."""
    state, memory = cut.find_steady_flight(setpoint)
    first, second = len(state), len(state) + MEMORY.size
    # In steady flight all commands that are still on their way are equal.
    past = np.tile(np.array(memory.pilot.law.command.duties), (cut.ages, 1))
    _, trim = cut.step_controller(state, memory, past, None)

    def step_period(x: Array, u: Array) -> tuple[Array, Array]:
        own, stored, before = (
            x[:first],
            MEMORY.read(x[first:second]),
            x[second:].reshape(-1, SLOTS),
        )
        after, demanded = cut.step_controller(own, stored, before, WrenchDemand(*u.tolist()))
        # Shift register of the command delay, newest first
        commands = np.vstack([np.array(after.pilot.law.command.duties), before[:-1]])
        state_after = cut.advance_vehicle(own, commands)
        return np.concatenate([state_after, MEMORY.write(after), commands.ravel()]), np.array(
            demanded
        )

    numbers, u = np.concatenate([state, MEMORY.write(memory), past.ravel()]), np.array(trim)
    # Flags and counters of the memory have no derivative.
    turned = [first + place for place in _find_continuous_states(memory)]
    everything = [*np.arange(first).tolist(), *turned, *np.arange(second, len(numbers)).tolist()]
    a, c = _compute_jacobians(lambda x: step_period(x, u), numbers, everything)
    b, _ = _compute_jacobians(lambda v: step_period(numbers, v), u, [0, 1, 2])
    # Drop states that cannot matter, such as the horizontal position: they hold eigenvalues 1.
    keep = _find_connected_states(a, b, c)
    a, b, c = a[np.ix_(keep, keep)], b[keep], c[:, keep]
    # In flight u = y, so the closed loop is x' = (A + B C) x.
    modes = np.linalg.eigvals(a + b @ c)
    worst = modes[np.abs(modes).argmax()]
    # Discrete eigenvalue: its modulus is the growth per period, its angle the frequency.
    radius, swing = float(np.abs(worst)), float(abs(np.angle(worst))) / cut.period
    up = up_in_body(memory.estimate.attitude)[2]
    tilt = math.acos(min(1.0, up))
    return LinearLoop(a, b, c, cut.period, radius, swing, tilt, cascade_memory(memory).thrusts)


def _find_continuous_states(memory: DroneMemory) -> list[int]:
    """Return the indices of the floats in a memory (no flags, no counters)."""
    kinds: list[bool] = []

    def walk(value: object) -> None:
        if isinstance(value, tuple):
            for item in value:
                walk(item)
        else:
            kinds.append(isinstance(value, float))

    walk(memory)
    return [place for place, real in enumerate(kinds) if real]


def _compute_jacobians(
    function: Callable[[Array], tuple[Array, Array]], at: Array, turned: list[int]
) -> list[Array]:
    """Return the Jacobians of both outputs of a function by central differences."""
    tables = [np.zeros((len(row), len(at))) for row in function(at)]
    for place in turned:
        step = np.zeros(len(at))
        step[place] = DIFFERENCE * max(1.0, abs(at[place]))
        for table, high, low in zip(tables, function(at + step), function(at - step), strict=True):
            # Central difference: the error is of second order in the step.
            table[:, place] = (high - low) / (2.0 * step[place])
    return tables


def _find_connected_states(a: Array, b: Array, c: Array) -> NDArray[np.intp]:
    """Return the states that are both reachable from an input and visible in an output."""
    # links[i, j]: state j influences state i after one period.
    links = (np.abs(a) > 0.0) & ~np.isnan(a)
    reached, seen = np.abs(b).max(axis=1) > 0.0, np.abs(c).max(axis=0) > 0.0
    # A path through n states has at most n steps.
    for _ in np.arange(len(a)):
        reached |= links[:, reached].any(axis=1)
        seen |= links[seen].any(axis=0)
    return np.flatnonzero(reached & seen)
