# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Operate a Crazyflie as a person asks: connect, arm, stop, land, disarm, and describe its health.

`bridge_core` decides in each tick what is sent. An operation lasts until the drone has confirmed
it, so it keeps the ticks going meanwhile.
"""

from collections.abc import Callable, Iterator
from functools import partial
import time
from typing import Final, final

from lta_bridge.crazyflie.bridge_core import BridgeCore, StampedReading, TICK_RATE
from lta_bridge.crazyflie.buoyancy import BuoyancyMonitor
from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.connection_manager import CONNECTING, ConnectionManager
from lta_bridge.crazyflie.drone_lock import DroneLock, is_port_closed
from lta_bridge.crazyflie.link import LinkLost, MalformedPacket, Ping
from lta_bridge.crazyflie.log_table import LOG_BLOCKS
from lta_bridge.crazyflie.safety import (
    DELIBERATE,
    LEAVE,
    SafetyInputs,
    SafetyRequest,
    SafetyStage,
    SILENT_LINK,
)
from lta_bridge.crazyflie.supervisor_word import explain_fault
from lta_bridge.parameters import CrazyflieBridgeSettings
from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import find_crazyflie, hash_airframe
from lta_graph.health import HealthFact, HealthLevel
from lta_model.vehicle import Vehicle

ALOFT: Final = (SafetyStage.READY, SafetyStage.FLYING, SafetyStage.LANDING)
DISARM_CONFIRM_TIME: Final = 1.0  # s of LEAVE for the drone to confirm disarming
DEAD: Final = 2.0  # s of silence before reconnecting: log blocks may be gone (firmware #428)

RISING = (
    'the drone rises without thrust, so it is lighter than air and will not land: hold the '
    'tether, and add ballast'
)
HELD_DOWN = (
    'the drone does not sink although it is pushed down, so it is lighter than air and will rise '
    'when its motors stop: hold the tether before you disarm it, and add ballast'
)


@final
class DroneOperation:
    """
    A Crazyflie and its connection.

    Parameters
    ----------
    settings : CrazyflieBridgeSettings
        Which drone, and how it is commanded.
    vehicle : Vehicle
        The vehicle of these settings.
    clock : callable
        Returns the graph time. [ns]
    is_active : callable
        Returns whether commands are accepted.
    run_tick : callable
        Runs a tick with all that belongs to it, `tick` among it.
    serve : callable
        Called before each tick of an operation, as nothing else is served meanwhile.

    Attributes
    ----------
    bridge : BridgeCore
        Commands, readings and safety.

    """

    def __init__(
        self,
        settings: CrazyflieBridgeSettings,
        vehicle: Vehicle,
        clock: Callable[[], int],
        is_active: Callable[[], bool],
        run_tick: Callable[[], None],
        serve: Callable[[], None],
    ) -> None:
        self._settings, self._vehicle = settings, vehicle
        self._clock, self._is_active, self._run_tick = clock, is_active, run_tick
        self._serve = serve
        self._link = CflibLink(settings.uri, LOG_BLOCKS, clock)
        file = self._file = find_crazyflie(settings.vehicle, vehicle.file.name, settings.crazyflie)
        command = settings.command or file.command
        self.bridge = BridgeCore(
            self._link,
            file,
            vehicle,
            command,
            watchdog=settings.watchdog in (command, 'always'),
            blind=settings.blind,
        )
        self._manager: ConnectionManager | None = None
        self._former: ConnectionManager | None = None  # its connection may still be closing
        self._request = SafetyRequest()
        self._was_linked, self._connected = False, 0.0

    @property
    def is_linked(self) -> bool:
        """Whether the drone is connected and its parameters are as expected."""
        return self._manager is not None and self._manager.up

    @property
    def needs_controller(self) -> bool:
        """Whether the controller, which arms separately, has to be armed now."""
        # With the drone, so that its integrators do not wind up before
        return self.bridge.sends_duties and self.bridge.state.stage in ALOFT

    def open(self) -> None:
        """Open the link, and keep it open; raise `BadInput` if another program commands it."""
        if self._former is not None and not self._former.close(0.0):
            raise BadInput(
                'The previous connection to the Crazyflie is still closing; try again in a '
                'few seconds.'
            )
        # Two programs that command one drone would fight each other
        claim = DroneLock(self._settings.uri)
        # The manager releases the lock, because its connection may outlive the caller's interest
        self._manager = ConnectionManager(
            self._link,
            self._file.expected,
            claim.close,
            self._vehicle.battery_compensated,
            partial(is_port_closed, self._settings.uri),
            self._settings.patience,
            hash_airframe(self._vehicle.file, self._file),
        )

    def close(self) -> None:
        """Disarm, and close the link; `land` comes before."""
        if self._manager is not None:
            if self._manager.up:
                self._link.request_arming(False)
            self._manager.close()
            self._former, self._manager = self._manager, None

    def tick(self) -> bool:
        """Step the safety state machine; return whether its stage has changed."""
        linked, now_ns = self.is_linked, self._clock()
        # A new connection: nothing known from the last one is valid
        if linked and not self._was_linked:
            self.bridge.clear_connection_data()
            self._connected = time.monotonic()
        self._was_linked = linked
        # Each request counts for one tick only
        request, self._request = self._request, SafetyRequest()
        before = self.bridge.state.stage
        self.bridge.tick(time.monotonic(), now_ns, linked, self._is_active(), request)
        # A fresh connection needs time for its first log packets
        if linked and time.monotonic() - self._connected > DEAD:
            silence = self._collect_inputs().silence
            if silence > DEAD and self._manager is not None:
                self._manager.reconnect(f'no packets from the Crazyflie for {silence:.1f} s')
        return self.bridge.state.stage is not before

    def wait_for_tick(self) -> None:
        """Run the next tick of an operation."""
        self._serve()
        self._run_tick()
        time.sleep(1.0 / TICK_RATE)

    def arm(self, on: bool, prepare: Callable[[], None]) -> tuple[bool, str]:
        """
        Arm or disarm; return whether it is confirmed, and the stage with its reason.

        `prepare` is called before a drone is armed that is disarmed.
        """
        why = self.bridge.find_arming_refusal(self._clock(), self.is_linked, self._is_active())
        if not self.is_linked and self._manager is not None and self._manager.why:
            why = self._manager.why
        if not (on and why):
            if on and self.bridge.state.stage is SafetyStage.DISARMED:
                prepare()
            self._request = self._request._replace(arm=on)
            self._run_tick()
            while self.bridge.state.stage is SafetyStage.ARMING:
                self.wait_for_tick()
            why = self.bridge.state.why
        stage = self.bridge.state.stage
        armed = stage in (SafetyStage.READY, SafetyStage.FLYING)
        return armed is on, stage.value if armed or not why else f'{stage.value}: {why}'

    def stop(self) -> str:
        """Send an emergency stop, and return the reason for the stage."""
        self._request = self._request._replace(stop=True)
        self._run_tick()
        return self.bridge.state.why

    def land(self) -> bool:
        """
        Tick until no motor turns, as the state machine lands it; return whether it flew.

        Commands must no longer be accepted.
        """
        until = time.monotonic() + LEAVE
        flew = self.bridge.is_busy
        while self.bridge.is_busy and time.monotonic() < until:
            self.wait_for_tick()
        # A request to disarm may be lost: go on until the supervisor confirms it.
        until = min(until, time.monotonic() + DISARM_CONFIRM_TIME)
        while flew and self.is_linked and self.bridge.is_armed and time.monotonic() < until:
            self.wait_for_tick()
        return flew

    def wait_for_reading(self) -> StampedReading | None:
        """Wait for an event of the link, and return its reading, if it has one."""
        event = self._link.events.get()
        if isinstance(event, LinkLost):
            if self._manager is not None:
                self._manager.reconnect(event.why)
        elif isinstance(event, Ping):
            self.bridge.add_round_trip(event.round_trip)
        elif isinstance(event, MalformedPacket):
            self.bridge.malformed.add(event.why)
        else:
            return self.bridge.receive_packet(event)
        return None

    def describe(self) -> list[HealthFact]:
        """Return the health of the link and the drone."""
        manager = self._manager
        why, attempts = (manager.why, manager.attempts) if manager else ('not configured', 0)
        inputs = self._collect_inputs()
        return list(describe_health(self.bridge, why, attempts, self._link.protocol, inputs))

    def _collect_inputs(self) -> SafetyInputs:
        active = self._is_active()
        return self.bridge.collect_safety_inputs(self._clock(), self.is_linked, active)


def describe_health(
    bridge: BridgeCore, why: str, attempts: int, protocol: int, inputs: SafetyInputs
) -> Iterator[HealthFact]:
    """Yield the health of link, safety, packets and commands; `why` explains a missing link."""
    yield _describe_link(bridge, why, attempts, protocol, inputs)
    yield _describe_safety(bridge, inputs)
    yield bridge.malformed.build_fact('packets', 'all can be read')
    yield bridge.unasked.build_fact('commands', 'all can be flown')


def describe_buoyancy(buoyancy: BuoyancyMonitor) -> str:
    """Return the error of a drone that is lighter than air; empty if it is not."""
    return RISING if buoyancy.rises else HELD_DOWN if buoyancy.is_held_down else ''


def _describe_link(
    bridge: BridgeCore, why: str, attempts: int, protocol: int, inputs: SafetyInputs
) -> HealthFact:
    figures = {
        'protocol': protocol,
        'silence_s': f'{inputs.silence:.3f}',
        'latency_s': f'{bridge.trips.latency:.4f}',
        'one_way_s': f'{1e-9 * bridge.trips.one_way_ns:.4f}',
        'drift_ppm': f'{1e6 * bridge.clock.drift:.1f}',
        'clock_restarts': bridge.clock.line.restarts,
        'packets': bridge.packets,
        'attempts': attempts,
    }
    alive = inputs.linked and inputs.silence < SILENT_LINK
    silent = f'no packets for {inputs.silence:.1f} s' if inputs.linked else why
    # A start is no fault yet
    missing = HealthLevel.WARN if silent == CONNECTING else HealthLevel.ERROR
    level, message = (HealthLevel.OK, 'connected') if alive else (missing, silent)
    return HealthFact('link', level, message, {key: str(value) for key, value in figures.items()})


def _describe_safety(bridge: BridgeCore, inputs: SafetyInputs) -> HealthFact:
    state = bridge.state
    duties = () if bridge.motors is None else bridge.motors.duties
    figures = {
        'word': str(inputs.word),
        'command': bridge.command,
        'voltage': f'{inputs.voltage:.2f}',
        'motors': ' '.join(f'{duty:.2f}' for duty in duties),
    }
    level = HealthLevel.OK
    if state.stage is SafetyStage.STOPPED or explain_fault(inputs.word):
        level = HealthLevel.ERROR
    elif state.stage is SafetyStage.LANDING and state.why not in DELIBERATE:
        level = HealthLevel.WARN
    message = f'{state.stage.value}: {state.why}' if state.why else state.stage.value
    if sensor := bridge.find_stuck_sensor():
        level, message = HealthLevel.ERROR, f'{message}; the {sensor} repeats its reading'
    if warning := describe_buoyancy(bridge.buoyancy):
        level, message = HealthLevel.ERROR, f'{message}; {warning}'
    return HealthFact('safety', level, message, figures)
