"""Stream the lines of a text: decompressed, without comments, with one delimiter."""

from collections.abc import Iterator
import gzip
import io
from typing import Any, BinaryIO, final, TYPE_CHECKING
import zlib

from lta_config.limits import INFLATED_FREELY, INFLATION, LINE_BYTES
from lta_config.schema.import_file import TextFormat

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

GZIP = b'\x1f\x8b'
NAMED = {'tab': '\t', 'whitespace': ' '}


def decompress_stream(stream: BinaryIO) -> BinaryIO | gzip.GzipFile:
    """Return a stream of a file's content, decompressed if it is gzip."""
    head = stream.read(2)
    stream.seek(0)
    return BoundedGzipFile(stream) if head == GZIP else stream


@final
class BoundedGzipFile(gzip.GzipFile):
    """A gzip stream that refuses decompression bombs."""

    def __init__(self, packed: BinaryIO) -> None:
        super().__init__(fileobj=packed)
        self._packed = packed

    def read(self, size: int | None = -1) -> bytes:
        """Return the next bytes; raise OSError if the compression ratio is implausible."""
        found = super().read(size)
        # Bounded by what has been read so far, so that a bomb stops early.
        allowed = INFLATED_FREELY + INFLATION * self._packed.tell()
        if self.tell() > allowed:
            raise OSError(
                f'it unpacks to more than {INFLATION} times its size, which no text log does'
            )
        return found


def open_text_lines(stream: BinaryIO, text: TextFormat, unread: int) -> tuple[Any, str]:
    """
    Return a stream from some line on, and its delimiter as one character.

    `unread` lines are skipped; comments and empty lines do not count.
    """
    delimiter = NAMED.get(text.delimiter, text.delimiter)
    plain = decompress_stream(stream)
    return CleanedLines(plain, text, unread), delimiter


def check_line_length(line: bytes) -> None:
    """Raise OSError for a line that was cut off at the limit."""
    if len(line) >= LINE_BYTES and not line.endswith(b'\n'):
        raise OSError(f'one of its lines is longer than {LINE_BYTES} bytes, the limit of LTA')


@final
class CleanedLines(io.RawIOBase):
    """A readable stream of the data lines; without comments it passes large blocks unchanged."""

    PIECE = 1 << 20  # bytes

    def __init__(self, source: BinaryIO | gzip.GzipFile, text: TextFormat, unread: int) -> None:
        self._source = source
        self._comment = None if text.comment is None else text.comment.encode()
        self._blank = text.delimiter == 'whitespace'
        self._rest = b''
        self._pieces = self._iterate_line_blocks(unread)

    def readable(self) -> bool:
        """Return True."""
        return True

    def readinto(self, buffer: 'WriteableBuffer', /) -> int:
        """Fill a buffer with the next bytes; return 0 at the end."""
        room = memoryview(buffer).cast('B')
        while not self._rest:
            piece = next(self._pieces, None)
            if piece is None:
                return 0
            self._rest = piece
        count = min(len(room), len(self._rest))
        # The caller's buffer may be smaller than a piece; the rest waits for the next call
        room[:count] = self._rest[:count]
        self._rest = self._rest[count:]
        return count

    def _iterate_line_blocks(self, unread: int) -> Iterator[bytes]:
        """Yield the data lines in large blocks."""
        try:
            while unread:
                line = self._source.readline(LINE_BYTES)
                if not line:
                    return
                check_line_length(line)
                # Empty lines and comments do not count as skipped lines
                unread -= self._is_data_line(line)
            # No line needs a change: pass large blocks on
            if self._comment is None and not self._blank:
                while piece := self._source.read(self.PIECE):
                    yield piece
                return
            while lines := self._read_lines():
                yield b''.join(map(self._normalize_delimiters, filter(self._is_data_line, lines)))
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise OSError(f'its compressed data are damaged or cut short: {error}') from None

    def _read_lines(self) -> list[bytes]:
        """Return the next lines, about one block."""
        found, size = [], 0
        while size < self.PIECE and (line := self._source.readline(LINE_BYTES)):
            check_line_length(line)
            found.append(line)
            size += len(line)
        return found

    def _is_data_line(self, line: bytes) -> bool:
        """Return whether a line is neither empty nor a comment."""
        bare = line.strip()
        return bool(bare) and (self._comment is None or not bare.startswith(self._comment))

    def _normalize_delimiters(self, line: bytes) -> bytes:
        """Return a line with a single space between cells, for whitespace-separated text."""
        return b' '.join(line.split()) + b'\n' if self._blank else line
