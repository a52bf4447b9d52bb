"""
Defer SIGINT, SIGTERM and SIGHUP during a critical section.

An exception that a signal handler raises inside a C extension may turn into another error or get
lost. Code that spends a long time in an extension defers signals until afterwards.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import signal
import threading
from types import FrameType

STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def catch_stops(stop: Callable[[int, FrameType | None], object]) -> None:
    """Call `stop` at every signal in STOPS, except SIGHUP under `nohup`, which stays ignored."""
    for number in STOPS:
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)


@contextmanager
def hold_interrupts() -> Iterator[list[int]]:
    """Record the signals in STOPS instead of acting on them; deliver the first one at the end."""
    presses: list[int] = []

    def record_signal(number: int, _: FrameType | None) -> None:
        presses.append(number)

    before = {number: signal.getsignal(number) for number in STOPS}
    # Signals that are ignored or have the default action stay as they are.
    handlers = {number: handler for number, handler in before.items() if callable(handler)}
    if threading.current_thread() is not threading.main_thread():
        handlers = {}  # only the main thread may set handlers
    for number in handlers:
        signal.signal(number, record_signal)
    try:
        yield presses
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
    # Delivered after the handlers are restored; further presses are the same request
    if presses:
        handlers[signal.Signals(presses[0])](presses[0], None)
