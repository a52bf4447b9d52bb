"""
The entry of the `lta` command: quick to load, so that Ctrl-C is heard from the beginning.

Exit status 0 done, 1 the run failed, 2 bad input (one sentence on stderr); 130 after Ctrl-C, 143
after SIGTERM and 129 after SIGHUP, all three of which stop a flight in order.
"""

import os
import signal
import sys
from typing import NoReturn

from lta_cli.streams import ignore_broken_pipes
from lta_graph.ament import list_middlewares
from lta_graph.process_end import exit_process

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
MIDDLEWARE = 'RMW_IMPLEMENTATION'


def main() -> NoReturn:
    """Run the command line and leave with its status."""
    heeded = [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]
    for number in heeded:  # nohup, for one, ignores SIGHUP
        signal.signal(number, _exit_at_once)
    # The lta script holds SIGINT back while Python starts; one that came meanwhile comes now.
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    ignore_broken_pipes()
    if (wrong := describe_wrong_middleware()) is not None:
        sys.stderr.write(f'{wrong}\n')
        sys.exit(2)
    from lta_cli.app import run_command_line, STOPPED  # a second of imports

    caught: list[int] = []

    def stop(number: int, _: object) -> NoReturn:
        caught.append(number)
        raise KeyboardInterrupt

    def heed() -> None:
        # Not earlier: a C extension that is being loaded may drop a KeyboardInterrupt.
        for number in heeded:
            signal.signal(number, stop)

    try:
        result = run_command_line(heed)
    except Exception:
        if not caught:
            raise
        result = STOPPED  # what is loaded later may turn a KeyboardInterrupt into an ImportError
    for number in heeded:
        signal.signal(number, signal.SIG_IGN)  # nothing is left to stop
    if result == STOPPED:
        sys.stderr.write('Stopped.\n')
        result = 128 + (caught[0] if caught else signal.SIGINT)
    exit_process(result)


def describe_wrong_middleware() -> str | None:
    """Return a sentence if the RMW that is asked for is not there: rcl would end the process."""
    asked, known = os.environ.get(MIDDLEWARE), list_middlewares()
    if not asked or not known or asked in known:
        return None
    return f"{MIDDLEWARE} is '{asked}', which is not installed; known: {', '.join(known)}."


def _exit_at_once(number: int, _: object) -> None:
    """End at once: nothing has been started yet."""
    os.write(sys.stderr.fileno(), b'Stopped.\n')
    os._exit(128 + number)
