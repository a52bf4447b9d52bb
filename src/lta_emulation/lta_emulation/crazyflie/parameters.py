# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Emulate the parameters: read, write and set by name (port 2), as in param_logic.c.

The firmware does not check the length: of a long write it uses the first bytes, and a short one is
completed by bytes that an earlier packet left in the buffer.
"""

from enum import IntEnum
import errno
from functools import cache
import struct
from typing import Final, final, NamedTuple

from lta_config.schema.crazyflie_file import hash_airframe, load_crazyflie
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_emulation.crazyflie.app import APP_VERSION
from lta_emulation.crazyflie.log_blocks import (
    BASIC,
    CORE,
    EXTENDED,
    FirmwareParameter,
    LogVariable,
    pack_value,
    PARAMETER_TYPES,
    READ_ONLY,
    TableOfContents,
)

KCONFIG_IDLE = 7000  # CONFIG_MOTORS_DEFAULT_IDLE_THRUST where arming is required (Kconfig)


class FirmwareBuild(NamedTuple):
    """A build of firmware 2026.08."""

    # Whether it has the app of firmware/crazyflie, and with it the out-of-tree controller
    app: bool
    # Whether it must be armed (CONFIG_MOTORS_REQUIRE_ARMING); otherwise it arms itself
    requires_arming: bool
    idle_thrust: int  # default of `powerDist.idleThrust`, of 65535
    # Whether it corrects duties for the battery voltage (CONFIG_ENABLE_THRUST_BAT_COMPENSATED).
    # This is only reported here: the correction is an effect of the body's vehicle, and `motor.m1`
    # to `m4` log the duty before it.
    compensated: bool
    # Hash of the vehicle that it was built for; by default that of GT-MAB
    airframe: int | None = None


AS_SOLD: Final = FirmwareBuild(app=False, requires_arming=False, idle_thrust=0, compensated=True)
ARMING: Final = FirmwareBuild(
    app=False, requires_arming=True, idle_thrust=KCONFIG_IDLE, compensated=True
)
APP: Final = FirmwareBuild(app=True, requires_arming=True, idle_thrust=0, compensated=False)


def select_build(command: str) -> FirmwareBuild:
    """Return the build for a command mode: 'setpoint' or 'motors'."""
    return AS_SOLD if command == 'setpoint' else APP


READ, WRITE, OTHER = 1, 2, 3  # channels
PERSISTENT: Final = 1  # the only extended type


class ParameterRequest(IntEnum):
    """Requests in the first byte of channel 3."""

    SET_BY_NAME = 0
    EXTENDED_TYPE = 2
    STORE = 3
    STORED = 4
    CLEAR = 5
    DEFAULT = 6
    EXTENDED_TYPE_2 = 7
    DEFAULT_2 = 8


PARAMETER_QUESTIONS: Final = frozenset(ParameterRequest)


@final
class ParameterStore:
    """Values of the parameters."""

    def __init__(self, contents: TableOfContents[FirmwareParameter]) -> None:
        self._contents = contents
        self.values = {entry.name: entry.default for entry in contents.entries}
        self._stored: dict[str, bytes] = {}  # as packed; a restart does not load them

    def answer_packet(self, channel: int, data: bytes, size: int) -> bytes | None:
        """
        Return the answer on one of the three channels; None for no answer.

        `channel`: 1 to 3. `data`: all 30 bytes of the buffer. `size`: size of the packet in the
        buffer [bytes].
        """
        if channel == READ:
            return self._answer_read(data)
        if channel == WRITE:
            return self._answer_write(data, size)
        if channel == OTHER:
            return self._answer_misc_channel(data)
        return None

    def _find_entry(self, number: bytes) -> FirmwareParameter | None:
        which = int.from_bytes(number, 'little')
        entries = self._contents.entries
        return entries[which] if which < len(entries) else None

    def _pack_entry(self, entry: FirmwareParameter) -> bytes:
        return pack_value(PARAMETER_TYPES[entry.kind & BASIC], self.values[entry.name])

    def _answer_read(self, data: bytes) -> bytes:
        number = data[:2]
        entry = self._find_entry(number)
        if entry is None:
            return number + bytes([errno.ENOENT])
        return number + b'\0' + self._pack_entry(entry)

    def _answer_write(self, data: bytes, size: int) -> bytes | None:
        """Store a value and echo the packet."""
        entry = self._find_entry(data[:2])
        if entry is None:
            return data[:2] + bytes([errno.ENOENT])
        # The firmware does not answer a write to a read-only parameter
        if entry.kind & READ_ONLY:
            return None
        self._store_value(entry, data[2:])
        return data[:size]

    def _store_value(self, entry: FirmwareParameter, value: bytes) -> None:
        kind = '<' + PARAMETER_TYPES[entry.kind & BASIC]
        # A name can end at the end of the buffer; the bytes behind it are zero here.
        (self.values[entry.name],) = struct.unpack_from(kind, value.ljust(8, b'\0'))

    def _answer_misc_channel(self, data: bytes) -> bytes | None:
        """Set by name, or answer a request for a parameter's type, default or storage."""
        if data[0] not in PARAMETER_QUESTIONS:
            return None
        if data[0] == ParameterRequest.SET_BY_NAME:
            return self._set_by_name(data)
        entry = self._find_entry(data[1:3])
        if entry is None:
            return data[:3] + bytes([errno.ENOENT])
        return data[:3] + self._answer_misc_request(ParameterRequest(data[0]), entry)

    def _answer_misc_request(self, question: ParameterRequest, entry: FirmwareParameter) -> bytes:
        default = pack_value(PARAMETER_TYPES[entry.kind & BASIC], entry.default)
        answer = {
            ParameterRequest.EXTENDED_TYPE: bytes([PERSISTENT]),
            ParameterRequest.EXTENDED_TYPE_2: bytes([0, PERSISTENT]),
            ParameterRequest.STORE: b'\0',
            ParameterRequest.STORED: bytes([entry.name in self._stored])
            + default
            + self._stored.get(entry.name, b''),
            ParameterRequest.CLEAR: b'\0',
            ParameterRequest.DEFAULT: default,
            ParameterRequest.DEFAULT_2: b'\0' + default,
        }
        lacking = {
            ParameterRequest.EXTENDED_TYPE: not entry.kind & EXTENDED,
            ParameterRequest.EXTENDED_TYPE_2: not entry.kind & EXTENDED,
            ParameterRequest.STORE: not entry.kind & EXTENDED,
            ParameterRequest.CLEAR: entry.name not in self._stored,
            ParameterRequest.DEFAULT: bool(entry.kind & READ_ONLY),
            ParameterRequest.DEFAULT_2: bool(entry.kind & READ_ONLY),
        }
        if lacking.get(question):
            return bytes([errno.ENOENT])
        if question is ParameterRequest.STORE:
            self._stored[entry.name] = self._pack_entry(entry)
        elif question is ParameterRequest.CLEAR:
            del self._stored[entry.name]
        return answer[question]

    def _set_by_name(self, data: bytes) -> bytes | None:
        # The request holds two strings that end with a zero byte: group and name
        if data.count(0) < 2:
            return None
        group, _, rest = data[1:].partition(b'\0')
        name, _, value = rest.partition(b'\0')
        status = self._store_by_name(group, name, value)
        # Echo of the request up to the name, then the status
        return (data + bytes(4))[: 3 + len(group) + len(name)] + bytes([status])

    def _store_by_name(self, group: bytes, name: bytes, value: bytes) -> int:
        """Store a value, preceded by its type, by name; return the firmware's errno."""
        which = self._contents.numbers.get(f'{group.decode("latin")}.{name.decode("latin")}')
        if which is None:
            return errno.ENOENT
        entry = self._contents.entries[which]
        # The request must give the exact type, without flags
        if value[:1] != bytes([entry.kind & ~(CORE | READ_ONLY | EXTENDED)]):
            return errno.EINVAL
        if entry.kind & READ_ONLY:
            return errno.EACCES
        self._store_value(entry, value[1:])
        return 0


