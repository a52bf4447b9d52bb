"""
Use the keyboard of a terminal as sticks.

A terminal repeats a pressed key but does not report its release. A key therefore counts as pressed
for `HELD` after it was last received.

Arrow and function keys send escape sequences that often end in a letter (down is ESC [ B). They
are removed, so that this letter is not taken for a key.
"""

import os
import re
import sys
import termios
import tty
from typing import Final, final

from lta_bridge.teleop.sticks import Sticks
from lta_config.errors import BadInput

HELD: Final = 0.6  # s; keyboards start to repeat after 0.25 to 0.5 s
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
        down = {key for key, pressed in self._pressed_at.items() if now - pressed < HELD}
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
