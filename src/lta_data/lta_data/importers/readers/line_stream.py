"""Stream the lines of a text: decompressed, without comments, with one delimiter."""

import codecs
from collections.abc import Iterator
import gzip
import io
import re
from typing import BinaryIO, final, TYPE_CHECKING
import zlib

from lta_config.limits import INFLATED_FREELY, INFLATION, LINE_BYTES
from lta_config.schema.import_file import TextFormat

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

GZIP = b'\x1f\x8b'
UTF16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
HEAD = 1 << 16  # bytes by which the encoding is detected
CONTROLS = frozenset(range(32)) - frozenset(b'\t\n\v\f\r\x1b')  # bytes that no text has
# A cell such as "[1.0, 2.0]" or "array([1.0, 2.0])"
LIST = re.compile(rb'"?(?:(?:np\.)?array\()?[\[(]([^\[\]()"]*)[\])](?:\))?"?')
QUOTED_DECIMAL = re.compile(rb'"([-+]?\d*),(\d+(?:[eE][-+]?\d+)?)"')
NAMED = {'tab': '\t', 'whitespace': ' '}


def decompress_stream(stream: BinaryIO) -> BinaryIO | gzip.GzipFile:
    """Return a stream of a file's content in UTF-8, decompressed if it is gzip."""
    packed = stream.read(2) == GZIP
    stream.seek(0)
    plain = BoundedGzipFile(stream) if packed else stream
    encoding = detect_encoding(plain.read(HEAD))
    plain.seek(0)
    if encoding in ('', 'utf-8'):
        return plain
    return codecs.EncodedFile(plain, 'utf-8', encoding, 'replace')


