# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A Crazyflie that only its link shows: emulated, or whatever `LTA_CF_URI` names.

Its motors turn in these tests. So anything but a UDP address, behind which a program may be, wants
`LTA_CF_PROPELLERS=off` as well. What has locked needs a restart: `LTA_CF_RESTART` is the command
that does it; without one, the tests that come after are skipped until somebody has.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import os
import subprocess
import time

from lta_bridge.crazyflie import readings
from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.link import LinkFailed, LogPacket
from lta_bridge.crazyflie.log_table import LOG_BLOCKS
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.parameters import FirmwareBuild
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_emulation.emulated_hardware import build_simulated_body
import pytest
from waiting import PATIENCE, wait_until

EVERY = 0.02  # s between two setpoints
PWM_STEP = 1 / 256  # duty: a smaller one leaves the motor's pin low
PID, OUT_OF_TREE = 1, 6  # stabilizer.controller


@contextmanager
def served(build: FirmwareBuild) -> Iterator[str]:
    """Yield the URI of a Crazyflie: that of `LTA_CF_URI`, or an emulated one of a build."""
    uri = os.environ.get('LTA_CF_URI', '')
    if uri:
        if not uri.startswith('udp://') and os.environ.get('LTA_CF_PROPELLERS') != 'off':
            pytest.fail(f'{uri}: take the propellers off, and set LTA_CF_PROPELLERS=off.')
        yield uri
    else:
        body = build_simulated_body('multirotor', 'lamp_room', 1)
        with CrazyflieServer(Firmware(body, build=build)) as server:
            yield server.uri


def turning(motors: readings.MotorsReading) -> bool:
    """Tell whether any motor turns."""
    return any(duty >= PWM_STEP for duty in motors.duties)


class Drone:
    """One connection, what was heard over it, and orders."""

    def __init__(self, uri: str) -> None:
        self.link = CflibLink(uri, LOG_BLOCKS, time.time_ns)
        self.heard: dict[str, list[LogPacket]] = {}
        for attempt in range(3):
            try:
                self.link.open(8.0)
                break
            except LinkFailed:  # as the keeper does: one lost datagram costs a connection
                if attempt == 2:
                    raise

    def _listen(self) -> None:
        while not self.link.events.empty():
            event = self.link.events.get()
            if isinstance(event, LogPacket):
                self.heard.setdefault(event.block, []).append(event)

    def until(
        self, condition: Callable[[], object], each: Callable[[], object] = lambda: None
    ) -> None:
        """Listen until something holds, and do something every 20 ms meanwhile."""

        def step() -> None:
            each()
            time.sleep(EVERY)
            self._listen()

        def arrived() -> str:
            return f'word {self.word!r}, motors {self.motors.duties}'

        self._listen()
        wait_until(condition, 'the drone', arrived, step)

    def wait(self, seconds: float, each: Callable[[], object] = lambda: None) -> None:
        """Listen for so long, by the drone's own clock."""
        until = self.now + seconds
        self.until(lambda: self.now >= until, each)

    @property
    def now(self) -> float:
        """The drone's time of the newest word on its motors [s]."""
        return 1e-3 * self.heard['motors'][-1].stamp_ms if 'motors' in self.heard else 0.0

    @property
    def motors(self) -> readings.MotorsReading:
        return readings.convert_motors(self.heard['motors'][-1].values)

    @property
    def word(self) -> SupervisorBit:
        return SupervisorBit(self.motors.word)

    @property
    def turns(self) -> bool:
        return turning(self.motors)

    @property
    def has_app(self) -> bool:
        """Whether the app of firmware/crazyflie is aboard."""
        return self.link.read_parameter('lta.app') is not None

    @property
    def arms_itself(self) -> bool:
        """Whether this firmware arms itself, and again where somebody disarms it."""
        return SupervisorBit.AUTO_ARM in self.word

    def turned(self, since: float) -> bool:
        """Tell whether a motor turned at any time since [s]."""
        return any(
            turning(readings.convert_motors(packet.values))
            for packet in self.heard['motors']
            if 1e-3 * packet.stamp_ms > since
        )

    def hover(self) -> None:
        self.link.send_hover_setpoint(0.0, 0.0, 0.45)

    def arm(self) -> None:
        """Ask until the supervisor says that it is armed."""
        self.until(
            lambda: SupervisorBit.ARMED in self.word, lambda: self.link.request_arming(True)
        )

    def control_by(self, controller: int) -> None:
        """Choose the firmware's controller, where there is more than its own."""
        if self.has_app:
            self.link.write_parameter('stabilizer.controller', controller, PATIENCE)

    def fly(self) -> None:
        """Arm, and hover by the firmware's controller until motors have turned for a second."""
        self.control_by(PID)
        self.arm()
        self.until(lambda: self.turns, self.hover)
        self.wait(1.0, self.hover)


@contextmanager
def connected(uri: str) -> Iterator[Drone]:
    """Yield a drone that can be armed; disarmed when it is left."""
    drone = Drone(uri)
    try:
        drone.until(lambda: 'motors' in drone.heard)
        if SupervisorBit.LOCKED in drone.word:
            drone.link.close()
            restart = os.environ.get('LTA_CF_RESTART')
            if not restart:
                pytest.skip('the drone is locked: switch it off and on, and run this test alone')
            subprocess.run(restart, shell=True, check=True, timeout=PATIENCE)
            drone = Drone(uri)
        drone.until(lambda: 'motors' in drone.heard)
        if SupervisorBit.ARMED in drone.word and SupervisorBit.AUTO_ARM not in drone.word:
            drone.until(
                lambda: SupervisorBit.ARMED not in drone.word,
                lambda: drone.link.request_arming(False),
            )
        drone.until(
            lambda: (
                SupervisorBit.CAN_BE_ARMED in drone.word or SupervisorBit.AUTO_ARM in drone.word
            )
        )
        yield drone
    finally:
        for _ in range(3):
            drone.link.request_arming(False)
        drone.link.close()
