"""
The Crazyflie bridge without ROS and cflib: packets to readings, commands to orders.

Two threads meet here: one hands in what the link tells, the other ticks. A lock keeps them apart.
"""

from collections.abc import Sequence
import math
import threading
from typing import Final, final, NamedTuple

from lta_bridge.crazyflie import duties_packet, readings, safety
from lta_bridge.crazyflie.device_clock import DeviceClock
from lta_bridge.crazyflie.link import CrazyflieLink, LogPacket
from lta_bridge.crazyflie.round_trips import RoundTrips
from lta_bridge.crazyflie.safety import SafetyStage
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_bridge.crazyflie.wiring import find_rotor_indices
from lta_config.schema.crazyflie_file import CrazyflieFile
from lta_graph.age import stamp_age
from lta_graph.rejections import RejectionCount

RATE: Final = 50.0  # Hz of ticks; the firmware wants setpoints at 10 Hz or more
GUARD: Final = 7  # ticks between two words to the emergency-stop watchdog: 7 a second
HOLD_MS: Final = 200  # for which duties hold aboard without newer ones
LETTING_GO: Final = 10  # times that the override is taken off: nobody confirms it
TURN_GAIN: Final = 1.5  # 1/s from heading error to yaw rate: about 0.7 s to turn in
FASTEST_TURN: Final = 1.0  # rad/s
UNTOLD: Final = 2.0  # s after which the voltage that was told last says nothing any more
POWER_OFF: Final = 3  # pm.state from which the firmware itself calls the cell low


class CrazyflieCommand(NamedTuple):
    """
    What the graph commands: duties by rotor, or speed [m/s], turn [rad] and height [m].

    `turn` is how far the heading that is wanted lies to the left of the present one.
    """

    stamp_ns: int
    duties: tuple[float, ...] = ()
    speed: float = 0.0
    turn: float = 0.0
    height: float = 0.0


class PositionEstimate(NamedTuple):
    """Where the estimator takes the drone to be, and when: height and way from the start. [m]"""

    height: float = math.nan
    distance: float = math.nan
    stamp_ns: int | None = None  # None before any was told


