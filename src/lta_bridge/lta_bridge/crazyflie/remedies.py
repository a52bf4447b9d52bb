"""Explain connection errors of cflib and libusb, with their remedies."""

from typing import Final

# Part of the library's message: the message for the user.
REMEDIES: Final = {
    'Cannot find a Crazyradio': 'no Crazyradio is plugged in: plug one in (lsusb -d 1915:7777 '
    'shows it), or fly over usb:// or udp://',
    'Could not open usb': 'no such Crazyflie is connected by USB: plug it in and switch it on '
    '(lsusb -d 0483:5740 shows it)',
    'Could not identify device': 'there is no such serial port: correct the URI',
    'Connection refused': 'no program listens at that host and port: start the drone or its '
    'emulation, or correct the URI',
    'Name or service not known': 'there is no host of that name: correct the URI',
    'Error communicating': 'the Crazyflie does not answer any more: switch it on, or correct the '
    'URI',
    'insufficient permissions': 'you may not open the USB device: add the udev rule of '
    'docs/hardware.md, and plug it in again',
    'Permission denied': 'you may not open the device: add the udev rule of docs/hardware.md, or '
    'join its group (sudo usermod -aG dialout $USER), and log in again',
    'No backend available': 'libusb is missing: sudo apt install libusb-1.0-0',
    'Resource busy': 'another program uses the radio: stop it, since two cannot share one',
    'Too many packets lost': 'the radio lost a hundred packets in a row: move closer, or choose '
    'another channel',
}


def suggest_remedy(text: str) -> str:
    """Return why a link failed: with the remedy if it is known, else the first line."""
    for sign, sentence in REMEDIES.items():
        if sign in text:
            return sentence
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[0] if lines else 'the link failed'
