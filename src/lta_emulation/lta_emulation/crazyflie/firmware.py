"""
The emulated Crazyflie without a link: packets and time in, packets out.

`Firmware.receive` answers a packet, `Firmware.tick` sends what is due. Its own clock may run fast
or slow.
"""

from collections.abc import Mapping
import struct
from typing import Final, final

from lta_emulation.crazyflie.app import App
from lta_emulation.crazyflie.body import Body, STILL
from lta_emulation.crazyflie.build import APP, Build
from lta_emulation.crazyflie.commander import Asserted, Commander, Wish
from lta_emulation.crazyflie.contents import Contents
from lta_emulation.crazyflie.log_blocks import BLOCKS, LogBlocks, VARIABLES
from lta_emulation.crazyflie.packet import Buffer, MOST, Packet
from lta_emulation.crazyflie.parameters import Parameters
from lta_emulation.crazyflie.supervisor import Acceleration, State, Supervisor
from lta_emulation.crazyflie.variables import default_controller, LOG, OUT_OF_TREE, parameters

NAME = b'Bitcraze Crazyflie'.ljust(MOST, b'\0')
TAG, DEVICE = b'2026.08', b'Crazyflie 2.1'
FULL_RATIO = 65535
ROUNDING: Final = 1e-3  # of a ratio: more than what a float of a whole one may lack
FULL, LOW = 4.0, 3.2  # V of a charged cell, and below which the firmware says low power
OWN, ALL_AS_FIRST = 1, (2, 3)  # motorPowerSet.enable; 3 is corrected for the battery as well
SUPERVISOR: Final = 12  # protocol: the first with a port of its own for the supervisor
WORD: Final = 12  # port 9: all bits; 1 to 11 ask for one of them


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
    build : Build
        Which firmware it is.
    up_at : float
        Until when it starts: it hears nothing, and motors stand. [s]

    Attributes
    ----------
    voltage, acceleration : float, tuple of float or None
        Of the cell [V] and on the drone [g], for tests; None for what the body senses.
    halted : bool
        Whether it has asserted: motors stop, it starts anew, fails its self-test for that, and
        only switching it off and on helps.

    """

    def __init__(
        self,
        body: Body,
        protocol: int = 12,
        boot_ms: int = 0,
        drift: float = 0.0,
        build: Build = APP,
        up_at: float = 0.0,
    ) -> None:
        self.body, self.build = body, build
        self.supervisor = Supervisor(arms_itself=not build.requires_arming)
        self.commander, self.app = Commander(), App()
        contents = Contents(parameters(build))
        self.parameters = Parameters(contents)
        self._contents = Contents(LOG, bytes([BLOCKS, VARIABLES])), contents
        self.log = LogBlocks(self._contents[0])
        self.voltage: float | None = None
        self.acceleration: Acceleration | None = None
        self.halted = False
        self._protocol, self._boot_ms, self._drift = protocol, boot_ms, drift
        self._up_at, self._buffer = up_at, Buffer()
        self._controller = default_controller(build)
        self._values: Mapping[str, float] = {}

    def milliseconds(self, now: float) -> int:
        """Return what its own clock says. [ms]"""
        return self._boot_ms + int(1e3 * now * (1.0 + self._drift))

    # Packets.

    def receive(self, packet: Packet, now: float) -> list[Packet]:
        """Take a packet at a time [s]; return the answers."""
        if self.halted or now < self._up_at:
            return []
        try:
            answer = self._answer(packet, now)
        except Asserted:
            self.halted = True
            return []
        return [] if answer is None else [packet.answer(answer)]

    def _answer(self, packet: Packet, now: float) -> bytes | None:
        port, channel, told = packet
        data, size = self._buffer.take(told), len(told)
        match port:
            case 2:
                return self._parameter(channel, data, size)
            case 3 if channel == 0:
                self.commander.attitude(now)
            case 4:
                return b'\x01\0' if data[:1] == b'\x01' else None
            case 5:
                if channel == 0:
                    return self._contents[0].told(data)
                if channel == 1:
                    return self.log.command(data, size, self.milliseconds(now))
            case 6 if channel == 1 and size:
                self._localize(data[0], now)
            case 7:
                self.commander.generic(channel, data, size, now)
            case 8:
                return self.commander.high_level(data, blocked=not self.supervisor.flies)
            case 9 if size and self._protocol >= SUPERVISOR:
                return self._supervise(channel, data, now)
            case 13:
                return self._platform(channel, data, size, now)
            case 15:
                return NAME if channel == 1 else told if channel == 0 else None
        return None

    def _parameter(self, channel: int, data: bytes, size: int) -> bytes | None:
        if channel == 0:
            return self._contents[1].told(data)
        answer = self.parameters.answer(channel, data, size)
        self._apply()
        return answer

    def _apply(self) -> None:
        """Let the parameters have their effect."""
        values, supervisor = self.parameters.values, self.supervisor
        supervisor.landed_timeout = 1e-3 * values['supervisor.landedTimeout']
        supervisor.preflight_timeout = 1e-3 * values['supervisor.prefltTimeout']
        supervisor.tumble_check = bool(values['supervisor.tmblChckEn'])
        if values['stabilizer.stop']:
            supervisor.stop()
        # 0 selects the build's own, and one that there is not keeps the present one.
        controller = int(values['stabilizer.controller'])
        most = OUT_OF_TREE if self.build.app else OUT_OF_TREE - 1
        if controller == 0:
            controller = default_controller(self.build)
        if controller <= most:
            self._controller = controller
        values['stabilizer.controller'] = self._controller

    def _localize(self, what: int, now: float) -> None:
        if what == 3:
            self.supervisor.stop()
        elif what == 4:
            self.supervisor.feed(now)

    def _supervise(self, channel: int, data: bytes, now: float) -> bytes | None:
        supervisor, what = self.supervisor, data[0]
        if channel == 0 and what == WORD:
            return bytes([0x80 | WORD]) + struct.pack('<H', supervisor.word)
        if channel == 0 and 0 < what < WORD:
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
                    supervisor.feed(now)
        return None

    def _platform(self, channel: int, data: bytes, size: int, now: float) -> bytes | None:
        if channel == 0:
            return self._platform_command(data, size)
        if channel == 1:
            told = {0: struct.pack('<I', self._protocol), 1: TAG, 2: DEVICE}.get(data[0])
            return None if told is None else data[:1] + told
        if channel == 2 and self.build.app:
            self.app.take(data[:size], now)
        return None

    def _platform_command(self, data: bytes, size: int) -> bytes:
        """Obey what has a port of its own since protocol 12; anything else comes back."""
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

    def tick(self, now: float) -> list[Packet]:
        """Go on to a time; return the log packets that are due. [s]"""
        if self.halted or now < self._up_at:
            self.body.fly(now, Wish(duties=STILL))
            return []
        self._run_app(now)
        sensed = self.body.read()
        self.supervisor.watch(now, self._turning(), self.commander.age(now), self._felt(sensed))
        self.body.fly(now, self._wish(now))
        sensed = self.body.read()
        self._values = {**sensed, **self._own(sensed.get('pm.vbat', FULL))}
        data = self.log.due(self.milliseconds(now), lambda name: self._values.get(name, 0.0))
        return [Packet(5, 2, packet) for packet in data]

    def _run_app(self, now: float) -> None:
        """Let the app feed the commander, disarm, and let go."""
        if not self.supervisor.armed:
            self.app.forget()
        if self.app.lets_go(now):
            self.commander.relax()
        elif self.app.feeds():
            self.commander.rest(now)
            if self.app.ends(now):
                self.supervisor.arm(False)

    @property
    def _idle(self) -> int:
        """The least ratio of a motor that may turn: none on a build that arms itself."""
        idle = int(self.parameters.values['powerDist.idleThrust'])
        return idle if self.build.requires_arming else 0

    def _turning(self) -> bool:
        """Tell whether a motor turns faster than at idle; one at idle does not fly."""
        return any(ratio > self._idle for ratio in map(_ratio, self.body.duties))

    def _felt(self, sensed: Mapping[str, float]) -> Acceleration:
        if self.acceleration is not None:
            return self.acceleration
        return sensed.get('acc.x', 0.0), sensed.get('acc.y', 0.0), sensed.get('acc.z', 1.0)

    def _wish(self, now: float) -> Wish:
        """Return what the motors do: the override asks neither supervisor nor time (motors.c)."""
        values, supervisor = self.parameters.values, self.supervisor
        ratios = tuple(values[f'motorPowerSet.m{number}'] / FULL_RATIO for number in range(1, 5))
        if values['motorPowerSet.enable'] == OWN:
            return Wish(duties=ratios)
        if values['motorPowerSet.enable'] in ALL_AS_FIRST:
            return Wish(duties=ratios[:1] * 4)
        if not supervisor.runs:
            return Wish(duties=STILL)
        return self._flown(now)._replace(idle=self._idle / FULL_RATIO)

    def _flown(self, now: float) -> Wish:
        """Return what the controller does: the app's with its duties, any other by setpoints."""
        if self._controller == OUT_OF_TREE:
            return Wish(duties=self.app.duties(now))
        if not self.supervisor.flies:
            return Wish()
        return self.commander.wish(level=self.supervisor.state is State.LEVEL_OUT)

    def _own(self, sensed: float) -> dict[str, float]:
        motors = {
            f'motor.m{number}': _ratio(duty)
            for number, duty in enumerate(self.body.duties, start=1)
        }
        voltage = sensed if self.voltage is None else self.voltage
        return {
            **motors,
            'supervisor.info': float(self.supervisor.word),
            'pm.vbat': voltage,
            'pm.state': 3.0 if voltage < LOW else 0.0,
        }


def _ratio(duty: float) -> int:
    """Return what the firmware makes of a duty: 16 bits, cut off."""
    return int(FULL_RATIO * duty + ROUNDING)
