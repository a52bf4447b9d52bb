"""What a bridge needs of a link to a Crazyflie, and what a link tells; no library named."""

from collections.abc import Mapping, Sequence
from queue import SimpleQueue
import re
from typing import Final, NamedTuple, Protocol

from lta_config.errors import BadInput

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
OLDEST = 9  # protocol: the first with today's setpoint packets (cflib, commander.py)


class LogPacket(NamedTuple):
    """Block name, stamp of 24 bits [ms], values by `group.name`, arrival in graph time [ns]."""

    block: str
    stamp_ms: int
    values: Mapping[str, float]
    arrival_ns: int


class Ping(NamedTuple):
    """What one way to the drone and back took. [s]"""

    round_trip: float


class Malformed(NamedTuple):
    """A packet came that cannot be read, and why."""

    why: str


class Lost(NamedTuple):
    """The link is gone, and why."""

    why: str


Event = LogPacket | Ping | Malformed | Lost


class LinkFailed(RuntimeError):
    """A link did not come up, or a parameter did not do as told; worth another try."""


class Link(Protocol):
    """One connection at a time; `open` and `close` block and are called from one thread."""

    events: SimpleQueue[Event]

    def open(self, deadline: float) -> None:
        """Connect, and ask for all log blocks; `LinkFailed` after a deadline. [s]"""
        ...

    def close(self) -> None:
        """Disconnect; nothing is sent afterwards."""
        ...

    def parameter(self, name: str) -> float | None:
        """Return the value of a parameter; None where the firmware has none of that name."""
        ...

    def write(self, name: str, value: float, deadline: float) -> None:
        """Set a parameter, confirmed by the Crazyflie's own word; `LinkFailed` otherwise. [s]"""
        ...

    def arm(self, on: bool) -> None:
        """Ask to arm or disarm."""
        ...

    def stop(self) -> None:
        """Send one emergency stop."""
        ...

    def watchdog(self) -> None:
        """Keep the firmware's emergency-stop watchdog quiet; the first word starts it."""
        ...

    def hover(self, forward: float, yaw_rate: float, height: float) -> None:
        """Send a speed [m/s], yaw rate [rad/s] and height [m]."""
        ...

    def duties(self, payload: bytes) -> None:
        """Send a packet to the app aboard."""
        ...

    def override(self, duties: Sequence[float]) -> None:
        """Turn motors whatever the firmware's supervisor says; no duties let go of them."""
        ...

    def hand_over(self, land: bool) -> None:
        """Say that no more setpoints come; where asked, land."""
        ...


def check_uri(uri: str) -> None:
    """
    Refuse what cannot name a Crazyflie.

    Raises
    ------
    BadInput
        With an example.

    """
    scheme, _, rest = uri.partition('://')
    if scheme not in SCHEMES or not re.fullmatch(SCHEMES[scheme], rest):
        raise BadInput(
            f"The URI '{uri}' names no Crazyflie; give one such as radio://0/80/2M/E7E7E7E7E7, "
            'usb://0 or udp://127.0.0.1:19850.'
        )


def order_of(motors: Mapping[str, str], names: Sequence[str]) -> tuple[int, ...]:
    """
    Return for M1 to M4 the place of its rotor among the vehicle's.

    Raises
    ------
    BadInput
        If a motor is wired to a rotor that the vehicle does not have.

    """
    for motor, rotor in motors.items():
        if rotor not in names:
            raise BadInput(
                f'Motor {motor} is wired to {rotor}, which the vehicle lacks; it has '
                f'{", ".join(names)}.'
            )
    return tuple(names.index(rotor) for rotor in motors.values())
