"""Explain connection errors of cflib and libusb, with their remedies."""

from typing import Final

# Part of the library's message: the message for the user.
REMEDIES: Final = {
    'Cannot find a Crazyradio': 'no Crazyradio is plugged in: plug one in (lsusb -d 1915:7777 '
    'shows it), or use a URI with usb:// or udp://',
    'Could not open usb': 'the Crazyflie of the URI is not connected by USB: plug it in and '
    'switch it on (lsusb -d 0483:5740 shows it)',
    'Could not identify device': 'the serial port of the URI does not exist: correct the URI',
    'Connection refused': 'no program listens at the host and port of the URI: start the drone or '
    'its emulation, or correct the URI',
    'Name or service not known': 'the host of the URI is unknown: correct the URI',
    'Error communicating': 'the Crazyflie no longer answers: switch it on, or correct the URI',
    'insufficient permissions': 'no permission to open the USB device: add the udev rule of '
    'docs/hardware.md, and plug the device in again',
    'Permission denied': 'no permission to open the device: add the udev rule of '
    'docs/hardware.md, or run "sudo usermod -aG dialout $USER", and log in again',
    'No backend available': 'libusb is not installed: run "sudo apt install libusb-1.0-0"',
    'Resource busy': 'another program uses the Crazyradio: stop it, because only one program can '
    'use the radio at a time',
    'Too many packets lost': 'the radio lost a hundred packets in a row: bring the drone closer, '
    'or choose another channel',
}


def suggest_remedy(text: str) -> str:
    """Return why a link failed: with the remedy if it is known, else the first line."""
    for sign, sentence in REMEDIES.items():
        if sign in text:
            return sentence
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[0] if lines else 'the connection to the Crazyflie failed'
