# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Turn one motor of a tethered drone briefly, with the same state machine as in flight.

The duty is sent to the app on the drone, which stops the motor 200 ms after the last packet. So
the motor stops however this program ends, even by SIGKILL or a pulled cable. The firmware's
override (`motorPowerSet`) has no such time-out and is not used.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
import math
from queue import Empty
import signal
import time
from typing import Final, final, NamedTuple, NoReturn

from lta_bridge.crazyflie import readings
from lta_bridge.crazyflie.bridge_core import BridgeCore, CrazyflieCommand, HOLD_MS, TICK_RATE
from lta_bridge.crazyflie.connection_manager import enforce_parameters
from lta_bridge.crazyflie.link import CrazyflieLink, LinkFailed, LinkLost, LogPacket
from lta_bridge.crazyflie.safety import SafetyRequest as Wish
from lta_bridge.crazyflie.safety import SafetyStage, STOPS
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.schema.crazyflie_file import CF_MOTORS, CrazyflieFile, hash_airframe
from lta_graph.interrupts import hold_interrupts
from lta_model.vehicle import Vehicle

STARTING: Final = 3.0  # s for telemetry to arrive, and again for the supervisor to arm
DISARM_TIME: Final = 1.0  # s for the supervisor to confirm disarming
NO_MOTOR_WISH: Final = Wish()


@final
class MotorTurnResult(NamedTuple):
    """Values logged by the drone."""

    duty: float  # largest duty of the tested motor, 0 to 1
    others: float  # largest duty of any other motor
    voltage: float  # lowest cell voltage; NaN if none was received [V]


@final
class MotorBench:
    """
    Turn one motor of one drone, 'm1' to 'm4'; the link must be open.

    `file` has the parameters, wiring and limits of the drone.
    """

    def __init__(
        self, link: CrazyflieLink, file: CrazyflieFile, vehicle: Vehicle, motor: str
    ) -> None:
        self._link, self._file, self._vehicle = link, file, vehicle
        rotors = vehicle.rotor_names
        self._bridge = BridgeCore(link, file, vehicle, 'motors', blind=True)  # tethered
        self._motor = CF_MOTORS.index(motor)
        # Two indices: _motor counts M1 to M4, _place the vehicle file's rotors
        self._place = list(rotors).index(file.motors[motor])
        self._rotors = len(rotors)
        self._logged: list[readings.MotorsReading] = []
        self._volts: list[float] = []

    def turn_motor(
        self, duty: float, seconds: float, tick: Callable[[float], None]
    ) -> MotorTurnResult:
        """
        Arm, turn the motor and disarm, also after an error.

        Parameters
        ----------
        duty : float
            0 to 1.
        seconds : float
            Duration. [s]
        tick : callable
            Called with the elapsed time. [s]

        Raises
        ------
        LinkFailed
            If the drone refuses, disarms itself, or stops sending.

        """
        enforce_parameters(
            self._link,
            self._file.expected,
            self._vehicle.battery_compensated,
            hash_airframe(self._vehicle.file, self._file),
        )
        try:
            self._arm()
            self._drive(duty, seconds, tick)
        finally:
            self._disarm()
        duties = [each.duties for each in self._logged]
        others = [one for each in duties for k, one in enumerate(each) if k != self._motor]
        return MotorTurnResult(
            max((each[self._motor] for each in duties), default=0.0),
            max(others, default=0.0), min(self._volts, default=math.nan),
        )  # fmt: skip

    def _arm(self) -> None:
        """Wait for telemetry, then arm and wait for the supervisor's confirmation."""
        until = time.monotonic() + STARTING
        while (
            self._bridge.find_arming_refusal(time.time_ns(), True, True)
            and time.monotonic() < until
        ):
            self._step(NO_MOTOR_WISH)
        if why := self._bridge.find_arming_refusal(time.time_ns(), True, True):
            raise LinkFailed(why)
        self._step(Wish(arm=True))
        while self._bridge.state.stage is SafetyStage.ARMING:
            self._step(NO_MOTOR_WISH)
        if self._bridge.state.stage is not SafetyStage.READY:
            raise LinkFailed(self._bridge.state.why)

    def _drive(self, duty: float, seconds: float, tick: Callable[[float], None]) -> None:
        # Repeated each tick, since the drone stops its motors without newer duties
        duties = tuple(duty if k == self._place else 0.0 for k in range(self._rotors))
        began = time.monotonic()
        while (elapsed := time.monotonic() - began) < seconds:
            self._bridge.accept_command(CrazyflieCommand(time.time_ns(), duties=duties))
            self._step(NO_MOTOR_WISH)
            tick(elapsed)
            if self._bridge.state.stage is not SafetyStage.FLYING:
                raise LinkFailed(self._bridge.state.why)

    def _step(self, wish: Wish) -> None:
        """Handle the received packets, run one tick, and wait for the next."""
        for packet in self._drain_packets():
            self._bridge.receive_packet(packet)
        self._bridge.tick(time.monotonic(), time.time_ns(), True, True, wish)
        time.sleep(1.0 / TICK_RATE)

    def _drain_packets(self) -> Iterator[LogPacket]:
        with suppress(Empty):
            while True:
                match self._link.events.get_nowait():
                    case LinkLost(why):
                        raise LinkFailed(
                            f'{why}; without commands the firmware stops the motor '
                            f'within {HOLD_MS} ms'
                        )
                    case LogPacket() as packet:
                        self._store_reading(packet)
                        yield packet

    def _store_reading(self, packet: LogPacket) -> None:
        if packet.block == 'motors':
            self._logged.append(readings.convert_motors(packet.values))
        elif packet.block == 'power':
            self._volts.append(readings.convert_power(packet.values).voltage)

    def _disarm(self) -> None:
        """Disarm until the supervisor confirms it; otherwise send emergency stops."""
        # A second Ctrl-C must not end the disarming
        with hold_interrupts(), suppress(LinkFailed):
            began = time.monotonic()
            logged_before = len(self._logged)
            while time.monotonic() - began < DISARM_TIME:
                self._link.request_arming(False)
                time.sleep(1.0 / TICK_RATE)
                for _ in self._drain_packets():
                    pass
                # The first new packet may have been sent before the request.
                if (
                    len(self._logged) > logged_before + 1
                    and not self._logged[-1].word & SupervisorBit.ARMED
                ):
                    return
            for _ in range(STOPS):
                self._link.send_emergency_stop()
                time.sleep(1.0 / TICK_RATE)


@contextmanager
def interrupt_on_signals() -> Iterator[None]:
    """Raise KeyboardInterrupt on SIGTERM and SIGHUP, so that every `finally` runs."""

    def raise_interrupt(*_: object) -> NoReturn:
        raise KeyboardInterrupt

    # Restored afterwards, so that callers keep their own handlers
    before = {
        each: signal.signal(each, raise_interrupt) for each in (signal.SIGTERM, signal.SIGHUP)
    }
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