class StampedReading(NamedTuple):
    """A reading with its graph time. [ns]"""

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
    One Crazyflie's side of the graph.

    Parameters
    ----------
    link : Link
        Where orders go.
    file : CrazyflieFile
        Command, wiring and limits.
    rotors : sequence of str
        The vehicle's, in the order of `motors`.
    command : str
        'setpoint', 'motors' or 'override'; the file's where empty.
    watchdog : bool
        Whether to start the firmware's emergency-stop watchdog with the first arming. It then cuts
        the motors and locks 1 s after the last word, and nothing but a restart ends it.

    Attributes
    ----------
    clock : DeviceClock
        Of the drone.
    state : safety.State
        Where the bridge stands.
    attitude : tuple or None
        The firmware's own, x y z w; None before it came.
    power, motors : Power, Motors or None
        The newest.
    trips : RoundTrips
        Of pings.
    malformed, unasked : Refused
        Packets that cannot be read, and commands that are none.

    """

    def __init__(
        self,
        link: CrazyflieLink,
        file: CrazyflieFile,
        rotors: Sequence[str],
        command: str = '',
        watchdog: bool = False,
    ) -> None:
        self._link, self._lock = link, threading.Lock()
        self.command = command or file.command
        self._order = find_rotor_indices(file.motors, rotors)
        self._rotors = len(rotors)
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
        self._asked: CrazyflieCommand | None = None
        self._where = PositionEstimate()
        self._sequence = 0
        self.packets = 0
        self._watchdog, self._guarded, self._ticks = watchdog, False, 0
        self._held = 0  # how often the override is still to be taken off

    @property
    def sends_duties(self) -> bool:
        """Whether our own allocation's duties go to the motors."""
        return self.command in ('motors', 'override')

    @property
    def is_busy(self) -> bool:
        """Whether motors may turn, or stops are still to be sent."""
        return (
            self.state.stage not in (SafetyStage.DISARMED, SafetyStage.STOPPED)
            or self.state.stops > 0
        )

    @property
    def is_armed(self) -> bool:
        """Whether the drone's newest word says that it is armed, and not because it always is."""
        word = 0 if self.motors is None else self.motors.word
        return bool(word & SupervisorBit.ARMED) and not word & SupervisorBit.AUTO_ARM

    def reset(self) -> None:
        """Begin anew with a new connection: nothing of the old one counts."""
        with self._lock:
            self.clock, self.trips = DeviceClock(), RoundTrips()
            self.attitude, self.power, self.motors, self._word_ns = None, None, None, None
            self._asked = None

    def add_round_trip(self, round_trip: float) -> None:
        """Take a round trip: stamps are set back by what the quickest message takes. [s]"""
        with self._lock:
            self.trips.add(round_trip)
            self.clock.line.one_way_ns = self.trips.one_way_ns

    def receive_packet(self, packet: LogPacket) -> StampedReading:
        """Return what a log packet says, with its graph time."""
        with self._lock:
            self.packets += 1
            stamp = self.clock.stamp_packet(packet.stamp_ms, packet.arrival_ns)
            values = packet.values
            if why := readings.find_value_fault(packet.block, values):
                self.malformed.add(why)
                return StampedReading(stamp, None)
            match packet.block:
                case 'imu':
                    return StampedReading(stamp, readings.convert_imu(values))
                case 'air':
                    return StampedReading(stamp, readings.convert_air(values))
                case 'attitude':
                    self.attitude = readings.convert_attitude(values)
                case 'motors':
                    self.motors = readings.convert_motors(values)
                    self._word_ns = packet.arrival_ns
                    return StampedReading(stamp, self.motors)
                case 'power':
                    self.power, self._power_ns = readings.convert_power(values), packet.arrival_ns
                    return StampedReading(stamp, self.power)
            return StampedReading(stamp, None)

    def accept_command(self, command: CrazyflieCommand) -> None:
        """Take a command of the graph; one that is no number or of other rotors is none."""
        numbers = (*command.duties, command.speed, command.turn, command.height)
        if self.sends_duties and len(command.duties) != self._rotors:
            self.unasked.add(f'duties that are not those of the {self._rotors} rotors')
        elif not all(map(math.isfinite, numbers)):
            self.unasked.add('a command that is not a number')
        else:
            self._asked = command

    def update_position(self, where: PositionEstimate) -> None:
        """Take where the estimator takes the drone to be."""
        self._where = where

    def collect_inputs(self, now_ns: int, linked: bool, active: bool) -> safety.SafetyInputs:
        """Return what is known. [ns]"""
        asked, motors, where = self._asked, self.motors, self._where
        since = None if asked is None else asked.stamp_ns
        return safety.SafetyInputs(
            linked=linked,
            active=active,
            word=0 if motors is None else motors.word,
            silence=stamp_age(self._word_ns, now_ns),
            command_age=stamp_age(since, now_ns),
            voltage=self._safety_voltage(now_ns),
            height=where.height,
            distance=where.distance,
            place_age=0.0 if where.stamp_ns is None else stamp_age(where.stamp_ns, now_ns),
        )

    def _safety_voltage(self, now_ns: int) -> float:
        """Return the voltage to judge by: none where the firmware calls it low, NaN if unknown."""
        if self.power is None or stamp_age(self._power_ns, now_ns) > UNTOLD:
            return math.nan
        return 0.0 if self.power.state >= POWER_OFF else self.power.voltage

    def tick(
        self, now: float, now_ns: int, linked: bool, active: bool, request: safety.SafetyRequest
    ) -> safety.SafetyOutputs:
        """
        Decide, and send.

        Parameters
        ----------
        now : float
            On a clock that only goes on. [s]
        now_ns : int
            Graph time. [ns]
        linked, active : bool
            Whether the link is up and the node active.
        asked : safety.Asked
            By people, since the last tick.

        """
        with self._lock:
            seen = self.collect_inputs(now_ns, linked, active)
            self.state, order = safety.step_state(self.state, now, seen, request, self.limits)
            self._send_outputs(order)
            return order

    def find_arming_refusal(self, now_ns: int, linked: bool, active: bool) -> str:
        """Return why arming would be refused now; empty where it would not."""
        return safety.find_arming_refusal(
            self.state, self.collect_inputs(now_ns, linked, active), self.limits
        )

    def _send_outputs(self, order: safety.SafetyOutputs) -> None:
        if order.stop:
            self._link.send_emergency_stop()
        self._guarded |= self._watchdog and bool(order.arm)
        self._ticks += 1
        stopped = self.state.stage is SafetyStage.STOPPED
        if self._guarded and not stopped and self._ticks % GUARD == 0:
            self._link.feed_watchdog()
        if order.arm is not None:
            self._link.request_arming(order.arm)
        if self.command == 'override':
            self._send_override(order)
        elif self.command == 'motors':
            self._send_duties(order)
        elif order.drive and self._asked is not None:
            asked = self._asked
            rate = max(-FASTEST_TURN, min(FASTEST_TURN, TURN_GAIN * asked.turn))
            self._link.send_hover_setpoint(
                order.drive * asked.speed, order.drive * rate, asked.height
            )
        if order.hand_over:
            self._link.hand_over(land=self.command == 'setpoint')

    def _motor_duties(self, order: safety.SafetyOutputs) -> tuple[float, ...]:
        """Return the duties of M1 to M4 that are in force; empty where none are."""
        if not order.drive or self._asked is None:
            return ()
        duties = (self._asked.duties[place] for place in self._order)
        return tuple(order.drive * min(1.0, max(-1.0, duty)) for duty in duties)

    def _send_override(self, order: safety.SafetyOutputs) -> None:
        """Turn the motors while commands are flown, and let go of them in every other state."""
        duties = self._motor_duties(order)
        if duties:
            self._held = LETTING_GO
        elif self._held:
            self._held -= 1
        else:
            return
        self._link.override_motors(duties)

    def _send_duties(self, order: safety.SafetyOutputs) -> None:
        """Send duties while commands stream, and none that hold for no time when handing over."""
        if not (order.stream or order.hand_over):
            return
        duties = self._motor_duties(order) or (0.0,) * len(self._order)
        self._sequence += 1
        hold = HOLD_MS if order.stream else 0
        self._link.send_duties(duties_packet.pack_duties(self._sequence, duties, hold))
