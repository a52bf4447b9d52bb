"""
Read text with columns with pyarrow.

Numbers are rounded to the nearest float; times are parsed as decimals, so that
1772424689.277293682 s keeps its nanoseconds. An empty cell is missing; `nan` is NaN.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import csv
from pathlib import Path
import re
from typing import Any, BinaryIO, final, TypeAlias

from lta_config.errors import BadInput
from lta_config.limits import check_column_count, check_log_size, LINE_BYTES, LOG_BYTES
from lta_config.schema.import_file import TextFormat
from lta_data.importers.protocol import Numbers
from lta_data.importers.readers.line_stream import decompress_stream, NAMED, open_text_lines
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv

EMPTY = ('', ' ', 'NA', 'null', 'None')  # cells without a number
PART = 4 << 20  # bytes of text per part
MOST_SKIPPED = 3 * PART  # bytes of skipped rows without another one; parts are read ahead
Cells: TypeAlias = pa.ChunkedArray  # of a column, as bytes; null where empty


def read_cells(
    path: Path, text: TextFormat, names: list[str]
) -> tuple[dict[str, Cells], list[str]]:
    """Return the cells of each column, without the empty ones, and remarks on skipped rows."""
    check_log_size(path)
    with path.open('rb') as stream:
        try:
            rows = TextRows(stream, text, names)
            batches, size = [], 0
            for batch in rows:
                size += batch.nbytes
                # Each cell has four bytes besides its text
                if size > 4 * LOG_BYTES:
                    raise BadInput(
                        f"'{path}' unpacks to more than {LOG_BYTES} bytes, the limit of an "
                        'import; split the log.'
                    )
                batches += [batch] if batch.num_rows else []
        except (pa.ArrowInvalid, pa.ArrowKeyError, EOFError, OSError) as error:
            if 'Empty CSV' not in str(error):
                reason = ' '.join(str(error).split())
                raise BadInput(
                    f"'{path}' cannot be read as a text table ({reason[:200]}); correct the file, "
                    'or the entries under "text" in the mapping, such as the delimiter.'
                ) from None
            raise empty_text_error(path) from None
    notes = rows.describe_skipped()
    if not batches:
        raise empty_text_error(path)
    table = pa.Table.from_batches(batches)
    return {name: table.column(name) for name in names}, notes


def empty_text_error(path: Path) -> BadInput:
    """Return the error for a text without rows."""
    return BadInput(f"'{path}' has column names but no rows; give a log with data.")


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


@final
class TextRows:
    """The rows of a text as record batches; rows with too many or too few cells are skipped."""

    def __init__(
        self,
        stream: BinaryIO,
        text: TextFormat,
        names: list[str],
    ) -> None:
        unread = text.skip + (1 if text.header is None else 0)
        self._lines, delimiter = open_text_lines(
            stream, text, unread, NAMED.get(text.delimiter, text.delimiter).join(names).encode()
        )
        self._skipped = 0
        self._skipped_bytes = 0  # since the last row that was read
        self._first_skipped = ''
        self._rows = 0
        with self._refuse_skipped_rows():
            self._reader = pacsv.open_csv(
                self._lines,
                read_options=pacsv.ReadOptions(
                    column_names=names, block_size=PART, use_threads=False
                ),
                parse_options=pacsv.ParseOptions(
                    delimiter=delimiter, invalid_row_handler=self._skip_row
                ),
                convert_options=pacsv.ConvertOptions(
                    # Bytes, since a text may not be UTF-8
                    column_types=dict.fromkeys(names, pa.binary()),
                    null_values=EMPTY,
                    strings_can_be_null=True,
                ),
            )

    def __iter__(self) -> Iterator[Any]:
        """Yield the rows as record batches."""
        with self._refuse_skipped_rows():
            for batch in self._reader:
                self._rows += batch.num_rows
                if batch.num_rows:
                    self._skipped_bytes = 0
                yield batch

    @contextmanager
    def _refuse_skipped_rows(self) -> Iterator[None]:
        """Raise BadInput if pyarrow stopped because too many rows were skipped."""
        try:
            yield
        except pa.ArrowInvalid:
            self._check_skipped()
            raise

    def _check_skipped(self) -> None:
        """Raise BadInput if most rows were skipped."""
        if self._skipped > self._rows and are_names(self._first_skipped):
            raise BadInput(
                f"Another table begins with '{self._first_skipped}', and has other columns; put "
                'it into a file of its own.'
            )
        if self._skipped > self._rows:
            raise BadInput(
                f'{self._skipped} of {self._skipped + self._rows} rows have another number of '
                f"cells than the names of the columns, as '{self._first_skipped}'; correct "
                '"delimiter", "skip" or "header" under "text" in the mapping.'
            )

    def describe_skipped(self) -> list[str]:
        """
        Return a remark on what was skipped, once all rows are read.

        Raise `BadInput` if most rows were.
        """
        self._check_skipped()
        skipped = self._skipped
        notes = []
        if skipped:
            notes.append(
                f'{skipped} {"row has" if skipped == 1 else "rows have"} another number of cells '
                f'than the names of the columns and {"is" if skipped == 1 else "are"} skipped, '
                f"the first as '{self._first_skipped}'."
            )
            if are_names(self._first_skipped):
                notes.append(
                    'There, another table with its own columns begins; put it into a file of its '
                    'own to import it, too.'
                )
        if self._lines.headers:
            times = 'once' if self._lines.headers == 1 else f'{self._lines.headers} times'
            notes.append(
                f'The names of the columns are repeated {times}; these lines are skipped.'
            )
        if self._lines.torn:
            notes.append('The last line is cut off and skipped.')
        return notes

    def _skip_row(self, row: Any) -> str:  # noqa: ANN401 - pyarrow's InvalidRow
        text = row.text or ''
        if not self._skipped:
            self._first_skipped = shorten_cell(text)
        self._skipped += 1
        self._skipped_bytes += len(text)
        hopeless = self._skipped > self._rows and self._skipped_bytes > MOST_SKIPPED
        return 'error' if hopeless else 'skip'


def read_column_names(path: Path, text: TextFormat) -> list[str]:
    """Return the unique names of a text's columns, stripped; raise BadInput if there are none."""
    if text.header is not None:
        return list(text.header)
    try:
        with path.open('rb') as stream:
            source, delimiter = open_text_lines(stream, text, text.skip)
            line = read_first_line(source)
    except (OSError, EOFError, pa.ArrowInvalid) as error:
        raise BadInput(f"'{path}' cannot be read ({error}); give an intact text file.") from None
    cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    check_column_count(path, len(cells))
    names: list[str] = []
    for index, cell in enumerate(cells):
        name = cell.strip() or f'unnamed {index + 1}'
        # pyarrow needs unique names
        names.append(name if name not in names else f'{name} ({index + 1})')
    if not names:
        raise BadInput(
            f"'{path}' has no line with column names; add one, or list the names in the mapping, "
            'as "header" under "text".'
        )
    return names


def read_first_line(source: Any) -> str:  # noqa: ANN401 - a stream of pyarrow or of ours
    """Return the first line that is not empty."""
    data = b''
    while b'\n' not in data.lstrip() and len(data) < LINE_BYTES:
        more = source.read(1 << 14)
        if not more:
            break
        data += bytes(more)
    # utf-8-sig drops the byte order mark that spreadsheets write
    text = data.decode('utf-8-sig', errors='replace').lstrip('\r\n')
    return text.splitlines()[0] if text.strip() else ''


def read_header(path: Path) -> list[str]:
    """Return the cells of the first line, to find a fitting mapping."""
    with path.open('rb') as stream:
        line = read_first_line(decompress_stream(stream))
    # The most frequent separator of the header line.
    delimiter = max(',;\t', key=line.count)
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]


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
