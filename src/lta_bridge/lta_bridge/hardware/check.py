"""What `lta hardware check` looks at, in order: what hangs here, who may open it, how it is."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
import time
from typing import final

from lta_bridge.crazyflie.cflib_link import CFLIB, scanned
from lta_bridge.crazyflie.claim import Claim
from lta_bridge.crazyflie.link import LinkFailed
from lta_bridge.crazyflie.links import link_to
from lta_bridge.crazyflie.log_table import BLOCKS
from lta_bridge.devices import BOARD, devices, DRONE, Found, Port, ports, RADIO
from lta_bridge.hardware import board, drone
from lta_bridge.hardware.board import BoardHeard
from lta_bridge.hardware.check_result import Check, State
from lta_bridge.hardware.drone import DroneHeard
from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import crazyflie_of
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import topic_table
from lta_config.typed import typed
from lta_model.vehicle import load_vehicle
from lta_vlc.demodulation import plan_bins
from lta_vlc.settings import Demodulation

INSTALL = '.venv/bin/pip install -c constraints.txt -r requirements-hardware.txt'


def found_here(found: Sequence[Found], serial: Sequence[Port]) -> Iterator[Check]:
    """Yield each device with its rights."""
    offered = f'{typed("hardware", "check", "--udev")} says how, once and for all.'
    for device in found:
        if device.kind is BOARD:
            continue  # told as a serial port
        name = device.kind.name
        if device.usable:
            yield Check(name, 'ok', f'{device.path}')
        else:
            yield Check(name, 'fail', f'{device.path}: you may not open it', offered)
    for port in serial:
        name = 'Teensy' if port.teensy else 'serial port'
        if port.usable:
            yield Check(name, 'ok', f'{port.path} ({port.about})')
        else:
            state: State = 'fail' if port.teensy else 'warn'
            yield Check(name, state, f'{port.path}: you may not open it', offered)
    if any(device.kind is not BOARD for device in found) and not CFLIB:
        yield Check('cflib', 'fail', 'not installed, so no Crazyflie can be heard', INSTALL)


def drone_at(uri: str, found: Sequence[Found]) -> str:
    """
    Return where a Crazyflie is: as asked for, or the first that answers a scan; empty if none.

    A scan of the radio asks every channel at the address that a Crazyflie is sold with.
    """
    if uri or not CFLIB:
        return uri
    kinds = {device.kind for device in found if device.usable}
    return next(iter(scanned(radio=RADIO in kinds, usb=DRONE in kinds)), '')


def board_at(port: str, serial: Sequence[Port]) -> str:
    """Return where a light board hangs: as asked for, or the first Teensy; empty if none."""
    return port or next((each.path for each in serial if each.teensy and each.usable), '')


def refuse_nothing(found: Sequence[Found], serial: Sequence[Port], drone: str, board: str) -> None:
    """
    Refuse to check what is not there.

    Raises
    ------
    BadInput
        If there is no radio, no drone and no board, with what to do.

    """
    if drone or board or found:
        return
    others = ', '.join(port.path for port in serial)
    aside = f' (serial ports: {others})' if others else ''
    raise BadInput(
        f'No Crazyradio, no Crazyflie and no light board hangs on this machine{aside}; plug one '
        'in, or say where it is: --uri udp://127.0.0.1:19850, --port /dev/ttyACM0.'
    )


@final
@dataclass(frozen=True, slots=True)
class Asked:
    """
    What to look at.

    Attributes
    ----------
    uri, port : str
        Where drone and light board are; looked for where empty.
    vehicle : str
        Name or file.
    frequency : float
        At which the lamp flickers. [Hz]
    seconds : float
        How long to listen to each. [s]

    """

    uri: str
    port: str
    vehicle: str
    frequency: float
    seconds: float


@final
@dataclass(frozen=True, slots=True)
class Outcome:
    """What is to be said, and the figures behind it, of what was heard."""

    checks: tuple[Check, ...]
    drone: DroneHeard | None
    board: BoardHeard | None


def checked(asked: Asked, tell: Callable[[str, float], None]) -> Outcome:
    """
    Look at all that hangs here.

    Parameters
    ----------
    asked : Asked
        What to look at.
    tell : callable
        Told what is done, and how much of it: 0 to 1.

    Raises
    ------
    BadInput
        If nothing is there, what was named cannot be opened, or another program commands it.

    """
    tell('looking around', 0.0)
    found, serial = list(devices()), ports()
    uri, port = drone_at(asked.uri, found), board_at(asked.port, serial)
    refuse_nothing(found, serial, uri, port)
    checks, drone_heard, board_heard = list(found_here(found, serial)), None, None
    if uri:
        drone_heard, said = _drone(asked, uri, tell)
        checks += said
    if port:
        board_heard, said = _board(asked, port, tell)
        checks += said
    return Outcome(tuple(checks), drone_heard, board_heard)


def _drone(
    asked: Asked, uri: str, tell: Callable[[str, float], None]
) -> tuple[DroneHeard | None, list[Check]]:
    craft = load_vehicle(asked.vehicle)
    file = crazyflie_of(asked.vehicle, craft.file.name)
    link = link_to(uri, BLOCKS, time.time_ns)
    tell(f'connecting to {uri}', 0.0)
    with closing(Claim(uri)), closing(link):  # two would take each other's answers
        try:
            link.open(drone.DEADLINE)
        except LinkFailed as error:
            remedy = 'Switch it on, bring it near, and see that no other program has the link.'
            return None, [Check('link', 'fail', f'{uri}: {error}', remedy)]
        heard = drone.listen(
            link, uri, file, asked.seconds,
            lambda been: tell('listening to the Crazyflie', been / asked.seconds),
        )  # fmt: skip
    return heard, list(drone.judged(heard, file, craft.battery_compensated))


def _board(
    asked: Asked, port: str, tell: Callable[[str, float], None]
) -> tuple[BoardHeard, list[Check]]:
    light = topic_table().light
    diodes = load_vehicle_file(asked.vehicle).sensors.diodes
    settings = Demodulation(frequency=asked.frequency)
    bins = plan_bins(settings, light.sample_rate.si, light.samples)
    heard = board.listen(
        port, light, diodes, bins, asked.seconds,
        lambda been: tell('listening to the light board', been / asked.seconds),
    )  # fmt: skip
    return heard, list(board.judged(heard, light, settings.threshold))
