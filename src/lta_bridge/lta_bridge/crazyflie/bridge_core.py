# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Core of the Crazyflie bridge, without ROS and cflib: convert packets to readings, send commands.

Two threads use it, one for the link's packets and one for the ticks; a lock protects the state.
"""

import math
import threading
from typing import Final, final, NamedTuple

from lta_bridge.crazyflie import duties_packet, readings, safety
from lta_bridge.crazyflie.buoyancy import BuoyancyMonitor, REST_DUTY
from lta_bridge.crazyflie.device_clock import DeviceClock, RoundTrips
from lta_bridge.crazyflie.duties_packet import find_rotor_indices
from lta_bridge.crazyflie.link import CrazyflieLink, LogPacket
from lta_bridge.crazyflie.safety import SafetyStage
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.schema.crazyflie_file import CrazyflieFile
from lta_control.estimator import (
    HeightSensors,
    is_stuck,
    SensorWatch,
    watch_height_sensors,
    watch_sensor,
)
from lta_control.flight_step import LandingWatch, watch_landing
from lta_graph.health import RejectionCount, stamp_age
from lta_model.vehicle import Vehicle

TICK_RATE: Final = 50.0  # Hz, tick rate; the firmware needs setpoints at 10 Hz or more
GUARD: Final = 7  # ticks between two messages to the emergency-stop watchdog: 7 Hz
HOLD_MS: Final = 200  # ms; the drone stops its motors without newer duties after this time
TURN_GAIN: Final = 1.5  # 1/s from heading error to yaw rate: time constant of about 0.7 s
SETPOINT_YAW_RATE: Final = 1.0  # rad/s
FASTEST_SETPOINT: Final = 2.0  # m/s; a stick gives no more
UNTOLD: Final = 2.0  # s; an older voltage counts as unknown
POWER_OFF: Final = 3  # pm.state of the firmware from which on the cell is low


class CrazyflieCommand(NamedTuple):
    """
    A command of the graph: duties by rotor, or speed [m/s], turn [rad] and height [m].

    `turn` is the heading error: the desired minus the present heading, positive to the left.
    """

    stamp_ns: int
    duties: tuple[float, ...] = ()
    speed: float = 0.0
    turn: float = 0.0
    height: float = 0.0


class PositionEstimate(NamedTuple):
    """Height and distance from the start by the estimator [m], with their graph time."""

    height: float = math.nan
    distance: float = math.nan
    stamp_ns: int | None = None  # None before the first estimate


class StampedReading(NamedTuple):
    """A reading with its graph time [ns]."""

    stamp_ns: int
    reading: (
        readings.ImuReading
        | readings.AirReading
        | readings.MotorsReading
        | readings.PowerReading
        | None
    )


@final
class BridgeCore:
    """
    Bridge between one Crazyflie and the graph.

    Parameters
    ----------
    link : CrazyflieLink
        Link to send commands over.
    file : CrazyflieFile
        Command mode, wiring and limits.
    vehicle : Vehicle
        Its rotors are in the order of duties in a command.
    command : str
        'setpoint' or 'motors'; empty for the mode of the file.
    watchdog : bool
        Whether to start the firmware's emergency-stop watchdog with the first arming. It stops
        the motors and locks the drone 1 s after the last message; only a restart unlocks it.
    blind : bool
        Whether it may fly without a position estimate.

    Attributes
    ----------
    attitude : tuple or None
        The firmware's attitude quaternion, x y z w; None before the first packet.
    power, motors : PowerReading, MotorsReading or None
        The newest readings.
    buoyancy : BuoyancyMonitor
        Whether the drone is lighter than air.
    wanted_height : float
        Height of the newest setpoint, which says whether the drone is to land. [m]
    rivals : str
        Who else publishes commands to fly, in words; empty if nobody.
    malformed, unasked : RejectionCount
        Unreadable packets and invalid commands.

    """

    def __init__(
        self,
        link: CrazyflieLink,
        file: CrazyflieFile,
        vehicle: Vehicle,
        command: str = '',
        watchdog: bool = False,
        blind: bool = False,
    ) -> None:
        # The lock guards state that both the tick and the thread of arriving packets use
        self._link, self._lock = link, threading.Lock()
        self.command = command or file.command
        self._order = find_rotor_indices(file.motors, vehicle.rotor_names)
        self._rotors = len(vehicle.rotor_names)
        limit = file.limits
        self.limits = safety.SafetyLimits(
            limit.voltage.si, limit.time.si, limit.height.si, limit.distance.si
        )
        self.clock = DeviceClock()
        self.state = safety.SafetyState()
        self.attitude: tuple[float, float, float, float] | None = None
        self.power: readings.PowerReading | None = None
        self.motors: readings.MotorsReading | None = None
        self.trips = RoundTrips()
        self.malformed, self.unasked = RejectionCount(), RejectionCount()
        self._word_ns: int | None = None
        self._power_ns: int | None = None
        self._command: CrazyflieCommand | None = None
        self._estimated = self._tracked = PositionEstimate()
        self._estimated_height = self._tracked_height = SensorWatch()
        self._air: readings.AirReading | None = None
        self._sensors = HeightSensors()
        self._blind = blind
        # Of the axes of M1 to M4; 1 is upwards
        rotors = vehicle.file.rotors
        self._vertical = [rotors[name].axis.vector[2] for name in file.motors.values()]
        self.buoyancy = BuoyancyMonitor()
        self.wanted_height = math.inf
        self.rivals = ''
        self._floor = vehicle.hull_height_on_floor
        self._landing, self._ticked = LandingWatch(), math.inf
        self._sequence = 0
        self.packets = 0
        self._watchdog, self._guarded, self._ticks = watchdog, False, 0
        self._has_flown = False  # whether this drone has flown
        self._rose = False  # whether a setpoint above the floor was sent since arming
        self._graph_ns, self._graph_at = -1, -math.inf  # graph time, and when it changed last [s]

    @property
    def sends_duties(self) -> bool:
        """Whether the bridge sends motor duties rather than setpoints."""
        return self.command == 'motors'

    @property
    def is_busy(self) -> bool:
        """Whether motors may turn, or emergency stops are still to be sent."""
        return (
            self.state.stage not in (SafetyStage.DISARMED, SafetyStage.STOPPED)
            or self.state.stops > 0
        )

    @property
    def is_armed(self) -> bool:
        """Whether the drone reports that it was armed, not counting automatic arming."""
        word = 0 if self.motors is None else self.motors.word
        return bool(word & SupervisorBit.ARMED) and not word & SupervisorBit.AUTO_ARM

    def clear_connection_data(self) -> None:
        """Discard everything that came over the previous connection."""
        with self._lock:
            self.clock, self.trips = DeviceClock(), RoundTrips()
            self.attitude, self.power, self.motors, self._word_ns = None, None, None, None
            self._command = self._air = None

    def add_round_trip(self, round_trip: float) -> None:
        """Add a ping's round trip [s]; half of the shortest one corrects the packets' stamps."""
        with self._lock:
            self.trips.add(round_trip)
            self.clock.line.one_way_ns = self.trips.one_way_ns

    def receive_packet(self, packet: LogPacket) -> StampedReading:
        """Convert a log packet to a reading with its graph time."""
        with self._lock:
            self.packets += 1
            stamp = self.clock.compute_packet_time(packet.stamp_ms, packet.arrival_ns)
            values = packet.values
            if why := readings.find_value_fault(packet.block, values):
                self.malformed.add(why)
                return StampedReading(stamp, None)
            match packet.block:
                case 'imu':
                    return StampedReading(stamp, readings.convert_imu(values))
                case 'air':
                    self._air = readings.convert_air(values)
                    return StampedReading(stamp, self._air)
                case 'attitude':
                    self.attitude = readings.convert_attitude(values)
                case 'motors':
                    self.motors = readings.convert_motors(values)
                    # Arrival, not stamp: silence is judged without trusting the drone's clock
                    self._word_ns = packet.arrival_ns
                    return StampedReading(stamp, self.motors)
                case 'power':
                    self.power, self._power_ns = readings.convert_power(values), packet.arrival_ns
                    return StampedReading(stamp, self.power)
            return StampedReading(stamp, None)

    def accept_command(self, command: CrazyflieCommand) -> None:
        """Store a command of the graph; reject non-finite values and a wrong rotor count."""
        numbers = (*command.duties, command.speed, command.turn, command.height)
        if self.sends_duties and len(command.duties) != self._rotors:
            self.unasked.add(f'{len(command.duties)} motor duties for {self._rotors} rotors')
        elif not all(map(math.isfinite, numbers)):
            self.unasked.add('a command with a value that is not a finite number')
        else:
            self._command = command

    def update_position(self, where: PositionEstimate) -> None:
        """Store the newest estimate of the estimator."""
        self._estimated = where

    def update_tracked_position(self, where: PositionEstimate) -> None:
        """Store the newest position of an external tracker."""
        self._tracked = where

    def _find_position(self, now_ns: int) -> tuple[PositionEstimate, float]:
        """Return the position to keep the limits by, and its age [s]."""
        estimate_is_stuck = is_stuck(self._estimated_height) or bool(self.find_stuck_sensor())
        both = [
            (where._replace(height=math.nan if stuck else where.height), age)
            for where, stuck in (
                (self._estimated, estimate_is_stuck),
                (self._tracked, is_stuck(self._tracked_height)),
            )
            for age in [stamp_age(where.stamp_ns, now_ns)]
        ]
        # Of two that are known, the one that is farther up or away decides
        recent = [
            where
            for where, age in both
            if age <= safety.LOST_POSITION and not math.isnan(where.height)
        ]
        if len(recent) == len(both):
            height = max(where.height for where in recent)
            distance = max(where.distance for where in recent)
            return PositionEstimate(height, distance), max(age for _, age in both)
        return min(both, key=lambda one: (math.isnan(one[0].height), one[1]))

    def find_stuck_sensor(self) -> str:
        """
        Return which sensor of the height repeats its reading; empty if none does.

        With duties our estimator finds this by the duties, and flies by the other sensor. With
        setpoints it sees none, and the firmware's own estimator does not look.
        """
        if self.sends_duties or self._air is None:
            return ''
        # Out of reach of the floor a range finder gives no reading, and is not used
        if is_stuck(self._sensors.range) and math.isfinite(self._air.distance):
            return 'range finder'
        return 'barometer' if is_stuck(self._sensors.pressure) else ''

    def collect_safety_inputs(
        self, now_ns: int, linked: bool, active: bool
    ) -> safety.SafetyInputs:
        """Return the inputs of the safety state machine at a graph time [ns]."""
        command, motors = self._command, self.motors
        where, age = self._find_position(now_ns)
        since = None if command is None else command.stamp_ns
        return safety.SafetyInputs(
            linked=linked,
            active=active,
            word=0 if motors is None else motors.word,
            silence=stamp_age(self._word_ns, now_ns),
            command_age=stamp_age(since, now_ns),
            voltage=self._safety_voltage(now_ns),
            height=where.height,
            distance=where.distance,
            place_age=age,
            blind=self._blind,
            rivals=self.rivals,
        )

    def _safety_voltage(self, now_ns: int) -> float:
        """Return the cell voltage: 0 if the firmware calls it low, NaN if unknown [V]."""
        if self.power is None or stamp_age(self._power_ns, now_ns) > UNTOLD:
            return math.nan
        # 0 V is below every limit, so the drone lands
        return 0.0 if self.power.state >= POWER_OFF else self.power.voltage

    def tick(
        self, now: float, now_ns: int, linked: bool, active: bool, request: safety.SafetyRequest
    ) -> safety.SafetyOutputs:
        """
        Step the safety state machine and send its outputs.

        Parameters
        ----------
        now : float
            Monotonic time. [s]
        now_ns : int
            Graph time. [ns]
        linked, active : bool
            Whether the link is up and the node active.
        request : safety.SafetyRequest
            The operator's requests since the last tick.

        """
        with self._lock:
            inputs = self.collect_safety_inputs(now_ns, linked, active)
            if now_ns != self._graph_ns:
                self._graph_ns, self._graph_at = now_ns, now
            elif now - self._graph_at > safety.STALE:
                # Nothing ages where graph time stands still: the clock of a simulation, stopped
                inputs = inputs._replace(command_age=math.inf)
            passed, self._ticked = max(now - self._ticked, 0.0), now
            turning = max(self._read_motor_duties(inputs), default=0.0) > REST_DUTY
            self._estimated_height, self._tracked_height = (
                watch_sensor(seen, where.height, turning, passed)
                for seen, where in (
                    (self._estimated_height, self._estimated),
                    (self._tracked_height, self._tracked),
                )
            )
            if self._air is not None:
                distance, pressure = self._air.distance, self._air.pressure
                self._sensors = watch_height_sensors(
                    self._sensors, distance, pressure, turning, passed
                )
            inputs = inputs._replace(grounded=self._watch_landing(turning, passed, inputs))
            self.state, order = safety.step_state(self.state, now, inputs, request, self.limits)
            self._send_outputs(order)
            self._watch_buoyancy(now, inputs)
            return order

    def _watch_landing(self, turning: bool, passed: float, inputs: safety.SafetyInputs) -> float:
        """Return for how long motors have turned to land without the drone sinking [s]."""
        lands = turning and self.wanted_height <= self._floor
        height = inputs.height if inputs.place_age <= safety.LOST_POSITION else math.nan
        self._landing = watch_landing(self._landing, height, lands, passed)
        return self._landing.still

    def _read_motor_duties(self, inputs: safety.SafetyInputs) -> tuple[float, ...]:
        """Return the newest duties of M1 to M4; empty if they are not known."""
        is_fresh = self.motors is not None and inputs.silence <= safety.SILENT_LINK
        return self.motors.duties if self.motors is not None and is_fresh else ()

    def _watch_buoyancy(self, now: float, inputs: safety.SafetyInputs) -> None:
        # A person may lift a drone that has not flown
        if not self._has_flown:
            self._has_flown = self.state.stage is SafetyStage.FLYING
            return
        # A tilted rotor lifts by the vertical share of its thrust
        shares = [
            duty * up
            for duty, up in zip(self._read_motor_duties(inputs), self._vertical, strict=False)
        ]
        lifting = max(0.0, *shares) if shares else math.nan
        pressing = max(0.0, *(-share for share in shares)) if shares else math.nan
        height = inputs.height if inputs.place_age <= safety.LOST_POSITION else math.nan
        self.buoyancy.observe(now, height, lifting, pressing)

    def find_arming_refusal(self, now_ns: int, linked: bool, active: bool) -> str:
        """Return why arming would be refused now; empty if it would be accepted."""
        return safety.find_arming_refusal(
            self.state, self.collect_safety_inputs(now_ns, linked, active), self.limits
        )

    def _send_outputs(self, order: safety.SafetyOutputs) -> None:
        if order.stop:
            self._link.send_emergency_stop()
        if order.arm is not None:
            self._rose = False
        # Once fed, the firmware's watchdog must be fed for good, or it stops the motors
        self._guarded |= self._watchdog and bool(order.arm)
        self._ticks += 1
        stopped = self.state.stage is SafetyStage.STOPPED
        # After an emergency stop the watchdog is left to expire: it locks the drone as well.
        if self._guarded and not stopped and self._ticks % GUARD == 0:
            self._link.feed_watchdog()
        if order.arm is not None:
            self._link.request_arming(order.arm)
        if self.sends_duties:
            self._send_duties(order)
        elif order.drive and self._command is not None and self._may_rise(self._command):
            command = self._command
            rate = max(-SETPOINT_YAW_RATE, min(SETPOINT_YAW_RATE, TURN_GAIN * command.turn))
            self._link.send_hover_setpoint(
                # The ramp of a landing scales speed and turn; the height stays until the hand-over
                order.drive * max(-FASTEST_SETPOINT, min(FASTEST_SETPOINT, command.speed)),
                order.drive * rate,
                max(0.0, min(self.limits.height, command.height)),
            )
        if order.hand_over:
            # A drone that has not risen must not start its motors in order to land
            self._link.hand_over(land=self.command == 'setpoint' and self._rose)

    def _may_rise(self, command: CrazyflieCommand) -> bool:
        """Return whether a setpoint has been above the floor since arming, as for a take-off."""
        # Otherwise the firmware's controller would start the motors of a drone that is to rest
        self._rose = self._rose or command.height > self._floor
        return self._rose

    def _motor_duties(self, order: safety.SafetyOutputs) -> tuple[float, ...]:
        """Return the duties of M1 to M4 to send now; empty if no command is flown."""
        if not order.drive or self._command is None:
            return ()
        # From the vehicle file's order of rotors to M1 to M4
        duties = (self._command.duties[place] for place in self._order)
        return tuple(order.drive * min(1.0, max(-1.0, duty)) for duty in duties)

    def _send_duties(self, order: safety.SafetyOutputs) -> None:
        """Send duties while streaming; on hand-over, send zero duties that expire at once."""
        if not (order.stream or order.hand_over):
            return
        duties = self._motor_duties(order) or (0.0,) * len(self._order)
        self._sequence += 1
        hold = HOLD_MS if order.stream else 0  # ms
        self._link.send_duties(duties_packet.pack_duties(self._sequence, duties, hold))
