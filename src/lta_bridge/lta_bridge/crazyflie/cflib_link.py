# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Link to a Crazyflie through Bitcraze's cflib (GPL, an optional extra).

Only this module imports cflib. Its workarounds answer four properties of cflib: it waits forever
if a datagram is lost while it connects, does not report a silent peer, blocks in `close_link`, and
sends a zero thrust there. So every wait here has a deadline, each attempt uses a new cflib object
that sends nothing as it closes, and the bridge judges liveness by received packets
(docs/hardware.md).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
import logging
import math
from queue import Empty, SimpleQueue
import re
import threading
import time
from typing import Any, Final, final
import warnings

from lta_bridge.crazyflie.connection_manager import suggest_remedy
from lta_bridge.crazyflie.device_clock import parse_ping_time
from lta_bridge.crazyflie.link import (
    Event,
    LinkFailed,
    LinkLost,
    LogPacket,
    MalformedPacket,
    OLDEST,
    Ping,
)
from lta_bridge.crazyflie.log_table import block_size, find_packet_fault, LogBlock
from lta_config.errors import BadInput

try:
    # cflib shows every DeprecationWarning, also those of its own libraries
    with warnings.catch_warnings(record=True):
        import cflib.crazyflie
        import cflib.crazyflie.log
        import cflib.crtp
except ImportError:  # reported when a link is created
    CFLIB = False
else:
    CFLIB = True

HOST_AND_PORT: Final = r'[^/:\s]+:\d{1,5}'  # host:port
RADIO_RATES: Final = r'(250K|1M|2M)'
ADDRESS: Final = r'[0-9A-Fa-f]{1,10}'  # five bytes in hexadecimal
SCHEMES: Final = {  # URI scheme to a pattern of the rest, as cflib parses it
    'radio': rf'(\d+|{ADDRESS})/\d{{1,3}}(/{RADIO_RATES}(/{ADDRESS})?)?(\?rate_limit=\d+)?',
    'usb': r'\d+',
    'udp': HOST_AND_PORT,
    'tcp': HOST_AND_PORT,
    'serial': r'\S+',
}
FIRMWARE_LANDING_TIME: Final = 3.0  # s, duration of the firmware's landing
U8 = 0x08  # parameter type code of the firmware
ECHO: Final = (15, 0)  # CRTP port and channel whose packets are echoed
CLOSING: Final = 3.0  # s; cflib needs two at most, but blocks forever if its driver has failed
# cflib's list of drivers is global to the process
DRIVERS = threading.Lock()


def check_uri(uri: str) -> None:
    """Raise `BadInput` for a URI that cflib does not understand."""
    scheme, _, rest = uri.partition('://')
    if scheme not in SCHEMES or not re.fullmatch(SCHEMES[scheme], rest):
        raise BadInput(
            f"'{uri}' is not a valid Crazyflie URI; give one such as radio://0/80/2M/E7E7E7E7E7, "
            'usb://0 or udp://127.0.0.1:19850.'
        )


def _register_drivers() -> None:
    """Register cflib's link drivers once; safe to call from any thread."""
    with DRIVERS:
        if not cflib.crtp.CLASSES:
            cflib.crtp.init_drivers(enable_serial_driver=True)
            # The bridge reports faults itself, in one sentence; cflib would log tracebacks.
            logging.getLogger('cflib').setLevel(logging.CRITICAL)


def scan_crazyflies(radio: bool, usb: bool) -> Iterator[str]:
    """
    Yield the URIs of Crazyflies that answer by radio or USB; cflib fails without such a device.

    UDP is not scanned: an emulated drone answers the last sender, which would take its packets
    away from another bridge.
    """
    _register_drivers()
    drivers = {'RadioDriver': radio, 'UsbDriver': usb}
    for driver in cflib.crtp.CLASSES:
        if drivers.get(driver.__name__):
            # cflib's own scan of all drivers ends at the first one that fails.
            try:
                interfaces = driver().scan_interface(None)
            except Exception:  # the USB libraries raise various types
                continue
            yield from (uri for uri, _ in interfaces)


