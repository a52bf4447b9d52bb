"""
The closed loop in one process, without ROS: the same cores in the same order as the graph.

As in lockstep, the estimator sees the duties of the step before, the controller a setpoint one
control period after its light block ended, and the navigator the energy of the turn before. What
the graph sends as a message goes through what the message makes of it
(`lta_control.message_rounding`), so that both fly the same flight to the last bit.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
import math
from typing import final

from lta_config.compilation.compiler import compile_functions
from lta_config.topics import TopicTable
from lta_control import message_rounding
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.estimator import MotionEstimate
from lta_control.law_autopilot import LawAutopilot
from lta_control.mission import course_step, mission_step
from lta_control.phases import Mission
from lta_control.reserve import decide_permission, FlightPermission, ReserveReport
from lta_control.sighting import build_sight, DeadReckonedMotion, LampPosition
from lta_energy.monitoring.estimate import EnergyEstimate as Known
from lta_energy.monitoring.monitor import update_estimate
from lta_energy.monitoring.power_system import PowerSystem
from lta_energy.monitoring.reading import MeterReading, TravelState
from lta_flight.flight_stack import build_autopilot, FlightStack
from lta_model.diode_ring import DiodeRing
from lta_model.vehicle import Vehicle
from lta_sim.readings import FlightOutcome, VehicleReadings
from lta_sim.world import World
from lta_vlc.beacon_request import NO_WISH
from lta_vlc.bearing import Bearing, estimate_bearing
from lta_vlc.demodulation import DemodulatedBlock, Peaks
from lta_vlc.diodes import build_diode_array
from lta_vlc.direction import Direction, DirectionFinder
from lta_vlc.direction_fit import fit_direction
from lta_vlc.lamp import estimate_lamp_position, LampEstimate
from lta_vlc.receiver import BeaconReceiver
import numpy as np
from numpy.typing import NDArray


@final
@dataclass(frozen=True, slots=True)
class LightObservation:
    """
    What one light block says.

    Parameters
    ----------
    hearing : Hearing
        What each diode sees of each beacon.
    bearing : Bearing or None
        The paper's, None where no diode is believed or the ring is evenly lit.
    direction : Direction or None
        The fit's, None where there is none.
    lamp : LampEstimate or None
        What the drone steers by: the lamp in the body frame, by the fit.

    """

    hearing: DemodulatedBlock
    bearing: Bearing | None
    direction: Direction | None
    lamp: LampEstimate | None

    @property
    def peaks(self) -> Peaks:
        """What the diodes see of the lamp that is wanted."""
        return self.hearing.peaks[0]


@final
@dataclass(frozen=True, slots=True)
class EnergyObservation:
    """What the meters have said, and what is known since."""

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
    policy : Policy
        What the drone decides by.
    known : Vehicle or None
        The vehicle as the drone knows it; by default the true one in standard air, as the nodes
        read it from its file.

    Attributes
    ----------
    readings, estimate, duties : Readings, Estimate, tuple of float
        What was sensed, believed and done at the newest step.
    light, asked : Light, Setpoint
        What the newest light block said, and what the navigator made of it; None before it.
    setpoint : Setpoint or None
        What the controller acts on.
    beacon : float
        Frequency that the navigator wants heard next; 0 for the demodulator's own. [Hz]
    energy : Energy or None
        The newest turn of the meters.

    """

    def __init__(
        self,
        world: World,
        table: TopicTable,
        policy: FlightStack,
        nominal_vehicle: Vehicle | None = None,
    ) -> None:
        self.world = world
        self.policy = policy
        self._table = table
        self._plan = world.scenario.course
        self._reversible = world.vehicle.reversible
        self._block = table['photodiodes'].period_ns * 1e-9
        self._half_block = table['photodiodes'].period_ns // table.control_ns // 2
        vehicle = nominal_vehicle or Vehicle(world.vehicle.file)
        dt = table.control_ns * 1e-9
        self.autopilot = build_autopilot(policy, vehicle, dt)
        self._aboard = PowerSystem.from_entry(vehicle.file.energy)
        diodes = build_diode_array(vehicle.file.sensors.diodes)
        self._ring = diodes.ring
        self._finder = DirectionFinder(diodes, compile_functions(fit_direction)[0], np.array)
        self._axes = round_axes(self._ring)
        self._listener = BeaconReceiver(
            policy.demodulation,
            table.light.sample_rate.si,
            table.light.samples,
            vehicle.file.sensors.diodes.largest_reading,
        )
        ranger = world.range_settings
        self._reach = (
            message_rounding.round_to_float32(ranger.minimum),
            message_rounding.round_to_float32(ranger.maximum),
        )
        self.readings = VehicleReadings(world.stamp_ns)
        self.duties = self.autopilot.duties
        self.light: LightObservation | None = None
        self.asked: Setpoint | None = None
        self.setpoint: Setpoint | None = None
        self.beacon = NO_WISH
        self.energy: EnergyObservation | None = None
        self.mission = Mission()
        self._reckoned: deque[DeadReckonedMotion] = deque(maxlen=self._half_block + 1)

    @property
    def estimate(self) -> MotionEstimate:
        """What the drone believes at the newest step."""
        return self.autopilot.estimate

    def step(self) -> FlightOutcome:
        """Sense, decide and fly one control period; return how the flight stands."""
        self.decide()
        self.apply_command()
        return self.world.outcome

    def iterate_steps(self) -> Iterator[FlightOutcome]:
        """Fly to where the graph would end; each step is yielded decided, before it is flown."""
        while True:
            self.decide()
            yield self.world.outcome
            over = self.world.outcome is not FlightOutcome.FLYING
            if over and self._table.is_settled(self.world.stamp_ns):
                return
            self.apply_command()

    def apply_command(self) -> None:
        """Fly one control period by the newest command."""
        pilot = self.autopilot
        place = pilot.command.mass_place if isinstance(pilot, LawAutopilot) else None
        self.world.advance(self.duties, place)

    def decide(self) -> None:
        """Sense and decide, without flying on."""
        readings = self.readings = self.world.sense()
        course = self.policy.course
        if course is not None:
            self.asked = self.setpoint = asked = course(self.world.elapsed)
            self.autopilot.set_setpoint(asked)
        elif self.asked is not self.setpoint and self.asked is not None:
            self.setpoint = asked = self.asked
            level = message_rounding.level_quaternion(asked.heading)
            self.autopilot.set_setpoint(
                message_rounding.build_setpoint(asked.altitude, level, asked.speed)
            )
        self._estimate_and_control(readings)
        if readings.block is not None and course is None:
            self._navigate(*readings.block)
        if readings.battery is not None:
            self._update_energy(readings)

    def _estimate_and_control(self, readings: VehicleReadings) -> None:
        """Estimate and control."""
        if isinstance(self.autopilot, LawAutopilot) and readings.truth is not None:
            self.autopilot.receive_tracking(readings.truth)
        self.duties = self.autopilot.step(
            readings.rates,
            readings.force,
            self._newest_range(readings),
            math.nan if readings.pressure is None else readings.pressure,
        )
        if self._plan is not None:
            self.duties = self._plan.excite_duties(
                self.world.elapsed, self.duties, self._reversible
            )
            self.autopilot.override_duties(self.duties)
        self._reckoned.append(self.autopilot.dead_reckoning)

    def _newest_range(self, readings: VehicleReadings) -> float:
        """Return the newest range as its message carries it, NaN where there is none. [m]"""
        if not readings.ranges:
            return math.nan
        return message_rounding.mask_out_of_range(
            message_rounding.round_to_float32(readings.ranges[-1][1]), *self._reach
        )

    def measured_state(self) -> CascadeMeasurement | None:
        """Return what the controller acts on; None while the estimator is learning."""
        return self.autopilot.measurement

    def _navigate(self, stamp_ns: int, block: NDArray[np.uint16]) -> None:
        """Look at the light, and steer by it or by the scenario's course."""
        self._listener.prioritize_beacon(self.beacon)
        hearing = self._listener.demodulate(block)
        peaks = hearing.peaks[0]
        threshold, prior = self.policy.demodulation.threshold, self.policy.prior
        found = self._finder.find(peaks, threshold, prior)
        where = None if found is None else estimate_lamp_position(found, prior)
        self.light = LightObservation(
            hearing, estimate_bearing(peaks, self._ring, threshold), found, where
        )
        amplitudes = tuple(peaks.amplitude.astype(np.float32).tolist())
        lamp = None if where is None else convert_lamp(where)
        scale = self.world.diode_scale
        sight = build_sight(lamp, self._axes, amplitudes, self._reckoned[0], self._block, scale)
        measured, energy = self.measured_state(), self.energy
        altitude = math.nan if measured is None or energy is None else measured.altitude
        order = self._reserve_order(stamp_ns)
        if self._plan is not None:
            time = (stamp_ns - self._table.start_ns) * 1e-9
            self.asked = course_step(self._plan, time, sight.heading, altitude, order)
            return
        policy, route = self.policy, self.world.scenario.route_beacons
        self.asked, self.mission = mission_step(
            policy.mission, policy.strategy, self.mission, sight, altitude, order,
            max(len(route), 1), policy.reserve.rule,
        )  # fmt: skip
        self.beacon = route[self.mission.asked][1] if route else NO_WISH

    def _reserve_order(self, stamp_ns: int) -> FlightPermission:
        """Return what the energy of the turn before allows, as the navigator takes it."""
        if self.energy is None:
            return FlightPermission.DOWN
        estimate = self.energy.estimate
        word = ReserveReport(stamp_ns, estimate.reserve, estimate.is_urgent)
        return decide_permission(self.policy.reserve, word, stamp_ns)

    def _whereabouts(self) -> TravelState | None:
        """Return distance from the start and speed as odom carries them; None while learning."""
        if self.measured_state() is None:
            return None
        reckoned = self._reckoned[-1]
        return TravelState(
            math.hypot(reckoned.x, reckoned.y), math.hypot(reckoned.forward, reckoned.left)
        )

    def _update_energy(self, readings: VehicleReadings) -> None:
        """Keep the energy books of one turn of the meters."""
        nothing = math.nan, math.nan
        voltage, current = map(message_rounding.round_to_float32, readings.battery or nothing)
        panel_voltage, panel_current = map(
            message_rounding.round_to_float32, readings.panel or nothing
        )
        lux = readings.illuminance
        reading = MeterReading(
            stamp_ns=readings.stamp_ns,
            voltage=voltage,
            current=current,
            panel_voltage=panel_voltage,
            panel_current=panel_current,
            illuminance=math.nan if lux is None else lux,
            where=self._whereabouts(),
        )
        before = Known() if self.energy is None else self.energy.estimate
        self.energy = EnergyObservation(
            reading, update_estimate(self.policy.energy, self._aboard, before, reading)
        )


def convert_lamp(lamp: LampEstimate) -> LampPosition:
    """Return a lamp as its message carries it."""
    return LampPosition(lamp.x, lamp.y, lamp.z, (lamp.xx, lamp.xy, lamp.yy))


def round_axes(ring: DiodeRing) -> tuple[tuple[float, float], ...]:
    """Return the axes of diodes as their message carries them."""
    rows = np.array([ring.cosines, ring.sines], dtype=np.float32).T
    return tuple((x, y) for x, y in rows.tolist())