def detect_encoding(head: bytes) -> str:
    """
    Return the encoding of a text by its first bytes; '' if they are no text.

    Spreadsheets write UTF-16 with a byte order mark, and European ones Latin-1 with a degree sign.
    """
    if head.startswith(UTF16):
        return '' if '\0' in head.decode('utf-16', errors='replace') else 'utf-16'
    if b'\0' in head:
        wide = head[: len(head) // 2 * 2]
        # Every other byte of plain text in UTF-16 is zero
        for encoding, zeros in (('utf-16-le', wide[1::2]), ('utf-16-be', wide[::2])):
            rest = wide[::2] if encoding == 'utf-16-le' else wide[1::2]
            if len(wide) > 8 and not any(zeros) and b'\0' not in rest:
                return encoding
        return ''
    try:
        codecs.getincrementaldecoder('utf-8')().decode(head)
    except UnicodeDecodeError:
        # Mostly letters, digits and marks of ASCII
        plain = CONTROLS.isdisjoint(head) and sum(byte > 127 for byte in head) < 0.1 * len(head)
        return 'cp1252' if plain else ''
    return 'utf-8'


@final
class BoundedGzipFile(gzip.GzipFile):
    """A gzip stream that refuses decompression bombs."""

    def __init__(self, packed: BinaryIO) -> None:
        super().__init__(fileobj=packed)
        self._packed = packed

    def read(self, size: int | None = -1) -> bytes:
        """Return the next bytes; raise OSError if the compression ratio is implausible."""
        data = super().read(size)
        # Bounded by what has been read so far, so that a bomb stops early.
        allowed = INFLATED_FREELY + INFLATION * self._packed.tell()
        if self.tell() > allowed:
            raise OSError(
                f'it unpacks to more than {INFLATION} times its size, which no text log does'
            )
        return data


def open_text_lines(
    stream: BinaryIO, text: TextFormat, unread: int, repeated: bytes = b''
) -> tuple['CleanedLines', str]:
    """
    Return a stream from some line on, and its delimiter as one character.

    `unread` lines are skipped; comments and empty lines do not count. Lines equal to `repeated`,
    the names of the columns, are left out and counted.
    """
    delimiter = NAMED.get(text.delimiter, text.delimiter)
    plain = decompress_stream(stream)
    return CleanedLines(plain, text, unread, repeated), delimiter


def check_line_length(line: bytes) -> None:
    """Raise OSError for a line that was cut off at the limit."""
    if len(line) >= LINE_BYTES and not line.endswith(b'\n'):
        raise OSError(f'one of its lines is longer than {LINE_BYTES} bytes, the limit of LTA')


@final
class CleanedLines(io.RawIOBase):
    """
    A readable stream of the data lines; without comments it passes large blocks unchanged.

    Attribute `headers`: lines left out so far because they repeat the names of the columns.
    Attribute `torn`: whether the last line was left out, because it has no end and lacks cells or
    a number.
    """

    PIECE = 1 << 20  # bytes

    def __init__(
        self,
        source: BinaryIO | gzip.GzipFile,
        text: TextFormat,
        unread: int,
        repeated: bytes = b'',
    ) -> None:
        self._source = source
        self._repeated = repeated.strip().replace(b'"', b'')
        self._delimiter = NAMED.get(text.delimiter, text.delimiter).encode()
        self._cells = 0  # of the first row
        self.headers = 0
        self.torn = False
        self._comment = None if text.comment is None else text.comment.encode()
        self._blank = text.delimiter == 'whitespace'
        self._decimal = text.decimal.encode()
        self._lists = text.lists
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
                unread -= self._is_content(line)
            # No line needs a change: pass large blocks on
            plain = self._comment is None and not self._blank
            for block in self._iterate_whole_lines():
                if not plain or (self._repeated and self._repeated in block.replace(b'"', b'')):
                    lines = filter(self._is_data_line, block.splitlines(keepends=True))
                    block = b''.join(map(self._normalize_delimiters, lines))
                yield self._normalize_cells(block)
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise OSError(f'its compressed data are damaged or cut short: {error}') from None

    def _normalize_cells(self, block: bytes) -> bytes:
        """Return lines with a point as decimal mark, and a cell for each number of a list."""
        if self._lists:
            between = self._delimiter
            block = LIST.sub(lambda cell: between.join(cell[1].replace(b',', b' ').split()), block)
        if self._decimal == self._delimiter:
            return QUOTED_DECIMAL.sub(rb'\1.\2', block)
        return block if self._decimal == b'.' else block.replace(self._decimal, b'.')

    def _iterate_whole_lines(self) -> Iterator[bytes]:
        """Yield blocks that end with a line; a torn last line is left out."""
        rest = b''
        while piece := self._source.read(self.PIECE):
            lines, end, rest = (rest + piece).rpartition(b'\n')
            check_line_length(rest)
            if not self._cells and lines.strip():
                self._cells = self._count_cells(lines.strip().split(b'\n', 1)[0])
            if end:
                yield lines + end
        if rest.strip():
            self.torn = self._is_content(rest) and self._is_torn(rest)
            if not self.torn:
                yield rest

    def _is_torn(self, line: bytes) -> bool:
        """Return whether a line without an end lacks cells, or ends with half a number."""
        if self._cells and self._count_cells(line) < self._cells:
            return True
        last = line.strip().split(self._delimiter)[-1].strip()
        return last[-1:] in (b'-', b'+', b'e', b'E')

    def _count_cells(self, line: bytes) -> int:
        return len(line.split()) if self._blank else line.count(self._delimiter) + 1

    def _is_data_line(self, line: bytes) -> bool:
        """Return whether a line is neither empty, nor a comment, nor the names once more."""
        bare = line.strip()
        if self._repeated and bare.replace(b'"', b'') == self._repeated:
            self.headers += 1
            return False
        return self._is_content(bare)

    def _is_content(self, line: bytes) -> bool:
        """Return whether a line is neither empty nor a comment."""
        bare = line.strip()
        return bool(bare) and (self._comment is None or not bare.startswith(self._comment))

    def _normalize_delimiters(self, line: bytes) -> bytes:
        """Return a line with a single space between cells, for whitespace-separated text."""
        return b' '.join(line.split()) + b'\n' if self._blank else line
