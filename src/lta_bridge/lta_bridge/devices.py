"""
Which radios, drones and boards hang on the USB of this machine, and who may open them.

Linux tells both without any library: `/sys/bus/usb/devices` has the numbers of each device, and
its file in `/dev` the rights. What is found here has not been opened.
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
    """A kind of USB device: vendor and product number in hexadecimal, and what people call it."""

    vendor: str
    product: str
    name: str


# Bitcraze: docs of crazyflie-lib-python, "USB permissions". PJRC: 00-teensy.rules.
RADIO: Final = UsbKind('1915', '7777', 'Crazyradio')
DRONE: Final = UsbKind('0483', '5740', 'Crazyflie on a cable')
BOARD: Final = UsbKind('16c0', '0483', 'Teensy')
KINDS: Final = (RADIO, DRONE, BOARD)


class UsbDevice(NamedTuple):
    """A device: what it is, its file, and whether this user may read and write it."""

    kind: UsbKind
    path: Path
    usable: bool


class SerialPortInfo(NamedTuple):
    """A serial port: its file, what the system calls it, a Teensy or not, and whether usable."""

    path: str
    about: str
    teensy: bool
    usable: bool


def find_devices(usb: Path = USB, dev: Path = DEV) -> Iterator[UsbDevice]:
    """
    Yield the devices of our kinds.

    Parameters
    ----------
    usb, dev : Path
        Where Linux tells of USB, and where its device files are.

    """
    for place in sorted(usb.glob('*')) if usb.is_dir() else ():
        told = {name: _read_text(place / name) for name in ('idVendor', 'idProduct')}
        for kind in KINDS:
            if (told['idVendor'], told['idProduct']) == (kind.vendor, kind.product):
                numbers = (_read_text(place / 'busnum'), _read_text(place / 'devnum'))
                path = dev / 'bus/usb' / '/'.join(number.zfill(3) for number in numbers)
                yield UsbDevice(kind, path, os.access(path, os.R_OK | os.W_OK))


def list_serial_ports() -> list[SerialPortInfo]:
    """Return the serial ports of this machine that are real: a mere number behind none is left."""
    number = (int(BOARD.vendor, 16), int(BOARD.product, 16))
    return [
        SerialPortInfo(
            port.device, port.description, (port.vid, port.pid) == number,
            os.access(port.device, os.R_OK | os.W_OK),
        )
        for port in sorted(list_ports.comports())
        if port.vid is not None
    ]  # fmt: skip


def format_udev_rules() -> str:
    """Return a udev file by which whoever sits at this machine may open all of our kinds."""
    head = '# Who is logged in at this machine may open what LTA flies and listens with.'
    lines = [
        f'# {kind.name}\nSUBSYSTEMS=="usb", ATTRS{{idVendor}}=="{kind.vendor}", '
        f'ATTRS{{idProduct}}=="{kind.product}", MODE="0660", GROUP="plugdev", TAG+="uaccess", '
        'ENV{ID_MM_DEVICE_IGNORE}="1"'
        for kind in KINDS
    ]
    return '\n'.join([head, *lines]) + '\n'


def _read_text(path: Path) -> str:
    """Return the text of a file of the system, empty where there is none."""
    try:
        return path.read_text(encoding='ascii').strip()
    except OSError:
        return ''
