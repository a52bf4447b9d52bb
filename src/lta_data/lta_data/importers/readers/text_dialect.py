"""Detect how a text with columns is written: delimiter, comments, lines before the names."""

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
import re
from typing import Final, Literal

from lta_config.errors import BadInput
from lta_config.limits import check_column_count, LINE_BYTES
from lta_config.schema.import_file import TextFormat
from lta_data.importers.draft.name_hints import UNIT_WORDS
from lta_data.importers.readers.line_stream import decompress_stream

LINES: Final = 60  # that are looked at
DELIMITERS: Final = {',': ',', ';': ';', 'tab': '\t', 'whitespace': None}
DECIMALS: Final[tuple[Literal['.', ','], ...]] = ('.', ',')
COMMENTS: Final = '#%'
# Columns of a trajectory of the TUM RGB-D benchmark, which has no header
TUM: Final = ['timestamp', 'tx', 'ty', 'tz', 'qx', 'qy', 'qz', 'qw']


def detect_text_format(path: Path) -> TextFormat:
    """
    Return the format of the lines of a text.

    The rows are the lines of numbers with the most frequent number of cells; the names are in the
    line before the first row, also as a comment. Without names, columns are column_1 and so on.

    Raise `BadInput` if no two lines have equally many numbers.
    """
    lines = list(_read_lines(path))
    row_counts = {
        (name, decimal): _count_rows(lines, mark, decimal)
        for decimal in DECIMALS
        for name, mark in DELIMITERS.items()
        if name != decimal
    }
    # By rows, then by how many more cells are numbers than not: a comma may be either mark
    (delimiter, decimal), (rows, _, cells) = max(row_counts.items(), key=lambda one: one[1])
    if rows < 2:
        raise BadInput(
            f"'{path}' has no two lines with equally many numbers between commas, semicolons, "
            'tabs or spaces; give a text with columns of numbers.'
        )
    check_column_count(path, cells)
    mark = DELIMITERS[delimiter]
    are_rows = [_is_row(line, mark, decimal, cells) for line in lines]
    # A single row of numbers before the names is that of a preamble, such as the number of frames
    pairs = (i for i in range(len(lines) - 1) if are_rows[i] and are_rows[i + 1])
    first = next(pairs, are_rows.index(True))
    before = [i for i in range(first) if lines[i].strip()]
    marks = [start for i in before if (start := lines[i].lstrip()[0]) in COMMENTS]
    comment = marks[0] if marks else None
    names = _find_names([lines[i] for i in before], delimiter, cells)
    if names is None and lines[first].strip().endswith(delimiter):
        # Not a delimiter at the end of the rows, but a last column without values
        names = _find_names([lines[i] for i in before], delimiter, cells + 1)
        cells += names is not None
    plain = [i for i in before if lines[i].lstrip()[:1] not in COMMENTS]
    if names is not None and _are_units(names):
        above = _find_names([lines[i] for i in before[:-1]], delimiter, cells)
        # The mapping lists the names, as no single line has both
        if above is not None:
            names = [_add_unit(name, unit) for name, unit in zip(above, names, strict=True)]
            before = []
    if joined := _join_lines_of_names([lines[i] for i in plain], mark, cells):
        # The mapping lists them, too
        names, before = joined, []
    # The line with the names is read by its position, unless it is a comment or not there
    if names is not None and before and plain and plain[-1] == before[-1]:
        return TextFormat(
            delimiter=delimiter, decimal=decimal, comment=comment, skip=len(plain) - 1
        )
    if names is None:
        names = TUM if cells == len(TUM) and mark is None else _number_columns(cells)
    return TextFormat(
        delimiter=delimiter, decimal=decimal, comment=comment, skip=len(plain), header=names
    )


def split_cells(line: str, mark: str | None) -> list[str]:
    """Return the stripped cells of a line; `mark` None stands for white space."""
    cells = [cell.strip().strip('"') for cell in line.strip().split(mark)]
    # A delimiter at the end of a line
    return cells[:-1] if mark in (',', ';', '\t') and cells and not cells[-1] else cells


