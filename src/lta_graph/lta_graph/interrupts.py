"""
Hold back Ctrl-C and its like while something must not be torn apart.

An exception raised by a signal in the middle of a C extension's conversion comes out as some other
error, or not at all; so what calls one for long holds signals back and lets them act afterwards.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import signal
import threading
from types import FrameType

STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def hold_interrupts() -> Iterator[list[int]]:
    """Count Ctrl-C and its like instead of being interrupted, and let the first act afterwards."""
    presses: list[int] = []

    def record_press(number: int, _: FrameType | None) -> None:
        presses.append(number)

    before = {number: signal.getsignal(number) for number in STOPS}
    # What is ignored or left to the kernel stays so.
    heard = {number: handler for number, handler in before.items() if callable(handler)}
    if threading.current_thread() is not threading.main_thread():
        heard = {}
    for number in heard:
        signal.signal(number, record_press)
    try:
        yield presses
    finally:
        for number, handler in heard.items():
            signal.signal(number, handler)
    if presses:
        heard[signal.Signals(presses[0])](presses[0], None)
