# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The simulated world around one drone, one control period at a time, without ROS.

A `World` holds the true state, returns the sensor readings and takes commands. The simulator node
and every one-process loop run this class. Time is integer nanoseconds on the grid of the topic
table. Each sensor has its own random stream, so that an additional sensor does not change the
noise of the others.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.topics import TopicTable
from lta_model import model
from lta_model.effects import EFFECTS
from lta_model.electrical.loads import navigation_power
from lta_model.light.view import LightView, Pose
from lta_model.measurement_chain import apply_chain, build_chains, Chain
from lta_model.rigid_body import height_and_tilt
from lta_model.scenario import Scenario
from lta_model.sensors import imu, pressure, range
from lta_model.state import pack_state, RIGID
from lta_model.vehicle import Vehicle
from lta_sim.command_link import CommandLink
from lta_sim.environment import draw_initial_memory, FlightEnvironment
from lta_sim.readings import FlightOutcome, SensorReadings, Vector
from lta_sim.scene_model import build_scene_model, vehicle_reach
from lta_sim.simulated_vehicle import SIM_LAYOUT, SimulatedVehicle
from lta_sim.supply import Supply
from lta_sim.termination import FlightTermination
from lta_sim.tracker import SimulatedTracker
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STILL_DERIVATIVE = np.zeros(RIGID)  # state derivative of a held drone
# Append new ones at the end: the position in this list is part of the seed.
STREAMS = (
    'start', 'imu', 'range', 'pressure', 'photodiodes', 'battery', 'panel', 'turbulence', 'diodes',
)  # fmt: skip
HELD_TREMOR = 1e-9  # of a drone that is held [m]
SETTLED_NS = 1_000_000_000  # in which motors reach the thrust of their duty
TIMED_SENSORS = ('pressure', 'photodiodes', 'battery', 'ground_truth/odom', 'illuminance')


