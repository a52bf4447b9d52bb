"""What cflib and libusb say when there is no way to a Crazyflie, with what to do about it."""

from typing import Final

# Part of what is said: the sentence in its place.
REMEDIES: Final = {
    'Cannot find a Crazyradio': 'no Crazyradio is plugged in: plug one in (lsusb -d 1915:7777 '
    'shows it), or fly over usb:// or udp://',
    'Could not open usb': 'no such Crazyflie is on a cable: plug it in and switch it on (lsusb -d '
    '0483:5740 shows it)',
    'Could not identify device': 'there is no such serial port: correct the URI',
    'Connection refused': 'nobody listens at that host and port: start what should, or correct '
    'the URI',
    'Name or service not known': 'no host has that name: correct the URI',
    'Error communicating': 'nobody answers there any more: switch the Crazyflie on, or correct '
    'the URI',
    'insufficient permissions': 'you may not open the USB device: add the udev rule of '
    'docs/hardware.md, and plug it in again',
    'Permission denied': 'you may not open the device: add the udev rule of docs/hardware.md, or '
    'join its group (sudo usermod -aG dialout $USER), and log in again',
    'No backend available': 'libusb is missing: sudo apt install libusb-1.0-0',
    'Resource busy': 'another program has the radio: end it, since two cannot share one',
    'Too many packets lost': 'the radio lost a hundred packets in a row: come nearer, or choose '
    'another channel',
}


def suggest_remedy(text: str) -> str:
    """Return why a link failed: with the remedy where that is known, else the first line."""
    for sign, sentence in REMEDIES.items():
        if sign in text:
            return sentence
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[0] if lines else 'the link failed'