def _read_lines(path: Path) -> Iterator[str]:
    """Yield the first lines."""
    try:
        with path.open('rb') as stream:
            source = decompress_stream(stream)
            for _ in range(LINES):
                line = source.readline(LINE_BYTES)
                if not line:
                    return
                yield line.decode('utf-8-sig', errors='replace')
    except (OSError, EOFError) as error:
        raise BadInput(f"'{path}' cannot be read ({error}); give an intact text file.") from None


def _split_numbers(line: str, mark: str | None, decimal: str) -> list[str]:
    """Return the cells of a line with points as decimal marks."""
    return [cell.replace(decimal, '.') for cell in split_cells(line, mark)]


def _count_rows(lines: Sequence[str], mark: str | None, decimal: str) -> tuple[int, int, int]:
    """Return the rows of the most frequent length, numbers less other cells, and that length."""
    split = [_split_numbers(line, mark, decimal) for line in lines]
    table = [cells for cells in split if cells and _are_numbers(cells)]
    if not table:
        return 0, 0, 0
    counts = Counter(map(len, table))
    count, rows = max(counts.items(), key=lambda one: (one[1], one[0]))
    numbers = list(map(_is_number, chain.from_iterable(table)))
    return rows, 2 * sum(numbers) - len(numbers), count


def _is_row(line: str, mark: str | None, decimal: str, count: int) -> bool:
    cells = _split_numbers(line, mark, decimal)
    return len(cells) == count and _are_numbers(cells)


def _are_numbers(cells: Sequence[str]) -> bool:
    """Return whether cells are numbers: one at least, and a date or an empty cell beside it."""
    numbers = sum(_is_number(cell) for cell in cells)
    words = sum(bool(cell) and not _is_number(cell) for cell in cells)
    return numbers > 0 and numbers >= words


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _find_names(before: Sequence[str], delimiter: str, cells: int) -> list[str] | None:
    """Return the names of the columns, from the last line with as many."""
    for line in reversed(before):
        text = line.strip().lstrip(COMMENTS).strip()
        for mark in (DELIMITERS[delimiter], ',', ';', '\t', None):
            names = split_cells(text, mark)
            if len(names) == cells and not any(map(_is_number, names)):
                return _make_unique(names)
    return None


def _join_lines_of_names(lines: Sequence[str], mark: str | None, cells: int) -> list[str]:
    """
    Return names that are written in several lines, as a tracker does: Body / Position / X.

    Empty if the last line names each column by itself.
    """
    split = [
        [cell.strip().strip('"') for cell in line.strip('\r\n').split(mark)] for line in lines
    ]
    rows = [row for row in reversed(split) if len(row) == cells and not any(map(_is_number, row))]
    if not rows or _are_units(rows[0]) or len({*filter(None, rows[0])}) == sum(map(bool, rows[0])):
        return []
    names = rows[0]
    for above in rows[1:]:
        filled = [name for name in names if name]
        # Identifiers tell columns apart, but mean nothing to a reader
        if len({*filled}) < len(filled) and 'ID' not in above[:2]:
            # A word that stands once labels the line, and not a column with a name
            names = [
                f'{word} {name}'.strip() if not name or above.count(word) > 1 else name
                for word, name in zip(above, names, strict=True)
            ]
    return _make_unique(names)


def _make_unique(names: Sequence[str]) -> list[str]:
    unique: list[str] = []
    for index, name in enumerate(names):
        label = name or f'unnamed {index + 1}'
        unique.append(label if label not in unique else f'{label} ({index + 1})')
    return unique


def _are_units(names: Sequence[str]) -> bool:
    """Return whether most cells of a line are known units, and two of them at least."""
    filled = [unit for unit in map(_bare_unit, names) if unit]
    count = sum(unit in UNIT_WORDS for unit in filled)
    return count >= 2 and 2 * count > len(filled)


def _bare_unit(cell: str) -> str:
    """Return a unit without brackets, or without the number that makes a name unique."""
    return re.sub(r' \(\d+\)$|^unnamed \d+$', '', cell).strip('[]() -').lower()


def _add_unit(name: str, unit: str) -> str:
    bare = _bare_unit(unit)
    return f'{name} [{bare}]' if bare in UNIT_WORDS else name


def _number_columns(cells: int) -> list[str]:
    return [f'column_{index + 1}' for index in range(cells)]
