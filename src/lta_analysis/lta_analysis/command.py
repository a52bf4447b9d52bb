"""
The entry of the `lta` command: quick to load, so that Ctrl-C is heard from the beginning.

Exit status 0 done, 1 the run failed, 2 bad input (one sentence on stderr), 130 Ctrl-C.
"""

import os
import signal
import sys


def main() -> None:
    """Run the command line and leave with its status."""
    signal.signal(signal.SIGINT, _leave)
    # The lta script holds SIGINT back while Python starts; one that came meanwhile comes now.
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    from lta_analysis.app import status, STOPPED  # a second of imports

    signal.signal(signal.SIGINT, signal.default_int_handler)
    result = status()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # nothing is left to stop
    if result == STOPPED:
        sys.stderr.write('Stopped.\n')
    sys.exit(result)


def _leave(*_: object) -> None:
    """End at once: nothing has been started yet."""
    os.write(sys.stderr.fileno(), b'Stopped.\n')
    os._exit(130)
