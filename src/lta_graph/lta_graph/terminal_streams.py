# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Standard output and error that a file's text cannot misuse, and that nothing breaks.

All text passes here: control characters of foreign names are replaced, characters that the
encoding lacks become '?', and output is dropped once its reader is gone, as in `lta fly | head`.
"""

import atexit
from contextlib import suppress
import errno
import io
import os
import sys
from typing import Any, final, NoReturn, TextIO, TYPE_CHECKING

from lta_config.errors import strip_control_codes

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer
READER_GONE = (errno.EPIPE, errno.EIO)  # the reader of a pipe left; a terminal was closed


@final
class BrokenPipeFile(io.FileIO):
    """A file that discards data once its pipe or terminal is closed."""

    def write(self, data: 'ReadableBuffer', /) -> int:
        """Write data and return the number of bytes written or discarded."""
        try:
            return super().write(data)
        except OSError as error:
            if error.errno not in READER_GONE:
                raise
            # Report all bytes as written, so that the buffer is emptied
            return len(memoryview(data))


@final
class TerminalStream(io.TextIOWrapper):
    """
    A text stream without control characters, except line breaks and tabs.

    Attribute `rich_proxied_file`: the same stream unfiltered, under the name that rich looks for.
    Rich writes its colours there; `PlainConsole` has filtered its texts.
    """

    def __init__(self, buffer: io.BufferedWriter, encoding: str) -> None:
        # Progress and results appear immediately, also in a pipe. Writing through keeps the order
        # of both streams.
        settings: Any = {'errors': 'replace', 'line_buffering': True, 'write_through': True}
        super().__init__(buffer, encoding, **settings)
        self.rich_proxied_file = io.TextIOWrapper(buffer, encoding, **settings)

    def write(self, text: str, /) -> int:
        """Write text and return its length."""
        return super().write(strip_control_codes(text))


def guard_streams() -> None:
    """Filter stdout and stderr of this process, and make both ignore a closed pipe."""
    sys.stdout = wrap_stream(sys.stdout)
    sys.stderr = wrap_stream(sys.stderr)


def reserve_stdout() -> None:
    """Keep stdout for the text of this process; what C libraries such as DDS print is stderr's."""
    sys.stdout.flush()
    own = os.dup(sys.stdout.fileno())
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    file = BrokenPipeFile(own, 'w')
    sys.stdout = TerminalStream(io.BufferedWriter(file), sys.stdout.encoding)


def wrap_stream(stream: TextIO) -> TerminalStream:
    """Return a filtered stream on the same descriptor that a closed pipe does not break."""
    # Do not close the descriptor: the original stream still owns it
    file = BrokenPipeFile(stream.fileno(), 'w', closefd=False)
    return TerminalStream(io.BufferedWriter(file), stream.encoding)


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