FLOAT, U8, U16, I8 = 7, 1, 2, 4
BYTE, WORD, LONG, REAL = 0x08, 0x09, 0x0A, 0x06  # of parameters
ATTITUDE_GAINS = {'roll': (6.0, 3.0, 0.0), 'pitch': (6.0, 3.0, 0.0), 'yaw': (6.0, 1.0, 0.35)}
PID_ANGLES = ('roll', 'pitch', 'yaw')
COMPLEMENTARY, PID, OUT_OF_TREE = 1, 1, 6  # estimator.h, controller.h

LOG = (
    *(LogVariable(f'acc.{axis}', FLOAT) for axis in 'xyz'),
    *(LogVariable(f'gyro.{axis}', FLOAT) for axis in 'xyz'),
    *(LogVariable(f'stateEstimate.{part}', FLOAT) for part in (*PID_ANGLES, 'x', 'y', 'z')),
    *(LogVariable(f'stabilizer.{angle}', FLOAT) for angle in PID_ANGLES),
    *(LogVariable(f'kalman.state{axis}', FLOAT) for axis in 'XYZ'),
    *(LogVariable(f'kalman.varP{axis}', FLOAT) for axis in 'XYZ'),
    LogVariable('range.zrange', U16),
    LogVariable('baro.pressure', FLOAT),
    LogVariable('pm.vbat', FLOAT),
    LogVariable('pm.state', I8),
    *(LogVariable(f'motor.m{number}', U16) for number in range(1, 5)),
    LogVariable('supervisor.info', U16),
)


