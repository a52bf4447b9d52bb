# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate a flight in one process without ROS, with the same cores in the same order as the graph.

As in lockstep, the estimator gets the duties of the last step, the controller a setpoint one
control period after its light block has ended, and the navigator the previous energy estimate.
Values that the graph sends as messages are rounded as the messages would: a heading is sent as a
quaternion, a range in 32 bits. The last bits would grow to millimetres by contact with the floor.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.topics import TopicTable
from lta_control.estimator import is_plausible_imu_sample, mask_out_of_range, MotionEstimate
from lta_control.guidance import Guidance, GuidanceInputs, ReserveReport
from lta_control.mission import Mission
from lta_control.motion import (
    CascadeMeasurement,
    DeadReckonedMotion,
    level_quaternion,
    Setpoint,
    yaw_from_quaternion,
)
from lta_control.odometry.ground_motion import ground_step
from lta_control.odometry.ground_state import GroundMotion
from lta_control.sighting import build_sight, build_sighting, LampPosition, LampSighting
from lta_control.vehicle_parameters import build_estimator_model
from lta_energy.monitoring.meters import MeterReading, PowerSystem, TravelState
from lta_energy.monitoring.monitor import EnergyEstimate as Known
from lta_energy.monitoring.monitor import update_estimate
from lta_flight.flight_stack import build_autopilot, FlightStack
from lta_model.sensors.photodiode import DiodeRing
from lta_model.vehicle import Vehicle
from lta_sim.readings import FlightOutcome, SensorReadings
from lta_sim.world import World
from lta_vlc.demodulation import DemodulatedBlock, Peaks
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import (
    Bearing,
    Direction,
    LampEstimate,
    LampFinder,
)
from lta_vlc.receiver import BeaconReceiver
import numpy as np
from numpy.typing import NDArray


@final
@dataclass(frozen=True, slots=True)
class LightObservation:
    """The results of one light block."""

    hearing: DemodulatedBlock  # amplitude and SNR of each beacon at each diode
    # The paper's estimate; None if no diode exceeds the threshold or the ring is evenly lit
    bearing: Bearing | None
    direction: Direction | None  # the fitted direction, if there is one
    # The lamp's position in the body frame by the fit, which the drone steers by
    lamp: LampEstimate | None

    @property
    def peaks(self) -> Peaks:
        """Return the peaks of the wanted lamp."""
        return self.hearing.peaks[0]


@final
@dataclass(frozen=True, slots=True)
class EnergyObservation:
    """The newest readings of the meters, and the estimate after them."""

    reading: MeterReading
    estimate: Known


