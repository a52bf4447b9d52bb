# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read text with columns with pyarrow.

Numbers are rounded to the nearest float; times are parsed as decimals, so that
1772424689.277293682 s keeps its nanoseconds. An empty cell is missing; `nan` is NaN.
"""

import codecs
from collections.abc import Sequence
import csv
import gzip
from pathlib import Path
import re
from typing import Any, Final, TypeAlias
import zlib

from lta_config.errors import BadInput
from lta_config.limits import check_column_count, check_log_size, LOG_BYTES
from lta_config.schema.import_file import TextFormat
from lta_data.importers.protocol import Numbers
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv

GZIP: Final = b'\x1f\x8b'
UTF16: Final = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
ENCODING_BYTES: Final = 1 << 16  # bytes by which the encoding is detected
HEAD_LINES: Final = 4 << 20  # bytes by which names and delimiters are; longer rows are refused
CONTROLS: Final = frozenset(range(32)) - frozenset(b'\t\n\v\f\r\x1b')  # bytes that no text has
# A cell such as "[1.0, 2.0]" or "array([1.0, 2.0])"
LIST: Final = re.compile(rb'"?(?:(?:np\.)?array\()?[\[(]([^\[\]()"]*)[\])](?:\))?"?')
QUOTED_DECIMAL: Final = re.compile(rb'"([-+]?\d*),(\d+(?:[eE][-+]?\d+)?)"')
NAMED_DELIMITERS: Final = {'tab': '\t', 'whitespace': ' '}
# Cells without a number
EMPTY_CELLS: Final = (
    '', ' ', '-', '--', 'NA', 'N/A', 'n/a', '#N/A', 'null', 'NULL', 'None', 'none', 'missing',
)  # fmt: skip
# A number with marks between its thousands, as 1,234.5, by its decimal mark: it has both, or two
# groups. Beside one, a single group is one, too
THOUSANDS: Final = {
    '.': (re.compile(r'[-+]?\d{1,3}(?:(?:,\d{3})+\.\d*|(?:,\d{3}){2,})'), ','),
    ',': (re.compile(r'[-+]?\d{1,3}(?:(?:\.\d{3})+,\d*|(?:\.\d{3}){2,})'), '.'),
}
Cells: TypeAlias = pa.ChunkedArray  # of a column, as bytes; null where empty


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


def read_text(path: Path, size: int = LOG_BYTES + 1) -> bytes:
    """
    Return the first bytes of a text in UTF-8, decompressed if it is gzip.

    Raise `BadInput` if it cannot be read, or has more bytes than a log may have.
    """
    try:
        with path.open('rb') as stream:
            is_packed = stream.read(len(GZIP)) == GZIP
        with gzip.open(path) if is_packed else path.open('rb') as stream:
            data = stream.read(size)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise BadInput(
            f"'{path}' cannot be read: its compressed data are damaged or cut short ({error})."
        ) from None
    except OSError as error:
        raise BadInput(f"'{path}' cannot be read ({error}); give an intact text file.") from None
    if len(data) > LOG_BYTES:
        raise BadInput(
            f"'{path}' unpacks to more than {LOG_BYTES} bytes, the limit of an import; split the "
            'log.'
        )
    encoding = detect_encoding(data[:ENCODING_BYTES])
    if encoding not in ('', 'utf-8'):
        data = data.decode(encoding, errors='replace').encode()
    return data.removeprefix(codecs.BOM_UTF8)


def find_line(data: bytes, text: TextFormat, index: int) -> int:
    """Return where a line begins, of those with content and no comment; the end if it lacks."""
    at = 0
    while at < len(data):
        end = data.find(b'\n', at) + 1 or len(data)
        if _is_content(data[at:end], text):
            if not index:
                return at
            index -= 1
        at = end
    return len(data)


def _is_content(line: bytes, text: TextFormat) -> bool:
    """Return whether a line is neither empty nor a comment."""
    bare = line.strip()
    return bool(bare) and not (text.comment and bare.startswith(text.comment.encode()))


def clean_text(data: bytes, text: TextFormat, names: Sequence[str]) -> tuple[bytes, list[str]]:
    """
    Return the rows of a text as pyarrow reads them, and remarks on lines that are left out.

    Cells are apart by one delimiter, decimal marks are points, and each number of a list has a
    cell.
    """
    notes = []
    data = data[find_line(data, text, text.skip + (text.header is None)) :]
    delimiter, is_blank = (
        NAMED_DELIMITERS.get(text.delimiter, text.delimiter),
        text.delimiter == 'whitespace',
    )
    mark = delimiter.encode()
    if text.comment is not None:
        data = re.sub(rb'(?m)^[ \t]*' + re.escape(text.comment.encode()) + rb'.*\n?', b'', data)
    if is_blank:
        data = re.sub(rb'(?m)^ | (?=\r?$)', b'', re.sub(rb'[ \t]+', b' ', data))
    if names[0].encode() in data:
        between = rb'"?[ ]*' + re.escape(mark) + rb'[ ]*"?'
        line = between.join(re.escape(name.encode()) for name in names)
        data, count = re.subn(rb'(?m)^[ ]*"?' + line + rb'"?[ \r]*(\n|\Z)', b'', data)
        if count:
            times = 'once' if count == 1 else f'{count} times'
            notes.append(
                f'The names of the columns are repeated {times}; these lines are skipped.'
            )
    if _is_torn(data, mark):
        data = data[: data.rfind(b'\n') + 1]
        notes.append('The last line is cut off and skipped.')
    if text.lists:
        data = LIST.sub(lambda cell: mark.join(cell[1].replace(b',', b' ').split()), data)
    # After lists, whose commas are no marks between thousands
    data = _join_thousands(data, text, delimiter)
    if text.decimal == delimiter:
        data = QUOTED_DECIMAL.sub(rb'\1.\2', data)
    elif text.decimal != '.':
        data = data.replace(text.decimal.encode(), b'.')
    return data, notes


def _join_thousands(data: bytes, text: TextFormat, delimiter: str) -> bytes:
    """Return numbers without the marks between their thousands, if the text has such numbers."""
    number, mark = THOUSANDS[text.decimal]
    # The delimiter is a mark inside quotes only
    begin, end = (b'"', b'"') if mark == delimiter else (rb'(?<![\w.,+-])', rb'(?![\w.,])')
    if not re.search(begin + number.pattern.encode() + end, data):
        return data
    group, point = re.escape(mark).encode(), re.escape(text.decimal).encode()
    lenient = rb'[-+]?\d{1,3}(?:' + group + rb'\d{3})+(?:' + point + rb'\d*)?'
    return re.sub(begin + lenient + end, lambda found: found[0].replace(mark.encode(), b''), data)


def _is_torn(data: bytes, mark: bytes) -> bool:
    """Return whether the last line has no end and lacks cells, or ends with half a number."""
    last = data[data.rfind(b'\n') + 1 :].strip()
    if not last or len(last) == len(data.strip()):
        return False
    first = data.lstrip().partition(b'\n')[0]
    half = last.split(mark)[-1].strip()[-1:] in (b'-', b'+', b'e', b'E')
    return last.count(mark) < first.strip().count(mark) or half


def read_cells(
    path: Path, text: TextFormat, names: list[str]
) -> tuple[dict[str, Cells], list[str]]:
    """Return the cells of each column, without the empty ones, and remarks on skipped rows."""
    check_log_size(path)
    data, notes = clean_text(read_text(path), text, names)
    skipped: list[str] = []  # the first of them; the others are only counted

    def skip_row(row: Any) -> str:
        skipped.append('' if skipped else shorten_cell(row.text or ''))
        return 'skip'

    try:
        table = pacsv.read_csv(
            pa.BufferReader(data),
            read_options=pacsv.ReadOptions(
                column_names=names, block_size=HEAD_LINES, use_threads=False
            ),
            parse_options=pacsv.ParseOptions(
                delimiter=NAMED_DELIMITERS.get(text.delimiter, text.delimiter),
                invalid_row_handler=skip_row,
            ),
            convert_options=pacsv.ConvertOptions(
                # Bytes, since a text may not be UTF-8
                column_types=dict.fromkeys(names, pa.binary()),
                null_values=EMPTY_CELLS,
                strings_can_be_null=True,
            ),
        )
    except (pa.ArrowInvalid, pa.ArrowKeyError) as error:
        if 'Empty CSV' in str(error):
            raise _empty_text_error(path) from None
        reason = ' '.join(str(error).split())
        raise BadInput(
            f"'{path}' cannot be read as a text table ({reason[:200]}); correct the file, or the "
            'entries under "text" in the mapping, such as the delimiter.'
        ) from None
    notes = [*_describe_skipped(skipped, table.num_rows), *notes]
    if not table.num_rows:
        raise _empty_text_error(path)
    return {name: table.column(name) for name in names}, notes


def _empty_text_error(path: Path) -> BadInput:
    """Return the error for a text without rows."""
    return BadInput(f"'{path}' has column names but no rows; give a log with data.")


def _describe_skipped(skipped: Sequence[str], rows: int) -> list[str]:
    """Return remarks on the rows that were skipped; raise `BadInput` if most were."""
    if not skipped:
        return []
    count, first = len(skipped), skipped[0]
    if count > rows and are_names(first):
        raise BadInput(
            f"Another table begins with '{first}', and has other columns; put it into a file of "
            'its own.'
        )
    if count > rows:
        raise BadInput(
            f'{count} of {count + rows} rows have another number of cells than the names of the '
            f'columns, as \'{first}\'; correct "delimiter", "skip" or "header" under "text" '
            'in the mapping.'
        )
    notes = [
        f'{count} {"row has" if count == 1 else "rows have"} another number of cells than the '
        f'names of the columns and {"is" if count == 1 else "are"} skipped, the first as '
        f"'{first}'."
    ]
    if are_names(first):
        notes.append(
            'There, another table with its own columns begins; put it into a file of its own to '
            'import it, too.'
        )
    return notes


def parse_cells(path: Path, name: str, cells: Cells) -> Numbers:
    """Return the cells of a column as numbers, NaN where empty; raise BadInput for words."""
    try:
        texts = pc.utf8_trim_whitespace(cells.cast(pa.string()))
        numbers: Numbers = pc.cast(texts, pa.float64()).to_numpy()
        return numbers
    except pa.ArrowInvalid:
        for row, cell in enumerate(decode_cells(cells)):
            if cell and not is_number(cell):
                raise BadInput(
                    f"'{path}': '{shorten_cell(cell)}' in column '{name}', row {row + 1}, is not "
                    'a number; correct it, or leave the cell empty.'
                ) from None
        raise


def read_column_names(path: Path, text: TextFormat) -> list[str]:
    """Return the unique names of a text's columns, stripped; raise BadInput if there are none."""
    if text.header is not None:
        return list(text.header)
    data = read_text(path, HEAD_LINES)
    line = decode_cell(data[find_line(data, text, text.skip) :].partition(b'\n')[0]).strip()
    if text.delimiter == 'whitespace':
        line = ' '.join(line.split())
    delimiter = NAMED_DELIMITERS.get(text.delimiter, text.delimiter)
    cells = split_quoted(line, delimiter)
    check_column_count(path, len(cells))
    names: list[str] = []
    for index, cell in enumerate(cells):
        name = cell or f'unnamed {index + 1}'
        # pyarrow needs unique names
        names.append(name if name not in names else f'{name} ({index + 1})')
    if not names:
        raise BadInput(
            f"'{path}' has no line with column names; add one, or list the names in the mapping, "
            'as "header" under "text".'
        )
    return names


