# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate and linearise one control period, with the loop opened at the controller's demand.

A period covers noise-free sensors, estimator, cascade, allocation, motors and vehicle, computed by
the functions that fly. All delays are therefore included: sampling, motor lag, filters and command
delay. Range and pressure arrive in some periods only; here they are used in every period, with
their variance raised by the same factor.

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

from lta_config.constants import STANDARD_GRAVITY
from lta_config.topics import load_topic_table
from lta_control.allocation import create_working_array, pad_to_slots, SLOTS
from lta_control.autopilot import Autopilot, build_drone_constants, MEMORY_LAYOUT
from lta_control.estimator import EstimatorInputs, EstimatorSettings
from lta_control.flight_step import (
    DroneConstants,
    DroneMemory,
    estimate_motion,
    motion_from_estimate,
    SensorInputs,
)
from lta_control.laws.cascade import (
    CascadeGains,
    CascadeLawMemory,
    compute_demand,
    deliver_demand,
    WrenchDemand,
)
from lta_control.motion import measure_motion, Setpoint, up_in_body
from lta_model.effects import initial_memory
from lta_model.model import STEP_NS, VehicleModel
from lta_model.rigid_body import height_and_tilt
from lta_model.sensors.imu import specific_force_at
from lta_model.sensors.pressure import air_pressure, PressureSettings
from lta_model.state import pack_state
from lta_model.vehicle import Vehicle
from lta_sim.kernels import kernel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SETTLING = 80.0  # s from take-off until the flight counts as steady
FLICKER = 1e-12  # m of the range finder, from one period to the next
SHORT_REST_TIME = 0.5  # s of bias calibration; short because the sensors have no bias here


