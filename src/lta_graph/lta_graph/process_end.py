"""The end of a process, without the second that it takes to take Python apart."""

import atexit
from contextlib import suppress
import os
import sys
from typing import NoReturn


def exit_process(status: int) -> NoReturn:
    """
    End this process: what was to be done at its end is done, and everything is said.

    Modules and compiled code are not taken apart, which the kernel forgets anyway: up to a
    second of a node, for which the others of a graph wait. Whoever needs a thread to finish joins
    it before. Under another program, such as a profiler or a debugger, all ends as usual.
    """
    if sys.modules['__main__'].__spec__ is not None:
        sys.exit(status)
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # nobody reads it any more
            stream.flush()
    os._exit(status)
