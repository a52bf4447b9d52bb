# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Sticks and buttons of a gamepad (/dev/input/js0) or the keyboard.

On opening, the kernel reports every axis and button of a gamepad, and then each change
(Documentation/input/joydev/joystick-api.rst, events of 8 bytes). An unplugged one is reopened.

A terminal repeats a pressed key but does not report its release. A key therefore counts as pressed
for `KEY_HOLD` after it was last received. Arrow and function keys send escape sequences that often
end in a letter (down is ESC [ B). They are removed, so that this letter is not taken for a key.
"""

from collections.abc import Collection, Iterator, Sequence
import math
import os
from pathlib import Path
import re
import struct
import sys
import termios
import tty
from typing import Final, final, NamedTuple, Protocol

from lta_config.errors import BadInput
from lta_config.settings import setting, Settings


class Sticks(NamedTuple):
    """Deflections and buttons at an instant."""

    # Ahead, to the left, up: from -1 to 1, exactly 0 at rest
    forward: float = 0.0
    turn: float = 0.0
    climb: float = 0.0
    # Whether to take control, hand it back, or stop the motors
    take: bool = False
    give_back: bool = False
    stop: bool = False

    @property
    def is_deflected(self) -> bool:
        """Whether any stick is deflected."""
        return any((self.forward, self.turn, self.climb))


class StickDevice(Protocol):
    """A device with sticks."""

    def read_sticks(self, now: float) -> Sticks | None:
        """Return the sticks at a monotonic time [s]; None if the device has failed."""

    def close(self) -> None:
        """Close the device."""


class GamepadLayout(Settings):
    """Axis and button numbers of a gamepad; the defaults fit an Xbox gamepad under Linux."""

    forward: int = setting(4, low=0, high=63, fixed=True)
    """Number of the axis for forward flight (right stick up)."""
    turn: int = setting(0, low=0, high=63, fixed=True)
    """Number of the axis for turning left (left stick left)."""
    climb: int = setting(1, low=0, high=63, fixed=True)
    """Number of the axis for climbing (left stick up)."""
    take: int = setting(0, low=0, high=63, fixed=True)
    """Number of the button that takes control (A)."""
    give_back: int = setting(1, low=0, high=63, fixed=True)
    """Number of the button that hands control back (B)."""
    stop: int = setting(2, low=0, high=63, fixed=True)
    """Number of the emergency-stop button, which locks the motors (X)."""
    rest: float = setting(0.1, low=0.0, high=0.9, fixed=True)
    """Dead zone: a smaller stick deflection, from 0 to 1, counts as zero."""


def to_sticks(
    layout: GamepadLayout,
    axes: Sequence[float],
    buttons: Sequence[int],
    tapped: Collection[int] = (),
) -> Sticks | None:
    """
    Return the sticks of a gamepad.

    Parameters
    ----------
    axes : sequence of float
        From -1 to 1; left and up are positive, as in sensor_msgs/Joy.
    buttons : sequence of int
        1 if pressed.
    tapped : collection of int
        Buttons pressed since the last reading, which may be released again.

    Returns
    -------
    Sticks or None
        None if it has fewer axes or buttons than the layout names.

    """
    axis_indices = (layout.forward, layout.turn, layout.climb)
    pressed = (layout.take, layout.give_back, layout.stop)
    if max(axis_indices) >= len(axes) or max(pressed) >= len(buttons):
        return None
    forward, turn, climb = (apply_dead_zone(axes[axis], layout.rest) for axis in axis_indices)
    # `tapped` has buttons that were pressed and released since the last read
    take, give_back, stop = (buttons[button] == 1 or button in tapped for button in pressed)
    return Sticks(forward, turn, climb, take, give_back, stop)


def from_sticks(layout: GamepadLayout, sticks: Sticks) -> tuple[list[float], list[int]]:
    """Return the axes and buttons of a gamepad with such sticks, the inverse of `to_sticks`."""
    numbers = (layout.forward, layout.turn, layout.climb)
    axes = [0.0] * (max(numbers) + 1)
    for number, value in zip(numbers, (sticks.forward, sticks.turn, sticks.climb), strict=True):
        if value:  # at rest, rounding could leave the dead zone
            axes[number] = math.copysign(layout.rest + (1.0 - layout.rest) * abs(value), value)
    pressed = (layout.take, layout.give_back, layout.stop)
    buttons = [0] * (max(pressed) + 1)
    for number, is_down in zip(pressed, (sticks.take, sticks.give_back, sticks.stop), strict=True):
        buttons[number] = int(is_down)
    return axes, buttons


def apply_dead_zone(raw: float, rest: float) -> float:
    """Remove the dead zone of a stick and rescale its deflection to -1 to 1."""
    size = (min(abs(raw), 1.0) - rest) / (1.0 - rest)
    if not size > 0.0:  # true for NaN too
        return 0.0
    # Zero at the edge of the dead zone, so that the command does not jump
    return size if raw > 0.0 else -size


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


KEY_HOLD: Final = 0.6  # s; keyboards start to repeat after 0.25 to 0.5 s
FORWARD, TURN, CLIMB = 'ws', 'ad', 'rf'  # positive key, then negative key
TAKE, GIVE_BACK, STOP = ' ', 'b', 'x'
ESCAPES: Final = re.compile(  # ECMA-48's CSI, Linux's own F1 to F5, and SS3 of a keypad
    rb'\x1b(?:\[\[[A-E]|\[(?!\[)[0-?]*[ -/]*[@-~]|O[ -~])'
)
# The beginning of an escape sequence at the end of a read
TORN: Final = re.compile(rb'\x1b(?:\[\[?[0-?]*[ -/]*|O)?\Z')
HELP: Final = """\
w s  ahead, back     a d  left, right     r f  up, down     (hold a key down)
space  take control     b  hand it back     x  EMERGENCY STOP: motors off for good
Ctrl-C quits; if you have control, the drone then holds and lands.
"""


@final
class Keyboard:
    """
    Read keys from a terminal, by default standard input.

    Raise `BadInput` if it is not a terminal.
    """

    def __init__(self, fd: int | None = None) -> None:
        self._fd = sys.stdin.fileno() if fd is None else fd
        if not os.isatty(self._fd):
            raise BadInput(
                'device:=keyboard needs a terminal, but teleop runs without one; start it in a '
                'terminal of its own with "lta run lta_bridge teleop", or use device:=joy.'
            )
        self._before = termios.tcgetattr(self._fd)
        # Keys arrive without Enter, and Ctrl-C still works
        tty.setcbreak(self._fd)
        os.set_blocking(self._fd, False)
        self._pressed_at: dict[str, float] = {}
        self._torn = b''
        self._dead = False

    def read_sticks(self, now: float) -> Sticks | None:
        """Return the pressed keys as sticks at a time [s]; None once the terminal is closed."""
        fresh = self._read_keys()
        if self._dead:
            return None
        for key in fresh:
            self._pressed_at[key] = now
        # A terminal reports no release: a key is down while it repeats
        down = {key for key, pressed in self._pressed_at.items() if now - pressed < KEY_HOLD}
        forward, turn, climb = (
            float((keys[0] in down) - (keys[1] in down)) for keys in (FORWARD, TURN, CLIMB)
        )
        return Sticks(forward, turn, climb, TAKE in fresh, GIVE_BACK in fresh, STOP in fresh)

    def _read_keys(self) -> str:
        try:
            typed = os.read(self._fd, 1024)
        except BlockingIOError:
            self._torn = b''  # nothing followed: it was the escape key itself
            return ''
        except OSError:
            typed = b''
        self._dead |= not typed  # end of file: the terminal was closed
        # Arrow and function keys contain letters that would act as commands
        whole = ESCAPES.sub(b'', self._torn + typed)
        torn = TORN.search(whole)
        self._torn = torn.group() if torn else b''
        return whole.removesuffix(self._torn).decode('ascii', 'ignore').lower()

    def close(self) -> None:
        """Restore the terminal's settings."""
        if not self._dead:
            os.set_blocking(self._fd, True)
            termios.tcsetattr(self._fd, termios.TCSADRAIN, self._before)
