# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check the connected hardware for `lta hardware check`: devices, access rights, measurements."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
import math
import time
from typing import Any, final

from lta_bridge.crazyflie.cflib_link import CFLIB, CflibLink, scan_crazyflies
from lta_bridge.crazyflie.connection_manager import CONNECT_TIME
from lta_bridge.crazyflie.drone_lock import DroneLock
from lta_bridge.crazyflie.link import LinkFailed
from lta_bridge.crazyflie.log_table import LOG_BLOCKS
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
from lta_bridge.hardware.board import BoardMeasurement, DiodeMeasurement
from lta_bridge.hardware.check_result import HardwareCheck, State
from lta_bridge.hardware.drone import DroneMeasurement, StreamStatistics
from lta_config.command_line import format_lta_command
from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import find_crazyflie, hash_airframe, hash_diodes
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_model.vehicle import load_vehicle
from lta_vlc.demodulation import plan_bins
from lta_vlc.settings import DemodulationSettings

INSTALL = (
    'Run "pip install cflib", in a source tree ".venv/bin/pip install -c constraints.txt -r '
    'requirements-hardware.txt".'
)


def assess_device_access(
    usb_devices: Sequence[UsbDevice], serial: Sequence[SerialPortInfo]
) -> Iterator[HardwareCheck]:
    """Yield a check of the access rights of each device."""
    command = format_lta_command('hardware', 'check', '--udev')
    remedy = f'Install the udev rules that "{command}" prints.'
    for device in usb_devices:
        if device.kind is BOARD:
            continue  # listed as a serial port
        name = device.kind.name
        if device.usable:
            yield HardwareCheck(name, 'ok', f'{device.path}')
        else:
            yield HardwareCheck(name, 'fail', f'{device.path}: no permission to open it', remedy)
    for port in serial:
        name = 'Teensy' if port.teensy else 'serial port'
        if port.usable:
            yield HardwareCheck(name, 'ok', f'{port.path} ({port.about})')
        else:
            state: State = 'fail' if port.teensy else 'warn'
            yield HardwareCheck(name, state, f'{port.path}: no permission to open it', remedy)
    if any(device.kind is not BOARD for device in usb_devices) and not CFLIB:
        yield HardwareCheck(
            'cflib',
            'fail',
            'the Python package cflib is missing, so no Crazyflie can be checked',
            INSTALL,
        )


def find_drone(uri: str, usb_devices: Sequence[UsbDevice]) -> str:
    """
    Return the given URI, or that of the first Crazyflie that answers a scan; empty if none does.

    A radio scan tries every channel at the factory address of a Crazyflie.
    """
    if uri or not CFLIB:
        return uri
    kinds = {device.kind for device in usb_devices if device.usable}
    return next(iter(scan_crazyflies(radio=RADIO in kinds, usb=DRONE in kinds)), '')


def find_board(port: str, serial: Sequence[SerialPortInfo]) -> str:
    """Return the given port, or that of the first usable Teensy; empty if there is none."""
    return port or next((each.path for each in serial if each.teensy and each.usable), '')


def require_hardware(
    usb_devices: Sequence[UsbDevice], serial: Sequence[SerialPortInfo], drone: str, board: str
) -> None:
    """Check that there is any hardware; raise BadInput if there is no radio, drone or board."""
    if drone or board or usb_devices:
        return
    others = ', '.join(port.path for port in serial)
    aside = f' (serial ports: {others})' if others else ''
    raise BadInput(
        f'No Crazyradio, Crazyflie or light board is connected to this machine{aside}; plug one '
        'in, or give its address, as in --uri udp://127.0.0.1:19850 or --port /dev/ttyACM0.'
    )


@final
@dataclass(frozen=True, slots=True)
class HardwareCheckRequest:
    """What to check."""

    # Addresses of drone and light board; searched for if empty
    uri: str
    port: str
    vehicle: str  # vehicle name or file
    frequency: float  # modulation frequency of the lamp [Hz]
    seconds: float  # duration of each measurement [s]


@final
@dataclass(frozen=True, slots=True)
class HardwareCheckReport:
    """All checks, and the measurements of drone and board if there were any."""

    checks: tuple[HardwareCheck, ...]
    drone: DroneMeasurement | None
    board: BoardMeasurement | None


