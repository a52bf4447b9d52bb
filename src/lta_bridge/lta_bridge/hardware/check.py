"""What `lta hardware check` looks at, in order: what hangs here, who may open it, how it is."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
import time
from typing import final

from lta_bridge.crazyflie.cflib_link import CFLIB, scan_crazyflies
from lta_bridge.crazyflie.drone_lock import DroneLock
from lta_bridge.crazyflie.link import LinkFailed
from lta_bridge.crazyflie.links import create_link
from lta_bridge.crazyflie.log_table import BLOCKS
from lta_bridge.devices import (
    BOARD,
    DRONE,
    find_devices,
    list_serial_ports,
    RADIO,
    SerialPortInfo,
    UsbDevice,
)
from lta_bridge.hardware import board, drone
from lta_bridge.hardware.board import BoardMeasurement
from lta_bridge.hardware.check_result import HardwareCheck, State
from lta_bridge.hardware.drone import DroneMeasurement
from lta_config.command_line import format_lta_command
from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import find_crazyflie
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_model.vehicle import load_vehicle
from lta_vlc.demodulation import plan_bins
from lta_vlc.settings import DemodulationSettings

INSTALL = '.venv/bin/pip install -c constraints.txt -r requirements-hardware.txt'


def judge_devices(
    usb_devices: Sequence[UsbDevice], serial: Sequence[SerialPortInfo]
) -> Iterator[HardwareCheck]:
    """Yield each device with its rights."""
    offered = f'{format_lta_command("hardware", "check", "--udev")} says how, once and for all.'
    for device in usb_devices:
        if device.kind is BOARD:
            continue  # told as a serial port
        name = device.kind.name
        if device.usable:
            yield HardwareCheck(name, 'ok', f'{device.path}')
        else:
            yield HardwareCheck(name, 'fail', f'{device.path}: you may not open it', offered)
    for port in serial:
        name = 'Teensy' if port.teensy else 'serial port'
        if port.usable:
            yield HardwareCheck(name, 'ok', f'{port.path} ({port.about})')
        else:
            state: State = 'fail' if port.teensy else 'warn'
            yield HardwareCheck(name, state, f'{port.path}: you may not open it', offered)
    if any(device.kind is not BOARD for device in usb_devices) and not CFLIB:
        yield HardwareCheck(
            'cflib', 'fail', 'not installed, so no Crazyflie can be heard', INSTALL
        )


def find_drone(uri: str, usb_devices: Sequence[UsbDevice]) -> str:
    """
    Return where a Crazyflie is: as asked for, or the first that answers a scan; empty if none.

    A scan of the radio asks every channel at the address that a Crazyflie is sold with.
    """
    if uri or not CFLIB:
        return uri
    kinds = {device.kind for device in usb_devices if device.usable}
    return next(iter(scan_crazyflies(radio=RADIO in kinds, usb=DRONE in kinds)), '')


def find_board(port: str, serial: Sequence[SerialPortInfo]) -> str:
    """Return where a light board hangs: as asked for, or the first Teensy; empty if none."""
    return port or next((each.path for each in serial if each.teensy and each.usable), '')


def check_any_hardware(
    usb_devices: Sequence[UsbDevice], serial: Sequence[SerialPortInfo], drone: str, board: str
) -> None:
    """
    Refuse to check what is not there.

    Raises
    ------
    BadInput
        If there is no radio, no drone and no board, with what to do.

    """
    if drone or board or usb_devices:
        return
    others = ', '.join(port.path for port in serial)
    aside = f' (serial ports: {others})' if others else ''
    raise BadInput(
        f'No Crazyradio, no Crazyflie and no light board hangs on this machine{aside}; plug one '
        'in, or say where it is: --uri udp://127.0.0.1:19850, --port /dev/ttyACM0.'
    )


@final
@dataclass(frozen=True, slots=True)
class HardwareCheckRequest:
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
class HardwareCheckReport:
    """What is to be said, and the figures behind it, of what was heard."""

    checks: tuple[HardwareCheck, ...]
    drone: DroneMeasurement | None
    board: BoardMeasurement | None


def run_check(
    request: HardwareCheckRequest, tell: Callable[[str, float], None]
) -> HardwareCheckReport:
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
    found, serial = list(find_devices()), list_serial_ports()
    uri, port = find_drone(request.uri, found), find_board(request.port, serial)
    check_any_hardware(found, serial, uri, port)
    checks, drone_heard, board_heard = list(judge_devices(found, serial)), None, None
    if uri:
        drone_heard, said = _check_drone(request, uri, tell)
        checks += said
    if port:
        board_heard, said = _check_board(request, port, tell)
        checks += said
    return HardwareCheckReport(tuple(checks), drone_heard, board_heard)


def _check_drone(
    request: HardwareCheckRequest, uri: str, tell: Callable[[str, float], None]
) -> tuple[DroneMeasurement | None, list[HardwareCheck]]:
    craft = load_vehicle(request.vehicle)
    file = find_crazyflie(request.vehicle, craft.file.name)
    link = create_link(uri, BLOCKS, time.time_ns)
    tell(f'connecting to {uri}', 0.0)
    with closing(DroneLock(uri)), closing(link):  # two would take each other's answers
        try:
            link.open(drone.DEADLINE)
        except LinkFailed as error:
            remedy = 'Switch it on, bring it near, and see that no other program has the link.'
            return None, [HardwareCheck('link', 'fail', f'{uri}: {error}', remedy)]
        heard = drone.measure_drone(
            link, uri, file, request.seconds,
            lambda been: tell('listening to the Crazyflie', been / request.seconds),
        )  # fmt: skip
    return heard, list(drone.judge_drone(heard, file, craft.battery_compensated))


def _check_board(
    request: HardwareCheckRequest, port: str, tell: Callable[[str, float], None]
) -> tuple[BoardMeasurement, list[HardwareCheck]]:
    light = load_topic_table().light
    diodes = load_vehicle_file(request.vehicle).sensors.diodes
    settings = DemodulationSettings(frequency=request.frequency)
    bins = plan_bins(settings, light.sample_rate.si, light.samples)
    heard = board.measure_board(
        port, light, diodes, bins, request.seconds,
        lambda been: tell('listening to the light board', been / request.seconds),
    )  # fmt: skip
    return heard, list(board.judge_board(heard, light, settings.threshold))
