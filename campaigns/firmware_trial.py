# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One fault in one flight of the real firmware.

As `faults.py`, with the firmware as a Linux process (firmware/crazyflie/linux) in place of
the emulated one, and a link between it and the bridge that can be spoilt. The build with our app
flies GT-MAB by duties, the others fly the multirotor by setpoints.
"""

from collections.abc import Callable
import math
from pathlib import Path
from select import select
import socket
import threading
import time
from typing import Any, Final, Self

from firmware_scenarios import APP, FULL, PWM_STEP
from lta_emulation.crazyflie.server import LossyLink
from lta_emulation.step_thread import StepThread
from lta_model.vehicle import load_vehicle

from campaigns.fault_kinds import WRAP_MS
from campaigns.faults import Trial
from campaigns.graph_trial import try_flight
from campaigns.linux_crazyflie import BLIMP, Process

TICK: Final = 0.002  # s between two looks at what is delayed
IDLE: Final = 0.05  # s where nothing is
LOOKED: Final = 0.01  # s between two looks at the motors
STILL: Final = (0.0,) * 4
STRIKES: Final[dict[str, Callable[['Relay'], None]]] = {
    'log reset': lambda relay: relay.send(b'\x5d\x05'),
    'reboot': lambda relay: relay.process.restart(),
    'locked': lambda relay: relay.send(b'\x9d\x03'),
    'tumbled': lambda relay: relay.process.set('upside_down', 1.0),
    'low cell': lambda relay: relay.process.set('voltage', 3.0),
}
IMPOSSIBLE: Final = ('crashed', 'old', 'protocol 7', 'E2BIG', 'ENOMEM')  # for this firmware


class Relay:
    """
    A link that can be spoilt, between a bridge and the firmware's own port.

    Parameters
    ----------
    process : Process
        The firmware.

    Attributes
    ----------
    up, down : Link
        What happens to datagrams to the drone and from it.
    uri : str
        Where a bridge finds the drone.

    """

    def __init__(self, process: Process) -> None:
        self.process, self.up, self.down = process, LossyLink(), LossyLink()
        self._near = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._near.bind(('127.0.0.1', 0))
        self._far = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._far.connect(('127.0.0.1', process.port))
        for one in (self._near, self._far):
            one.setblocking(False)
        self.uri = f'udp://127.0.0.1:{self._near.getsockname()[1]}'
        self._peer: tuple[str, int] | None = None
        self._shut, self._thread = threading.Event(), StepThread(self._carry, 'relay')
        self._began = time.monotonic()

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.stop()
        self._near.close()
        self._far.close()
        self.process.close()

    @property
    def now(self) -> float:
        """Time since it was made [s]."""
        return time.monotonic() - self._began

    def send(self, datagram: bytes) -> None:
        """Send something to the drone, past the link."""
        self._far.send(datagram)

    def close_port(self) -> None:
        """Close the port: whoever sends hears that nobody is there."""
        self._shut.set()

    def _carry(self) -> None:
        if self._shut.is_set():
            self._near.close()
            time.sleep(TICK)
            return
        delayed = self.up.has_pending or self.down.has_pending
        select([self._near, self._far], [], [], TICK if delayed else IDLE)
        self._take()
        for datagram in self.up.receive(self.now):
            self._pass(lambda datagram=datagram: self._far.send(datagram))
        for datagram in self.down.receive(self.now):
            self._pass(lambda datagram=datagram: self._near.sendto(datagram, self._peer))

    def _take(self) -> None:
        """Take what has come from either side."""
        while (came := self._pass(lambda: self._near.recvfrom(64))) is not None:
            self._peer = came[1]
            self.up.send(came[0], self.now)
        while (data := self._pass(lambda: self._far.recv(64))) is not None:
            self.down.send(data, self.now)

    @staticmethod
    def _pass(act: Callable[[], Any]) -> Any:
        """Return what a socket gives; None where it has nothing, or nobody is there."""
        try:
            return act()
        except (OSError, TypeError):  # TypeError: nobody has spoken yet
            return None


class Motors:
    """The motors as the firmware's own timers turn them."""

    def __init__(self, process: Process, vehicle: str) -> None:
        self._process, self._looked, self._duties = process, -math.inf, STILL
        self.world = self
        self.vehicle = load_vehicle(vehicle)

    @property
    def duties(self) -> tuple[float, ...]:
        """Duty of M1 to M4; less than a step of the PWM is none."""
        now = time.monotonic()
        if now > self._looked + LOOKED:
            self._looked, self._duties = now, self._look()
        return self._duties

    def _look(self) -> tuple[float, ...]:
        try:
            ratios = self._process.look(LOOKED).ratios
        except TimeoutError:  # the machine is busy, and the pilot must go on
            return self._duties
        except OSError:  # it is switched off
            return STILL
        return tuple(ratio / FULL if ratio >= PWM_STEP else 0.0 for ratio in ratios)


class FirmwareTrial(Trial):
    """A trial whose drone is the firmware."""

    program = Path()

    def _drone(self, name: str, vehicle: str, number: int) -> tuple[Any, Any]:
        environment = dict(BLIMP) if self.program.parent.name == APP else {}
        if name == 'wrap':
            begin = WRAP_MS - self._random.randrange(7000, 14000)
            environment |= {'LTA_BOOT_MS': str(begin), 'LTA_CLOCK_PPM': '200'}
        process = Process(self.program, environment=environment)
        self._relay = Relay(process)
        return Motors(process, vehicle), self._relay

    def _strike(self) -> None:
        if self.name in STRIKES:
            STRIKES[self.name](self._relay)
        else:
            super()._strike()

    def _wrapped(self) -> bool:
        return self._relay.process.look().stamp_ms > WRAP_MS + 1000


def fly(program: Path, name: str, number: int) -> dict[str, Any]:
    """Return the row of a flight of a build; a number decides its chance."""
    FirmwareTrial.program = program
    by_setpoints = program.parent.name != APP
    turn = 2 * number + by_setpoints  # even numbers fly by duties, odd ones by setpoints
    return try_flight(lambda folder, peer: FirmwareTrial(name, turn, folder, peer).fly())
