# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Emulate the firmware of a Crazyflie, independent of the link.

`Firmware.receive` answers a packet, `Firmware.tick` returns the log packets that are due. Its
clock may run fast or slow.
"""

from collections.abc import Mapping
import struct
from typing import Final, final, NamedTuple

from lta_emulation.crazyflie.app import FULL_RATIO, MotorDutyApp
from lta_emulation.crazyflie.commander import (
    BodyCommand,
    Commander,
    CrazyflieBody,
    FirmwareAssertion,
    STOPPED_DUTIES,
)
from lta_emulation.crazyflie.log_blocks import BLOCKS, LogBlocks, TableOfContents, VARIABLES
from lta_emulation.crazyflie.parameters import (
    APP,
    default_controller,
    FirmwareBuild,
    list_parameters,
    LOG,
    OUT_OF_TREE,
    ParameterStore,
)
from lta_emulation.crazyflie.supervisor import Acceleration, Supervisor, SupervisorState
from lta_emulation.crazyflie.trajectory_memory import TrajectoryMemory

LARGEST_PAYLOAD = 30  # bytes of payload


class CrtpPacket(NamedTuple):
    """A CRTP packet."""

    # 0 to 15, 0 to 3
    port: int
    channel: int
    data: bytes = b''  # payload, at most 30 bytes

    def pack_datagram(self) -> bytes:
        """Return the datagram; bits 2 and 3 of the header are zero, as the firmware sends them."""
        return bytes([self.port << 4 | self.channel]) + self.data[:LARGEST_PAYLOAD]

    def build_reply(self, data: bytes) -> 'CrtpPacket':
        """Return a reply on the same port and channel."""
        return CrtpPacket(self.port, self.channel, data)


def unpack_datagram(datagram: bytes) -> CrtpPacket | None:
    """Return the packet in a datagram; None if it is empty or too long."""
    if not 1 <= len(datagram) <= 1 + LARGEST_PAYLOAD:
        return None
    header = datagram[0]
    # Header: port in bits 4 to 7, channel in bits 0 and 1
    return CrtpPacket(header >> 4, header & 3, datagram[1:])


@final
class ReceiveBuffer:
    """
    The firmware's receive buffer.

    Most services do not check the length: after a short packet they read bytes of an earlier one,
    and they ignore surplus bytes.
    """

    def __init__(self) -> None:
        self._bytes = bytearray(LARGEST_PAYLOAD)

    def receive(self, data: bytes) -> bytes:
        """Receive a payload; return all that its service sees."""
        # Bytes behind a short payload stay from earlier packets, as in the firmware
        self._bytes[: len(data)] = data
        return bytes(self._bytes)


LINK_NAME = b'Bitcraze Crazyflie'.ljust(LARGEST_PAYLOAD, b'\0')
TAG, DEVICE = b'2026.08', b'Crazyflie 2.1'
RATIO_ROUNDING: Final = 1e-3  # of a ratio, above the rounding error of a float
FULL_VOLTAGE: Final = 4.0  # V of a charged cell
LOW_VOLTAGE: Final = 3.2  # V below which the firmware reports low power
OWN, ALL_AS_FIRST = 1, (2, 3)  # motorPowerSet.enable; 3 is corrected for the battery as well
SUPERVISOR: Final = 12  # first protocol with a separate port for the supervisor
STATUS_WORD_REQUEST: Final = 12  # port 9, request for all bits; 1 to 11 request a single one


@final
class Firmware:
    """
    The firmware of one Crazyflie.

    Parameters
    ----------
    body : Body
        Motors and sensors.
    protocol : int
        Version of CRTP that it reports: 12 or older.
    boot_ms : int
        Initial value of its clock; near 2**24 its log stamps wrap soon.
    drift : float
        Relative rate error of its clock, positive if it runs fast. [1]
    build : Build
        Which firmware it is.
    up_at : float
        End of its start-up, during which it ignores packets and motors stand still. [s]

    Attributes
    ----------
    voltage, acceleration : float, tuple of float or None
        Cell voltage [V] and specific force [g] set by tests; None to use the body's.
    halted : bool
        Whether it has failed an assertion: motors stop, it restarts and fails its self-test, and
        only switching it off and on helps.

    """

    def __init__(
        self,
        body: CrazyflieBody,
        protocol: int = 12,
        boot_ms: int = 0,
        drift: float = 0.0,
        build: FirmwareBuild = APP,
        up_at: float = 0.0,
    ) -> None:
        self.body, self.build = body, build
        self.supervisor = Supervisor(arms_itself=not build.requires_arming)
        self.commander, self.app = Commander(), MotorDutyApp()
        contents = TableOfContents(list_parameters(build))
        self.parameters = ParameterStore(contents)
        self._contents = TableOfContents(LOG, bytes([BLOCKS, VARIABLES])), contents
        self.log, self.memory = LogBlocks(self._contents[0]), TrajectoryMemory()
        self.voltage: float | None = None
        self.acceleration: Acceleration | None = None
        self.halted = False
        self._protocol, self._boot_ms, self._drift = protocol, boot_ms, drift
        self._up_at, self._buffer = up_at, ReceiveBuffer()
        self._controller = default_controller(build)
        self._values: Mapping[str, float] = {}

    def clock_ms(self, now: float) -> int:
        """Return the time of its own clock [ms]."""
        return self._boot_ms + int(1e3 * now * (1.0 + self._drift))

    # Packets.

    def receive(self, packet: CrtpPacket, now: float) -> list[CrtpPacket]:
        """Receive a packet at a time [s]; return the answers."""
        if self.halted or now < self._up_at:
            return []
        try:
            answer = self._answer_packet(packet, now)
        except FirmwareAssertion:
            self.halted = True
            return []
        return [] if answer is None else [packet.build_reply(answer)]

    def _answer_packet(self, packet: CrtpPacket, now: float) -> bytes | None:
        port, channel, payload = packet
        data, size = self._buffer.receive(payload), len(payload)
        match port:
            case 2:
                return self._answer_parameter(channel, data, size)
            case 3 if channel == 0:
                self.commander.receive_attitude(now)
            case 4:
                return self.memory.answer_packet(channel, data, size)
            # Log: 0 is the table, 1 settings, 2 (outgoing) data
            case 5:
                if channel == 0:
                    return self._contents[0].answer_request(data)
                if channel == 1:
                    return self.log.run_command(data, size, self.clock_ms(now))
            # Generic localization: emergency stop and its watchdog
            case 6 if channel == 1 and size:
                self._receive_localization(data[0], now)
            case 7:
                self.commander.receive_generic_setpoint(channel, data, size, now)
            case 8:
                return self.commander.answer_high_level(
                    data, blocked=not self.supervisor.accepts_setpoints
                )
            case 9 if size and self._protocol >= SUPERVISOR:
                return self._answer_supervisor(channel, data, now)
            case 13:
                return self._answer_platform(channel, data, size, now)
            # Link layer: 0 is an echo, 1 returns the name
            case 15:
                return LINK_NAME if channel == 1 else payload if channel == 0 else None
        return None

    def _answer_parameter(self, channel: int, data: bytes, size: int) -> bytes | None:
        if channel == 0:
            return self._contents[1].answer_request(data)
        answer = self.parameters.answer_packet(channel, data, size)
        self._apply_parameters()
        return answer

    def _apply_parameters(self) -> None:
        values, supervisor = self.parameters.values, self.supervisor
        supervisor.landed_timeout = 1e-3 * values['supervisor.landedTimeout']
        supervisor.preflight_timeout = 1e-3 * values['supervisor.prefltTimeout']
        supervisor.tumble_check = bool(values['supervisor.tmblChckEn'])
        if values['stabilizer.stop']:
            supervisor.stop()
        # 0 selects the build's default; an unknown number keeps the present controller.
        controller = int(values['stabilizer.controller'])
        # Only a build with the app has the out-of-tree controller
        most = OUT_OF_TREE if self.build.app else OUT_OF_TREE - 1
        if controller == 0:
            controller = default_controller(self.build)
        if controller <= most:
            self._controller = controller
        values['stabilizer.controller'] = self._controller

    def _receive_localization(self, what: int, now: float) -> None:
        if what == 3:
            self.supervisor.stop()
        elif what == 4:
            self.supervisor.feed_watchdog(now)

    def _answer_supervisor(self, channel: int, data: bytes, now: float) -> bytes | None:
        supervisor, what = self.supervisor, data[0]
        if channel == 0 and what == STATUS_WORD_REQUEST:
            return bytes([0x80 | STATUS_WORD_REQUEST]) + struct.pack('<H', supervisor.word)
        if channel == 0 and 0 < what < STATUS_WORD_REQUEST:
            # Answers have the highest bit of the request number set
            return bytes([0x80 | what, supervisor.word >> (what - 1) & 1])
        if channel == 1:
            match what:
                case 1:
                    return bytes([0x81, supervisor.arm(bool(data[1])), supervisor.armed])
                case 2:
                    return bytes([0x82, supervisor.recover(), not supervisor.crashed])
                case 3:
                    supervisor.stop()
                case 4:
                    supervisor.feed_watchdog(now)
        return None

    def _answer_platform(self, channel: int, data: bytes, size: int, now: float) -> bytes | None:
        if channel == 0:
            return self._run_platform_command(data, size)
        if channel == 1:
            answer = {0: struct.pack('<I', self._protocol), 1: TAG, 2: DEVICE}.get(data[0])
            return None if answer is None else data[:1] + answer
        if channel == 2 and self.build.app:
            self.app.receive_packet(data[:size], now)
        return None

    def _run_platform_command(self, data: bytes, size: int) -> bytes:
        """Handle the supervisor's port (protocol 12 and later); echo unknown requests."""
        supervisor = self.supervisor
        match data[0]:
            case 1:
                done = size > 1 and supervisor.arm(bool(data[1]))
                return bytes([1, done, supervisor.armed])
            case 2:
                return bytes([2, supervisor.recover(), not supervisor.crashed])
            case 3:
                return b''
        return data[:size]

    # Time.

    def tick(self, now: float) -> list[CrtpPacket]:
        """Advance to a time; return the log packets that are due [s]."""
        if self.halted or now < self._up_at:
            # The body moves on without thrust while the firmware is down
            self.body.advance(now, BodyCommand(duties=STOPPED_DUTIES))
            return []
        self._run_app(now)
        sensed = self.body.read_log_values()
        self.supervisor.run_transitions(
            now,
            self._is_motor_turning(),
            self.commander.setpoint_age(now),
            self._specific_force(sensed),
        )
        self.body.advance(now, self._select_command(now))
        # Read again: the body has advanced since
        sensed = self.body.read_log_values()
        self._values = {**sensed, **self._firmware_log_values(sensed.get('pm.vbat', FULL_VOLTAGE))}
        data = self.log.take_due_packets(
            self.clock_ms(now), lambda name: self._values.get(name, 0.0)
        )
        return [CrtpPacket(5, 2, packet) for packet in data]

    def _run_app(self, now: float) -> None:
        """Let the app renew its setpoint, disarm, and release the commander."""
        if not self.supervisor.armed:
            self.app.reset_after_disarming()
        if self.app.release_if_due(now):
            self.commander.release_setpoint()
        elif self.app.is_renewing_setpoint():
            self.commander.set_zero_thrust(now)
            if self.app.requests_disarm(now):
                self.supervisor.arm(False)

    @property
    def _idle_ratio(self) -> int:
        """Return the idle ratio of a motor that may turn; 0 on a build that arms automatically."""
        idle = int(self.parameters.values['powerDist.idleThrust'])
        return idle if self.build.requires_arming else 0

    def _is_motor_turning(self) -> bool:
        """Return whether a motor turns faster than idle, which counts as flying."""
        return any(ratio > self._idle_ratio for ratio in map(_quantize_duty, self.body.duties))

    def _specific_force(self, sensed: Mapping[str, float]) -> Acceleration:
        if self.acceleration is not None:
            return self.acceleration
        return sensed.get('acc.x', 0.0), sensed.get('acc.y', 0.0), sensed.get('acc.z', 1.0)

    def _select_command(self, now: float) -> BodyCommand:
        """Return the motors' command; an override bypasses supervisor and time-outs."""
        values, supervisor = self.parameters.values, self.supervisor
        ratios = tuple(values[f'motorPowerSet.m{number}'] / FULL_RATIO for number in range(1, 5))
        if values['motorPowerSet.enable'] == OWN:
            return BodyCommand(duties=ratios)
        if values['motorPowerSet.enable'] in ALL_AS_FIRST:
            return BodyCommand(duties=ratios[:1] * 4)
        if not supervisor.motors_enabled:
            return BodyCommand(duties=STOPPED_DUTIES)
        return self._controller_command(now)._replace(idle=self._idle_ratio / FULL_RATIO)

    def _controller_command(self, now: float) -> BodyCommand:
        """Return the controller's command: duties for the app's, setpoints for any other."""
        if self._controller == OUT_OF_TREE:
            return BodyCommand(duties=self.app.motor_duties(now))
        if not self.supervisor.accepts_setpoints:
            return BodyCommand()
        return self.commander.select_command(
            level=self.supervisor.state is SupervisorState.LEVEL_OUT
        )

    def _firmware_log_values(self, sensed: float) -> dict[str, float]:
        motors = {
            f'motor.m{number}': _quantize_duty(duty)
            for number, duty in enumerate(self.body.duties, start=1)
        }
        voltage = sensed if self.voltage is None else self.voltage
        return {
            **motors,
            'supervisor.info': float(self.supervisor.word),
            'pm.vbat': voltage,
            # 0 is "on battery", 3 "low power" (pm.h)
            'pm.state': 3.0 if voltage < LOW_VOLTAGE else 0.0,
        }


def _quantize_duty(duty: float) -> int:
    """Return a duty truncated to 16 bits, as in the firmware."""
    return int(FULL_RATIO * duty + RATIO_ROUNDING)
