"""
Read a gamepad from the Linux joystick device /dev/input/js0, events of 8 bytes.

On opening, the kernel reports every axis and button, and then each change
(Documentation/input/joydev/joystick-api.rst). An unplugged gamepad is reopened.
"""

from collections.abc import Iterator
import os
from pathlib import Path
import struct
from typing import Final, final

from lta_bridge.teleop.sticks import GamepadLayout, Sticks, to_sticks
from lta_config.errors import BadInput

EVENT: Final = struct.Struct('<IhBB')  # time [ms], value, type, number
BUTTON, AXIS, INITIAL = 0x01, 0x02, 0x80
FULL_STICK: Final = 32767
# Devices that are no gamepad of this machine
KEYBOARD, JOY, CMD_VEL = 'keyboard', 'joy', 'cmd_vel'
REOPEN: Final = 1.0  # s between two attempts


def require_gamepad(device: str) -> None:
    """Raise `BadInput` for a gamepad that is not there; the other devices need none."""
    if device not in (KEYBOARD, JOY, CMD_VEL) and not Path(device).exists():
        raise _missing_gamepad_error(Path(device))


def _missing_gamepad_error(path: Path) -> BadInput:
    return BadInput(f'There is no gamepad at {path}; plug one in, or use device:=keyboard.')


@final
class Gamepad:
    """Read a gamepad; raise BadInput if there is no such device, or it may not be read."""

    def __init__(self, path: Path, layout: GamepadLayout) -> None:
        self._path, self._layout = path, layout
        try:
            # Non-blocking: the node reads what there is and goes on
            self._fd: int | None = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        except FileNotFoundError:
            raise _missing_gamepad_error(path) from None
        except PermissionError:
            raise BadInput(
                f'You have no permission to read {path}; run "sudo usermod -aG input $USER" and '
                'log in again.'
            ) from None
        self._tried = 0.0
        self._axes: dict[int, float] = {}
        self._buttons: dict[int, int] = {}

    def read_sticks(self, now: float) -> Sticks | None:
        """
        Return the sticks at a time [s]; None if it is unplugged or does not fit the layout.

        A button pressed since the last call counts even if it was released or the gamepad
        unplugged meanwhile, so that a tap on the emergency stop is not missed.
        """
        if self._fd is None:
            self._try_reopen(now)
        tapped = set()
        for value, kind, number in self._read_events():
            if kind == AXIS:
                # Left and up are negative in the kernel's events and positive in Joy.
                self._axes[number] = -value / FULL_STICK
            elif kind == BUTTON:
                self._buttons[number] = value
                if value:
                    # A button pressed and released between two reads must count
                    tapped.add(number)
        if self._fd is None and not tapped:
            return None
        buttons = [int(level) for level in _list_values_by_number(self._buttons)]
        return to_sticks(self._layout, _list_values_by_number(self._axes), buttons, tapped)

    def _try_reopen(self, now: float) -> None:
        if now - self._tried < REOPEN:
            return
        self._tried = now
        try:
            self._fd = os.open(self._path, os.O_RDONLY | os.O_NONBLOCK)
        except OSError:
            return
        # The driver reports the initial state of all axes and buttons after opening
        self._axes, self._buttons = {}, {}

    def _read_events(self) -> Iterator[tuple[int, int, int]]:
        """Yield value, kind and number of the new events; close an unplugged device."""
        while self._fd is not None:
            try:
                data = os.read(self._fd, EVENT.size)
            except BlockingIOError:
                return
            except OSError:
                data = b''
            if len(data) < EVENT.size:
                self.close()
                return
            _, value, kind, number = EVENT.unpack(data)
            # INITIAL marks events that report the state at opening
            yield value, kind & ~INITIAL, number

    def close(self) -> None:
        """Close the device."""
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None


def _list_values_by_number(levels: dict[int, float] | dict[int, int]) -> list[float]:
    """Return the values by number, with 0 for missing ones."""
    return [levels.get(number, 0) for number in range(max(levels, default=-1) + 1)]
