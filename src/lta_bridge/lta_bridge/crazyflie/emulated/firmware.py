"""
The emulated Crazyflie without a link: packets and time in, packets out.

`Firmware.receive` answers a packet, `Firmware.tick` sends what is due. Time counts from the boot;
its own clock may run fast or slow.
"""

from collections.abc import Mapping
import struct
from typing import final

from lta_bridge.crazyflie.emulated.body import Body
from lta_bridge.crazyflie.emulated.commander import Commander, Wish
from lta_bridge.crazyflie.emulated.contents import Contents
from lta_bridge.crazyflie.emulated.log_blocks import BLOCKS, LogBlocks, VARIABLES
from lta_bridge.crazyflie.emulated.packet import Packet
from lta_bridge.crazyflie.emulated.parameters import Parameters
from lta_bridge.crazyflie.emulated.supervisor import Supervisor
from lta_bridge.crazyflie.emulated.variables import LOG, PARAMETERS

NAME = b'Bitcraze Crazyflie'.ljust(30, b'\0')
FULL_RATIO = 65535
FULL, LOW = 4.0, 3.2  # V of a charged cell, and below which the firmware says low power


@final
class Firmware:
    """
    The protocol and what stands behind it.

    Parameters
    ----------
    body : Body
        What flies.
    protocol : int
        Version of CRTP that it tells: 12, or an older one.
    boot_ms : int
        Where its clock begins; near 2**24 its log stamps wrap soon.
    drift : float
        By how much its clock runs fast. [1]

    """

    def __init__(
        self, body: Body, protocol: int = 12, boot_ms: int = 0, drift: float = 0.0
    ) -> None:
        self.body = body
        self.supervisor = Supervisor()
        self.commander = Commander()
        self.parameters = Parameters(Contents(PARAMETERS))
        limits = bytes([BLOCKS, VARIABLES])
        self._contents = Contents(LOG, limits), Contents(PARAMETERS)
        self.log = LogBlocks(self._contents[0])
        self.voltage: float | None = None  # of the cell, for tests; the body's own otherwise
        self._protocol, self._boot_ms, self._drift = protocol, boot_ms, drift
        self._values: Mapping[str, float] = {}

    def milliseconds(self, now: float) -> int:
        """Return what its own clock says. [ms]"""
        return self._boot_ms + int(1e3 * now * (1.0 + self._drift))

    def receive(self, packet: Packet, now: float) -> list[Packet]:
        """Take a packet at a time [s]; return the answers."""
        answer = self._answer(packet, now)
        return [] if answer is None else [packet.answer(answer)]

    def _answer(self, packet: Packet, now: float) -> bytes | None:
        port, channel, data = packet
        match port:
            case 2:
                if channel == 0:
                    return self._contents[1].told(data)
                return self._parameter(channel, data)
            case 3:
                self.commander.attitude(now)
            case 4:
                return b'\x01\0' if data[:1] == b'\x01' else None
            case 5:
                if channel == 0:
                    return self._contents[0].told(data)
                if channel == 1:
                    return self.log.command(data, self.milliseconds(now))
            case 6:
                self._localization(channel, data, now)
            case 7:
                self.commander.generic(channel, data, now)
            case 8:
                return self.commander.high_level(data)
            case 9:
                return self._supervise(channel, data, now) if self._protocol >= 12 else None
            case 13:
                return self._platform(channel, data, now)
            case 15:
                return NAME if channel == 1 else data if channel == 0 else None
        return None

    def _parameter(self, channel: int, data: bytes) -> bytes | None:
        answer = self.parameters.answer(channel, data)
        values = self.parameters.values
        self.supervisor.landed_timeout = 1e-3 * values['supervisor.landedTimeout']
        self.supervisor.preflight_timeout = 1e-3 * values['supervisor.prefltTimeout']
        if values['stabilizer.stop']:
            self.supervisor.lock()
        return answer

    def _localization(self, channel: int, data: bytes, now: float) -> None:
        if channel == 1 and data[:1] == b'\x03':
            self.supervisor.lock()
        elif channel == 1 and data[:1] == b'\x04':
            self.supervisor.feed(now)

    def _supervise(self, channel: int, data: bytes, now: float) -> bytes | None:
        supervisor = self.supervisor
        if channel == 0 and data[:1] == b'\x0c':
            return b'\x8c' + struct.pack('<H', supervisor.word(now))
        if channel == 1:
            match data[:1]:
                case b'\x01' if len(data) > 1:
                    return bytes([0x81, supervisor.arm(bool(data[1]), now), supervisor.armed])
                case b'\x02':
                    return bytes([0x82, 1, supervisor.recover()])
                case b'\x03':
                    supervisor.lock()
                case b'\x04':
                    supervisor.feed(now)
        return None

    def _platform(self, channel: int, data: bytes, now: float) -> bytes | None:
        if channel == 1 and data[:1] == b'\0':
            return b'\0' + struct.pack('<I', self._protocol)
        if channel == 2:
            self.commander.app(data, now)
        if channel == 0 and data[:1] == b'\x01' and len(data) > 1:
            self.supervisor.arm(bool(data[1]), now)
        return None

    def tick(self, now: float) -> list[Packet]:
        """Go on to a time; return the log packets that are due. [s]"""
        self.body.fly(now, self._wish(now))
        turning = any(duty > 0.0 for duty in self.body.duties)
        commander = self.commander
        self.supervisor.watch(now, turning, commander.age(now), commander.stopped)
        sensed = self.body.read()
        self._values = {**sensed, **self._own(now, sensed.get('pm.vbat', FULL))}
        data = self.log.due(self.milliseconds(now), lambda name: self._values.get(name, 0.0))
        return [Packet(5, 2, packet) for packet in data]

    def _wish(self, now: float) -> Wish:
        """Return what the motors do: the override asks neither supervisor nor time (motors.c)."""
        values = self.parameters.values
        if values['motorPowerSet.enable']:
            ratios = (values[f'motorPowerSet.m{number}'] for number in range(1, 5))
            return Wish(duties=tuple(ratio / FULL_RATIO for ratio in ratios))
        if self.supervisor.allows:
            return self.commander.wish(now)
        return Wish(duties=(0.0,) * 4)

    def _own(self, now: float, sensed: float) -> dict[str, float]:
        motors = {
            f'motor.m{number}': FULL_RATIO * duty
            for number, duty in enumerate(self.body.duties, start=1)
        }
        voltage = sensed if self.voltage is None else self.voltage
        return {
            **motors,
            'supervisor.info': float(self.supervisor.word(now)),
            'pm.vbat': voltage,
            'pm.state': 3.0 if voltage < LOW else 0.0,
        }