@final
class LoopCut:
    """
    One control period of a drone, with the loop closed or opened.

    `true`, `nominal`: the simulated vehicle, and the one that the drone assumes. `gains`: gains of
    the controller.
    """

    def __init__(self, true: Vehicle, nominal: Vehicle, gains: CascadeGains) -> None:
        table = load_topic_table()
        self.period = table.control_ns * 1e-9
        # Integration steps per control period, rounded up.
        self._steps = -(-table.control_ns // STEP_NS)
        self._true, self._model = true, true.build_model()
        self._floor = PressureSettings().floor
        own = EstimatorSettings()
        # More frequent readings with more noise each: the same information per second.
        less = own.altitude.model_copy(
            update={
                name: getattr(own.altitude, name)
                * math.sqrt(table[topic].period_ns / table.control_ns)
                for name, topic in (('range_noise', 'range'), ('pressure_noise', 'pressure'))
            }
        )
        settings = own.model_copy(update={'rest_time': SHORT_REST_TIME, 'altitude': less})
        self._still = _build_damped_model(true)
        self.drone: DroneConstants = build_drone_constants(nominal, settings, gains, self.period)
        delay = (
            self._model.effect_parameters.get('command_delay', {}).get('delay', 0.0) / self.period
        )
        # Split the delay into whole periods and the rest; 1e-9 absorbs rounding.
        self._whole = int(delay + 1e-9)
        self._part = delay - self._whole if delay - self._whole > 1e-9 else 0.0
        self.ages = self._whole + 2  # commands that this period and the next need

    def simulate_sensors(
        self, state: Array, past: Array, model: VehicleModel | None = None
    ) -> SensorInputs:
        """
        Return noise-free sensor readings.

        `state`: state of the vehicle. `past`, shape (n, SLOTS): commands of the earlier periods,
        newest first. `model`: model to use; by default that of the true vehicle.
        """
        sensors = self._true.file.sensors
        numbers = state.tolist()
        orders = self._rotor_command(past[self._whole])
        # The accelerometer needs the linear and angular acceleration of the state.
        rate = kernel.state_derivative(state, model or self._model, orders).tolist()
        imu, below = sensors.imu_position.vector, sensors.range_position.vector
        height, up = height_and_tilt(numbers, (below[0], below[1], below[2]))
        place = (imu[0], imu[1], imu[2])
        return SensorInputs(
            (numbers[10], numbers[11], numbers[12]),
            specific_force_at(numbers, rate, place, STANDARD_GRAVITY),
            # The range sensor measures along the tilted body axis.
            height / up,
            air_pressure(self._floor, height_and_tilt(numbers, place)[0]),
        )

    def advance_vehicle(
        self, state: Array, past: Array, model: VehicleModel | None = None
    ) -> Array:
        """Return the vehicle state one period later; `past[0]` is this period's command."""
        # With a fractional delay the older command still acts in the first part of the period.
        for share, age in ((self._part, self._whole + 1), (1.0 - self._part, self._whole)):
            if share > 0.0:
                step = share * self.period / self._steps
                orders = self._rotor_command(past[age])
                state = kernel.advance(
                    # Still air
                    state,
                    model or self._model,
                    orders,
                    (0.0, 0.0, 0.0),
                    step,
                    self._steps,
                )
        return state

    def _rotor_command(self, command: Array) -> Array:
        return self._true.pack_command(command[: len(self._true.rotors)].tolist())

    def step_controller(
        self, state: Array, memory: DroneMemory, past: Array, imposed: WrenchDemand | None
    ) -> tuple[DroneMemory, WrenchDemand]:
        """
        Return the memory of the drone after one step, and the demand of its cascade.

        The rotors get `imposed` if given, else the demand of the cascade.
        """
        drone = self.drone
        law, sensed = cascade_memory(memory), self.simulate_sensors(state, past)
        estimate = estimate_motion(
            drone.estimator,
            drone.body,
            memory.estimate,
            EstimatorInputs(
                sensed.rates,
                sensed.force,
                sensed.range,
                sensed.pressure,
                # The estimator knows the command of the period before
                pad_to_slots(past[0].tolist()),
            ),
            drone.dt,
        )
        measured = measure_motion(motion_from_estimate(estimate))
        demand, cascade = compute_demand(drone.law, law, measured, memory.setpoint, drone.dt)
        law = deliver_demand(
            drone.law.rotors, imposed or demand, cascade, law.thrusts, create_working_array()
        )
        pilot = memory.pilot._replace(law=law)
        return memory._replace(estimate=estimate, measured=measured, pilot=pilot), demand

    def find_steady_flight(self, setpoint: Setpoint) -> tuple[Array, DroneMemory]:
        """
        Return vehicle state and drone memory in steady flight at a setpoint.

        The flight there is noise-free, with a damped hull and without command delay. Neither
        changes the steady state, so it is found even where it is unstable.
        """
        autopilot = Autopilot(self.drone)
        state = pack_state((0.0, 0.0, self._true.hull_height_on_floor), memory=initial_memory())
        past = np.zeros((self.ages, SLOTS))
        for tick in np.arange(round((SHORT_REST_TIME + SETTLING) / self.period)):
            # No setpoint before the bias calibration on the ground has ended.
            if tick * self.period > SHORT_REST_TIME:
                autopilot.set_setpoint(setpoint)
            sensed = self.simulate_sensors(state, past, self._still)
            # A range finder that repeats its reading to the bit would count as stuck
            distance = sensed.range + FLICKER * (tick % 2)
            duties = autopilot.step(sensed.rates, sensed.force, distance, sensed.pressure)
            # Every age gets the present command, which removes the delay.
            past[:, : len(duties)] = duties
            state = self.advance_vehicle(state, past, self._still)
        return state, autopilot.memory


def cascade_memory(memory: DroneMemory) -> CascadeLawMemory:
    """Return the memory of the cascade of a drone that flies by it."""
    law = memory.pilot.law
    if not isinstance(law, CascadeLawMemory):
        raise TypeError(f'{law} is no memory of the cascade')
    return law


def _build_damped_model(vehicle: Vehicle) -> VehicleModel:
    """Return a model of the vehicle with critically damped roll and pitch."""
    effects = vehicle.collect_effects()
    own = dict(effects.get('rotational_drag', {}))
    # Pendulum stiffness m g z per radian about the centre of buoyancy.
    stiffness = abs(vehicle.mass * STANDARD_GRAVITY * float(vehicle.cg[2]))
    # Yaw has no stiffness, hence no critical damping.
    for axis, name in enumerate(('roll', 'pitch')):
        inertia = float(vehicle.inertia[axis, axis]) + vehicle.added_mass[3 + axis]
        # Parallel axes: the inertia of the file is about the centre of gravity.
        inertia += vehicle.mass * float(vehicle.cg[2]) ** 2
        # Critical damping of a second-order system: 2 sqrt(k J)
        own[name] = own.get(name, 0.0) + 2.0 * math.sqrt(stiffness * inertia)
    return VehicleModel.build(
        {**effects, 'rotational_drag': own},
        mass=vehicle.mass,
        cg=vehicle.cg,
        inertia=vehicle.inertia,
        displaced=vehicle.displaced_mass,
        rotors=[(rotor.place, rotor.axis) for rotor in vehicle.rotors],
    )


LINEARIZATION_STEP = 1e-6  # step of the central differences, relative above 1
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
        """Growth rate of the least damped mode; negative if it decays [1/s]."""
        return math.log(self.radius) / self.period


def linearize_loop(cut: LoopCut, setpoint: Setpoint) -> LinearLoop:
    """Linearise a loop about the steady flight at a setpoint."""
    state, memory = cut.find_steady_flight(setpoint)
    first, second = len(state), len(state) + MEMORY_LAYOUT.size
    # In steady flight all commands that are still on their way are equal.
    past = np.tile(np.array(memory.pilot.law.command.duties), (cut.ages, 1))
    _, trim = cut.step_controller(state, memory, past, None)

    def step_period(x: Array, u: Array) -> tuple[Array, Array]:
        own, stored, before = (
            x[:first],
            MEMORY_LAYOUT.read(x[first:second]),
            x[second:].reshape(-1, SLOTS),
        )
        after, demanded = cut.step_controller(own, stored, before, WrenchDemand(*u.tolist()))
        # Shift register of the command delay, newest first
        commands = np.vstack([np.array(after.pilot.law.command.duties), before[:-1]])
        state_after = cut.advance_vehicle(own, commands)
        return np.concatenate(
            [state_after, MEMORY_LAYOUT.write(after), commands.ravel()]
        ), np.array(demanded)

    numbers, u = np.concatenate([state, MEMORY_LAYOUT.write(memory), past.ravel()]), np.array(trim)
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
        step[place] = LINEARIZATION_STEP * max(1.0, abs(at[place]))
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
