# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Provide the entry point of the `lta` command.

It loads quickly, so that signals are handled from the start. Exit status: 0 done, 1 the run
failed, 2 bad input (one sentence on stderr), 130 Ctrl-C, 143 SIGTERM, 129 SIGHUP. These signals
shut a flight down cleanly.
"""

import gc
import os
import signal
import sys
import threading
from typing import Final, NoReturn
import warnings

from lta_graph.ament import list_middlewares
from lta_graph.terminal_streams import exit_process, guard_streams, reserve_stdout

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
COMPLETION = '_LTA_COMPLETE'  # a shell asks how the line may go on
JSON_OPTION: Final = '--json'  # stdout holds nothing else then
MIDDLEWARE = 'RMW_IMPLEMENTATION'
DROPPED_SIGNAL_PAUSE: Final = 0.05  # s; until a signal that a C library dropped is sent again


def main() -> NoReturn:
    """Run the command line and exit with its status."""
    # Read the dispositions once: the handlers below replace them
    heeded = [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]
    for number in heeded:  # signals that the parent ignores (nohup: SIGHUP) stay ignored
        signal.signal(number, _exit_at_once)
    # The lta script blocks SIGINT while Python starts; a pending one is delivered here.
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    guard_streams()
    if JSON_OPTION in sys.argv:
        reserve_stdout()
    # Arithmetic on damaged data: what matters of it is reported, and children inherit this
    if not sys.warnoptions:
        os.environ.setdefault('PYTHONWARNINGS', 'ignore::RuntimeWarning')
        warnings.simplefilter('ignore', RuntimeWarning)
    if COMPLETION in os.environ:
        from lta_cli.app import complete

        complete()
    # Check before the imports load rclpy
    if (message := describe_wrong_middleware()) is not None:
        sys.stderr.write(f'{message}\n')
        sys.exit(2)
    # Imports leave no garbage, but their many objects start searches for it
    gc.disable()
    from lta_cli.app import run_command_line, STOPPED  # imports take a second

    caught: list[int] = []

    def stop(number: int, _: object) -> NoReturn:
        caught.append(number)
        # All three signals end a flight in the same, clean way
        raise KeyboardInterrupt

    def send_again(dropped: 'sys.UnraisableHookArgs') -> None:
        if dropped.exc_type is not KeyboardInterrupt:
            sys.__unraisablehook__(dropped)
            return
        # A callback from C, such as that of a compiler, cannot raise: wait until it has returned
        last = caught[-1] if caught else signal.SIGINT
        threading.Timer(DROPPED_SIGNAL_PAUSE, os.kill, (os.getpid(), last)).start()

    sys.unraisablehook = send_again

    def heed() -> None:
        # What was imported stays, so later searches leave it out
        gc.freeze()
        gc.enable()
        # Install after the imports: a C extension that is loading may drop a KeyboardInterrupt.
        for number in heeded:
            signal.signal(number, stop)

    try:
        result = run_command_line(heed)
    except Exception:
        if not caught:
            raise
        result = STOPPED  # a late import may turn a KeyboardInterrupt into an ImportError
    for number in heeded:
        signal.signal(number, signal.SIG_IGN)  # the run is over; only the exit remains
    if result == STOPPED:
        sys.stderr.write('Stopped.\n')
        # The convention of shells for a process that ended by a signal
        result = 128 + (caught[0] if caught else signal.SIGINT)
    # Skips the interpreter teardown, which takes up to a second
    exit_process(result)


def describe_wrong_middleware() -> str | None:
    """Return a message if the requested RMW is not installed: rcl would abort the process."""
    # An empty list means that ROS 2 is not installed; its own message is better
    name, installed = os.environ.get(MIDDLEWARE), list_middlewares()
    if not name or not installed or name in installed:
        return None
    return (
        f"{MIDDLEWARE} is '{name}', which is not installed; unset it or use one of: "
        f'{", ".join(installed)}.'
    )


def _exit_at_once(number: int, _: object) -> None:
    """Exit immediately: nothing has been started yet."""
    # Unbuffered: `os._exit` does not flush streams
    os.write(sys.stderr.fileno(), b'Stopped.\n')
    os._exit(128 + number)
