"""
Read text with columns in parts with pyarrow, so that memory does not grow with the file.

Numbers are rounded to the nearest float; times are parsed as decimals, so that
1772424689.277293682 s keeps its nanoseconds. An empty cell is missing; `nan` is NaN.
"""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
import csv
from pathlib import Path
import re
from typing import Any, BinaryIO, final

from lta_config.errors import BadInput
from lta_config.limits import check_column_count, LINE_BYTES
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_config.schema.import_file import TextFormat
from lta_data.importers.log_provenance import CLOCK
from lta_data.importers.log_table import encode_label, LogTable, Times
from lta_data.importers.protocol import PassThroughMessage, RawTopic, Reached
from lta_data.importers.readers.line_stream import decompress_stream, NAMED, open_text_lines
from lta_data.importers.readers.row_times import (
    choose_time_offset,
    compute_even_times,
    parse_exact_times,
    SECOND,
    shorten_cell,
)
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv

EMPTY = ('', ' ', 'NA', 'null', 'None')  # cells without a number
PART = 4 << 20  # bytes of text per part
MOST_SKIPPED = 3 * PART  # bytes of skipped rows without another one; parts are read ahead
ZONELESS = 'The dates in the log have no time zone; UTC is assumed.'


@final
class CsvLog:
    """
    An opened text; see `protocol.LogReader`.

    Raise `BadInput` if it cannot be read as text with columns.
    """

    def __init__(self, path: Path, mapping: MappingFile) -> None:
        self._path = path
        self._mapping = mapping
        self._names = read_column_names(path, mapping.text)
        self.columns: Mapping[str, list[str]] = {'': self._names}
        self.raw: Mapping[str, RawTopic] = {}
        self.notes: list[str] = []
        self.facts: dict[str, str] = {}
        time = mapping.time
        self.timed = [] if time is None else time.columns
        self._labels = {name for entry in mapping.topics for name in entry.labels}
        self._rows = 0
        self._shift: int | None = None
        start = None if time is None else time.start
        if start is not None:
            self._shift = round(start.si * SECOND)
        elif not self.timed:
            self.facts[CLOCK] = 'rows counted'

    def iterate_tables(
        self, selection: Mapping[str, Collection[str]], reached: Reached
    ) -> Iterator[Mapping[str, LogTable]]:
        """Yield the text, one part at a time."""
        needed = [name for name in self._names if name in selection['']]
        if absent := [name for name in self.timed if name not in self._names]:
            raise missing_columns_error(self._path, absent, self._names)
        # Times as text: float64 would round nanoseconds since 1970
        as_text = [*self.timed, *self._labels]
        types = dict.fromkeys(needed, pa.float64()) | dict.fromkeys(as_text, pa.binary())
        size = self._path.stat().st_size
        with self._path.open('rb') as stream:
            for batch in self._read_record_batches(stream, types):
                reached(min(1.0, stream.tell() / size))
                if batch.num_rows:
                    yield {'': self._build_table(batch, needed)}

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield nothing."""
        yield from ()

    def _read_record_batches(
        self, stream: BinaryIO, types: Mapping[str, pa.DataType]
    ) -> Iterator[Any]:
        """Yield the text as record batches; an invalid cell raises BadInput with its row."""
        try:
            rows = TextRows(stream, self._mapping.text, self._names, types)
            yield from rows
            self.notes += rows.describe_skipped()
        except BadInput:
            raise
        except (pa.ArrowInvalid, pa.ArrowKeyError, EOFError, OSError) as error:
            raise self._translate_error(str(error), types) from None

    def _build_table(self, batch: Any, needed: list[str]) -> LogTable:  # noqa: ANN401 - of pyarrow
        """Return one part as a table."""
        first, self._rows = self._rows, self._rows + batch.num_rows
        rows = np.arange(first, self._rows, dtype=np.int64)
        stamps = self._read_stamps(batch, rows)
        columns, empty = {}, {}
        for name in needed:
            cells = batch.column(name)
            if name in self._labels:
                columns[name] = np.array([encode_label(decode_cell(c)) for c in cells.to_pylist()])
                continue
            columns[name] = cells.to_numpy(zero_copy_only=False).astype(np.float64)
            if cells.null_count:
                empty[name] = cells.is_null().to_numpy(zero_copy_only=False)
        return LogTable(stamps, stamps, rows, columns, first, empty)

    def _read_stamps(self, batch: Any, rows: Times) -> Times:  # noqa: ANN401 - of pyarrow
        """Return the measurement times of the rows. [ns]"""
        time = self._mapping.time
        if time is None or time.column is None:
            stamps = compute_even_times(time, rows)
        else:
            texts, *fractions = (
                list(map(decode_cell, batch.column(name).to_pylist())) for name in self.timed
            )
            stamps, zoneless = parse_exact_times(texts, time.unit, time.column, int(rows[0]))
            for more in fractions:
                stamps = (
                    stamps
                    + parse_exact_times(
                        more, time.fraction_unit, str(time.fraction), int(rows[0])
                    ).times
                )
            if zoneless and ZONELESS not in self.notes:
                self.notes.append(ZONELESS)
        # The first part decides for the whole file
        if self._shift is None:
            self._shift = choose_time_offset(int(stamps[0]), self.notes, self.facts)
        return stamps + self._shift

    def _translate_error(self, error: str, types: Mapping[str, pa.DataType]) -> BadInput:
        """Return the error for text that pyarrow cannot read."""
        # pyarrow names neither row nor column reliably, so find the cell by reading again
        if 'conversion error' in error:
            for name, kind in types.items():
                if kind == pa.float64() and (cell_place := self._find_non_numeric_cell(name)):
                    row, cell = cell_place
                    return BadInput(
                        f"'{self._path}': '{cell}' in column '{name}', row {row}, is not a "
                        'number; correct it, or leave the cell empty.'
                    )
        if 'Empty CSV' in error:
            return BadInput(f"'{self._path}' has column names but no rows; give a log with data.")
        reason = ' '.join(error.split())
        return BadInput(
            f"'{self._path}' cannot be read as a text table ({reason[:200]}); correct the file, "
            'or the entries under "text" in the mapping, such as the delimiter.'
        )

    def _find_non_numeric_cell(self, name: str) -> tuple[int, str] | None:
        """Return row and text of the first non-numeric cell of a column."""
        row = 0
        with self._path.open('rb') as stream:
            for batch in TextRows(stream, self._mapping.text, self._names, {name: pa.binary()}):
                for cell in map(decode_cell, batch.column(name).to_pylist()):
                    row += 1
                    if cell and not is_number(cell):
                        return row, shorten_cell(cell)
        return None


@final
class TextRows:
    """The rows of a text as record batches; rows with too many or too few cells are skipped."""

    def __init__(
        self,
        stream: BinaryIO,
        text: TextFormat,
        names: list[str],
        types: Mapping[str, pa.DataType],
    ) -> None:
        unread = text.skip + (1 if text.header is None else 0)
        self._lines, delimiter = open_text_lines(
            stream, text, unread, NAMED.get(text.delimiter, text.delimiter).join(names).encode()
        )
        self._skipped = 0
        self._skipped_bytes = 0  # since the last row that was read
        self._first_skipped = ''
        self._rows = 0
        # Bytes, since a text may not be UTF-8. Read at least one column to count the rows.
        column_types = types or {names[0]: pa.binary()}
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
                    include_columns=list(column_types),
                    column_types=dict(column_types),
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


def decode_cell(cell: bytes | None) -> str:
    """Return a cell as text; '' if it is missing."""
    return '' if cell is None else cell.decode(errors='replace')


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