def default_controller(build: FirmwareBuild) -> int:
    """Return the controller that a build selects by itself."""
    return OUT_OF_TREE if build.app else PID


def _airframe(build: FirmwareBuild) -> int:
    return _gtmab_airframe() if build.airframe is None else build.airframe


@cache
def _gtmab_airframe() -> int:
    return hash_airframe(load_vehicle_file('gtmab'), load_crazyflie('gtmab'))


def list_parameters(build: FirmwareBuild) -> tuple[FirmwareParameter, ...]:
    """Return the parameters of a build, with the values they have when it is up."""
    app = (
        FirmwareParameter('lta.app', BYTE | READ_ONLY, APP_VERSION),
        FirmwareParameter('lta.compensated', BYTE | READ_ONLY, int(build.compensated)),
        FirmwareParameter('lta.commit', LONG | READ_ONLY, 0),
        FirmwareParameter('lta.vehicle', LONG | READ_ONLY, _airframe(build)),
    )
    return (
        # Time-outs in ms
        FirmwareParameter('supervisor.landedTimeout', WORD | EXTENDED, 3000),
        FirmwareParameter('supervisor.prefltTimeout', WORD | EXTENDED, 30000),
        FirmwareParameter('supervisor.tmblChckEn', BYTE | EXTENDED, 1),
        FirmwareParameter('powerDist.idleThrust', LONG | EXTENDED | CORE, build.idle_thrust),
        FirmwareParameter('stabilizer.controller', BYTE | CORE, default_controller(build)),
        FirmwareParameter('stabilizer.stop', BYTE | CORE, 0),
        FirmwareParameter('motorPowerSet.enable', BYTE | CORE, 0),
        *(FirmwareParameter(f'motorPowerSet.m{number}', WORD | CORE, 0) for number in range(1, 5)),
        *(app if build.app else ()),
        # Stored but not used: what programs of others set or look for
        FirmwareParameter('stabilizer.estimator', BYTE | CORE, COMPLEMENTARY),
        FirmwareParameter('kalman.resetEstimation', BYTE | CORE, 0),
        FirmwareParameter('commander.enHighLevel', BYTE | CORE, 0),
        FirmwareParameter('led.bitmask', BYTE, 0),
        *(
            FirmwareParameter(f'pid_attitude.{angle}_k{term}', REAL | EXTENDED, gain)
            for angle, gains in ATTITUDE_GAINS.items()
            for term, gain in zip('pid', gains, strict=True)
        ),
        # A Flow deck, as it measures range and position, and an LED ring
        FirmwareParameter('deck.bcFlow2', BYTE | CORE | READ_ONLY, 1),
        FirmwareParameter('ring.effect', BYTE | EXTENDED | CORE, 6),
        # In a real firmware, the first digits of the commit
        FirmwareParameter('firmware.revision0', LONG | READ_ONLY, 0x2026_0800),
    )
