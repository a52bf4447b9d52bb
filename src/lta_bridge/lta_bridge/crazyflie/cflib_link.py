"""
The link by Bitcraze's cflib (GPL, an optional extra): the one place that imports it.

cflib waits for ever where a datagram is lost while it connects, says nothing when a peer falls
silent, blocks while it closes, and parts with a thrust of zero. So every wait here has a deadline,
each attempt has an object of its own, which says nothing as it goes, and liveness is judged
elsewhere, by what arrives (docs/hardware.md).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
import logging
import math
from queue import Empty, SimpleQueue
import threading
import time
from typing import Any, Final, final
import warnings

from lta_bridge.crazyflie.link import (
    Event,
    LinkFailed,
    LinkLost,
    LogPacket,
    MalformedPacket,
    OLDEST,
    Ping,
)
from lta_bridge.crazyflie.log_table import LogBlock
from lta_bridge.crazyflie.packet_check import block_size, find_packet_fault
from lta_bridge.crazyflie.remedies import suggest_remedy
from lta_bridge.crazyflie.round_trips import parse_ping_time
from lta_config.errors import BadInput

try:
    import cflib.crazyflie
    import cflib.crazyflie.log
    import cflib.crtp
except ImportError:  # told when a link is made, with the remedy
    CFLIB = False
else:
    CFLIB = True

PLACE: Final = r'[^/:\s]+:\d{1,5}'
RATE: Final = r'(250K|1M|2M)'
ADDRESS: Final = r'[0-9A-Fa-f]{1,10}'
SCHEMES: Final = {  # what comes behind ://, as cflib reads it
    'radio': rf'(\d+|{ADDRESS})/\d{{1,3}}(/{RATE}(/{ADDRESS})?)?(\?rate_limit=\d+)?',
    'usb': r'\d+',
    'udp': PLACE,
    'tcp': PLACE,
    'serial': r'\S+',
}
LANDING: Final = 3.0  # s for the firmware's own landing
U8, U16 = 0x08, 0x09  # the firmware's numbers for types of parameters
FULL_RATIO: Final = 65535
ECHO: Final = (15, 0)  # port and channel whose packets come back
CLOSING: Final = 3.0  # s; cflib takes two at most, or for ever where its driver has failed
PARTING: Final = 3  # times that motors are let go of before a link is closed
DRIVERS = threading.Lock()


def _register_drivers() -> None:
    """Register cflib's link drivers once, in whatever thread comes first."""
    with DRIVERS:
        if not cflib.crtp.CLASSES:
            cflib.crtp.init_drivers(enable_serial_driver=True)
            # What goes wrong is told in one sentence by who asked; cflib logs whole tracebacks.
            logging.getLogger('cflib').setLevel(logging.CRITICAL)


def scan_crazyflies(radio: bool, usb: bool) -> Iterator[str]:
    """
    Yield the URIs of Crazyflies that answer, by radio and on a cable.

    UDP is not asked: an emulated drone answers whoever spoke last, and may be flying for another.

    Parameters
    ----------
    radio, usb : bool
        Whether to ask a Crazyradio, and the USB ports; cflib fails without them.

    """
    _register_drivers()
    wanted = {'RadioDriver': radio, 'UsbDriver': usb}
    for driver in cflib.crtp.CLASSES:
        if wanted.get(driver.__name__):
            # cflib's own scan of all drivers ends at the first that cannot.
            try:
                found = driver().scan_interface(None)
            except Exception:  # whatever a dongle's library raises
                continue
            yield from (uri for uri, _ in found)


