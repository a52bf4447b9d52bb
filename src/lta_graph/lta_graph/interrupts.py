# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Defer SIGINT, SIGTERM and SIGHUP during a critical section.

An exception that a signal handler raises inside a C extension may turn into another error or get
lost. Code that spends a long time in an extension defers signals until afterwards.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import os
from pathlib import Path
import signal
import sys
import threading
from types import FrameType, TracebackType

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def catch_stops(stop: Callable[[int, FrameType | None], object]) -> None:
    """Call `stop` at every signal in STOP_SIGNALS; under `nohup`, SIGHUP stays ignored."""
    for number in STOP_SIGNALS:
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)


def guard_start(package: str) -> None:
    """
    Make an executable of a package end in order while it imports, until `main` takes over.

    Python would answer Ctrl-C during the imports, which take a second, with a traceback; the
    status is 130 instead. If a library cannot be loaded because of a limit of this process, a
    sentence names it, with status 2. So the package that holds the module of an executable calls
    this with its own name, and is imported before the module. The launchers block SIGINT while
    Python itself starts; it is unblocked here. Nothing changes in other executables, which may
    rely on Python's own handlers.
    """
    name = package.partition('.')[0]
    if Path(sys.argv[0]).parts[-3:-1] == ('lib', name):  # where `ros2 run` finds executables
        sys.excepthook = _explain_failed_start
        signal.signal(signal.SIGINT, lambda number, _: os._exit(128 + number))
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _explain_failed_start(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    """Report an error that nothing has caught, as `sys.excepthook`."""
    # Not above: Ctrl-C during that import would come too early to be guarded
    from lta_config.limits import describe_shortage

    shortage = describe_shortage(error)
    if shortage is None:
        sys.__excepthook__(kind, error, trace)
        return
    sys.stderr.write(f'{shortage}\n')
    sys.stderr.flush()
    os._exit(2)


@contextmanager
def hold_interrupts() -> Iterator[list[int]]:
    """Record STOP_SIGNALS instead of acting on them; deliver the first one at the end."""
    presses: list[int] = []

    def record_signal(number: int, _: FrameType | None) -> None:
        presses.append(number)

    before = {number: signal.getsignal(number) for number in STOP_SIGNALS}
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
