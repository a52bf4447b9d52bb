"""Exit a process without the interpreter teardown, which takes up to a second."""

import atexit
from contextlib import suppress
import os
import sys
from typing import NoReturn


def exit_process(status: int) -> NoReturn:
    """
    Run the exit handlers, flush the standard streams and exit immediately.

    Modules and compiled code are not torn down: that takes up to a second per node, and the kernel
    frees them anyway. Threads are not joined; join them before. Under a profiler or a debugger the
    process exits normally.
    """
    # `__spec__` is set when Python was started with -m, as profilers and debuggers are
    if sys.modules['__main__'].__spec__ is not None:
        sys.exit(status)
    # os._exit runs neither these handlers nor the flush of the streams
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # the reader has closed the pipe
            stream.flush()
    os._exit(status)