@final
class CflibLink:
    """
    One Crazyflie by cflib; see `lta_bridge.crazyflie.link.CrazyflieLink`.

    Parameters
    ----------
    uri : str
        Where it is, one of `SCHEMES`.
    blocks : sequence of Block
        What to log.
    clock : callable
        Graph time. [ns]

    Raises
    ------
    BadInput
        If cflib is not installed.

    """

    def __init__(self, uri: str, blocks: Sequence[LogBlock], clock: Callable[[], int]) -> None:
        if not CFLIB:
            raise BadInput(
                'A Crazyflie needs cflib, which is not installed: .venv/bin/pip install -c '
                'constraints.txt -r requirements-hardware.txt.'
            )
        _register_drivers()
        self._uri, self._blocks, self._clock = uri, blocks, clock
        self._drone: Any = None  # that is spoken to
        self._opened: Any = None  # that is to be closed
        self._sizes: dict[int, int] = {}  # bytes of values, by the number of a log block
        self._overrides = False  # whether motors were turned past the firmware's supervisor
        self.events: SimpleQueue[Event] = SimpleQueue()
        self._fault, self.protocol = '', -1  # of the packet that is read now; of the firmware

    def open(self, deadline: float) -> None:
        """Connect, and ask for all log blocks, until a deadline from now. [s]"""
        until = time.monotonic() + deadline
        drone = self._opened = self._drone = cflib.crazyflie.Crazyflie()
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
            why = f'the firmware speaks protocol {self.protocol}, older than {OLDEST}: update it'
        try:
            if why:
                raise LinkFailed(why)
            self._start_logging(drone, until)
        except LinkFailed:
            self.close()
            raise

    def _guard_callback(self, drone: object, callback: Callable[..., None]) -> Callable[..., None]:
        """Return a callback that is deaf to every drone object but the present one."""

        def call_if_current(*words: object) -> None:
            if self._drone is drone:
                callback(*words)

        return call_if_current

    def _on_link_lost(self, _: str, why: str) -> None:
        self.events.put(LinkLost(suggest_remedy(str(why))))

    def _check_packet(self, packet: Any) -> None:  # noqa: ANN401 - untyped library
        """Look at a packet before cflib reads it, in the same thread."""
        self._fault = find_packet_fault(
            packet.port, packet.channel, bytes(packet.data), self._sizes
        )
        if self._fault:
            self.events.put(MalformedPacket(self._fault))

    def _on_ping(self, echo: Any) -> None:  # noqa: ANN401 - untyped library
        """Take back what cflib sends ten times a second: when it did so."""
        if (sent := parse_ping_time(echo.data)) is not None:
            self.events.put(Ping(time.time() - sent))

    def _start_logging(self, drone: Any, until: float) -> None:  # noqa: ANN401 - untyped library
        """Start every block; all must be confirmed by a deadline."""
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
                self._sizes[config.id] = block_size(block)
                config.start()
            except (KeyError, AttributeError) as error:
                raise LinkFailed(f'log block {block.name} cannot be had: {error}') from None
        waiting = {block.name for block in self._blocks}
        while waiting:
            try:
                name, why = outcomes.get(timeout=max(0.0, until - time.monotonic()))
            except Empty:
                late = ', '.join(sorted(waiting))
                raise LinkFailed(f'log blocks did not start: {late}') from None
            if why:
                raise LinkFailed(f'log block {name} was refused: {why}')
            waiting.discard(name)

    def _on_log_packet(
        self, name: str, stamp_ms: int, values: Mapping[str, float], _: object
    ) -> None:
        if not self._fault:
            self.events.put(LogPacket(name, stamp_ms, values, self._clock()))

    def close(self) -> None:
        """Disconnect, which takes up to two seconds; what still flies or lands goes on with it."""
        if self._overrides:
            for _ in range(PARTING):
                self.override_motors(())
        drone, self._drone, self._opened = self._opened, None, None
        self._overrides, self._sizes = False, {}
        if drone is not None:
            # cflib's last word is a thrust of zero: it would drop a drone that lands by itself.
            # Its threads send on meanwhile, and end in a traceback on the socket that is gone.
            drone.send_packet = lambda *_, **__: None
            # Stop the reader while packets still come: afterwards it would wait 1 s for the next.
            drone.incoming.stop()
            leaving = threading.Thread(target=drone.close_link, name='cflib_close', daemon=True)
            leaving.start()
            leaving.join(CLOSING)

    def read_parameter(self, name: str) -> float | None:
        """Return the value read when the link came up, or since, in the firmware's unit."""
        group, _, word = name.partition('.')
        text = self._drone.param.values.get(group, {}).get(word)
        return None if text is None else float(text)

    def write_parameter(self, name: str, value: float, deadline: float) -> None:
        """Set a parameter and wait for the value to come back, until a deadline from now. [s]"""
        group, _, word = name.partition('.')
        echoes: SimpleQueue[float] = SimpleQueue()
        param = self._drone.param
        callback = lambda _, text: echoes.put(float(text))  # noqa: E731 - removed by the same name
        param.add_update_callback(group, word, callback)
        try:
            param.set_value(name, value if value % 1.0 else int(value))
            if echoes.get(timeout=deadline) != value:
                raise LinkFailed(f'parameter {name} did not become {value:g}')
        except AttributeError:  # cflib's word for one that is read-only
            raise LinkFailed(f'parameter {name} cannot be written') from None
        except Empty:
            raise LinkFailed(f'parameter {name} was not confirmed in {deadline:.0f} s') from None
        finally:
            param.remove_update_callback(group, word, callback)

    def request_arming(self, on: bool) -> None:
        """Ask to arm or disarm; firmware before protocol 12 is asked on its own port."""
        with warnings.catch_warnings(action='ignore'):
            self._call_cflib('supervisor', 'send_arming_request', on)

    def send_emergency_stop(self) -> None:
        """Send one emergency stop."""
        with warnings.catch_warnings(action='ignore'):
            self._call_cflib('supervisor', 'send_emergency_stop')
        # Whoever turned the override on: a stop does not reach motors through it.
        self._call_cflib('param', 'set_value_raw', 'motorPowerSet.enable', U8, 0)

    def feed_watchdog(self) -> None:
        """Keep the firmware's emergency-stop watchdog quiet for another second."""
        with warnings.catch_warnings(action='ignore'):
            self._call_cflib('supervisor', 'send_emergency_stop_watchdog')

    def send_hover_setpoint(self, forward: float, yaw_rate: float, height: float) -> None:
        """Send speed [m/s], yaw rate [rad/s] and height [m]; cflib takes degrees a second."""
        self._call_cflib(
            'commander', 'send_hover_setpoint', forward, 0.0, math.degrees(yaw_rate), height
        )

    def send_duties(self, payload: bytes) -> None:
        """Send a packet on the app channel."""
        self._call_cflib('appchannel', 'send_packet', payload)

    def override_motors(self, duties: Sequence[float]) -> None:
        """
        Set `motorPowerSet`, without waiting for an answer: the next one comes soon.

        Enabled last and disabled first, so that no motor turns by what an earlier one left.
        """
        self._overrides |= bool(duties)
        ratios = [round(FULL_RATIO * min(1.0, max(0.0, duty))) for duty in duties] or [0] * 4
        motors = [(f'motorPowerSet.m{n}', U16, ratio) for n, ratio in enumerate(ratios, start=1)]
        enable = ('motorPowerSet.enable', U8, int(bool(duties)))
        for words in (*motors, enable) if duties else (enable, *motors):
            self._call_cflib('param', 'set_value_raw', *words)

    def hand_over(self, land: bool) -> None:
        """Let go of the commander, and have the high-level one land."""
        self._call_cflib('commander', 'send_notify_setpoint_stop')
        if land:
            self._call_cflib('high_level_commander', 'land', 0.0, LANDING)

    def _call_cflib(self, part: str, method: str, *words: object) -> None:
        """Send where there is a link; it may go at any moment, in the middle of this too."""
        drone = self._drone
        if drone is None:
            return
        try:
            getattr(getattr(drone, part), method)(*words)
        except Exception as error:  # whatever a driver raises, and cflib's lock stays taken then
            self._drone = None
            self._on_link_lost('', f'{type(error).__name__}: {error}')


LINK: Final = CflibLink