@final
class ClosedLoop:
    """
    One flight, step by step.

    Parameters
    ----------
    world : World
        The drone and its scene.
    table : TopicTable
        Periods and block shape.
    policy : FlightStack
        Settings and algorithms of the drone.
    nominal_vehicle : Vehicle or None
        The vehicle as the drone knows it; by default from the true vehicle's file in standard air,
        as in the nodes.
    motion_only : bool
        Whether to read the estimator's sensors only, which is faster and enough for the cascade
        on a prescribed course.

    Attributes
    ----------
    nominal_vehicle : Vehicle
        The vehicle as the drone knows it.
    table : TopicTable
        Periods and first stamp.
    readings, estimate, duties : SensorReadings, MotionEstimate, tuple of float
        Sensor readings, estimate and duties of the newest step.
    ground : GroundMotion
        The motion over ground of the newest step; not with `motion_only`.
    light, next_setpoint : LightObservation, Setpoint
        The newest light block, and the navigator's setpoint after it; None before the first one.
    setpoint : Setpoint or None
        The setpoint of the controller.
    energy : EnergyObservation or None
        The newest energy update.

    """

    def __init__(
        self,
        world: World,
        table: TopicTable,
        policy: FlightStack,
        nominal_vehicle: Vehicle | None = None,
        motion_only: bool = False,
    ) -> None:
        self.world = world
        self._motion_only = motion_only
        self.policy = policy
        self.table = table
        self._plan = world.scenario.course
        self._guidance = Guidance(self._plan, world.scenario.route_beacons)
        self._reversible = world.vehicle.reversible
        self._block = table['photodiodes'].period_ns * 1e-9
        # Control steps in half a light block: bearings belong to the middle of their block
        self._half_block = table['photodiodes'].period_ns // table.control_ns // 2
        # Without the scene's air density, which the drone does not know
        vehicle = self.nominal_vehicle = nominal_vehicle or Vehicle(world.vehicle.file)
        dt = table.control_ns * 1e-9
        self.autopilot = build_autopilot(policy, vehicle, dt)
        self._is_tracked = policy.law.is_tracked
        self.ground = GroundMotion()
        self._hull, self._dt = build_estimator_model(vehicle).hull, dt
        self._sighting: LampSighting | None = None  # for the next step, as its messages would
        self._aboard = PowerSystem.from_entry(vehicle.file.energy)
        diodes = build_diode_array(vehicle.file.sensors.diodes)
        self._finder = LampFinder(diodes)
        self._axes = round_axes(diodes.ring)
        self._listener = BeaconReceiver(
            policy.demodulation,
            table.light.sample_rate.si,
            table.light.samples,
            vehicle.file.sensors.diodes.largest_reading,
        )
        self._reach = world.range_settings.minimum, world.range_settings.maximum
        self.readings = SensorReadings(world.stamp_ns)
        self.duties = self.autopilot.duties
        self.light: LightObservation | None = None
        self.next_setpoint: Setpoint | None = None
        self.setpoint: Setpoint | None = None
        self.energy: EnergyObservation | None = None
        # [0] is the dead-reckoned motion half a block ago, [-1] the newest
        self._reckoned: deque[DeadReckonedMotion] = deque(maxlen=self._half_block + 1)

    @property
    def mission(self) -> Mission:
        """Return the state of the mission."""
        return self._guidance.mission

    @property
    def beacon(self) -> float:
        """Frequency that the navigator requests next; 0 for the demodulator's own [Hz]."""
        return self._guidance.beacon

    @property
    def estimate(self) -> MotionEstimate:
        """Return the motion estimate of the newest step."""
        return self.autopilot.estimate

    def step(self) -> FlightOutcome:
        """Sense, decide and fly one control period; return the state of the flight."""
        self.decide()
        self.simulate_control_period()
        return self.world.outcome

    def iterate_steps(self) -> Iterator[FlightOutcome]:
        """Fly to where the graph would end; yield after each decision, before it is flown."""
        while True:
            self.decide()
            yield self.world.outcome
            over = self.world.outcome is not FlightOutcome.FLYING
            # The graph also completes the last light block before it stops
            if over and self.table.is_settled(self.world.stamp_ns):
                return
            self.simulate_control_period()

    def iterate_until(self, is_over: Callable[[], bool]) -> Iterator[None]:
        """Fly until a condition holds; yield after each decision, before it is flown."""
        while not is_over():
            self.decide()
            yield
            self.simulate_control_period()

    def simulate_control_period(self) -> None:
        """Simulate one control period with the newest command."""
        pilot, commands = self.autopilot, self.policy.commands
        place = pilot.mass_place
        if commands is not None:
            place = commands.find_mass_place(self.world.elapsed)
            if commands.wrenches is not None:
                self.world.command_wrench(commands.find_wrench)
        self.world.advance(self.duties, place)

    def decide(self) -> None:
        """Sense and decide, without advancing the simulation."""
        world = self.world
        readings = self.readings = world.sense_motion() if self._motion_only else world.sense()
        course = self.policy.course
        if course is not None:
            self.next_setpoint = self.setpoint = setpoint = course(world.elapsed)
            if setpoint is not None:
                self.autopilot.set_setpoint(setpoint)
        # A new setpoint takes effect one step later, as its message would
        elif self.next_setpoint is not self.setpoint and self.next_setpoint is not None:
            self.setpoint = self.next_setpoint
            self.autopilot.set_setpoint(round_heading(self.next_setpoint))
        self._estimate_and_control(readings)
        if self._motion_only:
            return
        self._estimate_ground_motion(readings)
        self._reckoned.append(self.autopilot.dead_reckoning)
        if readings.block is not None and course is None:
            self._navigate(*readings.block)
        if readings.battery is not None:
            self._update_energy(readings)

    def _estimate_and_control(self, readings: SensorReadings) -> None:
        """Run the estimator and the controller, and add the excitation of a course."""
        if self._is_tracked and readings.truth is not None:
            self.autopilot.receive_tracking(readings.truth)
        self.duties = self.autopilot.step(
            readings.rates,
            readings.force,
            newest_range(readings.ranges, self._reach),
            math.nan if readings.pressure is None else readings.pressure,
        )
        if self._plan is not None:
            self.duties = self._plan.excite_duties(
                self.world.elapsed, self.duties, self._reversible
            )
        if self.policy.commands is not None:
            self.duties = self.policy.commands.find_duties(self.world.elapsed)
        if self._plan is not None or self.policy.commands is not None:
            # The estimator must know the duties that act, not those commanded
            self.autopilot.record_applied_duties(self.duties)

    def _estimate_ground_motion(self, readings: SensorReadings) -> None:
        """Run the filter of the motion over ground, which the flight does not depend on."""
        if is_plausible_imu_sample(readings.rates, readings.force):
            self.ground = ground_step(
                self.policy.estimator.ground,
                self._hull,
                self.ground,
                self.autopilot.modelled_motion,
                self._sighting,
                self._dt,
            )
        self._sighting = None

    def measured_state(self) -> CascadeMeasurement | None:
        """Return the state that the controller uses; None until the estimator is ready."""
        return self.autopilot.measurement

    def _navigate(self, stamp_ns: int, block: NDArray[np.uint16]) -> None:
        """Process a light block, and update the setpoint by strategy or course."""
        self._listener.prioritize_beacon(self.beacon)
        hearing = self._listener.demodulate_next_block(block)
        peaks, threshold = hearing.peaks[0], self.policy.demodulation.threshold
        detection = self._finder.find_lamp(peaks, threshold, self.policy.prior)
        self.light = LightObservation(hearing, *detection)
        # Message fields of type float32
        amplitudes = tuple(peaks.amplitude.astype(np.float32).tolist())
        lamp = None if detection.lamp is None else to_lamp_position(detection.lamp)
        frequencies = tuple(peaks.frequency.astype(np.float32).tolist())
        middle_ns = stamp_ns + self.table['photodiodes'].period_ns // 2
        # The estimator gets the block one control period after its end
        age = (self.world.stamp_ns + self.table.control_ns - middle_ns) * 1e-9
        self._sighting = build_sighting(lamp, self._axes, amplitudes, frequencies, age)
        scale = self.world.vehicle.diodes.gain_scale
        sight = build_sight(lamp, self._axes, amplitudes, self._reckoned[0], self._block, scale)
        policy, report = self.policy, None
        if self.energy is not None:
            estimate = self.energy.estimate
            report = ReserveReport(stamp_ns, estimate.reserve, estimate.is_landing_urgent)
        self.next_setpoint = self._guidance.choose_setpoint(
            GuidanceInputs(
                policy.mission, policy.reserve, policy.strategy, stamp_ns, sight,
                self.measured_state(), report,
            )
        )  # fmt: skip

    def _travel_state(self) -> TravelState | None:
        """Return distance from the start over ground, and airspeed; None without an estimate."""
        if self.measured_state() is None:
            return None
        reckoned = self._reckoned[-1]
        return TravelState(
            math.hypot(*self.ground.position), math.hypot(reckoned.forward, reckoned.left)
        )

    def _update_energy(self, readings: SensorReadings) -> None:
        """Update the energy estimate with one set of meter readings."""
        # Missing readings are NaN, as in the messages
        nothing = math.nan, math.nan
        voltage, current = map(round_to_float32, readings.battery or nothing)
        panel_voltage, panel_current = map(round_to_float32, readings.panel or nothing)
        lux = readings.illuminance
        reading = MeterReading(
            stamp_ns=readings.stamp_ns,
            voltage=voltage,
            current=current,
            panel_voltage=panel_voltage,
            panel_current=panel_current,
            illuminance=math.nan if lux is None else lux,
            where=self._travel_state(),
        )
        before = Known() if self.energy is None else self.energy.estimate
        self.energy = EnergyObservation(
            reading, update_estimate(self.policy.energy, self._aboard, before, reading)
        )


