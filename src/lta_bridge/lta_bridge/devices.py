# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
List the radios, drones and boards connected by USB, and whether the user may open them.

Vendor and product numbers come from `/sys/bus/usb/devices`, the access rights from the device
files in `/dev`. No device is opened.
"""

from collections.abc import Iterator
import os
from pathlib import Path
from typing import Final, NamedTuple

from serial.tools import list_ports

USB: Final = Path('/sys/bus/usb/devices')
DEV: Final = Path('/dev')
RULES_FILE: Final = '/etc/udev/rules.d/60-lta.rules'


class UsbKind(NamedTuple):
    """A kind of USB device: vendor and product number in hexadecimal, and its common name."""

    vendor: str
    product: str
    name: str


# Bitcraze: docs of crazyflie-lib-python, "USB permissions". PJRC: 00-teensy.rules.
RADIO: Final = UsbKind('1915', '7777', 'Crazyradio')
DRONE: Final = UsbKind('0483', '5740', 'Crazyflie on a cable')
BOARD: Final = UsbKind('16c0', '0483', 'Teensy')
DEVICE_KINDS: Final = (RADIO, DRONE, BOARD)


class UsbDevice(NamedTuple):
    """A USB device: kind, device file, and whether this user may read and write it."""

    kind: UsbKind
    path: Path
    usable: bool


class SerialPortInfo(NamedTuple):
    """A serial port: device file, description, and whether it is a Teensy and usable."""

    path: str
    about: str
    teensy: bool
    usable: bool


def find_devices(usb: Path = USB, dev: Path = DEV) -> Iterator[UsbDevice]:
    """Yield the connected devices of the known kinds."""
    for place in sorted(usb.glob('*')) if usb.is_dir() else ():
        # Interfaces and hubs are listed too; without these files the texts are empty
        ids = {name: _read_text(place / name) for name in ('idVendor', 'idProduct')}
        for kind in DEVICE_KINDS:
            if (ids['idVendor'], ids['idProduct']) == (kind.vendor, kind.product):
                numbers = (_read_text(place / 'busnum'), _read_text(place / 'devnum'))
                # Such as /dev/bus/usb/001/004
                path = dev / 'bus/usb' / '/'.join(number.zfill(3) for number in numbers)
                yield UsbDevice(kind, path, os.access(path, os.R_OK | os.W_OK))


def list_serial_ports() -> list[SerialPortInfo]:
    """Return the serial ports that are USB devices; built-in ports may have no hardware."""
    number = (int(BOARD.vendor, 16), int(BOARD.product, 16))
    return [
        SerialPortInfo(
            port.device, port.description, (port.vid, port.pid) == number,
            os.access(port.device, os.R_OK | os.W_OK),
        )
        for port in sorted(list_ports.comports())
        # Only USB devices have a vendor number
        if port.vid is not None
    ]  # fmt: skip


def format_udev_rules() -> str:
    """Return a udev rules file that lets the logged-in user open the known devices."""
    head = '# Allow the logged-in user to open the radios, drones and boards that LTA uses.'
    lines = [
        f'# {kind.name}\nSUBSYSTEMS=="usb", ATTRS{{idVendor}}=="{kind.vendor}", '
        f'ATTRS{{idProduct}}=="{kind.product}", MODE="0660", GROUP="plugdev", TAG+="uaccess", '
        # Keeps ModemManager from sending modem commands to the port
        'ENV{ID_MM_DEVICE_IGNORE}="1"'
        for kind in DEVICE_KINDS
    ]
    return '\n'.join([head, *lines]) + '\n'


def _read_text(path: Path) -> str:
    """Return the text of a file in /sys; empty if it cannot be read."""
    try:
        return path.read_text(encoding='ascii').strip()
    except OSError:
        return ''