@final
class World:
    """
    One drone in one scene.

    Parameters
    ----------
    vehicle : Vehicle
        The drone, built for the scenario's air density.
    table : TopicTable
        Period and latency of each sensor.
    strategy : str
        Navigation strategy, for its power consumption and its stay at the lamp; '' for none.
    wrench_commanded : bool
        Whether recorded forces and moments fly the drone, not its rotors.

    Attributes
    ----------
    steps : int
        Number of control steps since the start.
    stamp_ns : int
        Stamp of the present control step. [ns]
    elapsed : float
        Time since the start. [s]

    Raises
    ------
    BadInput
        If the vehicle does not fit the scene or reacts too fast for the time step.

    """

    def __init__(
        self,
        vehicle: Vehicle,
        scenario: Scenario,
        table: TopicTable,
        seed: int,
        strategy: str = '',
        *,
        wrench_commanded: bool = False,
    ) -> None:
        self.vehicle = vehicle
        self.scenario = scenario
        # One independent random stream per sensor, from seed and index.
        self._chance = {
            name: np.random.default_rng(np.random.SeedSequence([seed, index]))
            for index, name in enumerate(STREAMS)
        }
        self._model = build_scene_model(vehicle, scenario)
        vehicle.check_step(model.STEP_NS * 1e-9, self._model)
        self._referee = FlightTermination(scenario, strategy)
        self._store_constants(table)
        self._draw_errors()
        self._craft = SimulatedVehicle(self._model, commanded=wrench_commanded)
        self.state = self._craft.state  # changes in place
        self.state[:] = self._initial_state()
        acting = self._acting = self._build_measurement_chains()
        self._link = CommandLink(
            vehicle.reversible, self._model.effect_parameters, acting['command_time']
        )
        self.command = self._craft.command
        self.command[:] = self._link.idle
        self.supply = Supply(
            vehicle, scenario.start.charge.si, self._chance, scenario.faults.times,
            navigation_power(vehicle.file.energy, strategy),
        )  # fmt: skip
        self._enter_step(0)
        self.outcome = FlightOutcome.FLYING  # outcome of the flight; final once decided
        self._ranges: list[tuple[int, float]] = []
        self._around = FlightEnvironment(
            self._model.effect_parameters, scenario, self._light, self._chance['turbulence'],
            self._period, vehicle_reach(vehicle)[0],
        )  # fmt: skip
        pose = self.start_pose = self._pose()
        self._begin_period(pose)
        self._load_kernels()

    def _load_kernels(self) -> None:
        """Compile the kernels or load them from disk now, not in the middle of a step."""
        self._craft.evaluate_state()
        # Zero steps compile without changing the state
        self._craft.advance(self._period, 0)
        self._imu.prepare(self.state, self._craft.rate)
        self._light.prepare(*self._shape)
        self.supply.prepare()

    def _store_constants(self, table: TopicTable) -> None:
        """Read constants from the files once, not at every step."""
        sensors, scenario = self.vehicle.file.sensors, self.scenario
        self._start_ns, self._control_ns = table.start_ns, table.control_ns
        self._period = table.control_ns * 1e-9
        self._range_ns = table['range'].period_ns
        self._rhythm = {
            name: (table[name].latency_ns, table[name].period_ns) for name in TIMED_SENSORS
        }
        self._shape = (table.light.sample_rate.si, table.light.samples)
        field = scenario.light_field
        diodes = self.vehicle.diodes.draw_gains(self._chance['diodes'])
        self._light = LightView(field, self.vehicle, diodes)
        self._imu_place = _to_vector(sensors.imu_position.vector)
        self._range_place = _to_vector(sensors.range_position.vector)
        self._held = scenario.start.held.si
        self._rotors = len(self.vehicle.reversible)

    def _build_measurement_chains(self) -> Mapping[str, Chain]:
        """Build and return the measurement chains between true and reported values."""
        acting = build_chains(self._model.effect_parameters, EFFECTS)
        self._imu = imu.Imu(
            self.imu_errors, self._imu_place, STANDARD_GRAVITY, self._chance['imu'],
            acting['force'], acting['rates'],
        )  # fmt: skip
        self._on_range, self._on_pressure = acting['range'], acting['pressure']
        self._tracker = SimulatedTracker(acting)
        return acting

    def _draw_errors(self) -> None:
        """Draw the errors that stay constant during the flight."""
        air = self.scenario.air
        self.imu_errors = imu.draw_errors(imu.ImuSettings(), self._chance['imu'])
        self.range_settings = range.RangeSettings()
        self._range = range.draw_errors(self.range_settings, self._chance['range'])
        self.pressure_settings = pressure.PressureSettings(floor=air.pressure.si)
        self._pressure = pressure.draw_errors(self.pressure_settings, self._chance['pressure'])

    def _initial_state(self) -> Array:
        """Return the state on the floor, with a random heading within the scenario's spread."""
        start = self.scenario.start
        x, y = start.position.vector
        spread = start.heading_spread.si
        heading = start.heading.si + float(self._chance['start'].uniform(-spread, spread))
        height = self.vehicle.hull_height_on_floor
        memory = draw_initial_memory(self._model.effect_parameters, self._chance['turbulence'])
        return pack_state((x, y, height), heading, memory=memory)

    def begin_at(self, motion: Sequence[float], duties: Sequence[float]) -> None:
        """
        Begin with another motion than that of a drone at rest; nothing then ends the flight.

        `motion` holds the first `RIGID` numbers of a state (`lta_model.state`). The motors have
        been running at `duties` for a while.
        """
        self.state[:RIGID] = motion
        if any(duties):
            self.command[: self._rotors] = duties
            self._integrate_for_duration(SETTLED_NS)
            self.state[:RIGID] = motion
        pose = self.start_pose = self._pose()
        self.fly_without_end()
        self._held = 0.0
        self._begin_period(pose)

    @property
    def charge(self) -> float:
        """State of charge of the cell [1]."""
        return self.supply.flow.charge

    @property
    def duties(self) -> Array:
        """Duty that each rotor receives at this moment, after any delay. [1]."""
        return self.command[: self._rotors]

    @property
    def is_held(self) -> bool:
        """Whether a hand still holds the drone where it stands."""
        return self.elapsed < self._held

    def fly_without_end(self) -> None:
        """Let neither a reached lamp nor the time limit end the flight."""
        self._referee = FlightTermination(self.scenario, endless=True)

    @property
    def goal_distance(self) -> float:
        """Horizontal distance from the hull centre to the next lamp [m]."""
        return self._referee.goal_distance(float(self.state[0]), float(self.state[1]))

    @property
    def is_at_lamp(self) -> bool:
        """Whether the hull centre is where the next lamp counts as reached."""
        return self._referee.is_at_lamp(*map(float, self.state[:3]))

    @property
    def wind(self) -> Vector:
        """Velocity of the air at the hull, all effects included. [m/s, map]."""
        self._craft.evaluate_state()
        return _to_vector(self._craft.wind.tolist())

    @property
    def thrusts(self) -> tuple[float, ...]:
        """Present thrust of each rotor. [N]."""
        self._craft.evaluate_state()
        return tuple(self._craft.thrusts[: self._rotors].tolist())

    def effect_wrenches(self) -> dict[str, Array]:
        """Return the present wrench of each effect, body frame. [N, N m]."""
        self._craft.evaluate_state()
        return dict(zip(SIM_LAYOUT.wrench_names, self._craft.wrenches.copy(), strict=True))

    def _pose(self) -> Pose:
        """Return position [m] and quaternion."""
        return tuple(self.state[:7].tolist())

    def _enter_step(self, steps: int) -> None:
        """Set the time to a control step, and find the topics that have a message there."""
        now = steps * self._control_ns
        self.steps, self.stamp_ns, self.elapsed = steps, self._start_ns + now, now * 1e-9
        # A topic's latency shifts its grid against the control grid
        self._due = {
            name
            for name, (latency, period) in self._rhythm.items()
            if now >= latency and (now - latency) % period == 0
        }

    def sense(self) -> SensorReadings:
        """Return the sensor readings at the present control step; call it once per step."""
        readings = self.sense_motion()
        self.sense_rest(readings)
        return readings

    def sense_motion(self) -> SensorReadings:
        """Return the estimator's inputs: IMU, range and pressure."""
        readings = SensorReadings(self.stamp_ns)
        self._craft.evaluate_state()
        # A held drone does not accelerate, whatever its thrusts
        rate = STILL_DERIVATIVE if self.is_held else self._craft.rate
        readings.force, readings.rates = self._imu.read(self.state, rate, self.elapsed)
        # Later range readings are taken inside `advance`, on their own grid.
        if self.steps == 0:
            self._sense_range(self.stamp_ns)
        readings.ranges, self._ranges = self._ranges, []
        if 'pressure' in self._due:
            readings.pressure = pressure.measure_pressure(
                self.pressure_settings, self._pressure,
                self._height_and_tilt(self._imu_place)[0], self.elapsed,
                self._chance['pressure'], self._on_pressure,
            )  # fmt: skip
        return readings

    def sense_rest(self, readings: SensorReadings) -> None:
        """Add light, energy and truth, which no node answers within the step."""
        if 'photodiodes' in self._due:
            # A block is stamped with its first sample and published after its last
            begun = self.stamp_ns - self._rhythm['photodiodes'][0]
            readings.block = (
                begun,
                self._light.sample_light_block(begun, *self._shape, self._chance['photodiodes']),
            )
        if 'battery' in self._due:
            readings.illuminance, _ = self._light.panel_light(self._pose())
            readings.battery = self.supply.read_battery_meter()
            readings.panel = self.supply.read_array_meter()
        self._tracker.record_motion(
            self.stamp_ns - self._start_ns, tuple(self.state[:RIGID].tolist())
        )
        if 'ground_truth/odom' in self._due:
            readings.truth = self._tracker.report_motion(self._predict_state)

    def _height_and_tilt(self, place: Vector) -> tuple[float, float]:
        return height_and_tilt(self.state[:RIGID].tolist(), place)

    def _sense_range(self, stamp_ns: int) -> None:
        """Take a range reading."""
        height, up = self._height_and_tilt(self._range_place)
        elapsed = (stamp_ns - self._start_ns) * 1e-9
        reading = range.measure_range(
            self.range_settings, self._range, height, up,
            self._chance['range'], self._on_range, elapsed,
        )  # fmt: skip
        self._ranges.append((stamp_ns, reading))

    def command_wrench(self, commands: Callable[[float], Array]) -> None:
        """
        Let a recorded force and moment act in the next control period.

        Parameters
        ----------
        commands : callable
            Returns the wrench that was commanded at a time since the start, shape (6,) [N, N m].
            It acts after the vehicle's delay, times its gains.

        """
        # The chain of the command time shifts a time back by the delay
        sent = apply_chain(self._acting['command_time'], (self.elapsed,), self.elapsed)[0]
        wrench = tuple(commands(sent).tolist())
        self._craft.commanded_wrench[:] = apply_chain(
            self._acting['command_wrench'], wrench, self.elapsed
        )

    def advance(self, duties: Sequence[float], mass_place: Vector | None = None) -> None:
        """
        Simulate one control period.

        Parameters
        ----------
        duties : sequence of float
            Duty of each rotor, clipped to its range.
        mass_place : tuple of 3 floats, optional
            Commanded position of the moving mass; by default the last one. [m, body]

        Raises
        ------
        ValueError
            If there is not one finite duty for each rotor; the state then stays unchanged. As
            `BadInput`, if the simulation diverged in this period.

        """
        # Without supply the motors stop, whatever the command.
        if not self.supply.is_fed:
            duties = (0.0,) * self._rotors
        # Raises for invalid duties, before anything has changed
        command = self._link.pack_command(duties, mass_place)
        now, end = self.stamp_ns, self.stamp_ns + self._control_ns
        for until, obeyed in self._link.send_command(now, end, self.elapsed, command):
            self.command[:] = obeyed
            self._integrate_until(now, until)
            now = until
        rigid = self.state[:RIGID].tolist()
        pose = tuple(rigid[:7])
        if 'illuminance' in self._due:
            self.supply.set_irradiance(self._light.panel_light(pose)[1])
        if model.has_diverged(rigid):
            raise model.build_divergence_error(self.vehicle.file.name, self.elapsed)
        self._craft.evaluate_state()
        self.supply.feed_loads(self._craft.thrusts.tolist(), self._period)
        self._enter_step(self.steps + 1)
        if self.outcome is FlightOutcome.FLYING:
            self.outcome = self._referee.evaluate_outcome(pose[0], pose[1], pose[2], self.elapsed)
        self._begin_period(pose)

    def _begin_period(self, pose: Pose) -> None:
        """Update command and surroundings for the next control period."""
        self._light.record_pose(pose)
        self._around.refresh(pose, self.supply.voltage, self.elapsed)
        self._craft.surroundings[:] = self._around.numbers

    def _integrate_until(self, now: int, end: int) -> None:
        """Integrate from one time to another, with the range readings on the way [ns]."""
        period = self._range_ns
        while now < end:
            # Stop at every range reading, which may lie inside a control period.
            # Number of the next range reading on its grid
            turn = (now - self._start_ns) // period + 1
            until = min(end, self._start_ns + turn * period)
            self._integrate_for_duration(until - now)
            now = until
            if (now - self._start_ns) % period == 0:
                self._sense_range(now)

    def _integrate_for_duration(self, span_ns: int) -> None:
        """Integrate for a duration under the present command [ns]."""
        # Rounded up, so that no integration step exceeds the stable one.
        steps = -(-span_ns // model.STEP_NS)
        place = self.state[:RIGID].copy()
        self._craft.advance(span_ns * 1e-9 / steps, steps)
        if self.is_held:  # motors, gas and turbulence continue while the drone is held
            self.state[:RIGID] = place
            # No hand is that still: a height that repeats to the bit is that of a stuck tracker
            self.state[2] += HELD_TREMOR if self.steps % 2 else -HELD_TREMOR

    def _predict_state(self, span_ns: int) -> Array:
        """Return the state after a duration under the present command [ns]."""
        # The state is one array in place: integrate ahead, then restore it.
        now = self.state.copy()
        self._integrate_for_duration(span_ns)
        later = self.state.copy()
        self.state[:] = now
        return later


def _to_vector(numbers: Sequence[float]) -> Vector:
    x, y, z = numbers
    return x, y, z