@final
class CflibLink:
    """
    Link to one Crazyflie; see `lta_bridge.crazyflie.link.CrazyflieLink`.

    Parameters
    ----------
    uri : str
        URI with one of `SCHEMES`.
    blocks : sequence of LogBlock
        Log blocks to start.
    clock : callable
        Returns the graph time. [ns]

    Raises
    ------
    BadInput
        If the URI is invalid, or cflib is not installed.

    """

    def __init__(self, uri: str, blocks: Sequence[LogBlock], clock: Callable[[], int]) -> None:
        check_uri(uri)
        if not CFLIB:
            raise BadInput(
                'The connection to a Crazyflie needs the Python package cflib, which is not '
                'installed; run "pip install cflib", in a source tree ".venv/bin/pip install '
                '-c constraints.txt -r requirements-hardware.txt".'
            )
        _register_drivers()
        self._uri, self._blocks, self._clock = uri, blocks, clock
        self._drone: Any = None  # the cflib object in use
        self._opened: Any = None  # the cflib object to close
        self._sizes: dict[int, int] = {}  # bytes of values by log block number
        self.events: SimpleQueue[Event] = SimpleQueue()
        self._fault = ''  # of the packet that cflib is about to read
        self.protocol = -1

    def open(self, deadline: float) -> None:
        """Connect and start all log blocks within a time [s]."""
        until = time.monotonic() + deadline
        drone = self._opened = self._drone = cflib.crazyflie.Crazyflie()
        # cflib's callbacks run in its own threads; an empty text means success
        outcome: SimpleQueue[str] = SimpleQueue()
        drone.fully_connected.add_callback(lambda _: outcome.put(''))
        for caller in (drone.connection_failed, drone.connection_lost):
            caller.add_callback(lambda _, why: outcome.put(suggest_remedy(str(why))))
        drone.connection_lost.add_callback(self._guard_callback(drone, self._on_link_lost))
        drone.packet_received.add_callback(self._guard_callback(drone, self._check_packet))
        drone.add_header_callback(self._guard_callback(drone, self._on_ping), *ECHO)
        drone.open_link(self._uri)
        try:
            why = outcome.get(timeout=deadline)
        except Empty:
            why = f'no Crazyflie answered at {self._uri} within {deadline:.0f} s'
        self.protocol = drone.platform.get_protocol_version()
        if not why and self.protocol < OLDEST:
            why = (
                f'the firmware has protocol version {self.protocol}, but must have {OLDEST} or '
                'newer: update the firmware'
            )
        try:
            if why:
                raise LinkFailed(why)
            self._start_logging(drone, until)
        except LinkFailed:
            self.close()
            raise

    def _guard_callback(self, drone: object, callback: Callable[..., None]) -> Callable[..., None]:
        """Return a callback that ignores calls of a cflib object no longer in use."""

        def call_if_current(*words: object) -> None:
            if self._drone is drone:
                callback(*words)

        return call_if_current

    def _on_link_lost(self, _: str, why: str) -> None:
        self.events.put(LinkLost(suggest_remedy(str(why))))

    def _check_packet(self, packet: Any) -> None:
        """Check a packet; cflib reads it next, in the same thread."""
        self._fault = find_packet_fault(
            packet.port, packet.channel, bytes(packet.data), self._sizes
        )
        if self._fault:
            self.events.put(MalformedPacket(self._fault))

    def _on_ping(self, echo: Any) -> None:
        """Measure the round trip of cflib's ping, which carries its send time."""
        if (sent := parse_ping_time(echo.data)) is not None:
            self.events.put(Ping(time.time() - sent))

    def _start_logging(self, drone: Any, until: float) -> None:
        """Start every log block; wait for all confirmations until a monotonic time."""
        outcomes: SimpleQueue[tuple[str, str]] = SimpleQueue()
        for block in self._blocks:
            config = cflib.crazyflie.log.LogConfig(block.name, block.period_ms)
            for name, kind in block.variables.items():
                config.add_variable(name, kind)
            callback = partial(self._on_log_packet, block.name)
            config.data_received_cb.add_callback(self._guard_callback(drone, callback))
            config.started_cb.add_callback(lambda one, _: outcomes.put((one.name, '')))
            config.error_cb.add_callback(lambda one, why: outcomes.put((one.name, str(why))))
            try:
                drone.log.add_config(config)
                # Before the start: the first packet may arrive before start() returns
                self._sizes[config.id] = block_size(block)
                config.start()
            except (KeyError, AttributeError) as error:
                raise LinkFailed(
                    f'the firmware cannot log the block {block.name} ({error}): update the '
                    'firmware'
                ) from None
        waiting = {block.name for block in self._blocks}
        while waiting:
            try:
                name, why = outcomes.get(timeout=max(0.0, until - time.monotonic()))
            except Empty:
                late = ', '.join(sorted(waiting))
                raise LinkFailed(
                    f'the Crazyflie did not start the log blocks {late} in time: switch it off '
                    'and on'
                ) from None
            if why:
                raise LinkFailed(
                    f'the Crazyflie refused the log block {name} ({why}): switch it off and on, '
                    'or update its firmware'
                )
            waiting.discard(name)

    def _on_log_packet(
        self, name: str, stamp_ms: int, values: Mapping[str, float], _: object
    ) -> None:
        if not self._fault:  # set for this packet by _check_packet just before
            self.events.put(LogPacket(name, stamp_ms, values, self._clock()))

    def close(self) -> None:
        """Disconnect; takes up to two seconds. A flying or landing drone continues."""
        drone, self._drone, self._opened = self._opened, None, None
        self._sizes = {}
        if drone is not None:
            # cflib sends a zero thrust as it closes, which would drop a drone that is landing.
            # Its threads also keep sending, and would print a traceback on the closed socket.
            drone.send_packet = lambda *_, **__: None
            # Stop the reader while packets still arrive: later it would wait 1 s for the next.
            drone.incoming.stop()
            # A daemon thread, so that a close_link that blocks cannot keep the process alive
            closer = threading.Thread(target=drone.close_link, name='cflib_close', daemon=True)
            closer.start()
            closer.join(CLOSING)

    def read_parameter(self, name: str) -> float | None:
        """Return the last value received, in the firmware's unit."""
        group, _, word = name.partition('.')
        text = self._drone.param.values.get(group, {}).get(word)
        return None if text is None else float(text)

    def write_parameter(self, name: str, value: float, deadline: float) -> None:
        """Set a parameter and wait for its confirmation within a time [s]."""
        group, _, word = name.partition('.')
        echoes: SimpleQueue[float] = SimpleQueue()
        param = self._drone.param
        callback = lambda _, text: echoes.put(float(text))  # noqa: E731 - removed by the same name
        param.add_update_callback(group, word, callback)
        try:
            # cflib packs integer parameters with struct, which rejects floats
            param.set_value(name, value if value % 1.0 else int(value))
            if echoes.get(timeout=deadline) != value:
                raise LinkFailed(
                    f'the Crazyflie did not accept the value {value:g} for its parameter {name}: '
                    'switch it off and on'
                )
        except AttributeError:  # cflib raises it for a read-only parameter
            raise LinkFailed(
                f'the parameter {name} of the firmware is read-only, so it cannot be set to '
                f'{value:g}: remove it from the Crazyflie file'
            ) from None
        except Empty:
            raise LinkFailed(
                f'the Crazyflie did not confirm its parameter {name} within {deadline:.0f} s: '
                'bring it closer to the radio, or switch it off and on'
            ) from None
        finally:
            param.remove_update_callback(group, word, callback)

    def request_arming(self, on: bool) -> None:
        """Request arming or disarming; cflib picks the port that the firmware's protocol needs."""
        # cflib warns on each call to firmware that has the older port only
        with warnings.catch_warnings(action='ignore'):
            self._call_cflib('supervisor', 'send_arming_request', on)

    def send_emergency_stop(self) -> None:
        """Send one emergency stop."""
        with warnings.catch_warnings(action='ignore'):
            self._call_cflib('supervisor', 'send_emergency_stop')
        # An emergency stop does not stop motors under an override, whoever enabled it.
        self._call_cflib('param', 'set_value_raw', 'motorPowerSet.enable', U8, 0)

    def feed_watchdog(self) -> None:
        """Reset the firmware's emergency-stop watchdog for another second."""
        with warnings.catch_warnings(action='ignore'):
            self._call_cflib('supervisor', 'send_emergency_stop_watchdog')

    def send_hover_setpoint(self, forward: float, yaw_rate: float, height: float) -> None:
        """Send speed [m/s], yaw rate [rad/s] and height [m]."""
        self._call_cflib(
            # The firmware expects the yaw rate in deg/s
            'commander',
            'send_hover_setpoint',
            forward,
            0.0,
            math.degrees(yaw_rate),
            height,
        )

    def send_duties(self, payload: bytes) -> None:
        """Send a packet on the app channel."""
        self._call_cflib('appchannel', 'send_packet', payload)

    def hand_over(self, land: bool) -> None:
        """Release the commander, and where `land`, let the high-level commander land."""
        # Until this message the firmware gives streamed setpoints priority over the landing
        self._call_cflib('commander', 'send_notify_setpoint_stop')
        if land:
            self._call_cflib('high_level_commander', 'land', 0.0, FIRMWARE_LANDING_TIME)

    def _call_cflib(self, part: str, method: str, *words: object) -> None:
        """Call a method of cflib if there is a link; the link may fail at any moment."""
        drone = self._drone
        if drone is None:
            return
        try:
            getattr(getattr(drone, part), method)(*words)
        except Exception as error:  # drivers raise various types, and cflib's lock stays taken
            self._drone = None
            self._on_link_lost('', f'{type(error).__name__}: {error}')
