"""The lines of a text as a stream: decompressed, without comments, with one delimiter."""

from collections.abc import Iterator
import gzip
import io
from typing import Any, BinaryIO, final, TYPE_CHECKING
import zlib

from lta_config.import_file import Text

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

GZIP = b'\x1f\x8b'
NAMED = {'tab': '\t', 'whitespace': ' '}


def decompressed(stream: BinaryIO) -> BinaryIO | gzip.GzipFile:
    """Return a stream of what a file holds, compressed with gzip or not."""
    head = stream.read(2)
    stream.seek(0)
    return gzip.GzipFile(fileobj=stream) if head == GZIP else stream


def text_lines(stream: BinaryIO, text: Text, unread: int) -> tuple[Any, str]:
    """
    Return a text from some line on, and its delimiter as one character.

    Parameters
    ----------
    stream : BinaryIO
        The file from its beginning.
    text : Text
        How it is written.
    unread : int
        Lines left out at the beginning; comments and empty lines do not count.

    """
    delimiter = NAMED.get(text.delimiter, text.delimiter)
    plain = decompressed(stream)
    return Cleaned(plain, text, unread), delimiter


@final
class Cleaned(io.RawIOBase):
    """A readable stream of the lines that count; large pieces pass untouched where all count."""

    PIECE = 1 << 20

    def __init__(self, source: BinaryIO | gzip.GzipFile, text: Text, unread: int) -> None:
        self._source = source
        self._comment = None if text.comment is None else text.comment.encode()
        self._blank = text.delimiter == 'whitespace'
        self._rest = b''
        self._pieces = self._cleaned(unread)

    def readable(self) -> bool:
        """Return True."""
        return True

    def readinto(self, buffer: 'WriteableBuffer', /) -> int:
        """Fill a buffer with what comes next; 0 at the end."""
        room = memoryview(buffer).cast('B')
        while not self._rest:
            piece = next(self._pieces, None)
            if piece is None:
                return 0
            self._rest = piece
        count = min(len(room), len(self._rest))
        room[:count] = self._rest[:count]
        self._rest = self._rest[count:]
        return count

    def _cleaned(self, unread: int) -> Iterator[bytes]:
        """Yield the lines that count, in large pieces."""
        try:
            while unread:
                line = self._source.readline()
                if not line:
                    return
                unread -= self._counts(line)
            if self._comment is None and not self._blank:
                while piece := self._source.read(self.PIECE):
                    yield piece
                return
            while lines := self._source.readlines(self.PIECE):
                yield b''.join(map(self._written, filter(self._counts, lines)))
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise OSError(f'its compression is damaged or cut short: {error}') from None

    def _counts(self, line: bytes) -> bool:
        """Tell whether a line is neither empty nor a comment."""
        bare = line.strip()
        return bool(bare) and (self._comment is None or not bare.startswith(self._comment))

    def _written(self, line: bytes) -> bytes:
        """Return a line with one delimiter between two cells."""
        return b' '.join(line.split()) + b'\n' if self._blank else line