def run_hardware_check(
    request: HardwareCheckRequest, tell: Callable[[str, float], None]
) -> HardwareCheckReport:
    """
    Check all connected hardware.

    `tell` is called with the present activity and its progress, 0 to 1.

    Raise `BadInput` if nothing is connected, a given device cannot be opened, or another program
    commands the drone.
    """
    tell('searching for devices', 0.0)
    devices, serial = list(find_devices()), list_serial_ports()
    uri, port = find_drone(request.uri, devices), find_board(request.port, serial)
    require_hardware(devices, serial, uri, port)
    checks, drone_result, board_result = list(assess_device_access(devices, serial)), None, None
    if uri:
        drone_result, more = _check_drone(request, uri, tell)
        checks += more
    if port:
        board_result, more = _check_board(request, port, tell)
        checks += more
    return HardwareCheckReport(tuple(checks), drone_result, board_result)


def _check_drone(
    request: HardwareCheckRequest, uri: str, tell: Callable[[str, float], None]
) -> tuple[DroneMeasurement | None, list[HardwareCheck]]:
    vehicle = load_vehicle(request.vehicle)
    file = find_crazyflie(request.vehicle, vehicle.file.name)
    link = CflibLink(uri, LOG_BLOCKS, time.time_ns)
    tell(f'connecting to {uri}', 0.0)
    # Without the lock two programs would take each other's packets.
    with closing(DroneLock(uri)), closing(link):
        try:
            link.open(CONNECT_TIME)
        except LinkFailed as error:
            remedy = (
                'Switch the Crazyflie on, bring it closer, and check that no other program uses '
                'it.'
            )
            return None, [HardwareCheck('link', 'fail', f'{uri}: {error}', remedy)]
        result = drone.measure_drone(
            link, uri, file, request.seconds,
            lambda elapsed: tell('listening to the Crazyflie', elapsed / request.seconds),
        )  # fmt: skip
    return result, list(
        drone.assess_drone(
            result, file, vehicle.battery_compensated, hash_airframe(vehicle.file, file)
        )
    )


def _check_board(
    request: HardwareCheckRequest, port: str, tell: Callable[[str, float], None]
) -> tuple[BoardMeasurement, list[HardwareCheck]]:
    light = load_topic_table().light
    file = load_vehicle_file(request.vehicle)
    diodes = file.sensors.diodes
    settings = DemodulationSettings(frequency=request.frequency)
    bins = plan_bins(settings, light.sample_rate.si, light.samples)
    result = board.measure_board(
        port, light, diodes, bins, request.seconds,
        lambda elapsed: tell('listening to the light board', elapsed / request.seconds),
    )  # fmt: skip
    return result, list(board.assess_board(result, light, settings.threshold, hash_diodes(file)))


def format_stream_rows(streams: Sequence[StreamStatistics]) -> list[tuple[str, ...]]:
    """Return the table of log blocks; the first row is the header."""
    head: tuple[str, ...] = ('block', 'rate [Hz]', 'wanted [Hz]', 'lost [%]', 'jitter [ms]')
    return [head, *(
        (
            each.name, f'{each.rate:.1f}', f'{each.requested_rate:.0f}', f'{1e2 * each.loss:.2f}',
            f'{1e3 * each.jitter:.1f}',
        )
        for each in streams
    )]  # fmt: skip


def format_diode_rows(diodes: Sequence[DiodeMeasurement]) -> list[tuple[str, ...]]:
    """Return the table of diodes; the first row is the header."""
    head: tuple[str, ...] = ('diode', 'mean', 'least', 'largest', 'SNR', 'fault')
    return [head, *(
        (
            str(k), f'{each.mean:.0f}', str(each.least), str(each.largest), f'{each.snr:.1f}',
            ', '.join(each.faults) or 'none',
        )
        for k, each in enumerate(diodes, start=1)
    )]  # fmt: skip


def to_json(outcome: HardwareCheckReport) -> dict[str, Any]:
    """Return the report for JSON; NaN and infinity become null."""
    return {
        'checks': [asdict(check) for check in outcome.checks],
        'drone': None if outcome.drone is None else _to_json_value(asdict(outcome.drone)),
        'light_board': None if outcome.board is None else _to_json_value(asdict(outcome.board)),
    }


def _to_json_value(value: Any) -> Any:
    match value:
        case float():
            return value if math.isfinite(value) else None
        case dict():
            return {name: _to_json_value(one) for name, one in value.items()}
        case tuple() if hasattr(value, '_asdict'):
            return _to_json_value(value._asdict())
        case list() | tuple():
            return [_to_json_value(one) for one in value]
    return value
