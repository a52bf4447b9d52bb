# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Keep a link connected from a separate thread: connect, check the parameters, reconnect on loss.

Opening and closing block, so they must not happen in a callback of the node. The pause after a
failed attempt doubles each time.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
import threading
import time
from typing import Final, final

from lta_bridge.crazyflie.link import CrazyflieLink, LinkFailed
from lta_config.schema.crazyflie_file import ExpectedParameter

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


CONNECT_TIME: Final = 8.0  # s for one attempt; a TOC of 700 entries takes about 5 s by radio
CONFIRM: Final = 2.0  # s for one parameter
# Parameters that let motors turn without a command.
IDLE_THRUST_PARAMETERS: Final = ('motorPowerSet.enable', 'powerDist.idleThrust')
FIRST_PAUSE, LONGEST_PAUSE = 0.5, 8.0  # s of pause after a failed attempt
CONNECTING: Final = 'connecting'  # the reason for no link until the first attempt has ended
LISTEN_PERIOD: Final = 0.1  # s between two looks whether the drone listens


def enforce_parameters(
    link: CrazyflieLink,
    expected: Mapping[str, ExpectedParameter],
    compensated: bool | None = None,
    airframe: int | None = None,
) -> None:
    """
    Check the firmware's parameters and set those that may be written.

    Parameters that turn motors without a command are switched off first, on every drone. Nothing
    else is written unless all checks pass.

    Parameters
    ----------
    link : CrazyflieLink
        An open link.
    expected : mapping
        Expected parameters by name.
    compensated : bool or None
        Whether the vehicle model assumes firmware that corrects duties for the battery's voltage;
        None to skip this check.
    airframe : int or None
        The hash of vehicle and wiring that the drone must have; None to skip this check.

    Raises
    ------
    LinkFailed
        If a parameter is missing, or differs and may not or cannot be written; or if the firmware
        belongs to another vehicle, or disagrees with it on the voltage compensation.

    """
    # First of all: a previous program may have left motors turning
    for name in IDLE_THRUST_PARAMETERS:
        if link.read_parameter(name):
            link.write_parameter(name, 0.0, CONFIRM)
    for name, want in expected.items():
        value = link.read_parameter(name)
        if value is None:
            raise LinkFailed(f'the firmware has no parameter {name} ({want.why})')
        # Check all before writing any, so that a refused drone stays as it was
        if value != want.value and not want.write:
            raise LinkFailed(
                f'the firmware parameter {name} is {value:g}, but must be {want.value:g} '
                f'({want.why})'
            )
    if compensated is not None and (
        why := explain_mismatch(has_voltage_compensation(link), compensated)
    ):
        raise LinkFailed(why)
    if airframe is not None and (why := explain_wrong_vehicle(link, airframe)):
        raise LinkFailed(why)
    for name, want in expected.items():
        if link.read_parameter(name) != want.value:
            link.write_parameter(name, want.value, CONFIRM)


def has_voltage_compensation(link: CrazyflieLink) -> bool:
    """Return whether the firmware corrects duties for the battery's voltage."""
    # Stock firmware lacks the parameter (None) and does compensate.
    return link.read_parameter('lta.compensated') != 0.0


def explain_wrong_vehicle(link: CrazyflieLink, airframe: int) -> str:
    """Return why a drone belongs to another vehicle; empty if it does not, or cannot tell."""
    value = link.read_parameter('lta.vehicle')
    # Stock firmware has no vehicle; the app of firmware/crazyflie has one
    if value is None or int(value) == airframe:
        return ''
    built = f'for another vehicle or wiring ({int(value):08x})' if value else 'for no vehicle'
    return (
        f'the firmware was built {built}, but vehicle file and motor wiring are those of '
        f'{airframe:08x}: give the vehicle file of this drone, or build and flash its firmware '
        'with "make firmware"'
    )


def explain_mismatch(firmware: bool, vehicle: bool) -> str:
    """Return why firmware and vehicle disagree on voltage compensation; empty if they agree."""
    if firmware and not vehicle:
        return (
            'the firmware corrects motor duties for the battery voltage, but the vehicle file '
            'does not have the effect battery_compensation: flash the firmware of '
            'firmware/crazyflie, or add the effect to the vehicle file'
        )
    if vehicle and not firmware:
        return (
            'the firmware does not correct motor duties for the battery voltage, but the vehicle '
            'file has the effect battery_compensation: flash stock firmware, or remove the effect '
            'from the vehicle file'
        )
    return ''


@final
class ConnectionManager:
    """
    Keep one link open until `close` is called.

    Parameters
    ----------
    link : CrazyflieLink
        Only the manager may open and close it.
    expected, compensated, airframe
        See `enforce_parameters`.
    on_closed : callable
        Called from the manager's thread when the link is closed for good.
    is_closed : callable
        Returns whether nothing listens yet where the link leads.
    patience : float
        How long to wait for that before the first attempt. [s]

    Attributes
    ----------
    up : bool
        Whether the link is open and its parameters are as expected.
    why : str
        Why the link is not up.
    attempts : int
        Number of connection attempts.

    """

    def __init__(
        self,
        link: CrazyflieLink,
        expected: Mapping[str, ExpectedParameter],
        on_closed: Callable[[], None] = lambda: None,
        compensated: bool | None = None,
        is_closed: Callable[[], bool] = lambda: False,
        patience: float = 0.0,
        airframe: int | None = None,
    ) -> None:
        self._is_closed, self._patience = is_closed, patience
        self._link, self._expected, self._given_back = link, expected, on_closed
        self._compensated, self._airframe = compensated, airframe
        self.up, self.why, self.attempts = False, CONNECTING, 0
        self._leave = threading.Event()
        self._again = threading.Event()
        self._thread = threading.Thread(target=self._run, name='crazyflie_link', daemon=True)
        self._thread.start()

    def reconnect(self, why: str) -> None:
        """Close the connection and open a new one."""
        self.up, self.why = False, why
        self._again.set()

    def close(self, deadline: float = 5.0) -> bool:
        """Close the link; return whether the thread ended within a time [s]."""
        self.up = False
        self._leave.set()
        # Wakes the thread if it holds a connection
        self._again.set()
        self._thread.join(deadline)
        return not self._thread.is_alive()

    def _run(self) -> None:
        until = time.monotonic() + self._patience
        while (
            time.monotonic() < until and self._is_closed() and not self._leave.wait(LISTEN_PERIOD)
        ):
            pass
        pause = FIRST_PAUSE
        while not self._leave.is_set():
            self._again.clear()
            self.attempts += 1
            failed = self._hold_connection()
            self.up = False
            with suppress(Exception):  # an unplugged dongle raises various types
                self._link.close()
            if not failed:
                pause = FIRST_PAUSE
                continue
            self.why = failed
            self._leave.wait(pause)
            # Exponential backoff
            pause = min(2.0 * pause, LONGEST_PAUSE)
        self._given_back()

    def _hold_connection(self) -> str:
        """Connect and wait for `reconnect` or `close`; return why connecting failed, or ''."""
        try:
            self._link.open(CONNECT_TIME)
            if not self._leave.is_set():
                enforce_parameters(self._link, self._expected, self._compensated, self._airframe)
        except LinkFailed as error:
            return str(error)
        except Exception as error:  # drivers raise various types; the thread must survive them
            return suggest_remedy(f'{type(error).__name__}: {error}')
        # The link may have been lost, or closed, while parameters were written
        if not (self._again.is_set() or self._leave.is_set()):
            self.up, self.why = True, ''
            self._again.wait()
        return ''