def round_to_float32(value: float) -> float:
    """Return a number rounded to a float32 field."""
    return float(np.float32(value))


def newest_range(ranges: Sequence[tuple[int, float]], reach: tuple[float, float]) -> float:
    """
    Return the newest range as in its message, or NaN if there is none [m].

    `ranges` holds stamps [ns] and distances, `reach` the limits of the sensor.
    """
    if not ranges:
        return math.nan
    # A Range message holds distance and limits in single precision
    nearest, farthest = map(round_to_float32, reach)
    return mask_out_of_range(round_to_float32(ranges[-1][1]), nearest, farthest)


def round_heading(setpoint: Setpoint) -> Setpoint:
    """Return a setpoint whose heading has been a quaternion."""
    return setpoint._replace(heading=yaw_from_quaternion(level_quaternion(setpoint.heading)))


def to_lamp_position(lamp: LampEstimate) -> LampPosition:
    """Return a lamp estimate with the fields of its message."""
    return LampPosition(lamp.x, lamp.y, lamp.z, (lamp.xx, lamp.xy, lamp.yy))


def round_axes(ring: DiodeRing) -> tuple[tuple[float, float], ...]:
    """Return diode axes rounded to single precision as in their message."""
    rows = np.array([ring.cosines, ring.sines], dtype=np.float32).T
    return tuple((x, y) for x, y in rows.tolist())
