"""Standard streams that outlive whoever listened to them: `lta fly | head -1` flies to its end."""

import errno
import io
import sys
from typing import final, TextIO, TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

GONE = (errno.EPIPE, errno.EIO)  # the reader of a pipe left; a terminal was closed


@final
class BrokenPipeFile(io.FileIO):
    """A file that takes what nobody reads any more, and drops it."""

    def write(self, data: 'ReadableBuffer', /) -> int:
        """Return how many bytes are done with."""
        try:
            return super().write(data)
        except OSError as error:
            if error.errno not in GONE:
                raise
            return len(memoryview(data))


def ignore_broken_pipes() -> None:
    """Make stdout and stderr of this process take everything, heard or not."""
    sys.stdout = wrap_stream(sys.stdout)
    sys.stderr = wrap_stream(sys.stderr)


def wrap_stream(stream: TextIO) -> TextIO:
    """Return a stream on the same descriptor that a closed pipe does not break."""
    return io.TextIOWrapper(
        io.BufferedWriter(BrokenPipeFile(stream.fileno(), 'w', closefd=False)),
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=True,
    )