def read_header(path: Path) -> list[str]:
    """Return the cells of the first line, to find a fitting mapping."""
    line = decode_cell(read_text(path, HEAD_LINES).lstrip(b'\r\n').partition(b'\n')[0]).strip()
    # The most frequent separator of the header line.
    delimiter = max(',;\t', key=line.count)
    return split_quoted(line, delimiter)


def split_quoted(line: str, delimiter: str) -> list[str]:
    """Return the stripped cells of a line, some of them in quotes."""
    line = line.replace('\r', ' ')  # within a line, csv takes it for a broken file
    try:
        cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error as error:
        raise BadInput(f'A line cannot be split into cells: {error}; check its quotes.') from None
    return [cell.strip() for cell in cells]


def shorten_cell(cell: str) -> str:
    """Shorten a cell to one line for an error message."""
    return ' '.join(cell[:40].split())


def decode_cell(cell: bytes | None) -> str:
    """Return a cell as text; '' if it is missing."""
    return '' if cell is None else cell.decode(errors='replace')


def decode_cells(cells: Cells) -> list[str]:
    """Return cells as texts; '' if they are missing."""
    return [decode_cell(cell) for cell in cells.to_pylist()]


def is_number(cell: str) -> bool:
    """Return whether pyarrow reads a text as a number."""
    try:
        pc.cast(pa.array([cell.strip()]), pa.float64())
    except pa.ArrowInvalid:
        return False
    return True


def are_names(line: str) -> bool:
    """Return whether a line has names of columns instead of numbers."""
    cells = re.split(r'[,;\s]+', line.strip())
    return len(cells) > 1 and all(cell.strip('"')[:1].isalpha() for cell in cells)


def missing_columns_error(path: Path, absent: list[str], there: list[str]) -> BadInput:
    """Return the error for missing columns."""
    words = ', '.join(f"'{name}'" for name in absent[:5])
    available = ', '.join(there[:60]) + (' ...' if len(there) > 60 else '')
    plural = 's' if len(absent) > 1 else ''
    return BadInput(
        f"'{path}' has no column{plural} {words}; it has {available}. Correct the mapping."
    )
