"""Keep running when the reader of stdout or stderr goes away, as in `lta fly | head -1`."""

import errno
import io
import sys
from typing import final, TextIO, TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

GONE = (errno.EPIPE, errno.EIO)  # the reader of a pipe left; a terminal was closed


@final
class BrokenPipeFile(io.FileIO):
    """A file that discards data once its pipe or terminal is closed."""

    def write(self, data: 'ReadableBuffer', /) -> int:
        """Write data and return the number of bytes written or discarded."""
        try:
            return super().write(data)
        except OSError as error:
            if error.errno not in GONE:
                raise
            # Report all bytes as written, so that the buffer is emptied
            return len(memoryview(data))


def ignore_broken_pipes() -> None:
    """Make stdout and stderr of this process ignore a closed pipe."""
    sys.stdout = wrap_stream(sys.stdout)
    sys.stderr = wrap_stream(sys.stderr)


def wrap_stream(stream: TextIO) -> TextIO:
    """Return a stream on the same descriptor that a closed pipe does not break."""
    return io.TextIOWrapper(
        # Do not close the descriptor: the original stream still owns it
        io.BufferedWriter(BrokenPipeFile(stream.fileno(), 'w', closefd=False)),
        encoding=stream.encoding,
        errors=stream.errors,
        # Progress and results appear immediately, also in a pipe
        line_buffering=True,
    )
